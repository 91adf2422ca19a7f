"""The two writers: what they write is read back with other software; equal bytes in other processes."""

from __future__ import annotations

import hashlib
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from pypdf import PdfReader

from tactcad.design.messages import CheckFailure
from tactcad.drawing.engine import ink
from tactcad.drawing.engine.ink import DrawnArc, DrawnSheet, Stroke, Text, arrow, preliminary
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.paper import A3, A4, TitleBlock, frame, notes, title_block, wrapped
from tactcad.drawing.engine.sheet_files import pdf_bytes, svg_bytes

SIGNS = "0.25 ±0.005 ⌀3.4 ↧8 R0.3 Ra 0.8 µm 45° 4×"


def block(**changes) -> TitleBlock:
    usual = dict(
        legal_owner="Owner & Co",
        number="x-element-a4mm",
        revision="B",
        date="2026-11-21",
        title="Sensing element",
        supplementary="An array",
        creator="A. Author",
        document_type="Part drawing",
        status="released",
        scale="5:1",
        sheet=2,
        sheets=7,
        material="7075-T6",
        mass=1.66,
        finish="Ra 1.6",
    )
    return TitleBlock(**{**usual, **changes})


def sheet(paper=A3, **changes) -> DrawnSheet:
    lines, _ = notes((30, 270), [SIGNS, "burr-free"], 90)
    items = (
        *frame(paper),
        *title_block(paper, block(**changes)),
        *lines,
        Text((30, 150), "upright 12.5", 3.5, angle=90),
        Stroke(((60, 150), (80, 150))),
        DrawnArc((150, 150), 20, 30, 120),
        arrow((60, 150), (70, 150)),
    )
    return DrawnSheet("x-element-a4mm", "Sensing element", paper.size, items)


def test_every_text_of_the_sheet_is_found_again_in_the_pdf():
    reader = PdfReader(io.BytesIO(pdf_bytes([sheet(), sheet(A4)], "title", "author", "2026-11-21")))
    assert len(reader.pages) == 2
    for page, paper in zip(reader.pages, (A3, A4)):
        points = [float(v) * 25.4 / 72 for v in page.mediabox[2:]]
        assert points == pytest.approx(paper.size)
        runs = []
        page.extract_text(
            visitor_text=lambda text, *_: runs.extend(line.strip() for line in text.splitlines())
        )
        wanted = [t.text for t in sheet(paper).texts]
        assert sorted(filter(None, runs)) == sorted(wanted)


def test_widths_are_those_of_the_font_as_reportlab_reads_it():
    from reportlab.pdfbase.ttfonts import TTFont

    read = TTFont("widths", str(ink.font_file()))
    assert ink.width(SIGNS, 2.5) == pytest.approx(read.stringWidth(SIGNS, ink.em(2.5)), rel=1e-3)


def test_capitals_are_as_high_as_stated():
    x0, y0, x1, y1 = ink.ink_box("H", 3.5)
    assert (y0, y1) == pytest.approx((0.0, 3.5))


def test_text_box_holds_the_ink_that_a_rasteriser_paints(tmp_path):
    """pdftoppm paints the text; every dark pixel lies in the box, and the box is no larger than a pixel too
    much."""
    text = Text((40, 60), "Qg±⌀(12)", 10, angle=90)
    bare = DrawnSheet("n", "t", A4.size, (text,))
    (tmp_path / "a.pdf").write_bytes(pdf_bytes([bare], "t", "a", "2026-11-21"))
    subprocess.run(["pdftoppm", "-r", "127", "-gray", tmp_path / "a.pdf", tmp_path / "a"], check=True)
    data = next(tmp_path.glob("a*.pgm")).read_bytes()
    w, h = map(int, data.split(b"\n", 3)[1].split())
    pixels = data[-w * h :]
    dark = [(i % w / 5, 297 - i // w / 5) for i, v in enumerate(pixels) if v < 128]
    xs, ys = zip(*dark)
    cx, cy = zip(*text.corners())
    assert (min(xs), max(xs), min(ys), max(ys)) == pytest.approx(
        (min(cx), max(cx), min(cy), max(cy)), abs=0.45
    )


def test_svg_holds_the_same_texts_at_the_same_places():
    drawn = svg_bytes(sheet()).decode()
    assert 'width="420mm" height="297mm"' in drawn
    found = re.findall(r'x="([\d.]+)" y="([\d.]+)" textLength="([\d.]+)"[^>]*>([^<]+)<', drawn)
    assert len(found) == len(sheet().texts)
    for (x, y, length, text), meant in zip(found, sheet().texts):
        assert text == meant.text.replace("&", "&amp;")
        assert (float(x), 297 - float(y), float(length)) == pytest.approx(
            (*meant.origin, meant.width), abs=2e-3
        )


def test_equal_bytes_in_processes_with_other_hash_seeds_zones_and_dates():
    script = (
        "import sys, hashlib; sys.path[:0] = sys.argv[1:]\n"
        "from test_sheet_writers import sheet, pdf_bytes, svg_bytes\n"
        "print(hashlib.sha256(pdf_bytes([sheet()], 't', 'a', '2026-11-21') + svg_bytes(sheet())).hexdigest())"
    )
    here = Path(__file__).parent
    seen = {
        subprocess.run(
            [sys.executable, "-c", script, str(here), str(here.parent)],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "TZ": zone, "SOURCE_DATE_EPOCH": epoch},
        ).stdout.strip()
        for seed, zone, epoch in (("1", "UTC", "1"), ("77", "Asia/Tokyo", "1700000000"))
    }
    assert seen == {
        hashlib.sha256(pdf_bytes([sheet()], "t", "a", "2026-11-21") + svg_bytes(sheet())).hexdigest()
    }


def test_the_date_is_the_designs():
    metadata = PdfReader(io.BytesIO(pdf_bytes([sheet()], "t", "a", "2026-11-21"))).metadata
    assert (
        metadata.creation_date.isoformat()
        == metadata.modification_date.isoformat()
        == "2026-11-21T00:00:00+00:00"
    )


def test_a_draft_says_so_and_stays_clean():
    draft = preliminary(sheet())
    assert layout_faults(draft) == []
    text = PdfReader(io.BytesIO(pdf_bytes([draft], "t", "a", "2026-11-21"))).pages[0].extract_text()
    assert re.sub(r"\s", "", text).count("PRELIMINARY") == 1


@pytest.mark.parametrize("paper", [A3, A4], ids=lambda p: p.name)
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"title": "A long title of a part that fills more than its own line"},
        {"mass": None},
        {"number": "a-rather-long-design-name-element-a12.345mm-t0.123mm"},
        {
            "finish": "Ra 1.6, clear anodised after machining; dowel holes masked; groove floor and face "
            "around it Ra 0.8"
        },
    ],
)
def test_title_block_fits_its_cells(paper, changes):
    assert layout_faults(sheet(paper, **changes)) == []


def test_what_no_cell_can_hold_is_refused():
    with pytest.raises(CheckFailure, match="title block"):
        title_block(A4, block(finish="very " * 200))


def test_missing_font_or_letter_is_said(monkeypatch):
    with pytest.raises(CheckFailure, match="U\\+5F20"):
        ink.width("张", 2.5)
    monkeypatch.setattr(ink, "_FILE", Path("nowhere.ttf"))
    with pytest.raises(CheckFailure, match="nowhere.ttf of the package matplotlib.* is missing"):
        pdf_bytes([sheet()], "t", "a", "2026-11-21")


def test_zones_are_those_of_iso_5457():
    """8 x 6 fields on A3 lying, 4 x 6 on A4 upright; letters from the top."""
    for paper, across, down in ((A3, "8", "F"), (A4, "4", "F")):
        texts = [item for item in frame(paper) if isinstance(item, Text)]
        assert max(t.text for t in texts if t.text.isdigit()) == across
        letters = [t for t in texts if t.text.isalpha()]
        assert max(t.text for t in letters) == down
        assert max(letters, key=lambda t: t.at[1]).text == "A"


def test_wrapped_lines_fit_and_lose_nothing():
    text = "wire-cut in at least three passes, " + "x" * 90
    lines = wrapped(text, 2.5, 60)
    assert all(ink.width(line, 2.5) <= 60 for line in lines)
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")
