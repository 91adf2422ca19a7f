"""The real command in a process of its own, two small designs, and what an undisturbed export of each holds.

Shared by the tests of this folder. Nothing here knows how an export is made: a folder is sound where its
manifest, read with nothing but json and hashlib, agrees with every file below it.
"""

from __future__ import annotations

import atexit
import hashlib
import json
import os
import re
import select
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import tactcad

ROOT = Path(__file__).parents[2]
MODULE = [sys.executable, "-m", "tactcad"]
HANGS = 600  # s; what takes longer is ended, and fails: busy machines take five times as long as quiet ones
RIGS = ("cart", "holder", "sample", "calibration", "grasping", "bonding")


def one_by_one(arm: float, revision: str) -> str:
    """The shipped array's file with one element and no rig."""
    text = (ROOT / "hardware" / "macro-array.toml").read_text(encoding="utf-8")
    table = re.compile(
        rf"^\[(?:{'|'.join((*RIGS, 'origin', 'design[.]unchanged[.].*'))})\]\n(?:(?!\[).*\n)*", re.MULTILINE
    )
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
    """`tactcad ARGUMENTS` to its end; what hangs fails."""
    return subprocess.run(
        [*command, *arguments],
        cwd=cwd,
        env=env,
        capture_output=True,
        check=False,
        timeout=HANGS,
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
    assert not list((work / "tmp").iterdir()) and not list((work / "home").iterdir())
    assert not list((work / "cache").rglob("*.part"))


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


# Forks for each command with the program loaded: what a shell would do, without Python's start and the
# libraries' loading. Reads JSON lines; writes two lines for each, the process's number and its status.
LOADED = f"""
import contextlib, gc, importlib, json, os, signal, sys, traceback
from tactcad.cli.main import COMMANDS, main
modules = "drawing.assemblies.assembly_sheets export.pipeline export.sides release.make"
modules += " checks.run solids.build"
modules += " lab.batch lab.grasp paper.validation"
names = ["tactcad." + name for name in (*modules.split(), *("cli." + name for name in COMMANDS))]
late = ["ezdxf", "matplotlib.ft2font", "pypdf", "reportlab.pdfgen.canvas", "scipy.ndimage", "trimesh"]
for name in (*late, *names):
    with contextlib.suppress(ModuleNotFoundError):  # where extras are hidden
        importlib.import_module(name)
gc.freeze()  # or a child would copy all of it when it looks for what is no longer used
while line := sys.stdin.buffer.readline():
    asked = json.loads(line)
    process = os.fork()
    if not process:
        signal.alarm({HANGS})  # what hangs is ended
        os.chdir(asked["cwd"])
        os.environ.clear()
        os.environ.update(asked["env"])
        for number, path in enumerate((os.devnull, asked["out"], asked["err"])):
            os.dup2(os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC), number)
        sys.argv = ["tactcad", *asked["arguments"]]
        status = 70  # of a traceback
        try:
            status = main()
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)  # what is loaded here takes a second to be put away
    os.write(1, b"%d\\n" % process)
    os.write(1, b"%d\\n" % os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]))
"""


@cache
def loaded(path: str) -> tuple[subprocess.Popen[bytes], Path]:
    """The process that forks, with this PYTHONPATH, and its folder; it ends with this one, which holds its
    input."""
    folder = Path(tempfile.mkdtemp())
    command = [sys.executable, "-c", LOADED]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "bufsize": 0}
    process = subprocess.Popen(command, cwd=folder, env=environment(folder, PYTHONPATH=path), **pipes)

    def end() -> None:
        process.communicate()
        shutil.rmtree(folder)

    atexit.register(end)
    return process, folder


class Started:
    """`tactcad ARGUMENTS` in a process of its own, forked with the program loaded; one at a time."""

    def __init__(self, arguments: Sequence[str], cwd: Path, env: dict[str, str]) -> None:
        process, folder = loaded(env["PYTHONPATH"])
        self.said, self.out, self.err = process.stdout, folder / "out", folder / "err"
        asked = {"arguments": list(arguments), "cwd": str(cwd), "env": env}
        asked |= {"out": str(self.out), "err": str(self.err)}
        process.stdin.write(json.dumps(asked).encode() + b"\n")
        self.pid = int(self.said.readline())

    def ended(self, seconds: float) -> bool:
        """Whether it ends within that time."""
        return bool(select.select([self.said], [], [], max(seconds, 0.0))[0])

    def result(self) -> subprocess.CompletedProcess[bytes]:
        """Waits for its end."""
        status = int(self.said.readline())
        return subprocess.CompletedProcess([], status, self.out.read_bytes(), self.err.read_bytes())


def tactcad_forked(
    *arguments: str | Path, cwd: Path, env: dict[str, str]
) -> subprocess.CompletedProcess[bytes]:
    """As `tactcad_run` with its plain command, but Python and libraries are loaded already: the variables
    that Python reads as it starts do nothing."""
    return Started([str(a) for a in arguments], cwd, env).result()


def tactcad_runs(
    commands: Sequence[Sequence[str]], cwd: Path, env: dict[str, str]
) -> list[subprocess.CompletedProcess[bytes]]:
    """`tactcad ARGUMENTS` for many argument lists, one after the other, each in its own process."""
    return [tactcad_forked(*arguments, cwd=cwd, env=env) for arguments in commands]
