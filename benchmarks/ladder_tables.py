"""The computed tables of docs/mechanics.md and docs/accuracy.md.

python benchmarks/ladder_tables.py docs/mechanics.md
python benchmarks/ladder_tables.py docs/accuracy.md
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from tables import lines, write_tables

from tactcad.mechanics import ladder, strain
from tactcad.mechanics.accuracy import CANDIDATES, accuracy_data, zone_name
from tactcad.mechanics.register import ladder_data, rungs, strain_data
from tactcad.mechanics.section import REFERENCE, HingeSection

# per cent at 2 N, by arm length in mm: the paper's finite-element study
PAPER_STRAIN = {4.0: 0.2711, 8.0: 0.6316}
PAPER_FORCE = 2.0  # N
PAD_HALF = 1.0  # mm: the load acts at the pad's centre
GRID = 0.5  # mm
BOTH = "two-sided: rms | max | one-sided: rms | max"


def _both(report: dict, name: str) -> list[str]:
    """rms and largest error of both notch forms."""
    found = [report[side].get(name) for side in ("two", "one")]
    return [f"{100 * e['rms']:.2g} % | {100 * e['max']:.2g} %" if e else "- | -" for e in found]


def errors() -> str:
    """Of every closed form over the promised box, on designs that the fit has not seen."""
    report = ladder_data()["report"]["relative_error"]["held out, box"]
    rows = []
    for rung in (rung for rung in rungs().values() if rung.compliance):
        against = f"{rung.against} elements"
        rows.append((rung.name, against, *_both(report, f"{rung.name}, against {against}")))
    return lines(f"rung | against converged | {BOTH}", rows)


def strain_errors() -> str:
    """Of the closed forms for strain, on held-out designs."""
    report = ladder_data()["report"]["relative_error"]["held out, box"]
    names = [n for n in report["one"] if "strain" in n]
    return lines(f"closed form | {BOTH}", [(name, *_both(report, name)) for name in names])


def beyond() -> str:
    """Over the whole range in which a rung answers, mostly in its corners, on designs that the fit has not
    seen."""
    report = ladder_data()["report"]["relative_error"]["held out, corners"]
    fitted = (rung for rung in rungs().values() if rung.fitted)
    rows = [(r.name, *_both(report, f"{r.name}, against {r.against} elements")) for r in fitted]
    return lines(f"rung | {BOTH}", rows)


def strain_zones() -> str:
    """Error of strain and stress by rung solid that is stated, by zone of the range."""
    zones = strain_data()["zones"]
    names, rows = list(zones[0]["stated"]), []
    for zone in zones:
        cells = ("-" if zone["stated"][n] is None else f"{zone['stated'][n]:.1%}" for n in names)
        rows.append((zone_name(zone), zone["designs"], *cells))
    return lines(f"zone | designs | {' | '.join(names)}", rows)


def fitted_range() -> str:
    """The dimensionless groups that the sample covered."""
    sampled = ladder_data()["range"]
    rows = [(name, f"{low:g}", f"{high:g}") for name, (low, high) in sampled["groups"].items()]
    rows += [(name, f"{least:g}", "-") for name, least in sampled["least"].items()]
    return lines("group | from | to", rows)


def papers_strains() -> str:
    """Gauge strain by every closed form over the paper's, at its two elements."""
    return _over_papers(ladder.CLOSED_FORMS, lambda s, rung: float(strain.gauge(s, PAPER_FORCE, GRID, rung)))


def papers_strains_by_elements() -> str:
    """The same by finite elements."""
    from tactcad.fem.fem_ladder import solve

    return _over_papers(
        ladder.FINITE_ELEMENTS, lambda s, rung: float(solve(s, rung, GRID).readings.gauge) * PAPER_FORCE
    )


def _over_papers(rungs: Iterable[str], gauge: Callable[[HingeSection, str], float]) -> str:
    cases = [(sides, a) for sides in ("two", "one") for a in PAPER_STRAIN]
    rows = []
    for rung in rungs:
        row = [rung]
        for sides, a in cases:
            section = REFERENCE.with_(load_arm=a - PAD_HALF, two_sided=sides == "two")
            row.append(f"{100 * gauge(section, rung) / PAPER_STRAIN[a]:.3f}")
        rows.append(row)
    return lines(f"rung | {' | '.join(f'{sides}-sided, a = {a:g}' for sides, a in cases)}", rows)


def promised() -> str:
    """Error that is promised, by zone of the envelope, of the rungs that can be chosen."""
    zones = accuracy_data()["zones"]
    rows = []
    for zone in zones:
        cells = (f"{100 * zone['promised'][n]:.2g} %" for n in ladder.FITTED)
        rows.append((zone_name(zone), zone["designs"]["solid"], *cells))
    solids = [c.name for c in CANDIDATES if c.rung == "fem-solid"]
    everywhere = []
    for name in solids:
        (same,) = {f"{100 * zone['promised'][name]:.2g} %" for zone in zones}
        everywhere.append(f"{same} ({name.partition(', ')[2]})")
    table = lines(f"zone | designs | {' | '.join(ladder.FITTED)}", rows)
    return f"{table}\n\nIn every zone `fem-solid` promises {' and '.join(everywhere)}."


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

if __name__ == "__main__":
    raise SystemExit(write_tables(__doc__, TABLES))
