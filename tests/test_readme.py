"""What README says is true: its commands exist, its outputs are the program's, its pictures are generated."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tactcad.cli.main import COMMANDS, main, parser_of

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


BLOCKS = re.findall(r"^```\w+\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)


def quoted(first: str) -> str:
    """The block that starts with `first`."""
    (found,) = (b for b in BLOCKS if b.startswith(first))
    return found.rstrip()


def in_order(shown: str, printed: str) -> bool:
    """Whether every line shown but "..." is printed, in that order."""
    lines = iter(line.rstrip() for line in printed.splitlines())
    return all(line.rstrip() in lines for line in shown.splitlines() if line != "...")


def test_it_is_short_and_says_that_no_licence_is_granted():
    assert len(README.split()) <= 900
    assert "The owner has not chosen a licence yet." in README


def test_first_screen_has_the_picture_and_the_two_commands():
    head = "\n".join(README.splitlines()[:12])
    assert "docs/images/" in head and "make export" in head and "make test" in head


def test_every_command_named_is_a_command_and_every_option_is_known(capsys):
    lines = [line for block in BLOCKS for line in block.splitlines()] + re.findall(r"`([^`\n]+)`", README)
    calls = [re.match(r"(?:\.venv/bin/)?tactcad ([a-z]+)([^#]*)", line) for line in lines]
    named = [call.groups() for call in calls if call]
    assert len(named) >= 8 and {name for name, _ in named} <= set(COMMANDS)
    for name, rest in named:
        with pytest.raises(SystemExit):
            main([name, "--help"])
        text = capsys.readouterr().out
        for option in re.findall(r"--[a-z]+", rest):
            assert option in text, f"tactcad {name} has no {option}"


def test_a_command_shown_with_arguments_lacks_none():
    shown = [line for block in BLOCKS for line in block.splitlines()] + re.findall(r"`([^`\n]+)`", README)
    for line in shown:
        words = shlex.split(line, comments=True)
        if "tactcad" in (Path(w).name for w in words[:1]) and words[2:] and words[1] in COMMANDS:
            parser_of(words[1], raises=True).parse(words[2:])


def test_make_targets_named_exist():
    makefile = (ROOT / "Makefile").read_text()
    named = set(re.findall(r"(?:`|^)make ([a-z]+)", README, flags=re.M))
    assert {"export", "test", "release", "docs"} <= named
    for target in named:
        assert re.search(rf"^{target}:", makefile, flags=re.M), target


def test_files_linked_exist():
    for path in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / path).is_file(), path


def test_estimate_shown_is_the_one_printed(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert main(["estimate"]) == 0
    printed = capsys.readouterr().out
    revision = re.search(r'(?m)^revision = "(\w+)"', (ROOT / "hardware" / "macro-array.toml").read_text())[1]
    assert in_order(quoted(f"macro-array {revision}, 7075-T6"), printed)


@pytest.mark.slow  # a fit over all layers in a process
def test_object_stiffness_shown_is_the_one_printed(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    calibrate, stiffness = (
        line.removeprefix(".venv/bin/tactcad ").replace(
            " calibration.csv", f" {tmp_path / 'calibration.csv'}"
        )
        for line in quoted(".venv/bin/tactcad calibrate").splitlines()
    )
    assert main(shlex.split(calibrate)) == 0 and main(shlex.split(stiffness)) == 0
    assert quoted("sample 1: K_obj") in capsys.readouterr().out


def test_refusal_shown_is_the_one_printed(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (
        (ROOT / "hardware" / "macro-array.toml")
        .read_text()
        .replace("fillet_radius = 0.30", "fillet_radius = 0.50")
    )
    (tmp_path / "wrong.toml").write_text(text)
    assert main(["export", "wrong.toml"]) == 2
    assert capsys.readouterr().err.strip() == quoted("tactcad: element.fillet_radius").strip()


@pytest.mark.cad
def test_python_shown_runs():
    script = quoted("import tactcad as tc")
    run = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
