"""Parts that did not change keep their letters: one limit is changed in a copy of a design, and the letters
are read back from the files, by none of the code that wrote them.
"""

from __future__ import annotations

import csv
import dataclasses
import json
import re
import tomllib
import zipfile
from pathlib import Path

import pypdf
import pytest
from variants import TINY_TEXT

import tactcad as tc
from tactcad.cli.main import main
from tactcad.design.load import parse
from tactcad.design.messages import CheckFailure, InputError
from tactcad.export.golden_file import UNPROVEN, accept, check_golden, doubts, read_golden
from tactcad.export.inspection import inspection_bytes
from tactcad.lab.inspection_sheet import read_sheet
from tactcad.parts.array.layout import Layout
from tactcad.release.make import golden_faults
from tactcad.review.freecad import freecad_record
from tactcad.scenes import make_scene

OF_B, OF_C = "2026-01-02", "2026-03-04"
# What the design has but the element: wire-cut, milled, ground, and the boards.
KEPT = (
    "blank", "board", "board-plate", "carrier", "end-plate-head", "end-plate-tapped", "lead-clamp",
    "setting-fixture", "setting-strip", "spacer", "stop-plate",
)  # fmt: skip
TABLE = f'\n[design.unchanged.B]\ndate = "{OF_B}"\nparts = {list(KEPT)}\n'.replace("'", '"')


def issued(letter: str, date: str, *edits: tuple[str, str]) -> str:
    text = re.sub('(?m)^revision = ".*"$', f'revision = "{letter}"', TINY_TEXT)
    text = re.sub('(?m)^date = ".*"$', f'date = "{date}"', text)
    for old, new in edits:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


LIMIT = ("\nhinge_length = 0.02\n", "\nhinge_length = 0.03\n")  # of the slot, on the element's sheet alone
B, C = issued("B", OF_B), issued("C", OF_C, LIMIT)


@pytest.fixture(scope="module")
def exports(tmp_path_factory):
    """Exports of revision B, and of C as `tactcad diff` said it."""
    folder = tmp_path_factory.mktemp("letters")
    (folder / "b.toml").write_text(B)
    (folder / "c.toml").write_text(C + TABLE)
    for name in "bc":
        out = ["--out", str(folder / name)]
        assert main(["export", str(folder / f"{name}.toml"), "--scene", "array", "--drawings", *out]) == 0
    return folder


def cells(pdf: Path) -> dict[str, str]:
    """What stands after a title block's headings, on the last page."""
    lines = pypdf.PdfReader(pdf).pages[-1].extract_text().splitlines()
    return {name: lines[lines.index(name) + 1] for name in ("Revision", "Date of issue")}


def rows(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


@pytest.mark.slow  # two whole exports with sheets
@pytest.mark.cad
def test_only_the_part_that_changed_has_the_new_letter(exports):
    c = exports / "c"
    of = {f"tiny-{name}": ("B", OF_B) for name in KEPT} | {"tiny-element-a5mm": ("C", OF_C)}
    sheets = {path.stem.rpartition("_")[0]: path for path in (c / "drawings").glob("*.pdf")}
    for number, path in sheets.items():
        letter, date = of.get(number, ("C", OF_C))  # assemblies and circuit are the design's
        assert cells(path) == {"Revision": letter, "Date of issue": date}, number
        assert path.stem.endswith(f"_{letter}")
    assert {"tiny-array", "tiny-circuit", "tiny-element-a5mm", "tiny-carrier"} <= {*sheets}
    for path in (c / "step").glob("tiny-*.step"):
        number, letter = re.fullmatch(r"(.*)_([A-Z])(?:-ap242)?", path.stem).groups()
        header = path.read_text("ascii").partition("ENDSEC")[0]
        assert (letter, header[header.index("'20") + 1 :][:10]) == of.get(number, ("C", OF_C)), path.name
        assert f"'revision {letter}'" in header
    dxf = {tuple(path.stem.rsplit("_", 1)) for path in (c / "dxf").iterdir()}
    assert ("tiny-element-a5mm", "C") in dxf and ("tiny-spacer", "B") in dxf
    assert all(letter == of[number][0] for number, letter in dxf)
    bill = {row["part_no"]: row["rev"] for row in rows(c / "bom.csv") if row["make_buy"] == "make"}
    assert bill == {number: of[number][0] for number in bill} and {*bill.values()} == {"B", "C"}
    for row in json.loads((c / "manifest.json").read_text())["files"]:
        boards = row["path"].startswith("circuit/boards/")
        assert row["revision"] == ("B" if boards else of.get(row["part_no"], ("C",))[0]), row["path"]
    assert {row["revision"] for row in rows(c / "inspection.csv")} == {"C"}
    measured = {(row["part_no"], row["revision"]) for row in rows(c / "inspection-parts.csv")}
    assert measured and all(letter == of[number][0] for number, letter in measured)
    board = c / "circuit" / "boards"
    assert {path.name.split("_")[1][0] for path in board.glob("tiny-board-1_*")} == {"B"}
    assert '(rev "B")' in (board / "tiny-board-1_B.kicad_pcb").read_text().splitlines()[2]


@pytest.mark.slow  # two whole exports with sheets
@pytest.mark.cad
def test_files_under_a_kept_letter_are_those_of_that_revision(exports):
    kept = [p for p in (exports / "c").rglob("*") if re.search(r"_B\b", p.name) or "gerber" in str(p)]
    assert len(kept) > 40
    for path in kept:
        if path.is_file():
            other = exports / "b" / path.relative_to(exports / "c")
            assert path.read_bytes() == other.read_bytes(), path.name


def test_freecad_shows_each_parts_letter():
    design = parse(C + TABLE, "c")
    parts = {part.part_no: part for part in make_scene(design, "array").parts}
    shown = {
        p["part_no"]: dict(p["properties"])["Revision"]
        for p in freecad_record(design, (), parts, ())["parts"]
    }
    assert (shown["tiny-element-a5mm"], shown["tiny-carrier"]) == ("C", "B")


def pasted(printed: str) -> str:
    """The tables in what a command printed."""
    return "".join(re.findall(r"(?s)\n\[design\.unchanged\..*?\n\]\n", printed))


@pytest.mark.slow  # two whole exports with sheets
@pytest.mark.cad
def test_diff_says_the_lines_for_an_export_without_golden_file(exports, tmp_path, capsys):
    file = tmp_path / "c.toml"
    file.write_text(C)
    assert main(["diff", str(exports / "b"), str(file)]) == 0
    table = pasted(capsys.readouterr().out)
    said = tomllib.loads(table)["design"]["unchanged"]
    assert said == {"B": {"date": OF_B, "parts": said["B"]["parts"]}} and {*said["B"]["parts"]} == {*KEPT}
    file.write_text(C + table)
    assert main(["diff", str(exports / "b"), str(file), "--fail-on", "revision"]) == 0
    assert "[design.unchanged" not in capsys.readouterr().out
    file.write_text(C + table.replace('"blank"', '"blank", "element-a5mm"'))
    assert main(["diff", str(exports / "b"), str(file), "--fail-on", "revision"]) == 1
    assert "revision must change: tiny-element-a5mm" in capsys.readouterr().out


def test_a_golden_file_knows_since_when_a_part_is_as_it_is(tmp_path):
    """B; C with another limit; the lines pasted afterwards; D with another hole, by default one letter; E."""
    path = tmp_path / "tiny.json"
    assert accept(parse(B, "b"), path, []) == []
    lines = accept(parse(C, "c"), path, [])
    table = pasted("\n".join([*lines, ""]))
    assert {*tomllib.loads(table)["design"]["unchanged"]["B"]["parts"]} == {*KEPT}
    assert accept(parse(C + table, "c"), path, []) == []
    assert read_golden(path)["kept"]["tiny-carrier"] == ["B", OF_B]
    assert check_golden(parse(C + table, "c"), path) == []

    # the element keeps a letter that is not its own: refused, and the check fails too
    wrong = parse(C + table.replace('"blank"', '"blank", "element-a5mm"'), "c")
    before = path.read_bytes()
    with pytest.raises(CheckFailure, match="tiny-element-a5mm: changed since revision B: take out of"):
        accept(wrong, path, [])
    assert path.read_bytes() == before
    assert any(f.severity == "fail" and "changed since" in f.message for f in check_golden(wrong, path))
    with pytest.raises(CheckFailure, match=r"not as in revision B of 2026-01-01, but B of 2026-01-02"):
        accept(parse(C + table.replace(OF_B, "2026-01-01"), "c"), path, [])

    hole = (LIMIT, ("mount_pitch_y = 32.0", "mount_pitch_y = 33.0"))
    lines = accept(parse(issued("D", "2026-05-06", *hole) + table.replace('"carrier", ', ""), "d"), path, [])
    issues = tomllib.loads(pasted("\n".join([*lines, ""])))["design"]["unchanged"]
    assert {*issues["B"]["parts"]} == {*KEPT} - {"carrier"}
    assert issues["C"] == {"date": OF_C, "parts": ["element-a5mm"]}  # which D does not keep, and so has D
    lines = accept(parse(issued("E", "2026-05-07", *hole), "e"), path, [])
    issues = tomllib.loads(pasted("\n".join([*lines, ""])))["design"]["unchanged"]
    assert issues["D"]["parts"] == ["carrier", "element-a5mm"]
    assert {*issues["B"]["parts"]} == {*KEPT} - {"carrier"}


@pytest.mark.slow  # a whole export
def test_kept_letters_that_nothing_proves_are_told(tmp_path, capsys):
    """A copy of a design whose element is another now, which no golden file knows; then one that holds B."""
    file = tmp_path / "hardware" / "tiny.toml"
    file.parent.mkdir()
    table = TABLE.replace('"blank"', '"blank", "element-a5mm"')
    file.write_text(C + table)
    export = ["export", str(file), "--scene", "array", "--out", str(tmp_path / "out")]
    assert main(export) == 0 and f"warning: {UNPROVEN}" in capsys.readouterr().err
    alone = check_golden(parse(C + table, "c"), None)
    assert [f.severity for f in alone] == ["flag"] and check_golden(parse(C, "c"), None) == []
    assert golden_faults(parse(C + table, "c"), tmp_path / "tiny.toml") == [UNPROVEN]
    golden = tmp_path / "tiny.json"
    accept(parse(B, "b"), golden, [])
    (said,) = doubts(parse(C + table, "c"), golden)
    assert said.startswith("tiny-element-a5mm: changed since revision B")
    assert doubts(parse(C + TABLE, "c"), golden) == []


def test_a_design_changed_in_python_keeps_no_letters():
    kept = tc.load("macro-array")
    assert kept.design.design.unchanged and not kept.with_(hinge_thickness=0.26).design.design.unchanged


def test_the_boards_follow_the_circuit_not_the_sheets(tmp_path):
    path = tmp_path / "tiny.json"
    accept(parse(B, "b"), path, [])
    lines = accept(parse(issued("C", OF_C, ("\ngain = 100\n", "\ngain = 50\n")), "c"), path, [])
    said = tomllib.loads(pasted("\n".join([*lines, ""])))["design"]["unchanged"]["B"]["parts"]
    assert {*said} == {*KEPT, "element-a5mm"} - {"board"}


def test_a_title_is_on_every_sheet(tmp_path):
    path = tmp_path / "tiny.json"
    accept(parse(B, "b"), path, [])
    other = issued("C", OF_C).replace('title = "', 'title = "Other ')
    with pytest.raises(CheckFailure, match="changed since revision B"):
        accept(parse(other + TABLE, "c"), path, [])
    assert accept(parse(other, "c"), path, []) == []


def test_a_filled_sheet_of_elements_that_did_not_change_is_still_read(tmp_path):
    """Of B, by a design of C in which the carrier alone is another."""
    hole = ("mount_pitch_y = 32.0", "mount_pitch_y = 33.0")
    sheet = tmp_path / "inspection.csv"
    sheet.write_bytes(inspection_bytes(Layout(parse(B, "b"))))
    kept = '\n[design.unchanged.B]\ndate = "2026-01-02"\nparts = ["element-a5mm"]\n'
    layout = Layout(parse(issued("C", OF_C, hole) + kept, "c"))
    assert read_sheet(sheet, layout)
    assert inspection_bytes(layout) == sheet.read_bytes()
    with pytest.raises(InputError, match="another revision"):
        read_sheet(sheet, Layout(parse(issued("C", OF_C, hole), "c")))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("unchanged.B]", "unchanged.C]", "design.unchanged.C: not before the design's revision"),
        ("unchanged.B]", "unchanged.AA]", "design.unchanged.AA: not before the design's revision"),
        ("unchanged.B]", "unchanged.b]", "design.unchanged.b: not usable text"),
        ("unchanged.B]", "unchanged]", "design.unchanged.date: not usable text"),
        ('"blank",', '"board",', "design.unchanged.B.parts: not a list of different texts"),
        ('"blank",', "3,", r"design.unchanged.B.parts\[0\]: not usable text"),
        (OF_B, "2026-03-05", "design.unchanged.B.date: later than the design"),
        (f'date = "{OF_B}"\n', "", "design.unchanged.B.date: missing"),
        (
            "\n[design.unchanged.B]",
            '\n[design.unchanged.A]\ndate = "2026-01-01"\nparts = ["spacer"]\n[design.unchanged.B]',
            "design.unchanged.B.parts: has another letter too; found 'spacer'",
        ),
    ],
)
def test_bad_letters_are_one_line(old, new, said):
    with pytest.raises(InputError, match=said):
        parse(C + TABLE.replace(old, new), "c")


def test_a_name_that_no_part_has_is_refused_by_all_that_write(tmp_path, capsys):
    (tmp_path / "hardware").mkdir()
    file = tmp_path / "hardware" / "tiny.toml"
    file.write_text(C + TABLE.replace('"blank"', '"blanc"'))
    for command in ("golden", "check", "export"):
        assert (
            main([command, str(file)] + (["--out", str(tmp_path / "out")] if command == "export" else []))
            == 2
        )
        assert re.search(
            r"B\.parts: no part that is made; found 'blanc'.*blank\?\)$", capsys.readouterr().err.strip()
        )
    assert [p.name for p in tmp_path.iterdir()] == ["hardware"]


def test_a_new_design_keeps_no_letters(tmp_path, capsys):
    (tmp_path / "old.toml").write_text(C.replace("\n[material]", f"{TABLE}\n[material]"))
    assert main(["new", str(tmp_path / "new.toml"), "--from", str(tmp_path / "old.toml")]) == 0
    text = (tmp_path / "new.toml").read_text()
    made = parse(text, "new")
    assert "unchanged" not in text and made.design.unchanged == {} and made.design.revision == "A"
    assert dataclasses.replace(made, design=None, origin={}) == dataclasses.replace(
        parse(C, "c"), design=None, origin={}
    )


@pytest.mark.cad
@pytest.mark.slow  # a whole release
def test_a_release_lists_each_part_with_its_letter(tmp_path):
    file = tmp_path / "hardware" / "tiny.toml"
    file.parent.mkdir()
    for text in (B, C + TABLE):
        file.write_text(text)
        assert main(["golden", str(file)]) == 0
    assert main(["release", str(file), "--sample", "--out", str(tmp_path / "out")]) == 0
    listed = {}
    for path in (tmp_path / "out").glob("*.zip"):
        with zipfile.ZipFile(path) as archive:
            readme = archive.read("README.txt").decode()
        assert readme.splitlines()[0].startswith("tiny, revision C: ")
        listed[path.stem] = dict(re.findall(r"(?m)^  (tiny-[\w-]+) +([A-Z]) ", readme))
        if "circuit-boards" in path.stem:
            assert "tiny-board, revision B." in readme
    whole = listed.pop("tiny-C-SAMPLE")
    assert whole == {f"tiny-{n}": "B" for n in KEPT if n != "board"} | {"tiny-element-a5mm": "C"}
    by_way = [table for table in listed.values() if table]
    assert len(by_way) >= 3 and all(whole.items() >= table.items() for table in by_way)
