"""Whether budgets are kept on designs drawn by chance, as the tables of benchmarks/results/budgets.md.

    python benchmarks/budgets.py benchmarks/results/budgets.md --designs 200 --commands 12    an hour

Each of the first gets a P or a time by chance and is answered by `tactcad estimate --batch` in a process
of its own; its K is compared with solid elements on a mesh finer than any chosen, and its processor time with
the stated time. Each of the second, whole designs of tests/sound_designs.py, is checked and exported. Results
are kept in .cache/budgets.jsonl: another run continues.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import fields
from itertools import chain, islice
from pathlib import Path
from random import Random

import numpy as np
from measuring import ROOT, child_seconds, tactcad
from samples import draw_box, draw_edges, draw_range, section
from tables import filled, lines

from tactcad.costs.grades import check_grades, export_grades, mesh_sizes, row_grades
from tactcad.design.allowance import Allowance, pick
from tactcad.design.messages import CheckFailure, InputError
from tactcad.fem.fem_ladder import converged_solid
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import validity
from tactcad.mechanics.accuracy import MEASURED_FOR
from tactcad.mechanics.section import HingeSection

KEPT = ROOT / ".cache" / "budgets.jsonl"
SEED = 20261123 + 200
MANY = 600  # drawn of each kind
MOST = 150.0  # elements x layers of a coarsest mesh: what is refined beyond mesh 2 in some 10 s
ERRORS, SECONDS = (2.5e-4, 0.5), (0.3, 5.0)
TIMES = 1.3


def designs(count: int) -> list[HingeSection]:
    """Of the box, of its edges, and of the whole range, in turns; those that can be refined here, and whose
    numbers, as written, lie where errors were measured: not fillets of half the slot, rounded up."""
    tables = (draw_box(MANY, SEED), draw_edges(MANY, SEED + 1), draw_range(MANY, SEED + 2))
    found = [islice(_small(section(table)), -(-count // 3)) for table in tables]
    return list(chain.from_iterable(zip(*found, strict=True)))[:count]


def _small(s: HingeSection) -> Iterator[HingeSection]:
    for one in map(s.rows, range(s.shape[0])):
        outside = bool(validity.reasons(one, MEASURED_FOR).item())
        if not outside and float(np.prod([sizes[0] for sizes in mesh_sizes(one)])) <= MOST:
            yield one


def estimates(count: int) -> Iterator[tuple[str, Callable[[], dict]]]:
    for i, one in enumerate(designs(count)):
        yield f"estimate {i}", lambda i=i, one=one: estimated(one, Random(SEED + i))


def estimated(one: HingeSection, random: Random) -> dict:
    by_error = random.random() < 0.5
    drawn = float(np.exp(random.uniform(*np.log(ERRORS if by_error else SECONDS))))
    asked = Allowance(drawn, None) if by_error else Allowance(None, drawn)
    try:
        grade = pick(row_grades(listed(one), asked.within), asked, "K").grade
    except CheckFailure as refusal:
        return {"refused": str(refusal)}
    with tempfile.TemporaryDirectory() as folder:
        source, out = Path(folder) / "in.csv", Path(folder) / "out.csv"
        names = [f.name for f in fields(one) if f.name not in ("two_sided", "pad_height", "friction")]
        values = [repr(float(getattr(one, name))) for name in names]
        sides = "two" if bool(one.two_sided) else "one"
        source.write_text(",".join([*names, "sides"]) + "\n" + ",".join([*values, sides]) + "\n")
        option = ["--within", repr(drawn)] if by_error else ["--in", repr(drawn)]
        took = child_seconds(tactcad("estimate", "--batch", source, "--out", out, *option))
        (row,) = csv.DictReader(out.open(newline=""))
    finer = (
        3 if row["model"] == "fem-solid" and row["mesh"] == "2" else 4 if row["model"] == "fem-solid" else 2
    )
    material = (float(one.youngs_modulus), float(one.poisson), float(one.width))
    truth = converged_solid(reference_shape(one), *material, mesh=finer).stiffness
    return {
        "rung": row["model"] + row["mesh"],
        "promised": float(row["expected_error"]),
        "asked": asked.within,
        "error": abs(float(row["stiffness"]) / truth - 1.0),
        "stated": grade.seconds,
        "took": took,
        "in": asked.seconds,
    }


def listed(one: HingeSection) -> HingeSection:
    """The same as an array of one."""
    return HingeSection(**{f.name: np.atleast_1d(getattr(one, f.name)) for f in fields(one)})


def commands(count: int) -> Iterator[tuple[str, Callable[[], dict]]]:
    sys.path.insert(0, str(ROOT / "tests"))
    for i in range(count):
        yield f"command {i}", lambda i=i: commanded(i)


def commanded(number: int) -> dict:
    from random_designs import as_toml
    from sound_designs import as_table, sound_table

    from tactcad.parts.rules import load
    from tactcad.scenes import scene_names

    random = Random(SEED + number)
    rows = random.choice(((3, 3), (5, 5), (2,), (4,), (8, 8), (20, 20)))
    tree = as_table(sound_table(random.randrange(2**48), rows, rigs=random.random() < 0.7))
    tree["design"] |= {"name": f"drawn-{number}", "title": "t", "revision": "A", "date": "2026-11-23"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "design.toml"
        path.write_text(as_toml(tree), encoding="utf-8")
        try:
            design = load(path)
        except InputError as refusal:
            return {"refused": str(refusal)}
        within = random.choice((0.02, 0.005, 0.002))
        asked, names = Allowance(within), scene_names(design)
        grades = check_grades([(design, names)]), export_grades(design, names)
        runs = ("check", path), ("export", path, "--out", f"{folder}/out")
        return {
            "stated": [pick(some, asked, "").grade.seconds for some in grades],
            "took": [
                child_seconds(tactcad(*run, "--within", repr(within)), TACTCAD_CACHE=f"{folder}/cache")
                for run in runs
            ],
        }


def kept() -> dict[str, dict]:
    lines = KEPT.read_text("utf-8").splitlines() if KEPT.is_file() else []
    return dict(map(json.loads, lines))


def run(tasks: Iterator[tuple[str, Callable[[], dict]]]) -> list[dict]:
    done, found = kept(), []
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    with KEPT.open("a", encoding="utf-8") as file:
        for name, task in tasks:
            if name not in done:
                done[name] = task()
                print(json.dumps([name, done[name]]), file=file, flush=True)
            found.append(done[name])
    return found


def promises(rows: list[dict]) -> str:
    shown = []
    for rung in [*dict.fromkeys(row["rung"] for row in rows), "all"]:
        some = [row for row in rows if rung in (row["rung"], "all")]
        share = np.array([row["error"] / row["promised"] for row in some])
        broken = sum(r["error"] > r["promised"] or (r["asked"] or 1.0) < r["promised"] for r in some)
        named = rung.replace("fem-solid", "fem-solid, mesh ")
        shown.append((named, len(some), broken, f"{share.max():.2g}", f"{np.median(share):.2g}"))
    return lines("rung | designs | promise broken | largest error over promise | median of it", shown)


def times(named: dict[str, tuple[list[float], list[float]]]) -> str:
    shown = []
    for name, (stated, took) in named.items():
        by = np.array(took) / np.array(stated)
        kept = f"{100 * (by <= TIMES).mean():.0f} %"
        shown.append((f"`{name}`", len(by), kept, *(f"{v:.2f}" for v in (by.min(), np.median(by), by.max()))))
    within = f"took at most {TIMES:g} times as long as stated"
    return lines(f"command | designs | {within} | least | median | largest", shown)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("document", type=Path, help="Markdown file that has the tables' places")
    parser.add_argument("--designs", type=int, default=200)
    parser.add_argument("--commands", type=int, default=12)
    asked = parser.parse_args()
    rows = [r for r in run(estimates(asked.designs)) if "refused" not in r]
    others = [r for r in run(commands(asked.commands)) if "refused" not in r]
    stated = [r for r in rows if r["stated"] is not None]  # by elements
    named = {"estimate": ([r["stated"] for r in stated], [r["took"] for r in stated])}
    for i, name in enumerate(("check", "export")):
        named[name] = [r["stated"][i] for r in others], [r["took"][i] for r in others]
    text = asked.document.read_text(encoding="utf-8")
    text = filled(text, "budget promises", promises(rows))
    asked.document.write_text(filled(text, "budget times", times(named)), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
