"""Detail levels of each scene: what full parts cost over envelopes, and a whole export of each."""

from __future__ import annotations

from typing import Any

from tactcad.export.manifest import read_manifest
from tactcad.parts.envelope import DETAILS
from tactcad.scenes import scene_names

from . import arrays
from .bench_tables import table
from .process import Run, child, command, cost, in_turns, last_line, measured
from .run_plan import RunPlan

TITLE = "Detail levels of each scene"
QUESTION = "What do holes, pockets and threads cost where an envelope would do?"


def measure(plan: RunPlan) -> dict:
    scenes = scene_names(arrays.published())[: plan.of(1, None, None)]
    commands = {
        f"{scene}, {detail}": child(
            "assembly", scene=scene, detail=detail, path=str(plan.folder / "scene.step")
        )
        for scene in scenes
        for detail in DETAILS
    }
    plan.say("the kernel alone")
    floor = measured(child("kernel")).peak_bytes if plan.mode != "smoke" else 0
    runs = in_turns(commands, plan.of(1, 1, 3), plan.say)
    rows = [_row(name, made, floor) for name, made in runs.items()]
    if plan.mode == "full":
        for row in rows:
            row |= _exported(row["scene"], row["detail"], plan)
    for full, light in zip(rows[::2], rows[1::2]):
        light["time ratio"] = light["seconds"] / full["seconds"]
        light["size ratio"] = light["bytes"] / full["bytes"]
    columns = (
        "scene; detail; parts; solids; seconds: built and written [s]; median [s]; time ratio: over full; "
        "peak_bytes: peak memory [MB]; above: above the kernel [MB]; bytes: STEP [kB]; "
        "size ratio: over full; cold: whole export [s]; unchanged [s]; files; export_bytes: all files [kB]"
    )
    note = (
        "Built and written: parts described and built, assembly written and read back, in a fresh process; "
        "the kernel alone takes "
        f"{floor / 1e6:.0f} MB. Whole export: `tactcad export --scene`, empty cache (full runs only)."
    )
    return {"tables": {"detail": table(TITLE, columns, rows, note)}, "findings": findings(rows)}


def _row(name: str, runs: list[Run], floor: int) -> dict:
    scene, detail = name.split(", ")
    told = [last_line(run) for run in runs]
    row: dict[str, Any] = {
        "scene": scene,
        "detail": detail,
        "parts": told[0]["parts"],
        "solids": told[0]["solids"],
    }
    row |= cost(runs, [sum(t["seconds"].values()) for t in told])
    return row | {"above": row["peak_bytes"] - floor, "bytes": told[0]["bytes"]}


def _exported(scene: str, detail: str, plan: RunPlan) -> dict:
    """The whole command, cold and again, with a cache of its own."""
    folder = plan.folder / f"{scene}-{detail}"
    design = plan.folder / "design.toml"
    design.write_text(arrays.published_text(), "utf-8")
    export = command(
        "export", str(design), "--scene", scene, "--detail", detail, "--out", str(folder / "out")
    )
    plan.say(f"{scene}, {detail}: whole export")
    cold, *again = (measured(export, {"TACTCAD_CACHE": str(folder / "cache")}).seconds for _ in range(4))
    files = read_manifest(folder / "out").files
    size = sum((folder / "out" / f.path).stat().st_size for f in files)
    return {"cold": cold, "unchanged": min(again), "files": len(files) + 1, "export_bytes": size}


def findings(rows: list[dict]) -> list[str]:
    light = rows[1::2]
    sizes, times = [r["size ratio"] for r in light], [r["time ratio"] for r in light]
    return [
        f"Envelopes take {min(times):.2f} to {max(times):.2f} of the time and {min(sizes):.2f} to "
        f"{max(sizes):.2f} of the file of full parts, "
        "and show no holes, pockets or threads: for collision and layout.",
        f"Memory is the kernel's: no scene adds more than {max(r['above'] for r in rows) / 1e6:.0f} MB to "
        "it.",
    ]
