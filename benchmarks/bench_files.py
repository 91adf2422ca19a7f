"""Benchmarks of files: detail levels, prototypes, growth with the array, one element, exports, sheets.

Tasks with separately measured memory and imports run in their own process: `python benchmarks/bench_files.py
TASK ARGUMENTS.json` prints its result as JSON on its last line.
"""

from __future__ import annotations

import json
import shutil
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from measuring import (
    PEERS,
    Run,
    RunPlan,
    array_of,
    array_text,
    benchmark,
    cost,
    freecad,
    freecad_answer,
    freecad_version,
    in_turns,
    interleaved,
    measured,
    of_samples,
    published,
    published_text,
    python,
    tactcad,
)
from samples import BOX, draw_box, section, write
from tables import exponent, goal, table

from tactcad.contour import Arc, Contour
from tactcad.export.step_text import Header
from tactcad.fem.elements import solve_plane
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import ladder
from tactcad.parts.language.description import DETAILS, Part
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.scene import Scene

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

HEADER = Header("bench", "bench", "A", "2026-01-01", "", "")
PICTURES = ("above", "open")


def child(task: Callable[..., dict], **arguments: object) -> list[str]:
    """A task as a process."""
    return python(__file__, task.__name__, json.dumps(arguments))


class Clock:
    """Seconds of named stages."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def __call__(self, name: str, action: Callable[[], Any]) -> Any:
        start = time.perf_counter()
        result = action()
        self.seconds[name] = time.perf_counter() - start
        return result


# --- tasks of processes of their own ---


def kernel() -> dict:
    """The kernel is loaded, nothing else."""
    import tactcad.export.step_file
    import tactcad.solids.build  # noqa: F401

    return {}


def assembly(scene: str, detail: str, path: str) -> dict:
    """Parts of one scene of the published design built, and its STEP assembly written and read back."""
    from tactcad.scenes.scene import at_detail

    kernel()
    clock = Clock()
    made = clock("describe", lambda: at_detail(make_scene(published(), scene), detail))
    shapes = clock("build", lambda: _shapes(made))
    data = clock("step", lambda: _step(made, shapes))
    Path(path).write_bytes(data)
    sizes = {"parts": len(made.parts), "solids": len(made.placements)}
    return {"seconds": clock.seconds, "bytes": len(data), **sizes}


def step(elements: int, shared: bool) -> dict:
    """The array's STEP assembly with one prototype a part, or with every placed part a shape of its own."""
    kernel()
    scene = make_scene(array_of(elements), "array")
    shapes = _shapes(scene)
    if not shared:
        scene, shapes = unshared(scene, shapes)
    clock = Clock()
    data = clock("step", lambda: _step(scene, shapes))
    return {"seconds": clock.seconds, "bytes": len(data), "solids": len(scene.placements)}


def stages(elements: int) -> dict:
    """What an export and a check of the array consist of, each stage's time."""
    from tactcad.checks.on_solids.interference import check_interference
    from tactcad.parts.rules import refuse_broken

    kernel()
    clock, design = Clock(), array_of(elements)
    clock("rules between fields", lambda: refuse_broken(design))
    scene = clock("placements and contacts", lambda: make_scene(design, "array"))
    shapes = clock("solids of its parts", lambda: _shapes(scene))
    clock("STEP assembly", lambda: _step(scene, shapes))
    for name in PICTURES:
        clock(f"picture, {name}", partial(_picture, scene, shapes, name))
    clock("interference", lambda: check_interference(scene, shapes))
    return {"seconds": clock.seconds}


def element(designator: str, repeats: int, files: dict[str, str]) -> dict:
    """One element built and written `repeats` times, as an export does it, to the file of "tactcad"; then the
    volume (mm3) of the one solid in each file."""
    from tactcad.export.step_file import part_step
    from tactcad.solids.build import build
    from tactcad.solids.measure import volume
    from tactcad.solids.step import model_file

    part = placed_part(designator)
    times: dict[str, Any] = {"build": [], "write": []}
    for _ in range(repeats):
        clock = Clock()
        solid = clock("build", lambda: build(part))
        data = clock("write", partial(part_step, part, solid, HEADER))
        for name, seconds in clock.seconds.items():
            times[name].append(seconds)
    Path(files["tactcad"]).write_bytes(data)
    read = {name: model_file(path).volume for name, path in files.items()}
    return times | {"volume": volume(solid), "read": read}


TASKS = {task.__name__: task for task in (kernel, assembly, step, stages, element)}


def _shapes(scene: Scene) -> dict[str, TopoDS_Shape]:
    from tactcad.solids.build import build

    return {part.part_no: build(part) for part in scene.parts}


def _step(scene: Scene, shapes: dict) -> bytes:
    from tactcad.export.step_file import scene_step

    return scene_step(scene, shapes, HEADER)


def _picture(scene: Scene, shapes: dict, name: str) -> bytes:
    from tactcad.drawing.engine import picture
    from tactcad.solids.occt import placed_shape

    shown = [p for p in scene.placements if name == "above" or p.designator not in scene.cover]
    drawn = picture.drawing(
        [placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in shown], picture.ABOVE
    )
    data = picture.svg(drawn, "bench", "bench")
    picture.check_picture(data, shown, picture.ABOVE)
    return data


def unshared(scene: Scene, shapes: Mapping[str, TopoDS_Shape]) -> tuple[Scene, dict[str, TopoDS_Shape]]:
    """The scene with a part number and a shape, copied, for every placement."""
    from tactcad.solids.step import from_bytes, to_bytes

    placements = tuple(
        replace(p, part=replace(p.part, part_no=f"{p.part.part_no}_{p.designator}")) for p in scene.placements
    )
    copies = {
        new.part.part_no: from_bytes(to_bytes(shapes[old.part.part_no]))
        for new, old in zip(placements, scene.placements)
    }
    return replace(scene, placements=placements), copies


def placed_part(designator: str) -> Part:
    """Of the published array."""
    scene = make_scene(published(), "array")
    return next(p.part for p in scene.placements if p.designator == designator)


# --- detail levels ---


@benchmark(
    "detail",
    "Detail levels of each scene",
    "What do holes, pockets and threads cost where an envelope would do?",
)
def detail_levels(plan: RunPlan) -> dict:
    scenes, path = scene_names(published())[: plan.of(1, None, None)], str(plan.folder / "scene.step")
    commands = {
        (scene, detail): child(assembly, scene=scene, detail=detail, path=path)
        for scene in scenes
        for detail in DETAILS
    }
    plan.say("the kernel alone")
    floor = measured(child(kernel)).peak_bytes if plan.mode != "smoke" else 0
    rows: list[dict] = []
    for (scene, detail), runs in in_turns(commands, plan.of(1, 1, 3), plan.say).items():
        said = [run.last_line for run in runs]
        row = {"scene": scene, "detail": detail, "parts": said[0]["parts"], "solids": said[0]["solids"]}
        row |= cost(runs, [sum(t["seconds"].values()) for t in said])
        row |= {"above": row["peak_bytes"] - floor, "bytes": said[0]["bytes"]}
        rows.append(row | (_exported(scene, detail, plan) if plan.mode == "full" else {}))
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
    sizes, times = ([r[f"{key} ratio"] for r in rows[1::2]] for key in ("size", "time"))
    findings = [
        f"Envelopes take {min(times):.2f} to {max(times):.2f} of the time and {min(sizes):.2f} to "
        f"{max(sizes):.2f} of the file of full parts, "
        "and show no holes, pockets or threads: for collision and layout.",
        f"Memory is the kernel's: no scene adds more than {max(r['above'] for r in rows) / 1e6:.0f} MB to "
        "it.",
    ]
    return {"tables": {"detail": table(columns, rows, note)}, "findings": findings}


def _exported(scene: str, detail: str, plan: RunPlan) -> dict:
    """The whole command, cold and again, with a cache of its own."""
    folder, design = plan.folder / f"{scene}-{detail}", plan.folder / "design.toml"
    design.write_text(published_text(), "utf-8")
    out = folder / "out"
    export = tactcad("export", design, "--scene", scene, "--detail", detail, "--out", out)
    plan.say(f"{scene}, {detail}: whole export")
    cold, *again = (measured(export, TACTCAD_CACHE=str(folder / "cache")).seconds for _ in range(4))
    files = exported_files(out)
    size = sum((out / f["path"]).stat().st_size for f in files)
    return {"cold": cold, "unchanged": min(again), "files": len(files) + 1, "export_bytes": size}


def exported_files(out: Path) -> list[dict]:
    return json.loads((out / "manifest.json").read_text("utf-8"))["files"]


# --- shared prototypes ---


@benchmark(
    "step", "STEP with and without shared prototypes", "What do shared prototypes save in an assembly file?"
)
def prototypes(plan: RunPlan) -> dict:
    rows = []
    for elements in plan.of((2,), (10, 40), (10, 100, 400)):
        commands = {
            "shared": child(step, elements=elements, shared=True),
            "copies": child(step, elements=elements, shared=False),
        }
        plan.say(f"{elements} elements")
        for name, runs in in_turns(commands, plan.of(1, 1, 3), plan.say).items():
            said = [run.last_line for run in runs]
            row = {"elements": elements, "solids": said[0]["solids"], "form": name, "bytes": said[0]["bytes"]}
            rows.append(row | cost(runs, [t["seconds"]["step"] for t in said]))
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
    return {"tables": {"prototypes": table(columns, rows)}, "findings": [finding]}


# --- growth with the number of elements ---

# Reasons why a stage may grow faster than its array; others are reported as unexplained.
_PICTURES = (
    "hidden lines: up to 300 shapes exactly, every edge against every face near it; beyond, strip by strip "
    "on triangles, but plates as long as the picture reach into every strip with all their holes"
)
EXPLAINED = {"picture, above": _PICTURES, "picture, open": _PICTURES, "all of these, process": "its pictures"}
NOISE = 0.15  # by which the exponent between two single times of a linear cost may be off


@benchmark("scaling", "Scaling with the number of elements", "Does any cost grow faster than the array?")
def scaling(plan: RunPlan) -> dict:
    rows = _estimates(plan) + _batches(plan) + _geometry(plan)
    exponents = _exponents(rows)
    columns = (
        "what; elements; seconds: time [ms]; median [ms]; each: time an element [us]; "
        "peak_bytes: peak memory [MB]"
    )
    fitted = (
        "what; from; to: to elements; exponent; low: 95 % from; high: to; last: last two sizes; verdict; why"
    )
    note = (
        "cost = a n^p by least squares of the logarithms, Student's interval. Fixed costs hide growth at "
        "small sizes: the last two sizes alone stand beside it."
    )
    in_fresh = "Geometry: stages of one export and check in a fresh process."
    findings = [
        f"{e['what']}: n^{e['exponent']:.2f}, n^{e['last']:.2f} between the two largest: {e['why']}."
        for e in exponents
        if e["verdict"] == "above linear"
    ]
    if exponents and not findings:
        findings = ["Nothing grows faster than the number of elements."]
    return {
        "tables": {
            "exponents": table(fitted, exponents, note, "Fitted exponents"),
            "scaling": table(columns, rows, in_fresh),
        },
        "findings": findings,
    }


def _estimates(plan: RunPlan) -> list[dict]:
    """The default closed form in this process, range checks included, and plane elements."""
    sizes = plan.of((10, 100), (10, 100, 1000, 10_000), (10, 30, 100, 300, 1000, 3000, 10_000))
    few = plan.of((1, 2), (3, 10, 30), (10, 30, 100, 300))
    plan.say("estimates by the default rung")
    forms = {n: partial(ladder.evaluate, section(draw_box(n, plan.seed))) for n in sizes}
    timed = interleaved(forms, plan.of(1, 5, 15))
    rows = [_row("estimate, rung solid", n, t.seconds, t.median) for n, t in timed.items()]
    designs = section(draw_box(max(few), plan.seed))
    plan.say("plane elements, density 3")
    shapes = [reference_shape(designs.rows(i)) for i in range(max(few))]
    elements = {n: lambda n=n: [solve_plane(s, 1.0, 0.33, 1.0) for s in shapes[:n]] for n in few}
    timed = interleaved(elements, plan.of(1, 1, 3))
    return rows + [_row("plane elements, density 3", n, t.seconds, t.median) for n, t in timed.items()]


def _batches(plan: RunPlan) -> list[dict]:
    """`tactcad estimate --batch` as a process, from CSV file to CSV file."""
    rows, source = [], plan.folder / "batch.csv"
    run = tactcad("estimate", "--batch", source, "--out", plan.folder / "stiffness.csv")
    for n in plan.of((10, 100), (10, 100, 1000, 10_000), (10, 100, 1000, 10_000)):
        plan.say(f"tactcad estimate --batch, {n} rows")
        drawn = draw_box(n, plan.seed)
        write({k: drawn[k] for k in BOX} | {"youngs_modulus": np.full(n, 70e3)}, source)
        runs = [measured(run) for _ in range(plan.of(1, 2, 5))]
        rows.append(_row("estimate --batch, process", n, **cost(runs)))
    return rows


def _geometry(plan: RunPlan) -> list[dict]:
    rows = []
    for n in plan.of((2,), (10, 20, 40, 100), (10, 30, 100, 300, 1000)):
        plan.say(f"geometry of {n} elements")
        runs = [measured(child(stages, elements=n)) for _ in range(plan.of(1, 1, 2))]
        said = [run.last_line["seconds"] for run in runs]
        for stage in said[0]:
            timed = of_samples([seconds[stage] for seconds in said])
            rows.append(_row(stage, n, timed.seconds, timed.median))
        rows.append(_row("all of these, process", n, **cost(runs)))
    return rows


def _row(what: str, n: int, seconds: float, median: float, peak_bytes: float | None = None) -> dict:
    row = {"what": what, "elements": n, "seconds": seconds, "median": median, "each": seconds / n}
    return row | {"peak_bytes": peak_bytes}


def _exponents(rows: list[dict]) -> list[dict]:
    found = []
    for what in dict.fromkeys(row["what"] for row in rows):
        group = [row for row in rows if row["what"] == what]
        sizes = [row["elements"] for row in group]
        if len(sizes) < 2:
            continue
        p = exponent(sizes, [row["seconds"] for row in group])
        above = p.low > 1.0 or p.last > 1.0 + NOISE
        finite = np.isfinite(p.low)
        row = {"what": what, "from": sizes[0], "to": sizes[-1], "exponent": p.value}
        row |= {"low": p.low if finite else None, "high": p.high if finite else None, "last": p.last}
        row["verdict"] = "above linear" if above else "at most linear"
        found.append(row | {"why": EXPLAINED.get(what, "not explained") if above else ""})
    return found


# --- one element ---


@benchmark(
    "element",
    "One element: tactcad, the bare kernel, FreeCAD",
    "What do the description, its checks and repeatable files cost over a script?",
)
def one_element(plan: RunPlan) -> dict:
    part, repeats = placed_part("E1"), plan.of(1, 5, 20)
    paths = {name: plan.folder / f"{name}.step" for name in ("FreeCAD", "bare kernel", "tactcad")}
    if not freecad_version():
        del paths["FreeCAD"]
    runs: dict[str, list[dict]] = {name: [] for name in paths}
    for _ in range(plan.of(1, 1, 3)):
        for name in paths:  # tactcad comes last and reads back what all have written
            plan.say(name)
            job, own = as_job(part, repeats, paths[name]), {}
            if name == "FreeCAD":
                command, own = freecad(job)
            elif name == "bare kernel":
                command = python(PEERS / "kernel_element.py", json.dumps(job))
            else:
                files = {n: str(path) for n, path in paths.items()}
                command = child(element, designator="E1", repeats=repeats, files=files)
            run = measured(command, **own)
            said = freecad_answer(run.output) or run.last_line
            runs[name].append(said | {"process": run.seconds, "peak_bytes": run.peak_bytes})
    read = runs["tactcad"][-1]["read"]
    rows = [_program(name, own, read[name], part, paths[name]) for name, own in reversed(runs.items())]
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
    others = "; ".join(f"{r['program']} {1e3 * (r['build'] + r['write']):.0f} ms" for r in rows[1:])
    finding = (
        "tactcad builds, checks, writes and reads back an element in "
        f"{1e3 * (rows[0]['build'] + rows[0]['write']):.0f} ms ({others}); "
        "all volumes agree with the closed form within "
        f"{1e6 * max(max(r['off'], r['read off']) for r in rows):.1g} ppm."
    )
    missing = [] if freecad_version() else ["FreeCAD (freecadcmd) is not installed: not compared."]
    return {"tables": {"element": table(columns, rows, note)}, "findings": [finding], "missing": missing}


def as_job(part: Part, repeats: int, path: Path) -> dict:
    """The part's contour for a peer's script."""
    return {
        "outer": _chain(part.extrusion.outer),
        "openings": [_chain(c) for c in part.extrusion.openings],
        "thickness": part.extrusion.thickness,
        "repeats": repeats,
        "step": str(path),
    }


def _chain(contour: Contour) -> list:
    if whole := contour.as_circle():
        return [["circle", *whole]]
    return [
        ["arc", s.start, s.at(0.5), s.end] if isinstance(s, Arc) else ["line", s.start, s.end]
        for s in contour
    ]


def _program(name: str, runs: list[dict], read: float, part: Part, path: Path) -> dict:
    build, write = ([s for f in runs for s in f[key]] for key in ("build", "write"))
    return {
        "program": name,
        "build": min(build),
        "write": min(write),
        "median": of_samples([b + w for b, w in zip(build, write)]).median,
        "process": min(f["process"] for f in runs),
        "peak_bytes": min(f["peak_bytes"] for f in runs),
        "bytes": path.stat().st_size,
        "volume": runs[0]["volume"],
        "off": abs(runs[0]["volume"] / part.volume - 1.0),
        "read off": abs(read / part.volume - 1.0),
    }


# --- whole exports ---

GOALS = {"cold / plain": 1.5, "unchanged / numpy": 3.0, "STEP over smallest": 5.0}
GOAL_ESTIMATE = 3.0  # times `import numpy`
NUMPY = python("-c", "import numpy")


@benchmark(
    "export",
    "Whole exports",
    "How long from design file to finished folder: first, again, and after a change?",
)
def exports(plan: RunPlan) -> dict:
    sizes = plan.of({2: 1}, {10: 1}, {10: 5, 100: 3, 1000: 1})  # elements: runs
    rows = [_export(elements, runs, plan) for elements, runs in sizes.items()]
    for row in rows:
        row["STEP over smallest"] = row["bytes"] / rows[0]["bytes"]
    starts = _starts(plan)
    columns = (
        "elements; runs; cold [s]; plain: plain script [s]; cold / plain: ratio; "
        "changed: one arm changed [s]; unchanged [s]; numpy: import numpy [s]; unchanged / numpy: ratio; "
        "peak_bytes: peak memory [MB]; bytes: assembly STEP [kB]; STEP over smallest: over the smallest"
    )
    started = (
        "what: process; seconds: time [s]; median [s]; ratio: over import numpy; peak_bytes: peak memory [MB]"
    )
    note = (
        "`tactcad export --scene array` in fresh processes, shortest of the runs. Cold: empty cache. The "
        "plain script builds each shape once, writes each file once and reads it back once, without tactcad, "
        "cache or repeatable bytes."
    )
    findings = []
    for name, most in GOALS.items():
        missed = [f"{row['elements']} elements: {row[name]:.2f}" for row in rows if row[name] > most]
        worst = max(row[name] for row in rows)
        words = f"{name} at most {most:g}: {', '.join(missed)}." if missed else None
        findings.append(goal(words or f"{name} {worst:.2f} (goal {most:g}).", not missed))
    ratio = next(row for row in starts if row["what"] == "tactcad estimate")["ratio"]
    words = f"`tactcad estimate` takes {ratio:.2f} times `import numpy` (goal {GOAL_ESTIMATE:g})."
    return {
        "tables": {
            "export": table(columns, rows, note),
            "start-up": table(started, starts, "Whole processes, in turns.", "Starting up"),
        },
        "findings": [*findings, goal(words, ratio <= GOAL_ESTIMATE)],
    }


def _export(elements: int, runs: int, plan: RunPlan) -> dict:
    times: dict[str, list[float]] = {name: [] for name in ("cold", "plain", "changed", "unchanged", "numpy")}
    peaks = []
    for run in range(runs):
        folder = plan.folder / f"export-{elements}-{run}"
        folder.mkdir()
        design, out = folder / "design.toml", folder / "out"
        cache = {"TACTCAD_CACHE": str(folder / "cache")}
        export = tactcad("export", design, "--scene", "array", "--out", out)
        design.write_text(array_text(elements), "utf-8")
        load(design)  # a design that breaks a rule would only measure its refusal
        plan.say(f"{elements} elements, cold, run {run + 1}")
        cold = measured(export, **cache)
        times["cold"].append(cold.seconds)
        peaks.append(cold.peak_bytes)
        plan.say(f"{elements} elements, plain script, run {run + 1}")
        plain = python(PEERS / "plain_export.py", elements, folder / "plain")
        times["plain"].append(measured(plain).seconds)
        for _ in range(plan.of(1, 5, 10) if run == 0 else 0):
            times["unchanged"].append(measured(export, **cache).seconds)
            times["numpy"].append(measured(NUMPY).seconds)
        size = sum(
            (out / f["path"]).stat().st_size for f in exported_files(out) if f["kind"] == "step-assembly"
        )
        if plan.mode != "smoke":
            plan.say(f"{elements} elements, one arm changed, run {run + 1}")
            design.write_text(array_text(elements, changed=True), "utf-8")
            times["changed"].append(measured(export, **cache).seconds)
    row = {"elements": elements, "runs": runs, "bytes": size, "peak_bytes": min(peaks)}
    row |= {name: min(seconds, default=None) for name, seconds in times.items()}
    for above, below in (("cold", "plain"), ("unchanged", "numpy")):
        row[f"{above} / {below}"] = min(times[above]) / min(times[below])
    return row


def _starts(plan: RunPlan) -> list[dict]:
    commands = {
        "python -c 'import numpy'": NUMPY,
        "tactcad estimate": tactcad("estimate"),
        "tactcad schema": tactcad("schema"),
        "the CAD kernel and build123d": child(kernel),
    }
    chosen = dict(list(commands.items())[: plan.of(2, None, None)])
    runs = in_turns(chosen, plan.of(1, 3, 15), plan.say)
    rows: list[dict] = [{"what": name} | cost(made) for name, made in runs.items()]
    for row in rows:
        row["ratio"] = row["seconds"] / rows[0]["seconds"]
    return rows


# --- drawing sheets ---

ONE_CORE = ("taskset", "-c", "0")


@benchmark("sheets", "Drawing sheets", "What do dimensioned sheets of every part add to an export?")
def sheets(plan: RunPlan) -> dict:
    design = plan.folder / "sheets.toml"
    design.write_text(array_text(plan.of(2, 10, 10)), "utf-8")
    scenes = plan.of(("--scene", "array"), ("--scene", "array"), ())
    pinned = shutil.which(ONE_CORE[0]) is not None
    all_cores, one_core = "sheets, all cores", "sheets, one core"
    kinds: dict[str, Sequence[str]] = {"without sheets": (), all_cores: ("--drawings",)}
    kinds |= {one_core: ("--drawings",)} if pinned else {}
    if plan.mode == "smoke":
        kinds = {all_cores: kinds[all_cores]}
    runs: dict[str, list[Run]] = {kind: [] for kind in (*kinds, "sheets, unchanged")}
    for turn in range(plan.of(1, 1, 3)):
        for kind, options in kinds.items():
            plan.say(f"{kind}, run {turn + 1}")
            folder = plan.folder / f"{kind}-{turn}"
            export = tactcad("export", design, *scenes, *options, "--out", folder / "out")
            cache = {"TACTCAD_CACHE": str(folder / "cache")}
            runs[kind].append(measured([*(ONE_CORE if kind == one_core else ()), *export], **cache))
            if kind == all_cores:
                runs["sheets, unchanged"].append(measured(export, **cache))
                count = len(list((folder / "out" / "drawings").glob("*.pdf")))
    rows: list[dict] = [
        {"what": kind} | cost(made) | {"sheets": count if kind != "without sheets" else 0}
        for kind, made in runs.items()
    ]
    by, without = {row["what"]: row for row in rows}, runs.get("without sheets")
    for kind in (all_cores, one_core) if without else ():
        if kind in by:
            by[kind]["added"] = by[kind]["seconds"] - by["without sheets"]["seconds"]
    columns = (
        "what: export; sheets; seconds: time [s]; median [s]; added: over without [s]; "
        "peak_bytes: peak memory [MB]"
    )
    note = (
        f"`tactcad export {' '.join(scenes)}` of the published design, empty cache but for the unchanged "
        "one; one core keeps the whole export on it."
    )
    findings = [
        f"{r['sheets']} sheets add {r['added']:.1f} s to an export of {r['seconds'] - r['added']:.1f} s "
        "on all cores."
        for r in (by[all_cores],)
        if "added" in r
    ]
    missing = [] if pinned else ["taskset is not installed: one core was not measured."]
    return {"tables": {"sheets": table(columns, rows, note)}, "findings": findings, "missing": missing}


if __name__ == "__main__":
    print(json.dumps(TASKS[sys.argv[1]](**json.loads(sys.argv[2]))))
