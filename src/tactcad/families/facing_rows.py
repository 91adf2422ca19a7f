"""Facing rows of cantilevers, each with its hinge, gauge, pad and stop: the published array."""

from __future__ import annotations

from tactcad.design.family import (
    Family,
    FamilyBoards,
    FamilyEstimate,
    FamilyPads,
    FamilyReadings,
    FamilyReadout,
    FamilyRobot,
    FamilyStack,
    Late,
)
from tactcad.design.tree import Design

FAMILY = Family(
    name="facing-rows",
    spec=Design,
    layout=Late("tactcad.parts.array.layout:Layout"),
    about=Late("tactcad.release.readme:facing_rows"),
    parts=Late("tactcad.parts.array.measurements:measurements"),
    scenes="tactcad.scenes.rigs",
    rules=Late("tactcad.parts.rules:design_rules"),
    estimate=FamilyEstimate(
        rows=Late("tactcad.lab.array_estimate:estimate"),
        run=Late("tactcad.cli.estimate:estimate_design"),
        golden=Late("tactcad.export.strength_table:elements"),
        strength=Late("tactcad.export.strength_table:strength_bytes"),
        strain=Late("tactcad.review.review_record:strain_field"),
    ),
    plans={
        "element": Late("tactcad.drawing.parts.element_plan:element_plan"),
        "array": Late("tactcad.drawing.assemblies.arrangement:mounting"),
    },
    stack=FamilyStack(
        limits=Late("tactcad.stacks.requirements:requirements"),
        built=Late("tactcad.stacks.mechanic:Assembled"),
        figures=Late("tactcad.stacks.virtual_build:element_figures"),
        elements=Late("tactcad.stacks.virtual_build:elements_built"),
    ),
    pads=FamilyPads(
        places=Late("tactcad.lab.pads:pads_of"),
        springs=Late("tactcad.lab.pads:springs_of"),
        limit=Late("tactcad.lab.pads:limit_of"),
    ),
    readout=FamilyReadout(
        netlist=Late("tactcad.circuit.bridges:netlist"),
        tracks=Late("tactcad.circuit.tracks:with_tracks"),
        wiring=Late("tactcad.circuit.netlist_files:wiring"),
        sheets=Late("tactcad.drawing.circuit_sheets.sheets:circuit_written"),
        signals=Late("tactcad.review.effect:signals"),
    ),
    readings=FamilyReadings(
        calibrate=Late("tactcad.cli.calibrate:calibrate_rows"),
        stiffness=Late("tactcad.cli.stiffness:stiffness_rows"),
    ),
    variables=Late("tactcad.synthesis.synthesise:design"),
    checks="tactcad.checks.facing_rows",
    robot=FamilyRobot(
        mechanism=Late("tactcad.robot.cantilevers:cantilevers"), jobs=Late("tactcad.robot.robot_files:jobs")
    ),
    boards=FamilyBoards(
        made=Late("tactcad.circuit.board_layout:laid_out"),
        supplies=Late("tactcad.parts.array.supplies:electronic_supplies"),
    ),
)
