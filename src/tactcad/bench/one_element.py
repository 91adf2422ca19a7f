"""One element as a solid and as STEP: tactcad, the bare kernel and FreeCAD, from the same contour."""

from __future__ import annotations

import json
from pathlib import Path

from tactcad.contour import Arc, Contour
from tactcad.parts.description import Part
from tactcad.scenes import make_scene

from . import arrays, freecad
from .bench_tables import table
from .process import Run, child, last_line, measured, python
from .run_plan import RunPlan
from .timing import of_samples

TITLE = "One element: tactcad, the bare kernel, FreeCAD"
QUESTION = "What do the description, its checks and repeatable files cost over a script?"
BARE = Path(__file__).with_name("peers") / "kernel_element.py"

Program = tuple[str, list[str], dict[str, str] | None]


def measure(plan: RunPlan) -> dict:
    part = next(p.part for p in make_scene(arrays.published(), "array").placements if p.designator == "E1")
    repeats = plan.of(1, 5, 20)
    runs: dict[str, list[dict]] = {}
    for _ in range(plan.of(1, 1, 3)):
        for name, command, environment in _programs(part, repeats, plan.folder):
            plan.say(name)
            run = measured(command, environment)
            runs.setdefault(name, []).append(
                _answer(run) | {"process": run.seconds, "peak_bytes": run.peak_bytes}
            )
    read = runs["tactcad"][-1]["read"]
    rows = [_row(name, own, read[name], part.volume, plan.folder) for name, own in reversed(runs.items())]
    bare = next(row for row in rows if row["program"] == "bare kernel")
    for row in rows:
        row["time ratio"] = (row["build"] + row["write"]) / (bare["build"] + bare["write"])
    columns = (
        "program; build [ms]; write: write STEP [ms]; median: both, median [ms]; time ratio: over the bare "
        "kernel; process: whole process [s]; peak_bytes: peak memory [MB]; bytes: STEP [kB]; volume: volume, "
        "mm3; off: off the closed form [ppm]; read off: STEP read back, off [ppm]"
    )
    note = (
        f"{part.part_no}, {part.volume:.6f} mm3 in closed form. tactcad's build compares solid and closed "
        "form, and its file is read back and compared before it is let out; the scripts check nothing."
    )
    missing = [] if freecad.version() else ["FreeCAD (freecadcmd) is not installed: not compared."]
    return {
        "tables": {"element": table(TITLE, columns, rows, note)},
        "findings": findings(rows),
        "missing": missing,
    }


def as_job(part: Part, repeats: int, step: Path) -> dict:
    """The part's contour for a peer's script."""
    return {
        "outer": _chain(part.extrusion.outer),
        "openings": [_chain(c) for c in part.extrusion.openings],
        "thickness": part.extrusion.thickness,
        "repeats": repeats,
        "step": str(step),
    }


def _chain(contour: Contour) -> list:
    whole = contour.as_circle()
    if whole:
        return [["circle", *whole]]
    return [
        ["arc", s.start, s.at(0.5), s.end] if isinstance(s, Arc) else ["line", s.start, s.end]
        for s in contour
    ]


def _programs(part: Part, repeats: int, folder: Path) -> list[Program]:
    """(name, command, environment) of each; tactcad comes last and reads back what all have written."""
    job = {name: as_job(part, repeats, folder / f"{name}.step") for name in ("FreeCAD", "bare kernel")}
    programs: list[Program] = []
    if freecad.version():
        programs.append(("FreeCAD", freecad.command(), freecad.environment(job["FreeCAD"])))
    programs.append(("bare kernel", python(str(BARE), json.dumps(job["bare kernel"])), None))
    files = {name: str(folder / f"{name}.step") for name in ("tactcad", *(name for name, *_ in programs))}
    return [*programs, ("tactcad", child("element", designator="E1", repeats=repeats, files=files), None)]


def _answer(run: Run) -> dict:
    return freecad.answer(run.output) or last_line(run)


def _row(name: str, runs: list[dict], read: float, exact: float, folder: Path) -> dict:
    build, write = ([s for f in runs for s in f[key]] for key in ("build", "write"))
    volume = runs[0]["volume"]
    return {
        "program": name,
        "build": min(build),
        "write": min(write),
        "median": of_samples([b + w for b, w in zip(build, write)]).median,
        "process": min(f["process"] for f in runs),
        "peak_bytes": min(f["peak_bytes"] for f in runs),
        "bytes": (folder / f"{name}.step").stat().st_size,
        "volume": volume,
        "off": abs(volume / exact - 1.0),
        "read off": abs(read / exact - 1.0),
    }


def findings(rows: list[dict]) -> list[str]:
    ours = rows[0]
    others = "; ".join(f"{r['program']} {1e3 * (r['build'] + r['write']):.0f} ms" for r in rows[1:])
    worst = max(max(r["off"], r["read off"]) for r in rows)
    return [
        "tactcad builds, checks, writes and reads back an element in "
        f"{1e3 * (ours['build'] + ours['write']):.0f} ms ({others}); "
        f"all volumes agree with the closed form within {1e6 * worst:.1g} ppm."
    ]
