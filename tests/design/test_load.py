"""Bad design files: each is refused with the field's path, the value and what is legal, in one line."""

from __future__ import annotations

import re
import time

import pytest
from variants import DROP, HARDWARE, table, variant

from tactcad.design.load import MOST_BYTES, find, from_table, names, parse, paths, read
from tactcad.design.messages import InputError

GOOD = (HARDWARE / "macro-array.toml").read_text()

# change -> where the message points, what it says, what it calls legal
BAD_VALUES = {
    "unknown field": (
        {"element.hinge_thicknes": 0.25},
        "element.hinge_thicknes",
        "unknown",
        "element.hinge_thickness",
    ),
    "unknown table": ({"elements.x": 1}, "elements", "unknown", "element"),
    "unknown field of a rig": ({"sample.stifness": 1}, "sample.stifness", "unknown", "sample.stiffness"),
    "a target": ({"target.base": "x"}, "target", "no design", "a target is for `tactcad design`"),
    "a study": ({"study.name": "x"}, "study", "no design", "a study is for `tactcad sweep`"),
    "another table's field in an override": (
        {"element.override.3.width": 1},
        "element.override.3.width",
        "unknown",
        "see `tactcad schema`",
    ),
    "unknown field of an override": (
        {"element.override.3.hinge": 1},
        "element.override.3.hinge",
        "unknown",
        "element.override.3.hinge_",
    ),
    "missing field": (
        {"element.hinge_thickness": DROP},
        "element.hinge_thickness",
        "missing",
        "0.005 to 5 mm",
    ),
    "missing rows": ({"array.row_arms": DROP}, "array.row_arms", "missing", "one or two rows"),
    "missing table": ({"sheet": DROP}, "sheet", "missing", "[sheet]"),
    "value instead of a table": ({"sheet": 3.0}, "sheet", "table", "[sheet]"),
    "fraction of a ring": ({"holder.rings": 2.5}, "holder.rings", "not a whole number", "from 1 to 12"),
    "too many rings": ({"holder.rings": 13}, "holder.rings", "out of range", "from 1 to 12"),
    "truth value": (
        {"element.hinge_thickness": True},
        "element.hinge_thickness",
        "not a number",
        "0.005 to 5 mm",
    ),
    "text": ({"element.hinge_thickness": "0.25"}, "element.hinge_thickness", "not a number", "0.005 to 5 mm"),
    "list": ({"element.hinge_thickness": [0.25]}, "element.hinge_thickness", "not a number", "0.005 to 5 mm"),
    "table": (
        {"element.hinge_thickness": {"x": 1}},
        "element.hinge_thickness",
        "not a number",
        "0.005 to 5 mm",
    ),
    "NaN": ({"element.hinge_thickness": float("nan")}, "element.hinge_thickness", "finite", "0.005 to 5 mm"),
    "infinity": ({"array.pitch": float("inf")}, "array.pitch", "finite", "0.2 to 50 mm"),
    "minus infinity": ({"array.pitch": float("-inf")}, "array.pitch", "finite", "0.2 to 50 mm"),
    "zero": ({"sheet.thickness": 0}, "sheet.thickness", "out of range", "0.1 to 20 mm"),
    "zero arm": ({"array.row_arms": [[4, 0]]}, "array.row_arms[0][1]", "out of range", "0.1 to 100 mm"),
    "negative": ({"rating.force": -2.0}, "rating.force", "out of range", "N"),
    "1e300": ({"material.youngs_modulus": 1e300}, "material.youngs_modulus", "out of range", "MPa"),
    "huge integer": ({"material.density": 10**400}, "material.density", "out of range", "kg/m3"),
    "huge hexadecimal": ({"material.density": 16**4000}, "material.density", "out of range", "kg/m3"),
    "no rows": ({"array.row_arms": []}, "array.row_arms", "rows", "one or two rows"),
    "empty row": ({"array.row_arms": [[]]}, "array.row_arms[0]", "list of 0", "1 to 500"),
    "row too long": ({"array.row_arms": [[4] * 501]}, "array.row_arms[0]", "list of 501", "1 to 500"),
    "arms without rows": ({"array.row_arms": [4, 5]}, "array.row_arms[0]", "not a list", "numbers"),
    "third row": ({"array.row_arms": [[4], [4], [4]]}, "array.row_arms", "one plane", "one or two rows"),
    "truth value in a row": ({"array.row_arms": [[4, False]]}, "array.row_arms[0][1]", "not a number", "mm"),
    "unknown alloy": (
        {"material.alloy": "brass", "material.density": DROP},
        "material.alloy",
        "not in the table of materials, and density is not given",
        "7075-T6",
    ),
    "number for a choice": ({"element.sides": 1}, "element.sides", "choice", "'one'"),
    "name with a path": ({"design.name": "../evil"}, "design.name", "text", "a-z"),
    "absolute name": ({"design.name": "/etc/passwd"}, "design.name", "text", "a-z"),
    "hidden name": ({"design.name": ".hidden"}, "design.name", "text", "a-z"),
    "name with a backslash": ({"design.name": "a\\b"}, "design.name", "text", "a-z"),
    "name with a null": ({"design.name": "a\x00b"}, "design.name", "text", "a-z"),
    "name that ends in a line end": ({"design.name": "macro\n"}, "design.name", "text", "a-z"),
    "name in capitals": ({"design.name": "Macro"}, "design.name", "text", "a-z"),
    "empty name": ({"design.name": ""}, "design.name", "text", "a-z"),
    "long name": ({"design.name": "a" * 41}, "design.name", "text", "1 to 40"),
    "number for a name": ({"design.name": 5}, "design.name", "text", "a-z"),
    "control character in the title": ({"design.title": "a\x1b[31mb"}, "design.title", "text", "printable"),
    "line end in the author": ({"design.author": "a\nb"}, "design.author", "text", "one line"),
    "text run backwards": ({"design.author": "a\u202eb"}, "design.author", "text", "printable"),
    "what XML cannot hold": ({"design.title": "a\uffffb"}, "design.title", "text", "printable"),
    "no title at all": ({"design.title": "  "}, "design.title", "text", "printable"),
    "revision with a path": ({"design.revision": "A/B"}, "design.revision", "text", "capital"),
    "small revision": ({"design.revision": "a"}, "design.revision", "text", "capital"),
    "date in words": ({"design.date": "today"}, "design.date", "not a day", "YYYY-MM-DD"),
    "no such day": ({"design.date": "2026-02-30"}, "design.date", "not a day", "YYYY-MM-DD"),
    "override of nothing": ({"element.override": 3}, "element.override", "table", "element.override.N"),
    "override zero": (
        {"element.override.0.hinge_thickness": 0.2},
        "element.override.0",
        "element number",
        "1",
    ),
    "override by word": (
        {"element.override.E1.hinge_thickness": 0.2},
        "element.override.E1",
        "element number",
        "1",
    ),
    "override out of range": (
        {"element.override.3.hinge_thickness": 0},
        "element.override.3.hinge_thickness",
        "out of range",
        "mm",
    ),
    "gap by word": ({"stop.gaps": {"short": 0.1}}, "stop.gaps.short", "arm length", "mm"),
    "gap of zero": ({"stop.gaps": {"4": 0}}, "stop.gaps.4", "out of range", "mm"),
    "gap by 4_0": ({"stop.gaps": {"4_0": 0.1}}, "stop.gaps.4_0", "arm length", "mm"),
    "gap by Arabic digits": ({"stop.gaps": {"\u0664": 0.1}}, "stop.gaps.\u0664", "arm length", "mm"),
    "gap twice": ({"stop.gaps": {"4": 0.1, "4.0": 0.2}}, "stop.gaps.4.0", "twice", "mm"),
    "gaps as a number": ({"stop.gaps": 0.1}, "stop.gaps", "table", "gap by arm length"),
    "origin of nothing": (
        {"origin": {"element.hinge": "paper"}},
        "origin.element.hinge",
        "unknown",
        "origin.element.hinge_",
    ),
    "origin that is a number": (
        {"origin": {"sheet.thickness": 3}},
        "origin.sheet.thickness",
        "not text",
        "source",
    ),
    "origin of a rig that is not there": ({"sample": DROP}, "origin.sample.", "unknown", ""),
    "key with a line end": (
        {"element.override.a\nb.hinge_thickness": 1},
        "element.override.a\nb",
        "element number",
        "1",
    ),
    "gap by a line end": ({"stop.gaps": {"a\x1bb\n": 0.1}}, "stop.gaps.a\x1bb\n", "arm length", "mm"),
    "long key": ({"element." + "x" * 5000: 1}, "element.xxx", "unknown", "tactcad schema"),
    "long key of an override": (
        {"element.override." + "9" * 5000 + ".hinge_thickness": 1},
        "element.override.999",
        "element number",
        "1",
    ),
}


def refused(call, *args) -> InputError:
    with pytest.raises(InputError) as caught:
        call(*args)
    text = str(caught.value)
    assert text.isprintable(), "one line, without control characters"
    assert len(text) < 600
    return caught.value


@pytest.mark.parametrize("name", BAD_VALUES)
def test_bad_value_is_refused_with_its_path_and_what_is_legal(name):
    changes, where, what, legal = BAD_VALUES[name]
    error = refused(from_table, table(changes))
    assert error.where.startswith(where)
    assert what in error.what
    assert legal in error.legal


def test_the_value_stands_in_the_message():
    error = refused(from_table, table({"element.hinge_thickness": 7.125}))
    assert str(error) == "element.hinge_thickness: out of range; found 7.125; legal: from 0.005 to 5 mm"


def test_both_ends_of_a_range_are_legal_and_the_next_number_is_not():
    assert variant({"element.hinge_thickness": 5}).element.hinge_thickness == 5.0
    refused(from_table, table({"element.hinge_thickness": 5.000000000000001}))
    assert variant({"element.hinge_thickness": 0.005}).element.hinge_thickness == 0.005
    refused(from_table, table({"element.hinge_thickness": 0.00499999999999999}))


BAD_TEXTS = {
    "not TOML": ("this is no design", "not TOML"),
    "duplicate key": (GOOD.replace("thickness = 3.0", "thickness = 3.0\nthickness = 4.0", 1), "not TOML"),
    "duplicate table": (GOOD + "\n[sheet]\nthickness = 3.0\n", "not TOML"),
    "nothing": ("", "missing table"),
    "deep list": ("a = " + "[" * 100_000, "nested too deeply"),
    "deep list that closes": ("a = " + "[" * 5000 + "]" * 5000, "nested too deeply"),
    "deep inline table": ("a = " + "{a=" * 100_000, "nested too deeply"),
    "integer of 10000 digits": ("a = " + "9" * 10_000, "not TOML"),
    "day that is none": ("a = 2026-02-30", "not TOML"),
    "lone carriage return": ("a = 1\rb = 2", "not TOML"),
    "null character": ("a = 1\x00", "not TOML"),
}


@pytest.mark.parametrize("name", BAD_TEXTS)
def test_text_that_is_no_design_is_refused(name):
    text, what = BAD_TEXTS[name]
    error = refused(parse, text, "x.toml")
    assert error.where.startswith("x.toml") or what == "missing table"
    assert what in error.what


@pytest.mark.parametrize(
    "text",
    [
        "a." * 5_000 + "a = 1",
        "[origin]\n" + "a." * 5_000 + "a = 'paper'",
        "[" + "a." * 5_000 + "a]",
        "a = " + "[1]," * 200_000,
        "[element]\n" + "".join(f"x{i} = 1\n" for i in range(60_000)),
    ],
    ids=["dotted key", "dotted origin", "dotted table", "commas", "many unknown fields"],
)
def test_hostile_text_is_refused_in_seconds(text):
    start = time.process_time()
    refused(parse, text, "x.toml")
    assert time.process_time() - start < 10


def test_lists_as_deep_as_the_parser_goes_are_refused_all_the_same():
    """Where TOML's own reader just gets through, showing the value must not fail."""
    for depth in (10, 100, 200, 300, 330, 400, 490):
        refused(parse, "sheet = " + "[" * depth + "]" * depth, "x.toml")
        refused(parse, "[sheet]\nthickness = " + "[" * depth + "]" * depth, "x.toml")


def test_files_that_cannot_be_designs(tmp_path):
    assert "no such file" in refused(read, tmp_path / "absent.toml").what
    assert "not a file" in refused(read, tmp_path).what
    large = tmp_path / "large.toml"
    large.write_bytes(b"# " + b"x" * 10_000_000)
    error = refused(read, large)
    assert "larger" in error.what and str(MOST_BYTES) in error.legal
    latin = tmp_path / "latin.toml"
    latin.write_bytes(GOOD.replace('title = "', 'title = "J\xf6rg ').encode("latin-1"))
    error = refused(read, latin)
    assert "UTF-8" in error.what
    line = GOOD[: GOOD.index("title")].count("\n") + 1
    assert error.where.startswith(f"{latin}:{line}:")
    loop = tmp_path / "loop.toml"
    loop.symlink_to(loop)
    refused(read, loop)
    assert "no such file" in refused(read, tmp_path / "two\nlines.toml").what
    refused(read, tmp_path / ("x" * 5000 + ".toml"))


def test_names_in_hardware():
    assert set(names()) >= {"macro-array", "soft-tissue"}
    error = refused(find, "makro-array")
    assert error.where == "DESIGN" and "macro-array" in error.legal
    for hostile in ("", " ", "..", "macro-array\n", "*"):
        refused(find, hostile)


def test_windows_text_reads_as_the_same_design(tmp_path):
    plain = read(HARDWARE / "macro-array.toml")
    for data in (
        b"\xef\xbb\xbf" + GOOD.encode(),
        GOOD.replace("\n", "\r\n").encode(),
        b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode(),
    ):
        path = tmp_path / "windows.toml"
        path.write_bytes(data)
        assert read(path) == plain


def test_text_beyond_ascii_is_kept():
    design = variant({"design.author": "J\u00f6rg \u0141. \u6d4b\u8bd5 \U0001f600 O'Neil"})
    assert design.design.author == "J\u00f6rg \u0141. \u6d4b\u8bd5 \U0001f600 O'Neil"


def test_a_toml_date_is_a_date_and_nothing_else():
    dated = GOOD.replace('date = "2026-11-28"', "date = 2026-11-28")
    assert dated != GOOD
    assert parse(dated, "x").design.date == "2026-11-28"
    wrong = GOOD.replace('title = "Macro tactile array 2 x 5"', "title = 2026-11-21")
    assert refused(parse, wrong, "x").where == "design.title"


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue"])
def test_every_value_in_a_shipped_design_has_an_origin(name):
    given = table(base=name)
    origins = given.pop("origin")
    written = {f"{section}.{field}" for section, fields in given.items() for field in fields}
    assert set(origins) == written
    for path, origin in origins.items():
        kind, _, reason = origin.partition(":")
        assert kind in ("paper", "inferred", "derived", "chosen"), path
        assert len(reason.strip()) >= 3, f"{path}: {kind} without what or why"


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue"])
def test_what_the_file_says_is_what_the_design_holds(name):
    """Read by TOML alone and by the loader: the same values at the same paths."""
    held = paths(read(HARDWARE / f"{name}.toml"))
    for section, fields in table(base=name).items():
        for field, value in fields.items() if section != "origin" else ():
            got = held[f"{section}.{field}"]
            listed = [list(r) if isinstance(r, tuple) else r for r in got] if isinstance(got, tuple) else got
            assert listed == value, f"{section}.{field}"


def test_the_papers_values_stand_in_the_shipped_design():
    """Dimensions that the paper prints: sheet, hinge, pad, resolution, arm lengths by number (Table 1)."""
    d = read("macro-array")
    assert (d.sheet.thickness, d.element.hinge_thickness, d.element.pad_length) == (3.0, 0.25, 2.0)
    assert (d.array.pitch, d.array.row_pitch) == (4.0, 4.0)
    assert (d.material.youngs_modulus, d.material.poisson) == (69000.0, 0.33)
    by_number = [a for row in d.array.row_arms for a in row]
    published = {1: 4, 2: 7, 3: 6, 4: 8, 6: 8, 7: 5, 8: 4, 9: 5, 10: 7}
    assert len(by_number) == 10
    assert {n: by_number[n - 1] for n in published} == published


def test_overrides_are_sorted_and_keep_what_they_do_not_name():
    d = variant({"element.override.10.fillet_radius": 0.2, "element.override.2.hinge_thickness": 0.3})
    assert list(d.element.override) == [2, 10]
    assert d.element.override[2].hinge_thickness == 0.3
    assert d.element.override[2].fillet_radius is None


def test_an_alloy_gives_what_the_file_leaves_out():
    from tactcad.design.materials import ALLOYS, OPTIONAL

    left_out = ("youngs_modulus", "poisson", "density", "yield_strength", "fatigue_strength")
    for name, alloy in ALLOYS.items():
        d = variant({"material.alloy": name, **{f"material.{f}": DROP for f in left_out}})
        assert all(getattr(d.material, f) == getattr(alloy, f) for f in (*left_out, *OPTIONAL))
    d = variant({"material.youngs_modulus": 70500})
    assert d.material.youngs_modulus == 70500.0


def test_messages_cannot_be_forged_by_a_file_name(tmp_path):
    error = refused(read, str(tmp_path / "x\ntactcad: all is well.toml"))
    assert not re.search(r"^tactcad: all is well", str(error), re.MULTILINE)


def test_a_whole_number_may_be_written_with_a_point_and_is_an_integer():
    for written in (10, 10.0):
        weights = variant({"grasping.weights": written}).grasping.weights
        assert (weights, type(weights)) == (10, int)
