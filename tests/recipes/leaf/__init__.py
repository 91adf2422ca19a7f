"""A single leaf: a strip of sheet on a block, bent by a force at its end."""

from __future__ import annotations

from tactcad.design.family import Family, FamilyEstimate, FamilyReadings, FamilyStack, Late

from .tables import LeafDesign

HERE = "tactcad.families.leaf"
FAMILY = Family(
    name="leaf",
    spec=LeafDesign,
    layout=Late(f"{HERE}.tables:LeafLayout"),
    about=Late(f"{HERE}.parts:about"),
    parts=Late(f"{HERE}.parts:measured"),
    scenes=f"{HERE}.scene",
    rules=Late(f"{HERE}.parts:rules"),
    estimate=FamilyEstimate(
        rows=Late(f"{HERE}.parts:rows"),
        run=Late("tactcad.cli.estimate:plain_estimate"),
        golden=Late(f"{HERE}.parts:golden"),
        strength=Late(f"{HERE}.parts:strength"),
        strain=None,
    ),
    plans={},
    stack=FamilyStack(
        limits=Late(f"{HERE}.scene:limits"),
        built=Late(f"{HERE}.scene:Laid"),
        figures=Late(f"{HERE}.scene:figures"),
        elements=Late("tactcad.scenes.rig:none"),
    ),
    pads=None,
    readout=None,
    readings=FamilyReadings(
        calibrate=Late(f"{HERE}.parts:calibrate"), stiffness=Late("tactcad.scenes.rig:none")
    ),
    variables=None,
    checks=f"{HERE}.scene",
)
