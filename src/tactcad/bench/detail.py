"""Detail levels of each scene: what full parts cost over envelopes, and a whole export of each."""

from __future__ import annotations

import json

from tactcad.parts.detail import DETAILS
from tactcad.scenes import scene_names

from . import arrays, tables
from .plan import Plan
from .process import child, command, last_line, measured
from .timing import of_samples

TITLE = "Detail levels of each scene"
QUESTION = "What do holes, pockets and threads cost where an envelope would do?"


def measure(plan: Plan) -> dict:
    scenes = scene_names(arrays.published())[: plan.of(1, None, None)]
    cases = [(scene, detail) for scene in scenes for detail in DETAILS]
    plan.say("the kernel alone")
    floor = measured(child("kernel")).peak_bytes if plan.mode != "smoke" else 0
    runs: dict[tuple[str, str], list] = {case: [] for case in cases}
    for turn in range(plan.of(1, 1, 3)):
        for scene, detail in cases:
            plan.say(f"{scene}, {detail}, run {turn + 1}")
            runs[scene, detail].append(
                measured(child("assembly", scene=scene, detail=detail, path=str(plan.folder / "scene.step")))
            )
    rows = [_row(scene, detail, runs[scene, detail], floor) for scene, detail in cases]
    if plan.mode == "full":
        for row in rows:
            row |= _exported(row["scene"], row["detail"], plan)
    for full, light in zip(rows[::2], rows[1::2]):
        light["time ratio"], light["size ratio"] = (
            light["seconds"] / full["seconds"],
            light["bytes"] / full["bytes"],
        )
    columns = [
        ("scene", "scene", tables.PLAIN),
        ("detail", "detail", tables.PLAIN),
        ("parts", "parts", tables.PLAIN),
        ("solids", "solids", tables.PLAIN),
        ("seconds", "built and written", tables.SECONDS),
        ("median", "median", tables.SECONDS),
        ("time ratio", "over full", tables.PLAIN),
        ("peak_bytes", "peak memory", tables.MEGA),
        ("above", "above the kernel", tables.MEGA),
        ("bytes", "STEP", tables.KILO),
        ("size ratio", "over full", tables.PLAIN),
        ("cold", "whole export", tables.SECONDS),
        ("unchanged", "unchanged", tables.SECONDS),
        ("files", "files", tables.PLAIN),
        ("export_bytes", "all files", tables.KILO),
    ]
    note = (
        "Built and written: parts described and built, assembly written and read back, in a fresh process; "
        "the kernel alone takes "
        f"{floor / 1e6:.0f} MB. Whole export: `tactcad export --scene`, empty cache (full runs only)."
    )
    return {
        "tables": {"detail": tables.table(TITLE, columns, rows, note)},
        "findings": findings(rows),
        "missing": [],
    }


def _row(scene: str, detail: str, runs: list, floor: int) -> dict:
    found = [last_line(run) for run in runs]
    timed = of_samples([sum(f["seconds"].values()) for f in found])
    peak = min(run.peak_bytes for run in runs)
    return {
        "scene": scene,
        "detail": detail,
        "parts": found[0]["parts"],
        "solids": found[0]["solids"],
        "seconds": timed.least,
        "median": timed.median,
        "peak_bytes": peak,
        "above": peak - floor,
        "bytes": found[0]["bytes"],
    }


def _exported(scene: str, detail: str, plan: Plan) -> dict:
    """The whole command, cold and again, with a cache of its own."""
    folder = plan.folder / f"{scene}-{detail}"
    design = plan.folder / "design.toml"
    design.write_text(arrays.published_text(), "utf-8")
    export = command(
        "export", str(design), "--scene", scene, "--detail", detail, "--out", str(folder / "out")
    )
    plan.say(f"{scene}, {detail}: whole export")
    cold, *again = (measured(export, {"TACTCAD_CACHE": str(folder / "cache")}).seconds for _ in range(4))
    files = [f["path"] for f in json.loads((folder / "out" / "manifest.json").read_text("utf-8"))["files"]]
    size = sum((folder / "out" / path).stat().st_size for path in files)
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
