"""Design files with hostile names, values, sizes and encodings, through the real command.

Refused ones: one line, exit status 2, nothing written. Legal ones with strange text: escaped in every kind of
file.
"""

from __future__ import annotations

import csv
import json
import os
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest
from command_line import contents, environment, one_by_one, refused, tactcad_forked, tactcad_runs

GOOD = one_by_one(4.0, "A")


def with_value(field: str, value: str) -> str:
    """GOOD with one value of [design] as this TOML text."""
    bare = re.sub(rf"^{field} = .*\n", "", GOOD, count=1, flags=re.MULTILINE)
    return bare.replace("[design]\n", f"[design]\n{field} = {value}\n", 1)


# TOML text -> what it stands for
HOSTILE_NAMES = {
    '"../x"': "leads out of the folder",
    '"/x"': "absolute",
    '"a/b"': "a folder in it",
    '"a\\\\b"': "Windows' folder in it",
    '"a\\u0000b"': "NUL",
    '"a\\nb"': "line end",
    '"."': "this folder",
    '".."': "folder above",
    '""': "empty",
    '" "': "a space",
    '"a "': "trailing space",
    '"a."': "trailing dot",
    '"-rf"': "an option",
    '"a;id"': "shell",
    '"$(id)"': "shell",
    '"a`id`"': "shell",
    '"a\'b"': "quote",
    "'a\"b'": "quote",
    '"<b>"': "markup",
    '"=1+1"': "formula",
    '"a:b"': "Windows' stream",
    '"con"': "Windows device",
    '"aux"': "Windows device",
    '"com1"': "Windows device",
    '"MACRO"': "capital letters: one file with macro on some disks",
    f'"{"x" * 41}"': "too long",
    f'"{"x" * 100_000}"': "far too long",
    '"\\u202egpj"': "turns the direction of text",
    '"\u89e6\u899a"': "letters that old programs break",
    '"\U0001f600"': "emoji",
    '"a\\u200bb"': "invisible",
    "7": "no text",
    '["a"]': "no text",
}
HOSTILE_LINES = [
    '""',
    '" "',
    '"a\\nb"',
    '"a\\u0000b"',
    '"\\u202egpj"',
    '"\\u0085"',
    '"\\ufffe"',
    f'"{"x" * 81}"',
    "1",
    "[[]]",
]


def refuse(tmp_path, data: bytes, command: str = "export", name: str = "bad.toml") -> str:
    """The line with which the design is refused; nothing may have been written."""
    work = tmp_path / "work"
    work.mkdir()
    (work / name).write_bytes(data)
    (done,) = tactcad_runs([[command, name]], work, environment(tmp_path))
    assert [p.name for p in work.rglob("*")] == [name]
    assert not (tmp_path / "cache").exists()
    return refused(done)


@pytest.mark.by_day(10, "a process each")
@pytest.mark.parametrize("name", HOSTILE_NAMES, ids=list(HOSTILE_NAMES.values()))
def test_hostile_name(tmp_path, name):
    said = refuse(tmp_path, with_value("name", name).encode())
    assert (
        said.startswith("tactcad: design.name: not usable text; found ") and "legal: 1 to 40 of a-z" in said
    )
    assert len(said) < 400 and said.isprintable()


@pytest.mark.by_day(1, "ten processes each")
@pytest.mark.parametrize("field", ["title", "author", "organisation"])
def test_hostile_lines(tmp_path, field):
    for n, value in enumerate(HOSTILE_LINES):
        said = refuse(
            tmp_path / f"{n}" if not (tmp_path / f"{n}").mkdir() else tmp_path,
            with_value(field, value).encode(),
        )
        assert said.startswith(f"tactcad: design.{field}: not usable text; found ")


def nested(depth: int, opening: str, closing: str) -> bytes:
    return f"x = {opening * depth}{closing * depth}\n".encode()


HOSTILE_FILES = {
    "empty": (b"", "design"),
    "10 MB of comment": (b"#" * 10_000_000, "larger"),
    "10 MB of design": ((GOOD + "\n#\n") * (10_000_000 // len(GOOD)), "larger"),
    "1 MB of keys": ("\n".join(f"a{n} = 1" for n in range(80_000)), "a0: unknown field"),
    "1 MB in one number": (with_value("revision", '"A"') + "[sheet]\nx = " + "9" * 900_000, "TOML"),
    "10 000 arrays": (nested(10_000, "[", "]"), "nested too deeply"),
    "300 arrays": (nested(300, "[", "]"), "x: unknown field"),
    "100 000 arrays that never close": (nested(100_000, "[", ""), "nested too deeply"),
    "10 000 inline tables": (nested(10_000, "{a = ", "}"), "nested too deeply"),
    "10 000 arrays as a value": (
        GOOD + "[sample]\nside = " + "[" * 10_000 + "]" * 10_000,
        "nested too deeply",
    ),
    "60 kB dotted key": ("a." * 30_000 + "a = 1", "too many names"),
    "dotted key with quotes": ('"\\"" . ' * 30_000 + "a = 1", "too many names"),
    "dotted table": ("[" + "'a'." * 30_000 + "a]", "too many names"),
    "dotted key in a table": ("a = {" + "a." * 30_000 + "a = 1}", "too many names"),
    "UTF-16": (GOOD.encode("utf-16"), "UTF-8"),
    "UTF-16, no mark": (GOOD.encode("utf-16-le"), "TOML"),
    "UTF-32": (GOOD.encode("utf-32"), "UTF-8"),
    "latin-1": (with_value("author", '"J\xf6rg"').encode("latin-1"), "UTF-8"),
    "lone surrogate": (with_value("author", '"\ud800"').encode("utf-8", "surrogatepass"), "UTF-8"),
    "escaped surrogate": (with_value("author", '"\\ud800"'), "TOML"),
    "two marks": (b"\xef\xbb\xbf" + GOOD.encode("utf-8-sig"), "TOML"),
    "NUL": (GOOD.replace("\n", "\n\0", 1), "TOML"),
    "NULs": (bytes(10_000), "TOML"),
    "old Mac's line ends": (GOOD.replace("\n", "\r"), "TOML"),
    "a picture": (b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "UTF-8"),
    "a date that is none": (with_value("date", "2026-02-30"), "TOML"),
    "NaN": (
        re.sub("^thickness = .*$", "thickness = nan", GOOD, count=1, flags=re.MULTILINE),
        "not a finite number",
    ),
    "infinity": (
        re.sub("^thickness = .*$", "thickness = -inf", GOOD, count=1, flags=re.MULTILINE),
        "not a finite number",
    ),
    "key with line end": (GOOD.replace("[sheet]", '[sheet]\n"a\\nb" = 1', 1), "unknown field"),
    "key of 100 kB": (GOOD.replace("[sheet]", "[sheet]\n" + "a" * 100_000 + " = 1", 1), "unknown field"),
    "key with a terminal's commands": (
        GOOD.replace("[sheet]", '[sheet]\n"\\u001b[2J" = 1', 1),
        "unknown field",
    ),
    "Python's own names": ("[__class__]\n__init__ = 1\n", "unknown field"),
    "sections that are lists": (GOOD.replace("[sheet]", "[[sheet]]", 1), "not a table"),
}


@pytest.mark.by_day(12, "a process each")
@pytest.mark.parametrize("name", HOSTILE_FILES)
def test_hostile_file(tmp_path, name):
    data, expected = HOSTILE_FILES[name]
    said = refuse(
        tmp_path, data.encode() if isinstance(data, str) else data, "check" if len(name) % 2 else "export"
    )
    assert expected in said and len(said) < 600 and said.isprintable()


def test_what_is_no_file(tmp_path):
    """Folder, pipe, devices, links that lead nowhere or in circles, names that cannot be."""
    work = tmp_path / "work"
    (work / "folder.toml").mkdir(parents=True)
    os.mkfifo(work / "pipe.toml")
    (work / "loop.toml").symlink_to("loop.toml")
    (work / "away.toml").symlink_to("nowhere")
    before = sorted(p.name for p in work.iterdir())
    names = [
        "folder.toml",
        "./pipe.toml",
        "loop.toml",
        "loop.toml/x.toml",
        "away.toml",
        "/dev/zero",
        "/dev/null",
        "/dev/tty",
        ".",
        "/",
        "nowhere.toml",
        "no-such",
        "",
        "x" * 300,
        "x" * 5000 + ".toml",
        "folder.toml/",
        "-",
        b"\xff.toml",
        "a\nb.toml",
        "\u202e.toml",
        "/proc/self/mem",
        "$(id).toml",
        "~/x.toml",
    ]
    for name in names:
        said = refused(tactcad_forked("export", name, cwd=work, env=environment(tmp_path)))
        assert "; legal: " in said, said
    assert sorted(p.name for p in work.iterdir()) == before


@pytest.mark.parametrize("change", ["as it is", "byte order mark", "Windows' line ends", "both"])
def test_encodings_that_are_fine(bench, work, change):
    """The same design from another editor is the same export."""
    text = (
        bench.texts["A"].replace("\n", "\r\n")
        if change in ("Windows' line ends", "both")
        else bench.texts["A"]
    )
    (work / "A.toml").write_bytes(
        text.encode("utf-8-sig" if change in ("byte order mark", "both") else "utf-8")
    )
    done = tactcad_forked("export", "A.toml", "--out", "exports/out", cwd=work, env=environment(work))
    assert done.returncode == 0, done.stderr.decode()
    assert contents(work / "exports" / "out") == bench.files["A"]


# --- legal text that is poison elsewhere ---

TITLE = "</title></svg><script>alert('1')</script>]]>&lt;\"\\ %s {0} $(id) \u89e6\u899a"
AUTHOR = "=cmd|' /C calc'!A0 \U0001f600 J\u00f6rg"
ORGANISATION = "O'Neil \\X2\\0041\\X0\\ ;ENDSEC; '#1=X(' @SUM(1) \u05d0\u05d1"


class Page(HTMLParser):
    """Tags and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)

    def handle_data(self, data):
        self.text += data


def step_text(coded: str) -> str:
    """Text of a STEP string (ISO 10303-21, 6.4.3): quotes and backslashes doubled, the rest beyond ASCII as
    \\X2\\, \\X4\\."""

    def decoded(match: re.Match) -> str:
        if match.group(0) in ("''", "\\\\"):
            return match.group(0)[0]
        width = 4 if match.group(1) == "X2" else 8
        digits = match.group(2)
        return "".join(chr(int(digits[i : i + width], 16)) for i in range(0, len(digits), width))

    return re.sub(r"''|\\\\|\\(X2|X4)\\((?:[0-9A-F]{4})+)\\X0\\", decoded, coded)


@pytest.mark.slow  # a whole export with sheets
def test_legal_text_is_escaped_in_every_kind_of_file(work):
    text = with_value("title", json.dumps(TITLE, ensure_ascii=False))
    for field, value in (("author", AUTHOR), ("organisation", ORGANISATION)):
        said = f"{field} = {json.dumps(value, ensure_ascii=False)}"
        text = text.replace("[design]\n", f"[design]\n{said}\n", 1)
    (work / "A.toml").write_text(text, encoding="utf-8")
    done = tactcad_forked(
        "export", "A.toml", "--guide", "--out", "exports/out", cwd=work, env=environment(work)
    )
    assert done.returncode == 0, done.stderr.decode()
    seen = dict.fromkeys(("svg", "html", "step", "csv"), 0)
    for path, data in contents(work / "exports" / "out").items():
        kind = path.rpartition(".")[2]
        seen[kind] = seen.get(kind, 0) + 1
        if kind == "svg":
            found = ElementTree.fromstring(data)
            assert not any(e.tag.rpartition("}")[2] in ("script", "foreignObject") for e in found.iter())
            if path.endswith(("-above.svg", "-below.svg", "-open.svg", "-exploded.svg")):
                assert TITLE in "".join(found.itertext())
        elif kind == "html":
            page = Page(data.decode())
            assert "script" not in page.tags and page.tags.count("title") == 1
            assert ("svg" in page.tags) == path.endswith("stack.html")
            assert TITLE in page.text
        elif kind == "step":
            head = data.decode("ascii").split("DATA;")[0]
            strings = [step_text(s) for s in re.findall(r"'((?:[^']|'')*)'", head)]
            assert AUTHOR in strings and ORGANISATION in strings
            assert data.count(b"\nENDSEC;\n") == 2 and data.count(b"\nDATA;\n") == 1
        elif kind == "csv":
            rows = list(csv.reader(data.decode().splitlines()))
            assert len({len(row) for row in rows}) == 1
            cells = [cell for row in rows for cell in row if not re.fullmatch(r"-?[\d.]+(e-?\d+)?", cell)]
            assert not [cell for cell in cells if cell[:1] in tuple("=+-@\t\r") and cell[:1]]
        elif kind == "json":
            json.loads(data)
        elif kind == "dxf":
            assert data.isascii() and b"calc" not in data
    assert all(seen.values()), seen
    again = tactcad_forked("diff", "A.toml", "B.toml", "--html", "d.html", cwd=work, env=environment(work))
    page = Page((work / "d.html").read_text(encoding="utf-8"))
    assert again.returncode == 0 and "script" not in page.tags and TITLE in page.text and AUTHOR in page.text
