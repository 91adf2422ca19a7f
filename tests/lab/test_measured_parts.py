"""`tactcad export --measured`: a filled inspection sheet makes spacers, places of equal elements, and sheets
that say from which measurement."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from hashlib import sha256
from itertools import permutations

import pytest

from tactcad.cli.main import main
from tactcad.export.inspection import inspection_bytes
from tactcad.lab.inspection_sheet import reissued
from tactcad.parts.array.element import LEDGE, spacer
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load

DESIGN = load("macro-array")
LAYOUT = Layout(DESIGN)
REISSUED = f"{DESIGN.design.revision}M"


def sheet(tmp_path, values: dict[tuple[str, str], float], layout=LAYOUT):
    """The exported sheet, filled in as a shop does."""
    rows = list(csv.DictReader(io.StringIO(inspection_bytes(layout).decode(), newline="")))
    for row in rows:
        if (value := values.get((row["element"], row["characteristic"]))) is not None:
            row["measured"] = f"{value:.4f}"
    path = tmp_path / "measured.csv"
    with path.open("w", newline="") as out:
        writer = csv.DictWriter(out, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    return path


def thick(value: float) -> dict[tuple[str, str], float]:
    return {(f"E{n}", "sheet thickness"): value + 0.001 * (n % 3 - 1) for n in range(1, 10)}


def test_spacers_are_the_pitch_less_the_measured_sheet(tmp_path):
    path = sheet(tmp_path, thick(3.042))
    again = reissued(DESIGN, path)
    assert again.sheet == pytest.approx(3.042) and again.count == 9
    part = spacer(Layout(again.design))
    assert part.extrusion.thickness == pytest.approx(4 - 3.042)
    assert (part.characteristics[0].lower, part.characteristics[0].upper) == pytest.approx((0.948, 0.968))
    assert part.characteristics[0].remark == ""
    digest = sha256(path.read_bytes()).hexdigest()[:16]
    assert any(path.name in note and digest in note and "3.042" in note for note in part.notes)
    assert again.design.design.revision == REISSUED
    two = replace(DESIGN, design=replace(DESIGN.design, revision="AB"))
    assert reissued(two, sheet(tmp_path, thick(3.042), Layout(two))).design.design.revision == "ABM"
    # beside the stack's last spacer the array is as long as drawn
    assert Layout(again.design).stack - LAYOUT.stack == pytest.approx(0.958 - 1.0)


def test_equal_elements_change_places_until_the_ledges_are_level(tmp_path):
    """By brute force over all 2^5 ways of the five pairs of equal arms."""
    heights = [5.004, 4.998, 5.001, 5.003, 5.0, 4.997, 5.002, 4.999, 4.996, 5.0045]
    values = thick(3.0) | {(f"E{n}", LEDGE): h for n, h in enumerate(heights, 1)}
    again = reissued(DESIGN, sheet(tmp_path, values))
    arms = {p.number: (p.arm, p.row) for p in LAYOUT.elements}
    assert sorted(again.elements.values()) == list(range(1, 11))
    assert all(arms[n][0] == arms[m][0] for n, m in again.elements.items())

    def apart(way: dict[int, int]) -> float:
        first, second = ([heights[way[n] - 1] for n in way if arms[n][1] == r] for r in (1, 2))
        return abs(sum(first) / len(first) - sum(second) / len(second))

    pairs = [[n for n in arms if arms[n][0] == arm] for arm in sorted({a for a, _ in arms.values()})]
    best, ways = 1.0, [{}]
    for pair in pairs:
        ways = [way | dict(zip(pair, order)) for way in ways for order in permutations(pair)]
    best = min(apart(way) for way in ways)
    assert apart(again.elements) == pytest.approx(best, abs=1e-9)
    assert abs(again.lean) == pytest.approx(best, abs=1e-6)
    assert best < 0.3 * apart({n: n for n in arms})


def test_a_sheet_without_thickness_is_refused_in_one_line(tmp_path, capsys):
    path = sheet(tmp_path, {})
    assert main(["export", "--measured", str(path), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "no sheet thickness is measured" in said
    assert not (tmp_path / "out").exists()


@pytest.mark.cad
@pytest.mark.slow  # an export with sheets
def test_the_export_is_issued_again(tmp_path, capsys):
    path, out = sheet(tmp_path, thick(2.96)), tmp_path / "out"
    arguments = [
        "export",
        "--measured",
        str(path),
        "--scene",
        "array",
        "--drawings",
        "--json",
        "--out",
        str(out),
    ]
    assert main(arguments) == 0
    record = json.loads(capsys.readouterr().out)["measured"]
    assert record["spacer_mm"] == pytest.approx(1.04) and record["revision"] == REISSUED
    drawn = (out / "drawings" / f"macro-array-spacer_{REISSUED}.svg").read_text()
    assert "measured.csv" in drawn and "1.04" in drawn
