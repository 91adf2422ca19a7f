"""Nothing that is tracked names a machine's folder or a package registry."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# Written so that this file does not match itself.
FORBIDDEN = {
    "a machine's folder": re.compile(r"(?<![\w.~$})-])/(wor[k]|roo[t]|hom[e]|tm[p]|op[t]|User[s])/"),
    "a file address": re.compile(r"file:[/]{2}"),
    "a registry": re.compile(
        r"pypi[.]org|pythonhosted[.]org|--(extra-)?index[-]url|--find[-]links", re.IGNORECASE
    ),
    "a folder outside the repository": re.compile(r"[.][.]/share[d]\b"),
}


def tracked() -> list[Path]:
    run = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], capture_output=True, check=False)
    if run.returncode:
        pytest.skip("not a git checkout: what is tracked cannot be told")
    return [ROOT / name for name in run.stdout.decode().split("\0") if name]


def violations(text: str) -> list[str]:
    return [f"{kind}: {hit.group()}" for kind, rule in FORBIDDEN.items() for hit in rule.finditer(text)]


def test_no_machine_paths_or_registries():
    found = {}
    for path in tracked():
        if path.is_file() and (hits := violations(path.read_bytes().decode("utf-8", "replace"))):
            found[path.relative_to(ROOT).as_posix()] = hits
    assert not found


@pytest.mark.parametrize(
    "text",
    [
        "cd /wor" + "k/main",
        'open("/tm' + 'p/x")',
        "/hom" + "e/ann/x",
        "file:/" + "/x",
        "pip --index" + "-url x",
    ],
)
def test_the_rules_catch_what_they_are_for(text):
    assert violations(text)


def test_what_is_generated_is_not_tracked():
    names = [path.relative_to(ROOT).as_posix() for path in tracked()]
    kept = ("exports/golden/", "exports/README.md")
    assert not [n for n in names if n.startswith((".venv", ".cache", "build/"))]
    assert not [n for n in names if n.startswith("exports/") and not n.startswith(kept)]
