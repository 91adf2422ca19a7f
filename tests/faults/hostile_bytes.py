"""Files as strangers hand them in: a good one, changed here and there by chance, within its grammar and
against it."""

from __future__ import annotations

import json
from copy import deepcopy
from random import Random
from typing import Any

NUMBERS = (
    "0 -0 -1 3 1e-9 1e-320 1e308 -1e308 1e400 0e400 1e-400 1e99999999999999999999 nan inf -inf 1_0 0x10 1,5 "
    "0.1 1.0000000001 2e5 100000 99999999999 1e16 0.30000000000000004"
).split() + ["9" * 400, "9" * 5000, "\u0663", "0." + "0" * 5000 + "1"]
TEXTS = [
    "",
    " ",
    "x",
    "\u202e",
    "\u200b",
    "\ud800",
    "\0",
    "a\nb",
    "../x",
    "=1+1",
    '"',
    "'",
    "\\",
    "\u00e9\u89e6\U0001f600",
    "#",
    ";",
    "\t",
    ",",
    "E1",
    "element",
    "x" * 300,
    "None",
    "true",
    "[",
    "]",
    "{",
    "}",
    "=",
    "\r",
    "\x0b",
    "\u2028",
    "\x85",
    "\ufeff",
]
VALUES: list[Any] = [
    *(None, True, False, 0, -1, 1, 7, 0.5, -0.0, 1e308, 1e-320, 10**400, 10**18, "", "x", "1"),
    *([], {}, [1], [[1]], {"a": 1}, [None], [[[0, 0, 1, 1]]], "\ud800", "\u202e", float("nan"), float("inf")),
]


def hostile(good: bytes, kind: str, seed: int) -> bytes:
    """The file after one to five changes; `kind` is its name's ending."""
    r = Random(seed)
    if kind == "json" and r.random() < 0.7:
        return _other_json(json.loads(good), r)
    data = good
    for _ in range(r.choice((1, 1, 1, 2, 3, 5))):
        data = r.choice(CHANGES)(data, r)
    return data


def _other_json(value: Any, r: Random) -> bytes:
    for _ in range(r.choice((1, 1, 2, 4))):
        holder, key = None, None
        node = value
        while isinstance(node, dict | list) and node and (holder is None or r.random() < 0.8):
            holder, key = node, r.choice(list(node) if isinstance(node, dict) else range(len(node)))
            node = holder[key]
        if holder is None:
            continue
        what = r.randrange(5)
        if what == 0:
            del holder[key]
        elif what == 1 and isinstance(holder, dict):
            holder[r.choice(TEXTS)] = holder.pop(key)
        elif what == 2 and isinstance(holder, list):
            holder.insert(key, holder[key])
        else:
            holder[key] = deepcopy(r.choice(VALUES))
    text = json.dumps(value, ensure_ascii=r.random() < 0.8)
    return text.encode("utf-8", "surrogatepass")


def _number(data: bytes, r: Random) -> bytes:
    """Another number in place of one."""
    places = [i for i, c in enumerate(data) if chr(c).isdigit() and (i == 0 or data[i - 1] in b",;\t =[:\n(")]
    if not places:
        return data
    i = end = r.choice(places)
    while end < len(data) and data[end] in b"0123456789.eE+-":
        end += 1
    return data[:i] + r.choice(NUMBERS).encode() + data[end:]


def _text(data: bytes, r: Random) -> bytes:
    """Text put in, or in place of a little."""
    i = r.randrange(len(data) + 1)
    return data[:i] + r.choice(TEXTS).encode("utf-8", "surrogatepass") + data[i + r.choice((0, 0, 1, 5)) :]


def _byte(data: bytes, r: Random) -> bytes:
    i = r.randrange(len(data) + 1)
    return data[:i] + bytes([r.randrange(256)]) + data[i + 1 :]


def _cut(data: bytes, r: Random) -> bytes:
    i = r.randrange(len(data) + 1)
    return data[:i] + data[min(len(data), i + r.choice((1, 10, 100, 10**9))) :]


def _lines(data: bytes, r: Random) -> bytes:
    """A line gone, twice, elsewhere, or in place of another."""
    lines = data.split(b"\n")
    i, k = r.randrange(len(lines)), r.randrange(len(lines))
    what = r.randrange(4)
    if what == 0:
        del lines[i]
    elif what == 1:
        lines.insert(k, lines[i])
    elif what == 2:
        lines[i], lines[k] = lines[k], lines[i]
    else:
        lines[i] = lines[k]
    return b"\n".join(lines)


def _cells(data: bytes, r: Random) -> bytes:
    """Two cells of lines change places."""
    lines = data.split(b"\n")
    i, k = r.randrange(len(lines)), r.randrange(len(lines))
    a, b = lines[i].split(b","), lines[k].split(b",")
    m, n = r.randrange(len(a)), r.randrange(len(b))
    a[m], b[n] = b[n], a[m]
    lines[i] = b",".join(a)
    if i != k:
        lines[k] = b",".join(b)
    return b"\n".join(lines)


def _column(data: bytes, r: Random) -> bytes:
    """One number in every line of a column, or the column times a factor."""
    lines, place = data.split(b"\n"), r.randrange(8)
    number, factor = r.choice(NUMBERS).encode(), r.choice((None, -1, 1e-3, 1e3, 1e-300, 1e300, 0))
    for n, line in enumerate(lines):
        cells = line.split(b",")
        if line.startswith(b"#") or place >= len(cells):
            continue
        try:
            old = float(cells[place])
        except ValueError:
            continue
        cells[place] = number if factor is None else repr(old * factor).encode()
        lines[n] = b",".join(cells)
    return b"\n".join(lines)


def _separators(data: bytes, r: Random) -> bytes:
    return data.replace(
        *r.choice(((b",", b";"), (b",", b"\t"), (b".", b","), (b"\n", b"\r"), (b"\n", b"\r\n"), (b'"', b"'")))
    )


def _again(data: bytes, r: Random) -> bytes:
    return data + data[r.randrange(len(data) + 1) :] if data else b""


CHANGES = (
    _number,
    _number,
    _number,
    _text,
    _text,
    _byte,
    _cut,
    _lines,
    _lines,
    _cells,
    _column,
    _separators,
    _again,
)
