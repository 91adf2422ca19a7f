"""What each way of answering costs, for `--within` and `--in`: src/tactcad/costs/data/costs.json.

    python benchmarks/costs.py                    all of it, some 20 minutes of one core
    python benchmarks/costs.py elements meshes    these parts alone, the others kept

Processor seconds of one core, with this machine's calibration (costs/grades.py), so that other load changes
them little. Costs are fitted on counts (a mesh's elements, parts, candidates) by least squares of the
relative error, none negative.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
from bench_geometry import volume
from measuring import array_of, array_text, child_seconds, processor_seconds, python, tactcad
from samples import draw_box, draw_edges, draw_range, joined, section
from scipy.optimize import nnls

from tactcad.costs.grades import ANGULAR, DATA, calibration, counts, mesh_sizes, processor
from tactcad.mechanics.accuracy import CANDIDATES
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.solids import CHORD_MM

DESIGNS = ("macro-array", "soft-tissue", "better-array", "double-sample", "smallest-bearing")
COMMANDED = (("macro-array", True), ("macro-array", False), ("soft-tissue", True), ("smallest-bearing", True))
WITH_EXTRAS = (1, 2)  # of these, drawings and guides too
SEED = 20261123
SOLVED = 30  # designs, a third each of the box, of its edges, and of the whole range
# Largest elements x layers of a coarsest mesh that is solved here: some 10 s; beyond, the law goes on.
MOST = {2: 400, 3: 160}
MARGIN = 1.4  # of the largest share of w^2/24 that was measured, as of the rungs
LONGEST_MESH = 4.0  # s; a part that takes longer is not meshed finer still


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="which (default: all)")
    asked = parser.parse_args().parts or list(PARTS)
    found = json.loads(DATA.read_text("utf-8")) if DATA.is_file() else {}
    before = calibration()
    for name in asked:
        start = time.process_time()
        made = PARTS[name]()
        # each part has the calibration of its own hour; all are kept as one machine's
        scale = found.get("calibration_s", before) / calibration()
        found |= {key: rounded(scaled(value, scale)) for key, value in made.items()}
        print(f"{name}: {time.process_time() - start:.0f} s, scale {scale:.3g}", file=sys.stderr)
        found.setdefault("calibration_s", rounded(before))
        found |= {"date": date.today().isoformat(), "machine": processor()}
        DATA.write_text(json.dumps(found, indent=1) + "\n", "utf-8")
    return 0


def scaled(value: Any, by: float) -> Any:
    """Every first number of a power law, and every number of a linear cost; the rest as it is."""
    if isinstance(value, dict):
        return {name: v if name == "share" else scaled(v, by) for name, v in value.items()}
    return [value[0] * by, *value[1:]] if isinstance(value, list) else value * by


def rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: rounded(v) for name, v in value.items()}
    return [rounded(v) for v in value] if isinstance(value, list) else float(f"{value:.3g}")


def fitted(names: tuple[str, ...], rows: list[dict[str, float]], values: list[float]) -> dict[str, float]:
    """Costs of each count, none negative, by least squares of the relative error."""
    table, each = np.array([[row.get(name, 1.0) for name in names] for row in rows]), np.array(values)
    costs, _ = nnls(table / each[:, None], np.ones(len(each)))
    off = table @ costs / each
    print(f"  {len(each)} cases, fitted over measured {off.min():.2f} to {off.max():.2f}", file=sys.stderr)
    return dict(zip(names, costs.tolist()))


def power(sizes: np.ndarray, values: np.ndarray) -> list[float]:
    """[a, p, ...] of a x^p ..., by least squares of the logarithms."""
    table = np.column_stack([np.ones(len(values)), np.log(sizes)])
    found, *_ = np.linalg.lstsq(table, np.log(values), rcond=None)
    off = np.exp(table @ found - np.log(values))
    print(f"  {len(values)} cases, fitted over measured {off.min():.2f} to {off.max():.2f}", file=sys.stderr)
    return [float(np.exp(found[0])), *found[1:].tolist()]


def starts() -> dict[str, Any]:
    """Whole processes: an estimate by a closed form, what finite elements add, and the CAD kernel."""
    run = tactcad("estimate", "soft-tissue")
    numpy = min(child_seconds(run) for _ in range(5))
    elements = min(child_seconds([*run, "--model", "fem-plane"]) for _ in range(3)) - numpy
    kernel = min(child_seconds(python("-c", "import tactcad.solids.build")) for _ in range(3))
    return {"start": {"numpy": numpy, "elements": elements, "kernel": kernel}}


def elements() -> dict[str, Any]:
    """fem-plane and fem-solid by the size of their coarsest mesh."""
    from tactcad.fem.fem_ladder import stiffness

    third = SOLVED // 3
    drawn = (draw_box(third, SEED), draw_edges(third, SEED + 1), draw_range(third, SEED + 2))
    s = section(joined(drawn))
    stiffness(s.rows(0), "fem-plane")
    sizes: dict[str, list] = {c.name: [] for c in CANDIDATES if c.rung.startswith("fem")}
    took: dict[str, list] = {name: [] for name in sizes}
    for one in map(s.rows, range(s.shape[0])):
        cells, across = (size[0] for size in mesh_sizes(one))
        for c in CANDIDATES:
            if c.name in sizes and (c.mesh is None or cells * across <= MOST[c.mesh]):
                sizes[c.name].append([cells, across])
                solve = lambda c=c, one=one: stiffness(one, c.rung, c.mesh or 2)  # noqa: E731
                took[c.name].append(processor_seconds(solve))
    return {"elements": {name: power(np.array(sizes[name]), np.array(took[name])) for name in sizes}}


def meshes() -> dict[str, Any]:
    """Parts of the shipped designs by every turn: largest share of w^2/24, and seconds by its features."""
    from tactcad.solids.build import build
    from tactcad.solids.measure import measure
    from tactcad.solids.triangles import triangles

    parts = {
        p.part_no: p for d in DESIGNS[:3] for n in scene_names(load(d)) for p in make_scene(load(d), n).parts
    }
    shares, rows = [], {angular: [] for angular in ANGULAR}
    for part in parts.values():
        shape = build(part)
        exact = measure(shape)["volume"]
        for angular in ANGULAR:
            start = time.process_time()
            mesh = triangles(shape, CHORD_MM, angular)
            took = time.process_time() - start
            shares.append(abs(volume(mesh) / exact - 1.0) * 24.0 / angular**2)
            rows[angular].append((1.0 + len(part.features), took))
            if took > LONGEST_MESH:
                break
    print(f"  {len(parts)} parts, largest share {max(shares):.3g}", file=sys.stderr)
    laws = {f"{angular:g}": _of_total(np.array(rows[angular])) for angular in ANGULAR}
    return {"mesh": {"share": MARGIN * max(shares), "seconds": laws}}


def _of_total(rows: np.ndarray) -> list[float]:
    """[a, p] whose sum is as measured, as a command meshes many, by least squares of the seconds."""
    sizes, took = rows.T
    laws = [(took.sum() / (sizes**p).sum(), p) for p in np.linspace(0.5, 2.0, 61)]
    return list(min(laws, key=lambda law: ((took - law[0] * sizes ** law[1]) ** 2).sum()))


def commands() -> dict[str, Any]:
    """`check` and `export` with all scenes and with the array's alone, and of longer arrays."""
    cases = [
        (name, load(name), scene_names(load(name)) if whole else ("array",)) for name, whole in COMMANDED
    ]
    rows, took = [], {name: [] for name in ("check", "export", *EXTRAS)}
    with tempfile.TemporaryDirectory() as folder:
        for n, count in enumerate((20, 60)):
            path = Path(folder) / f"long-{n}.toml"
            path.write_text(array_text(count), "utf-8")
            cases.append((str(path), load(path), ("array",)))
        for n, (source, design, scenes) in enumerate(cases):
            rows.append(dict(counts(design, scenes)[0]))
            chosen = [word for scene in scenes for word in ("--scene", scene)]
            for command in ("check", "export"):
                out = ["--out", f"{folder}/{n}"] if command == "export" else []
                cache = Path(folder) / f"cache-{n}"
                run = tactcad(command, source, *chosen, *out)
                took[command].append(child_seconds(run, TACTCAD_CACHE=str(cache)))
            if n in WITH_EXTRAS:
                for option in EXTRAS:
                    took[option].append(_extra(source, chosen, option, folder, took["export"][-1]))
    names = ("start", "part", "element"), ("start", "made", "place", "element")
    found = {c: fitted(some, rows, took[c]) for c, some in zip(("check", "export"), names)}
    extra_rows = [rows[n] for n in WITH_EXTRAS]
    return found | {key: fitted((of,), extra_rows, took[option]) for option, (key, of) in EXTRAS.items()}


EXTRAS = {"--drawings": ("drawings", "made"), "--guide": ("guides", "place")}


def _extra(source: str, chosen: list[str], option: str, folder: str, without: float) -> float:
    """What an option adds to an export with nothing in the cache."""
    with tempfile.TemporaryDirectory(dir=folder) as own:
        run = tactcad("export", source, *chosen, option, "--out", f"{own}/out")
        return child_seconds(run, TACTCAD_CACHE=f"{own}/cache") - without


def builds() -> dict[str, Any]:
    """`build`: the fixed work, and an array of each distribution."""
    from tactcad.stacks.virtual_build import sensor

    sizes, once, each = [], [], []
    for design in [*map(load, DESIGNS), array_of(40), array_of(100)]:
        sizes.append({"element": float(sum(map(len, design.array.row_arms)))})
        made, loading = sensor(design), child_seconds(python("-c", "import tactcad.stacks.virtual_build"))
        once.append(loading + processor_seconds(lambda: sensor(design).stack()))
        few, many = (processor_seconds(lambda n=n: made.built(n)) for n in (200, 1200))
        each.append((many - few) / 1000)
    return {
        "build": fitted(("start", "element"), sizes, once),
        "array": fitted(("start", "element"), sizes, each),
    }


STUDY = """
[study]
name = "costs"
sampling = "sobol"
count = {count}
[vary."element.hinge_thickness"]
range = [0.24, 0.26]
[measure]
what = ["{what}"]
{elements}
"""


def sweeps() -> dict[str, Any]:
    """`sweep` by one worker: starting, a design's row, a closed form of one element, a design's rules."""
    many, few, alone = 1 << 19, 64, "elements = [4]"
    with tempfile.TemporaryDirectory() as folder:

        def took(count: int, what: str = "solid", elements: str = alone) -> float:
            name = f"{what}-{count}-{len(elements)}"
            study = Path(folder) / f"{name}.toml"
            study.write_text(STUDY.format(count=count, what=what, elements=elements), "utf-8")
            return child_seconds(tactcad("sweep", study, "--out", f"{folder}/{name}", "--workers", "1"))

        start, one, five = took(1), took(many), took(many, elements="elements = [1, 2, 3, 4, 5]")
        rules = (took(few, "rules", "") - took(1, "rules", "")) / (few - 1)
    closed = (five - one) / (4 * many)
    row = max((one - start) / many - closed, 0.0)
    return {"sweep": {"start": start, "row": row, "closed": closed, "design": rules}}


PARTS = {part.__name__: part for part in (starts, elements, meshes, commands, builds, sweeps)}

if __name__ == "__main__":
    raise SystemExit(main())
