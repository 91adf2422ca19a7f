"""Bad input through the command: exit status 2, one line, nothing written, an earlier export untouched."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest
from variants import DROP, HARDWARE, ORIGIN, table

from tactcad.cli.main import COMMANDS, main
from tactcad.export.manifest import SCHEMA
from tactcad.export.publication import replacing

GOOD = (HARDWARE / "macro-array.toml").read_text()


def as_toml(tree: dict) -> str:
    """A design's table as TOML text; tables in it come after its values."""
    lines = []

    def write(prefix: str, node: dict) -> None:
        if prefix:
            lines.append(f"[{prefix}]")
        for name, value in node.items():
            if not isinstance(value, dict):
                shown = {"nan": "nan", "inf": "inf", "-inf": "-inf"}.get(str(value))
                lines.append(f"{json.dumps(name)} = {shown or json.dumps(value)}")
        for name, value in node.items():
            if isinstance(value, dict):
                write(f"{prefix}.{json.dumps(name)}" if prefix else name, value)

    write("", tree)
    return "\n".join(lines) + "\n"


def bad(**changes) -> bytes:
    tree = table({path.replace("__", "."): value for path, value in changes.items()})
    tree["origin"] = ORIGIN
    return as_toml(tree).encode()


# the issue's own list, and what else a file can be
BAD_FILES = {
    "unknown field": bad(element__hinge_thicknes=0.25),
    "missing field": bad(element__hinge_thickness=DROP),
    "wrong type": bad(element__hinge_thickness="0.25"),
    "truth value": bad(element__hinge_thickness=True),
    "NaN": bad(element__hinge_thickness=float("nan")),
    "infinity": bad(array__pitch=float("inf")),
    "zero": bad(sheet__thickness=0),
    "negative": bad(sheet__thickness=-3),
    "1e300": bad(element__arm_height=1e300),
    "hinge thicker than the arm": bad(element__hinge_thickness=3.0),
    "fillets that do not fit the slot": bad(element__fillet_radius=0.45),
    "arms that reach the opposite row": bad(array__row_pitch=2.0),
    "holes outside the body": bad(holes__screw_offsets=[4.1, 30.0]),
    "third row": bad(array__row_arms=[[4], [4], [4]]),
    "name with a path in it": bad(design__name="../../evil"),
    "name with a line end": bad(design__name="macro\nall is well"),
    "not TOML": b"solid cube {",
    "a picture": b"\x89PNG\r\n\x1a\n" + bytes(range(256)),
    "latin-1": GOOD.replace('title = "', 'title = "J\xf6rg ').encode("latin-1"),
    "utf-16": GOOD.encode("utf-16"),
    "empty": b"",
    "10 MB": b"#" * 10_000_000,
    "deep nesting": b"a = " + b"[" * 50_000,
    "duplicate key": GOOD.replace("thickness = 3.0", "thickness = 3.0\nthickness = 4.0", 1).encode(),
}


def state(folder: Path) -> dict[str, tuple]:
    """Every path below the folder with what it is and when it changed last."""
    found = {}
    for path in sorted(folder.rglob("*")):
        stat = path.lstat()
        kind = os.readlink(path) if path.is_symlink() else path.read_bytes() if path.is_file() else "folder"
        found[str(path.relative_to(folder))] = (kind, stat.st_mtime_ns)
    return found


@pytest.fixture
def workplace(tmp_path, monkeypatch) -> Path:
    """A folder with an earlier export in it."""
    monkeypatch.chdir(tmp_path)
    with replacing("exports/macro-array", SCHEMA) as work:
        work.write({"bom.csv": b"the earlier export"})
    return tmp_path


@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_file_exits_2_with_one_line_and_touches_nothing(workplace, capsys, name, snapshot):
    (workplace / "bad.toml").write_bytes(BAD_FILES[name])
    before = state(workplace)
    for command in (["check"], ["export", "--out", "exports/macro-array"]):
        assert main([*command, "bad.toml"]) == 2
        assert state(workplace) == before
        assert capsys.readouterr() == ("", snapshot(name="of either command"))


@pytest.mark.parametrize(
    "arguments",
    [
        ["export", "nowhere.toml"],
        ["export", "no-such-design"],
        ["export", "."],
        ["export", "/dev/null"],
        ["export", ""],
        ["export", "two\nlines.toml"],
        ["export", "macro-array", "--scene", "nothing"],
        ["export", "macro-array", "--scene", "two\nlines"],
        ["check", "nowhere.toml"],
        ["check", "macro-array", "--scene", "nothing"],
        ["check", "macro-array", "--shop", "nowhere.toml"],
    ],
    ids=lambda a: " ".join(a).replace("\n", "-"),
)
def test_what_is_not_there_exits_2(workplace, capsys, arguments, snapshot):
    before = state(workplace)
    try:
        status = main(arguments)
    except SystemExit as stopped:  # the parser's own refusals
        status = stopped.code
    assert status == 2
    assert state(workplace) == before
    assert capsys.readouterr() == ("", snapshot)


def test_a_folder_that_is_not_ours_is_not_replaced(workplace, capsys):
    (workplace / "mine").mkdir()
    (workplace / "mine" / "thesis.txt").write_text("three years")
    before = state(workplace / "mine")
    assert main(["export", "macro-array", "--out", "mine"]) == 2
    assert state(workplace / "mine") == before
    assert re.fullmatch(r"tactcad: [^\n]+\n", capsys.readouterr().err)


def test_a_process_ends_without_traceback(tmp_path, snapshot):
    """The same from outside, where nothing of pytest's can hide a traceback or a second line."""
    (tmp_path / "bad.toml").write_bytes(BAD_FILES["hinge thicker than the arm"])
    run = subprocess.run(
        [sys.executable, "-m", "tactcad", "export", "bad.toml"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 2
    assert (run.stdout, run.stderr) == ("", snapshot(name="hinge thicker than the arm"))
    assert [p.name for p in tmp_path.rglob("*")] == ["bad.toml"]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_examples(command, capsys):
    with pytest.raises(SystemExit) as ended:
        main([command, "--help"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert "examples:" in said and f"  tactcad {command}" in said


def test_unknown_commands_and_options_exit_2(capsys, snapshot):
    for arguments in (["explode"], ["help", "exprot"], ["export", "--no-such-option"], ["schema", "a", "b"]):
        with pytest.raises(SystemExit) as ended:
            main(arguments)
        assert ended.value.code == 2
        assert capsys.readouterr() == ("", snapshot)


def test_version():
    run = subprocess.run(
        [sys.executable, "-m", "tactcad", "--version"], capture_output=True, text=True, check=True
    )
    assert re.fullmatch(r"tactcad \d+\.\d+\.\d+\n", run.stdout)


def test_a_closed_pipe_is_no_error():
    """`tactcad schema | head -1` ends quietly."""
    run = subprocess.run(
        f"{sys.executable} -m tactcad schema | head -1; exit ${{PIPESTATUS[0]}}",
        shell=True,
        executable="/bin/bash",
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize(
    "error, said",
    [
        (ModuleNotFoundError("No module named 'manifold3d'", name="manifold3d"), "pip install '.[cad]' in"),
        (ImportError("libGL.so.1: cannot open", name="OCP"), "libGL.so.1: cannot open; legal: on Debian or"),
    ],
)
def test_a_kernel_that_cannot_be_loaded_is_one_line(error, said, monkeypatch, capsys):
    monkeypatch.setattr("tactcad.cli.schema.run", Mock(side_effect=error))
    assert main(["schema"]) == 2
    told = capsys.readouterr().err
    assert said in told and told.count("\n") == 1


def test_another_missing_module_is_our_own_mistake(monkeypatch):
    monkeypatch.setattr(
        "tactcad.cli.schema.run", Mock(side_effect=ModuleNotFoundError(name="tactcad.nothing"))
    )
    with pytest.raises(ModuleNotFoundError):
        main(["schema"])
