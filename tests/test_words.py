"""Words in documents beside the code: every text that is asked for is there, with just the blanks that are
filled in, also where no design of ours comes along; and none stands there for nothing."""

from __future__ import annotations

import ast
import tomllib
from pathlib import Path
from string import Formatter

import pytest

import tactcad

SOURCE = Path(tactcad.__file__).parent
PAGES = tomllib.loads((SOURCE / "paper/data/pages.toml").read_text("utf-8"))["finding"]
README = SOURCE / "release/readme.py"
RIGS = [p for p in SOURCE.rglob("*.py") if "telling(__file__)" in p.read_text("utf-8")]


def blanks(text: str) -> set[str]:
    return {name.split(".")[0].split("[")[0] for _, name, _, _ in Formatter().parse(text) if name}


def names(of: ast.expr) -> list[str]:
    """The texts that an expression may name; none if it is computed."""
    if isinstance(of, ast.IfExp):
        return [*names(of.body), *names(of.orelse)]
    return [of.value] if isinstance(of, ast.Constant) else []


def asked(path: Path, function: str) -> list[tuple[str, set[str | None]]]:
    calls = [n for n in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(n, ast.Call)]
    calls = [c for c in calls if isinstance(c.func, ast.Name) and c.func.id == function]
    return [(name, {k.arg for k in c.keywords}) for c in calls for name in names(c.args[0])]


@pytest.mark.parametrize("path", [*RIGS, README], ids=lambda p: p.stem)
def test_texts_have_the_blanks_that_are_filled(path):
    document = tomllib.loads(path.with_suffix(".toml").read_text("utf-8"))
    texts, function = (document["say"], "say") if path == README else (document, "said")
    calls = asked(path, function)
    assert {name for name, _ in calls} == set(texts)
    assert [(name, given) for name, given in calls if blanks(texts[name]) != given] == []


@pytest.mark.parametrize("section", PAGES)
def test_findings_have_what_they_say(section):
    path = next(p for p in (SOURCE / "paper").glob("*.py") if f'saying("{section}"' in p.read_text("utf-8"))
    known = {k for _, given in asked(path, "saying") for k in given}
    for name, given in asked(path, "say"):
        if None not in given:
            assert blanks(PAGES[section][name]) <= known | given, name
