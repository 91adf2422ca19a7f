"""STEP assemblies with one prototype a part, and with every placed part a shape of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from tactcad.scenes.scene import Scene

from .bench_tables import table
from .process import child, cost, in_turns, last_line
from .run_plan import RunPlan

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

TITLE = "STEP with and without shared prototypes"
QUESTION = "What do shared prototypes save in an assembly file?"
FORMS = {"shared": True, "copies": False}


def unshared(scene: Scene, shapes: Mapping[str, TopoDS_Shape]) -> tuple[Scene, dict[str, TopoDS_Shape]]:
    """The scene with a part number and a shape, copied, for every placement."""
    from tactcad.solids.bytes import from_bytes, to_bytes

    placements = tuple(
        replace(p, part=replace(p.part, part_no=f"{p.part.part_no}_{p.designator}")) for p in scene.placements
    )
    data = {part.part_no: to_bytes(shapes[part.part_no]) for part in scene.parts}
    copies = {
        new.part.part_no: from_bytes(data[old.part.part_no]) for new, old in zip(placements, scene.placements)
    }
    return replace(scene, placements=placements), copies


def measure(plan: RunPlan) -> dict:
    rows = []
    for elements in plan.of((2,), (10, 40), (10, 100, 400)):
        commands = {name: child("step", elements=elements, shared=shared) for name, shared in FORMS.items()}
        plan.say(f"{elements} elements")
        for name, runs in in_turns(commands, plan.of(1, 1, 3), plan.say).items():
            told = [last_line(run) for run in runs]
            row = {"elements": elements, "solids": told[0]["solids"], "form": name, "bytes": told[0]["bytes"]}
            rows.append(row | cost(runs, [t["seconds"]["step"] for t in told]))
    for original, copies in zip(rows[::2], rows[1::2]):
        copies["size ratio"] = copies["bytes"] / original["bytes"]
        copies["time ratio"] = copies["seconds"] / original["seconds"]
    columns = (
        "elements; solids; form: prototypes; bytes: file [kB]; size ratio: over shared; seconds: written and "
        "read back [s]; median [s]; time ratio: over shared; peak_bytes: peak memory [MB]"
    )
    last = rows[-1]
    finding = (
        f"{last['elements']} elements, {last['solids']} solids: copies make the file "
        f"{last['size ratio']:.1f} times as large, and "
        f"writing it and reading it back {last['time ratio']:.1f} times as long."
    )
    return {"tables": {"prototypes": table(TITLE, columns, rows)}, "findings": [finding]}
