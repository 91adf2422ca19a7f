"""FreeCAD as a peer: runs a script in FreeCAD's own Python, where it is installed."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from functools import lru_cache
from pathlib import Path

from tactcad.export.cache import LIBRARIES, default_root

COMMANDS = ("freecadcmd", "FreeCADCmd")
SCRIPT = Path(__file__).with_name("peers") / "freecad_element.py"
PATIENCE = 60  # s: a fresh user folder makes FreeCAD's first start slow


def executable() -> str | None:
    """Path of FreeCAD's command line, None where it is not installed."""
    return next(filter(None, map(shutil.which, COMMANDS)), None)


def command() -> list[str]:
    return [executable() or COMMANDS[0], str(SCRIPT)]


def environment(job: dict) -> dict[str, str]:
    """The environment that carries the job, since FreeCAD's command line takes every argument for a file to
    open; and FreeCAD's home, which is not the user's.
    """
    home = default_root() / LIBRARIES
    home.mkdir(parents=True, exist_ok=True)
    return {
        "HOME": str(home),
        "TACTCAD_PEER": json.dumps(job),
        "QT_QPA_PLATFORM": os.environ.get("QT_QPA_PLATFORM", "offscreen"),
    }


def answer(output: str) -> dict:
    """The line that the script prints after its mark, found among FreeCAD's own output."""
    lines = [line for line in output.splitlines() if line.startswith("PEER ")]
    return json.loads(lines[-1].removeprefix("PEER ")) if lines else {}


@lru_cache(maxsize=1)
def version() -> str:
    """Its version, "" where it is not installed or does not answer."""
    try:
        run = subprocess.run(
            command(),
            env={**os.environ, **environment({"repeats": 0})},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
            timeout=PATIENCE,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return answer(run.stdout).get("version", "")
