"""The table of docs/checks.md: each check, its bad part, what is then said, and what it takes.

    python tests/checks_table.py            messages anew, times as they stand
    python tests/checks_table.py --times    times too: the shipped array and its rigs, then 2 x 500 elements
    (minutes)

Messages are what the checks say of the bad parts in bad_parts.py. Times are processor time of one process,
which other work on the machine changes little.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
from pathlib import Path
from types import SimpleNamespace

ROOT = Path(__file__).parents[1]
DOCUMENT = ROOT / "docs" / "checks.md"
BEGIN, END = "<!-- checks: written by tests/checks_table.py -->\n", "<!-- end of checks -->\n"
HEAD = "| `tactcad check` times | check | its bad part | what it says | array | its rigs | largest |\n"
HEAD += "|---|---|---|---|---|---|---|\n"

Times = dict[str, tuple[str, str, str]]


def rows(times: Times) -> list[str]:
    """A line a check, in the order of BAD; the times stand in the first line of those that are timed
    together."""
    from bad_parts import BAD

    lines, before = [], ""
    for name, bad in BAD.items():
        finding = next(f for f in bad.find() if f.check == name)
        flagged = " (flag)" if finding.severity == "flag" else ""
        cells = times.get(bad.run, ("",) * 3) if bad.run != before else ("",) * 3
        said = finding.message.replace("|", "\\|")
        what = f"{bad.what}, `{bad.test.rpartition('/')[2]}`"
        lines.append(
            f"| {bad.run if bad.run != before else ''} | `{name}`{flagged} | {what} | {said} | "
            + " | ".join(cells)
            + " |\n"
        )
        before = bad.run
    return lines


def known_times(text: str) -> Times:
    """The times that stand in the document, by the name under which they are taken."""
    found = re.findall(r"^\| ([a-z -]+) \| `.*\| ([^|]*) \| ([^|]*) \| ([^|]*) \|$", text, re.MULTILINE)
    return {run: tuple(cells) for run, *cells in found}


def measured() -> Times:
    """Seconds of every timed check on the macro array alone, on it with its rigs, and on 2 x 500 elements."""
    sys.path.insert(0, str(ROOT / "benchmarks"))
    from measuring import array_of

    from tactcad.checks import check_report as clocked
    from tactcad.checks.run import run_checks
    from tactcad.export.golden_file import check_golden, golden_path
    from tactcad.parts.designs import load
    from tactcad.scenes import scene_names

    clocked.time = SimpleNamespace(perf_counter=time.process_time)
    shipped = load("macro-array")
    run_checks(shipped, ["array"])  # builds and loads what is kept
    columns = []
    for design, names in ((shipped, ["array"]), (shipped, scene_names(shipped)), (array_of(1000), ["array"])):
        report = run_checks(design, names)
        if design is shipped:
            report.run(
                "golden", check_golden, design, golden_path(ROOT / "hardware" / "macro-array.toml", design)
            )
        columns.append(report.seconds)
        print({run: f"{s:.3f}" for run, s in report.seconds.items()}, flush=True)
    runs = dict.fromkeys(run for column in columns for run in column)
    return {run: tuple(shown(column.get(run)) for column in columns) for run in runs}


def shown(seconds: float | None) -> str:
    if seconds is None:
        return "-"
    return (
        f"{1e3 * seconds:.2g} ms"
        if seconds < 0.1
        else f"{seconds:.2g} s"
        if seconds < 10
        else f"{seconds:.0f} s"
    )


def renewed(text: str, times: Times) -> str:
    before, rest = text.split(BEGIN)
    return before + BEGIN + HEAD + "".join(rows(times)) + END + rest.split(END)[1]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--times", action="store_true", help="measure the times anew")
    args = parser.parse_args()
    text = DOCUMENT.read_text(encoding="utf-8")
    DOCUMENT.write_text(renewed(text, measured() if args.times else known_times(text)), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
