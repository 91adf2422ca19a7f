"""tactcad diff: every kind of side, text, JSON and the page."""

from __future__ import annotations

import json
import os
import re
import shutil
import tomllib
from html.parser import HTMLParser
from math import dist
from pathlib import Path

import pytest

from tactcad.cli.main import main
from tactcad.contour import circle, rectangle
from tactcad.design.messages import InputError
from tactcad.export.difference import Change
from tactcad.export.difference_page import _path, page
from tactcad.export.sides import compare_sides, read_side

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "hardware" / "soft-tissue.toml"
REVISION = tomllib.loads(SHIPPED.read_text())["design"]["revision"]


@pytest.fixture
def thicker(tmp_path):
    """The shipped design with another hinge, as revision Z."""
    text = SHIPPED.read_text()
    changed = text.replace("hinge_thickness = 0.15", "hinge_thickness = 0.17").replace(
        f'revision = "{REVISION}"', 'revision = "Z"'
    )
    assert changed != text
    path = tmp_path / "thicker.toml"
    path.write_text(changed)
    return path


@pytest.fixture(scope="module")
def exports(tmp_path_factory):
    """One export of each, without rigs: only those who need the kernel pay for it."""
    folder = tmp_path_factory.mktemp("exports")
    text = SHIPPED.read_text()
    (folder / "b.toml").write_text(text.replace("hinge_thickness = 0.15", "hinge_thickness = 0.17"))
    for path, name in ((SHIPPED, "a"), (folder / "b.toml", "b")):
        assert main(["export", str(path), "--scene", "array", "--out", str(folder / name)]) == 0
    return folder / "a", folder / "b"


def diff(capsys, *args) -> str:
    assert main(["diff", *map(str, args)]) == 0
    return capsys.readouterr().out


def test_two_designs(thicker, capsys):
    lines = diff(capsys, SHIPPED, thicker).splitlines()
    assert f"changed revision: {REVISION} -> Z" in lines
    assert "changed values / element.hinge_thickness: 0.15 -> 0.17 (+13.3 %)" in lines
    [K] = [line for line in lines if line.startswith("changed elements / E1 / stiffness")]
    old, new = map(float, re.search(r": (\S+) -> (\S+) ", K).groups())
    assert (new / old) == pytest.approx((0.17 / 0.15) ** 3, rel=0.05)  # a hinge's stiffness goes with t^3
    [outline] = [line for line in lines if "element-a9mm / contours" in line]
    assert "mm apart" in outline
    changed = [line for line in lines if line.startswith("changed")]
    assert not [line for line in changed if "spacer" in line or "carrier" in line]


def test_a_design_and_its_golden_file(capsys):
    golden = ROOT / "exports" / "golden" / "soft-tissue.json"
    out = diff(capsys, golden, "soft-tissue")
    assert "no difference" in out and "a golden file holds no design values" in out
    assert not [line for line in out.splitlines() if line.startswith(("changed", "added", "removed"))]


def test_json(thicker, capsys):
    record = json.loads(diff(capsys, SHIPPED, thicker, "--json"))
    assert (
        record["identical"] is False
        and record["old"]["revision"] == REVISION
        and record["new"]["kind"] == "design"
    )
    [change] = [c for c in record["changes"] if c["path"] == ["values", "element.hinge_thickness"]]
    assert (change["kind"], change["old"], change["new"]) == ("changed", 0.15, 0.17)


def test_a_small_value_of_the_design_counts_in_every_digit(tmp_path, capsys):
    text = SHIPPED.read_text()
    for name, value in (("a", "-17e-6"), ("b", "-17.5e-6")):
        lines = re.sub(r"(?m)^resistance_per_kelvin.*\n", "", text)
        (tmp_path / f"{name}.toml").write_text(
            lines.replace("[gauge]\n", f"[gauge]\nresistance_per_kelvin = {value}\n")
        )
    out = diff(capsys, tmp_path / "a.toml", tmp_path / "b.toml")
    assert out.count("changed") == 1 and "gauge.resistance_per_kelvin" in out


@pytest.mark.parametrize("content", ["{}", "[1", ""])
def test_what_is_no_side_is_refused(tmp_path, content):
    for path in (tmp_path / "x.json", tmp_path):
        if path.suffix:
            path.write_text(content)
        with pytest.raises(InputError):
            read_side(str(path))


def test_the_page_needs_nothing_else_and_shows_values_and_contours(thicker, tmp_path, capsys):
    out = tmp_path / "changes.html"
    diff(capsys, SHIPPED, thicker, "--html", out)
    text = out.read_text()
    assert_offline(text)
    assert "element.hinge_thickness" in text and "soft-tissue-element-a9mm" in text
    assert (
        text.count('<path class="old"') == text.count('<path class="new"') == 6
    )  # two elements and the bonding nest, whose tongue lies under the hinge; whole and enlarged


def test_hostile_text_stays_text():
    old, new = read_side(str(SHIPPED)), read_side(str(SHIPPED))
    change = Change("changed", ("values", "design.title"), "<script>alert(1)</script>", '"><img src=x>')
    text = page(old, new, [change]).decode()
    assert "<script" not in text and "<img" not in text and "&lt;script&gt;" in text


def test_drawn_arcs_are_the_contour_s():
    """A circle of radius 2 about (3, 2): SVG's y points down."""
    data = _path([circle((3.0, 2.0), 4.0)])
    x, y = map(float, re.match(r"M([-\d.]+),([-\d.]+)", data).groups())
    points = [(x, y)]
    for rx, _, turn, x, y in re.findall(r"A([\d.]+),([\d.]+),0,0,([01]),([-\d.]+),([-\d.]+)", data):
        points.append((float(x), float(y)))
        assert float(rx) == 2.0 and turn == "0"  # counter-clockwise seen with y up is sweep 0 with y down
    assert len(points) == 5 and all(dist(p, (3.0, -2.0)) == pytest.approx(2.0, abs=1e-6) for p in points)
    assert _path([rectangle(1, 1, 2, 3)]).startswith(
        "M1.000000,-1.000000L2.000000,-1.000000L2.000000,-3.000000"
    )


@pytest.mark.cad
@pytest.mark.slow  # a whole export
def test_an_export_agrees_with_its_design_and_with_the_golden_file(tmp_path, capsys):
    """Kernel and DXF on one side, closed forms on the other."""
    first = tmp_path / "whole"
    assert main(["export", str(SHIPPED), "--out", str(first)]) == 0
    for other in (SHIPPED, ROOT / "exports" / "golden" / "soft-tissue.json"):
        out = diff(capsys, first, other)
        assert "no difference" in out, out
        assert "an export holds no hole list" in out


@pytest.mark.slow  # two whole exports
@pytest.mark.cad
def test_two_exports(exports, tmp_path, capsys):
    html = tmp_path / "changes.html"
    out = diff(capsys, *exports, "--html", html)
    assert "changed values / element.hinge_thickness: 0.15 -> 0.17" in out
    assert "element-a9mm / contours" in out
    assert "spacer" not in out
    text = html.read_text()
    assert_offline(text)
    # the two elements look different, and the array's pictures may; the spacer does not
    shown = set(re.findall(r"<h3>(pictures/[^<]+)</h3>", text))
    assert {"pictures/soft-tissue-element-a5mm.svg", "pictures/soft-tissue-element-a9mm.svg"} <= shown
    assert "pictures/soft-tissue-spacer.svg" not in shown
    assert text.count("<img ") == 2 * len(shown)


@pytest.mark.slow  # two whole exports
@pytest.mark.cad
def test_an_altered_export_is_refused(exports):
    folder = exports[0].resolve()
    bill = folder / "bom.json"
    data = bill.read_bytes()
    bill.write_bytes(data + b" ")
    try:
        with pytest.raises(InputError, match="bom.json: changed"):
            read_side(str(exports[0]))
    finally:
        bill.write_bytes(data)


@pytest.mark.slow  # two whole exports
@pytest.mark.cad
def test_the_sides_records_stay_as_read(exports):
    side = read_side(str(SHIPPED))
    before = json.dumps(side.record)
    compare_sides(read_side(str(exports[0])), side)
    assert json.dumps(side.record) == before


def assert_offline(text: str) -> None:
    """Every address in the page is data in the page itself."""
    addresses = []

    class Reader(HTMLParser):
        def handle_starttag(self, tag, attrs):
            assert tag not in ("script", "link", "iframe", "object")
            addresses.extend(v for k, v in attrs if k in ("src", "href", "xlink:href", "data"))

    Reader().feed(text)
    assert all(address.startswith("data:image/svg+xml;base64,") for address in addresses)
    assert "url(" not in text and "@import" not in text


@pytest.mark.slow  # a page of two whole designs
def test_a_page_of_designs_whose_names_are_no_text(tmp_path):
    """Names of files are bytes: what is no UTF-8 in them is shown as escapes."""
    mine = Path(os.fsdecode(bytes(tmp_path) + b"/a\xff.toml"))
    shutil.copy(ROOT / "hardware" / "macro-array.toml", mine)
    page = tmp_path / "page.html"
    assert main(["diff", str(mine), "soft-tissue", "--html", str(page)]) == 0
    assert "a\\udcff.toml" in page.read_text("utf-8")
