"""The tables of docs/mechanics.md and docs/accuracy.md, computed.

`python benchmarks/ladder_tables.py docs/mechanics.md`, and the other likewise.

Blocks stand between `<!-- table NAME -->` and `<!-- end -->`; running it writes them anew.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path

from tactcad.mechanics import ladder, strain
from tactcad.mechanics.accuracy import CANDIDATES, accuracy_data, zone_name
from tactcad.mechanics.constants import ladder_data, strain_data
from tactcad.mechanics.register import REGISTER
from tactcad.mechanics.section import REFERENCE, HingeSection

PAPER_STRAIN = {
    4.0: 0.2711,
    8.0: 0.6316,
}  # per cent at 2 N, by arm length in mm: the paper's finite-element study
PAPER_FORCE = 2.0  # N
PAD_HALF = 1.0  # mm: the load stands at the pad's centre
GRID = 0.5  # mm


def errors() -> str:
    """Error of every closed form over the promised box, on designs that the fit has not seen."""
    report = ladder_data()["report"]["relative_error"]
    lines = [
        "| rung | against converged | two-sided: rms | max | one-sided: rms | max |",
        "|---|---|---|---|---|---|",
    ]
    for rung in (rung for rung in REGISTER if rung.compliance):
        name = f"{rung.name}, against {rung.against} elements"
        row = [report["held out, box"][side][name] for side in ("two", "one")]
        cells = " | ".join(f"{100 * e['rms']:.2g} % | {100 * e['max']:.2g} %" for e in row)
        lines.append(f"| {rung.name} | {rung.against} elements | {cells} |")
    return "\n".join(lines)


def strain_errors() -> str:
    """Error of the closed forms for strain, on held-out designs."""
    report = ladder_data()["report"]["relative_error"]["held out, box"]
    names = [n for n in report["one"] if "strain" in n]
    lines = ["| closed form | two-sided: rms | max | one-sided: rms | max |", "|---|---|---|---|---|"]
    for name in names:
        cells = []
        for side in ("two", "one"):
            e = report[side].get(name)
            cells.append(f"{100 * e['rms']:.2g} % | {100 * e['max']:.2g} %" if e else "- | -")
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def strain_zones() -> str:
    """Worst error of strain and stress by rung solid that was found, and what is stated, by zone of the
    range."""
    zones = strain_data()["zones"]
    names = list(zones[0]["worst"])
    lines = ["| zone | designs | " + " | ".join(names) + " |", "|---|---|" + "---|" * len(names)]
    for zone in zones:
        pairs = [(zone["worst"][n], zone["stated"][n]) for n in names]
        cells = ["-" if worst is None else f"{worst:.1%} -> {stated:.1%}" for worst, stated in pairs]
        lines.append(f"| {zone_name(zone)} | {zone['designs']} | {' | '.join(cells)} |")
    return "\n".join(lines)


def beyond() -> str:
    """Error over the whole range in which a rung answers, mostly in its corners, on designs that the fit has
    not seen."""
    report = ladder_data()["report"]["relative_error"]["held out, corners"]
    lines = ["| rung | two-sided: rms | max | one-sided: rms | max |", "|---|---|---|---|---|"]
    for rung in (rung for rung in REGISTER if rung.fitted):
        row = [report[side][f"{rung.name}, against {rung.against} elements"] for side in ("two", "one")]
        cells = " | ".join(f"{100 * e['rms']:.2g} % | {100 * e['max']:.2g} %" for e in row)
        lines.append(f"| {rung.name} | {cells} |")
    return "\n".join(lines)


def fitted_range() -> str:
    """The dimensionless groups that the sample covered."""
    sampled = ladder_data()["range"]
    lines = ["| group | from | to |", "|---|---|---|"]
    lines += [f"| {name} | {low:g} | {high:g} |" for name, (low, high) in sampled["groups"].items()]
    return "\n".join([*lines, *(f"| {name} | {least:g} | - |" for name, least in sampled["least"].items())])


def papers_strains() -> str:
    """Strain by every closed form at the paper's two elements."""
    return _strain_table(ladder.CLOSED_FORMS, _closed_form)


def papers_strains_by_elements() -> str:
    """The same by finite elements."""
    from tactcad.fem.fem_ladder import solve

    def by_elements(s: HingeSection, rung: str) -> tuple[float, float]:
        found = solve(s, rung, GRID)
        return float(found.readings.gauge) * PAPER_FORCE, found.readings.fillet_strain * PAPER_FORCE

    return _strain_table(ladder.FINITE_ELEMENTS, by_elements)


def _closed_form(s: HingeSection, rung: str) -> tuple[float, float]:
    return float(strain.gauge(s, PAPER_FORCE, GRID, rung)), float(strain.peak(s, PAPER_FORCE, rung))


def _strain_table(rungs: tuple[str, ...], strains: Callable[[HingeSection, str], tuple[float, float]]) -> str:
    arms = list(PAPER_STRAIN)
    lines = [
        "| rung | notch | "
        + " | ".join(f"a = {a:g}: gauge | over paper's | at the fillet" for a in arms)
        + " |",
        "|---|---|" + "---|" * (3 * len(arms)),
    ]
    for rung in rungs:
        for sides in ("two", "one"):
            cells = []
            for a in arms:
                gauge, peak = strains(REFERENCE.with_(load_arm=a - PAD_HALF, two_sided=sides == "two"), rung)
                cells.append(
                    f"{100 * gauge:.4f} % | {100 * gauge / PAPER_STRAIN[a]:.3f} | {100 * peak:.4f} %"
                )
            lines.append(f"| {rung} | {sides} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def promised() -> str:
    """Worst error that was measured, and promised, of the rungs that can be chosen, by zone of the
    envelope."""
    data = accuracy_data()
    names = [c.name for c in CANDIDATES if c.rung in (*ladder.FITTED, *ladder.FINITE_ELEMENTS)]
    lines = ["| zone | designs | " + " | ".join(names) + " |", "|---|---|" + "---|" * len(names)]
    for zone in data["zones"]:
        cells = (f"{100 * zone['worst'][n]:.2g} % -> {100 * zone['promised'][n]:.2g} %" for n in names)
        lines.append(f"| {zone_name(zone)} | {zone['designs']['solid']} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


TABLES = {
    "promised": promised,
    "errors": errors,
    "beyond": beyond,
    "range": fitted_range,
    "strain errors": strain_errors,
    "strain zones": strain_zones,
    "paper's strains": papers_strains,
    "paper's strains by elements": papers_strains_by_elements,
}


def renewed(text: str, names: tuple[str, ...] = tuple(TABLES)) -> str:
    """The document with those of the named tables that it has computed anew."""
    for name in names:
        if f"<!-- table {name} -->" in text:
            text = filled(text, name, TABLES[name]())
    return text


def filled(text: str, name: str, table: str) -> str:
    """The document with this table between the marks of that name, where it has them."""
    block = re.compile(rf"(<!-- table {re.escape(name)} -->\n).*?(<!-- end -->)", re.DOTALL)
    return block.sub(lambda m: f"{m.group(1)}{table}\n{m.group(2)}", text)


if __name__ == "__main__":
    document = Path(sys.argv[1])
    document.write_text(renewed(document.read_text("utf-8")), "utf-8")
