"""FreeCAD's own document as a person sees it: its window program on an Xvfb screen in memory."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from tactcad.review.freecad import environment, profile

INSIDE = Path(__file__).with_name("in_freecad_screen.py")
SCREEN = "-screen 0 1400x900x24"
SECONDS = 300
LEAST = 0.03  # share of the screen that the parts cover; chosen: the array fitted to its view covers a tenth


def command() -> str | None:
    """The program that gives another one a screen, None if there is none."""
    return shutil.which("xvfb-run")


def screen_faults(program: str, document: Path, kept: Path) -> list[str]:
    """Whether the document's parts are seen; `kept` (PNG) is the picture to look at."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "user.cfg").write_text(profile())
        empty = folder / "empty.png"
        own = {"QT_QPA_PLATFORM": "xcb", "LIBGL_ALWAYS_SOFTWARE": "1"}
        files = {"REVIEW_FILE": str(document.resolve()), "REVIEW_FULL": str(kept.resolve())}
        try:
            subprocess.run(
                [str(command()), "-a", "-s", SCREEN, program, "-u", str(folder / "user.cfg"), str(INSIDE)],
                env=environment(folder) | own | files | {"REVIEW_EMPTY": str(empty)},
                capture_output=True,
                check=False,
                timeout=SECONDS,
            )
            covered = share_that_differs(empty, kept)
        except (OSError, subprocess.TimeoutExpired) as error:
            return [f"{document.name}: no picture of FreeCAD's window: {error}"]
    return [] if covered > LEAST else [f"{document.name}: FreeCAD's window shows nothing ({covered:.1%})"]


def share_that_differs(one: Path, other: Path) -> float:
    """Of two pictures of equal size."""
    a, b = (np.asarray(Image.open(path).convert("RGB")).astype(int) for path in (one, other))
    return float((np.abs(a - b).max(axis=2) > 30).mean())
