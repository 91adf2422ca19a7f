"""An export's files for robots: robot/NAME.urdf, NAME.xml, taxels.csv, taxels.json and meshes, read back."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from functools import partial
from pathlib import PurePosixPath
from xml.etree import ElementTree

import numpy as np

from tactcad.design.family import family_of
from tactcad.design.messages import InputError
from tactcad.export.inputs import digest
from tactcad.export.part_formats.usual import part_stl
from tactcad.export.products import Batch, Output, Plan, part_facts
from tactcad.export.shapes import Shapes
from tactcad.parts.language.description import NOT_MADE, Part
from tactcad.scenes.scene import Placement
from tactcad.solids import USUAL

from . import mjcf, taxel_table, urdf
from .mechanism import Inertia, Mechanism, Solid, mesh_name, seen, together

MM = 1e-3  # m


def jobs(plan: Plan) -> Iterator[Batch]:
    """One job for all files: they follow from one mechanism. Envelopes have no meshes to look at."""
    design, detail = plan.design, plan.options.detail
    mechanism: Mechanism = family_of(design).must("robot", "export --robot").mechanism(design)
    placed = (*mechanism.fixed, *(p for m in mechanism.moving for p in m.parts))
    meshes = {mesh_name(p): p.part for p in placed} if detail == "full" else {}
    key, name = digest(("robot", plan.shapes.made_by, design, detail)), design.design.name
    paths = [f"robot/{p}" for p in ("taxels.csv", "taxels.json", f"{name}.urdf", f"{name}.xml", *meshes)]
    files = tuple(Output(path, "robot", "", f"{key} {path}") for path in paths)
    own = Shapes(plan.shapes.cache, plan.shapes.made_by)  # whole parts, if the export's are envelopes
    yield Batch(files, partial(_made, mechanism, own, meshes), size=200)


def _made(mechanism: Mechanism, shapes: Shapes, meshes: dict[str, Part]) -> Sequence[bytes]:
    base, arms = solids(mechanism, shapes, bool(meshes))
    step, name = mjcf.timestep(mechanism, arms), mechanism.design.design.name
    taxels = taxel_table.as_made(mechanism.design, (m.taxel for m in mechanism.moving))
    texts = [urdf.text(mechanism, base, arms), mjcf.text(mechanism, base, arms, step)]
    refuse_foreign_meshes(f"{name}.urdf", texts[0], meshes)
    refuse_foreign_meshes(f"{name}.xml", texts[1], meshes)
    tables = [taxel_table.csv_bytes(taxels), taxel_table.json_bytes(taxels, step)]
    return [*tables, *texts, *(part_stl(p.part_no, shapes.of(p), USUAL, MM) for p in meshes.values())]


def refuse_foreign_meshes(name: str, text: bytes, known: Collection[str]) -> None:
    """Raise InputError for a mesh of a model, as read back, that is not in its folder."""
    root = ElementTree.fromstring(text)
    compiler = root.find("compiler")
    folder = PurePosixPath("" if compiler is None else compiler.get("meshdir", ""))
    for mesh in root.iter("mesh"):
        asked = mesh.get("filename") or mesh.get("file") or ""
        if str(folder / asked) not in known:
            legal = "a file in meshes/ of the robot's folder"
            raise InputError(
                f"{name}: mesh", "leads out of the folder, or to nothing", value=asked, legal=legal
            )


def solids(mechanism: Mechanism, shapes: Shapes, drawn: bool) -> tuple[Solid, tuple[Solid, ...]]:
    """The fixed parts, in the mount's frame, and every element in its own; `drawn`: with appearance."""
    made = [p for p in mechanism.fixed if p.part.process not in NOT_MADE]
    stands = together([_inertia(p, shapes) for p in mechanism.fixed])
    base = Solid(stands, mechanism.fixed if drawn else (), tuple(_box(p, shapes) for p in made))
    arms = []
    for m in mechanism.moving:
        parts, sides = tuple(seen(p, m.origin, m.turn) for p in m.parts), MM * m.box
        box = (sides.mean(axis=0), (sides[1] - sides[0]) / 2)
        inertia = together([_inertia(p, shapes) for p in parts])
        arms.append(Solid(inertia, parts if drawn else (), (box,)))
    return base, tuple(arms)


def _inertia(p: Placement, shapes: Shapes) -> Inertia:
    facts, R, mass = part_facts(p.part, shapes), np.array(p.rotation), MM * p.part.mass
    tensor = R @ np.array(facts["inertia"]) @ R.T * mass / facts["volume"] * MM**2
    return Inertia(mass, MM * (R @ np.array(facts["centre"]) + p.origin), tensor)


def _box(p: Placement, shapes: Shapes) -> tuple[np.ndarray, np.ndarray]:
    """Middle and half sides, m, of an axis-parallel part."""
    (low, high), R = np.array(part_facts(p.part, shapes)["box"]), np.array(p.rotation)
    return MM * (R @ (low + high) / 2 + p.origin), MM * np.abs(R) @ (high - low) / 2
