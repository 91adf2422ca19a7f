"""Texts and keys of TOML and JSON files: what is only said in comments is free, what hides or misleads is
refused."""

from __future__ import annotations

import json

import pytest

from tactcad.checks.shop import DEFAULT, load_shop
from tactcad.design import load
from tactcad.design.files import read_json
from tactcad.design.messages import InputError
from tactcad.design.text_values import parse_toml
from tactcad.paper import published

LONG = ".".join("abcdefghijklmnopq")  # 17 names
FREE = [
    f"# {LONG}\na = 1",
    f'a = "{LONG}" # {LONG}',
    f"a = '{LONG}'",
    f'a = """\n{LONG}\n"" {LONG} \\""" {LONG}"""',
    f"a = '''\n''{LONG}'''",
    f'a = "\\"" # "{LONG}',
    f'a = """x""""\nb = 1 # {LONG}',
    f'"#" = 1 # {LONG}',
]
KEYS = [
    f"{LONG} = 1",
    f'a = "" # x\n{LONG} = 1',
    f'a = "#"\n{LONG} = 1',
    f'"#".{LONG} = 1',
    '"a" . ' * 17 + "b = 1",
    f"a = {{ {LONG} = 1 }}",
    f'a = """#"""\n[{LONG}]',
    f"a = '''x\\'''\n{LONG} = 1",
    f'a = """x\\\\"""\n{LONG} = 1',
    f'a = """x"""""\n{LONG} = 1',
]


@pytest.mark.parametrize("text", FREE)
def test_comments_and_texts_may_hold_any_number_of_dotted_words(text):
    assert parse_toml(text, "x.toml")


@pytest.mark.parametrize("text", KEYS)
def test_a_key_of_many_names_is_refused_wherever_it_stands(text):
    with pytest.raises(InputError, match="a key of too many names"):
        parse_toml(text, "x.toml")


INVISIBLE = [
    "\u200b",
    "\u2060\u200b",
    "\u200d",
    "\u00ad",
    "\u3164",
    "\uffa0\u115f",
    "\u2800",
    "\U000e0041",
    "--",
]
MISLEADING = [
    "a\u202eb",
    "a\u2066b",
    "a\u200fb",
    "a\u061cb",
    "a\u200bb",
    "a\u2028b",
    "a\x07b",
    "a\U000e0041b",
]
SEEN = [
    "Array 7",
    "\u89e6\u899a",
    "\u0645\u06cc\u200c\u062e\u0648\u0627\u0647\u0645",
    "\u05d0\u05d1",
    "\U0001f468\u200d\U0001f469 2",
]


def titled(macro_text: str, title: str, field: str = "title") -> str:
    lines = [line for line in macro_text.splitlines() if not line.startswith(f"{field} =")]
    at = lines.index("[design]") + 1
    return "\n".join([*lines[:at], f"{field} = {json.dumps(title, ensure_ascii=False)}", *lines[at:]])


@pytest.fixture(scope="module")
def text() -> str:
    return load.find("macro-array").read_text("utf-8")


@pytest.mark.parametrize("field", ["title", "author", "organisation"])
def test_a_name_is_seen_and_shows_as_it_is_read(text, field):
    for title in INVISIBLE + MISLEADING:
        with pytest.raises(InputError, match=rf"^design\.{field}: not usable text"):
            load.parse(titled(text, title, field), "x.toml")
    for title in SEEN:
        assert getattr(load.parse(titled(text, title, field), "x.toml").design, field) == title


def test_a_source_that_turns_the_direction_of_text(text):
    for value in ("\u202emorf", "\u200b", ""):
        changed = text.split("\n[origin]\n")[0] + f'\n[origin]\n"sheet.thickness" = "{value}"\n'
        with pytest.raises(InputError, match=r"^origin\.sheet\.thickness: not (usable )?text"):
            load.parse(changed, "x.toml")


def test_a_shop_whose_wall_is_an_integer_beyond_floats(tmp_path):
    shop = DEFAULT.read_text("utf-8")
    for old, new, said in (
        ("\nwall = ", "\nwall = 1" + "0" * 400 + " # ", "limits.wall: is no size"),
        ("\nname = ", '\nname = "\u202ea" # ', "name: not usable text: it holds U\\+202E"),
    ):
        assert old in shop
        (tmp_path / "shop.toml").write_text(shop.replace(old, new, 1))
        with pytest.raises(InputError, match=f"^{tmp_path}/shop.toml: {said}"):
            load_shop(tmp_path / "shop.toml")


@pytest.mark.parametrize("cell", ["0e400", "0e99999999999999999999", "1e-400000000000000000000"])
def test_a_printed_number_whose_last_digit_is_beyond_all_numbers(tmp_path, cell):
    table = (published.files("tactcad.paper") / "data" / "table1.csv").read_text("utf-8").splitlines()
    start = next(i for i, line in enumerate(table) if line.startswith("element"))
    cells = table[start + 1].split(",")
    cells[table[start].split(",").index("zero_signal_V")] = cell
    table[start + 1] = ",".join(cells)
    (tmp_path / "t.csv").write_text("\n".join(table))
    if "-" in cell:  # nothing is lost: a number nearer to nought than any other
        assert published.load(tmp_path / "t.csv").table1.zero_signal.half_step[0] == 0.0
        return
    with pytest.raises(InputError, match=rf"t\.csv:{start + 2}:8: its last digit is beyond all numbers"):
        published.load(tmp_path / "t.csv")


@pytest.mark.parametrize(
    "value", ['"\\ud800"', '"\\udc00x"', "1" + "0" * 400, '"\u202e"', "1e400", "-" + "9" * 5000]
)
def test_json_that_no_file_can_hold_again(tmp_path, value):
    for text in (f'{{"a": [{value}]}}', f'{{"b": {{"c": {value}}}}}') + (
        (f"{{{value}: 1}}",) if '"' in value else ()
    ):
        (tmp_path / "x.json").write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match=f"^{tmp_path}/x.json: "):
            read_json(tmp_path / "x.json", 10_000, "a file")
