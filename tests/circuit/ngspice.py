"""Runs a deck in ngspice; what it prints, by name."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

NGSPICE = shutil.which("ngspice")


def solved(deck: str, folder: Path) -> dict[str, float]:
    """Every `name = number` that the deck prints."""
    if NGSPICE is None:
        if os.environ.get("TACTCAD_NEEDS_NGSPICE"):
            pytest.fail("ngspice is missing: apt-get install ngspice")
        pytest.skip("ngspice is not there")
    file = folder / "deck.cir"
    file.write_text(deck, encoding="utf-8")
    done = subprocess.run(
        [NGSPICE, "-b", str(file)], capture_output=True, text=True, timeout=120, check=False
    )
    assert "rror" not in done.stderr + done.stdout, done.stderr + done.stdout
    assert done.returncode == 0 or "quit 0" not in deck
    return {name: float(value) for name, value in re.findall(r"^(\w+) = (\S+)$", done.stdout, re.MULTILINE)}
