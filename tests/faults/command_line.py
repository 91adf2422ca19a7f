"""The real command in a process of its own, two small designs, and what an undisturbed export of each holds.

Shared by the tests of this folder. Nothing here knows how an export is made: a folder is sound where its
manifest, read with nothing but json and hashlib, agrees with every file below it.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import tactcad

ROOT = Path(__file__).parents[2]
MODULE = [sys.executable, "-m", "tactcad"]
RIGS = ("cart", "holder", "sample", "calibration", "grasping")


def one_by_one(arm: float, revision: str) -> str:
    """The shipped array's file with one element and no rig."""
    text = (ROOT / "hardware" / "macro-array.toml").read_text(encoding="utf-8")
    table = re.compile(rf"^\[(?:{'|'.join((*RIGS, 'origin'))})\]\n(?:(?!\[).*\n)*", re.MULTILINE)
    text = table.sub("", text + "\n").replace(
        "youngs_modulus = 69000\n", ""
    )  # the paper's, which wants an origin
    text = re.sub(r"^row_arms = .*$", f"row_arms = [[{arm}]]", text, count=1, flags=re.MULTILINE)
    text = re.sub(r'^revision = ".*"$', f'revision = "{revision}"', text, count=1, flags=re.MULTILINE)
    found = tomllib.loads(text)
    assert (
        found["array"]["row_arms"] == [[arm]]
        and found["design"]["revision"] == revision
        and not set(found) & set(RIGS)
    )
    return text


def environment(folder: Path, **changes: str) -> dict[str, str]:
    """Nothing of this machine's but the way to programs and libraries; home, temporary files and cache of its
    own."""
    for name in ("home", "tmp"):
        (folder / name).mkdir(exist_ok=True)
    kept = {k: v for k, v in os.environ.items() if k in ("PATH", "LD_LIBRARY_PATH")}
    own = {
        "HOME": str(folder / "home"),
        "TMPDIR": str(folder / "tmp"),
        "TACTCAD_CACHE": str(folder / "cache"),
    }
    return (
        kept
        | own
        | {"PYTHONPATH": str(Path(tactcad.__file__).parents[1]), "PYTHONDONTWRITEBYTECODE": "1"}
        | changes
    )


def tactcad_run(
    *arguments: str | bytes | Path, cwd: Path, env: dict[str, str], command: Sequence[str] = MODULE, **more
) -> subprocess.CompletedProcess[bytes]:
    """`tactcad ARGUMENTS` to its end, at most two minutes: what hangs fails."""
    return subprocess.run(
        [*command, *arguments],
        cwd=cwd,
        env=env,
        capture_output=True,
        check=False,
        timeout=600,
        stdin=subprocess.DEVNULL,
        **more,
    )


def running(process: int) -> bool:
    """Whether it lives: an ended one may wait for whoever inherits it."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def refused(done: subprocess.CompletedProcess[bytes], status: int = 2) -> str:
    """The one line that a refusal says. No traceback, nothing on standard output."""
    said = done.stderr.decode("utf-8", "backslashreplace")
    assert done.returncode == status, said[-2000:]
    assert b"Traceback" not in done.stderr and done.stdout == b"", said[-2000:]
    lines = said.splitlines()
    assert re.fullmatch(r"tactcad: .{1,1500}", lines[-1]), said[-2000:]
    if status == 2:
        assert len(lines) == 1, said[-2000:]
    return lines[-1]


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below the folder by its path."""
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if not p.is_dir()}


def assert_sound(folder: Path) -> None:
    """Every file's SHA-256 is the manifest's, and there are no others."""
    files = contents(folder)
    listed = {f["path"]: f["sha256"] for f in json.loads(files.pop("manifest.json"))["files"]}
    assert {path: hashlib.sha256(data).hexdigest() for path, data in files.items()} == listed


def assert_tidy(out: Path, work: Path) -> None:
    """Beside the export lies nothing, nor in other places."""
    assert [p.name for p in out.parent.iterdir()] == [out.name]
    assert out.is_dir() and not out.is_symlink()
    assert not list((work / "tmp").iterdir())
    assert not list((work / "cache").rglob(".new-*"))


@dataclass(frozen=True)
class Bench:
    """Two designs by name, what each exports to, and a cache that holds all of it. `seconds`: a cold
    export."""

    folder: Path
    texts: dict[str, str]
    files: dict[str, dict[str, bytes]]
    cache: Path
    seconds: float

    def write_designs(self, folder: Path) -> None:
        for name, text in self.texts.items():
            (folder / f"{name}.toml").write_text(text, encoding="utf-8")


# Runs many commands, each in a process of its own that is forked with the program loaded: what a shell would
# do, without waiting for Python to start every time. Takes and gives JSON: argument lists; then status,
# output, messages of each.
FORKS = """
import importlib, json, os, signal, sys, tempfile
from tactcad.cli.main import COMMANDS, main
import tactcad.export.pipeline, tactcad.export.sides
import tactcad.lab.batch, tactcad.lab.grasp, tactcad.paper.validation
for name in COMMANDS:
    importlib.import_module("tactcad.cli." + name)
found = []
for arguments in json.load(sys.stdin):
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        process = os.fork()
        if not process:
            signal.alarm(60)  # what hangs is ended
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            os.dup2(out.fileno(), 1)
            os.dup2(err.fileno(), 2)
            sys.stdin = None
            sys.exit(main(arguments))
        status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
        said = []
        for stream in (out, err):
            stream.seek(0)
            said.append(stream.read().decode("latin-1"))
        found.append([status, *said])
json.dump(found, sys.stdout)
"""


def tactcad_runs(
    commands: Sequence[Sequence[str]], cwd: Path, env: dict[str, str]
) -> list[subprocess.CompletedProcess[bytes]]:
    """`tactcad ARGUMENTS` for many argument lists, one after the other, each in its own process."""
    done = subprocess.run(
        [sys.executable, "-c", FORKS],
        input=json.dumps(commands),
        cwd=cwd,
        env=env,
        capture_output=True,
        text=True,
        check=True,
    )
    return [
        subprocess.CompletedProcess(arguments, status, out.encode("latin-1"), err.encode("latin-1"))
        for arguments, (status, out, err) in zip(commands, json.loads(done.stdout), strict=True)
    ]
