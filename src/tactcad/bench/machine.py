"""The machine that measured: processor, cores, versions, and which peers are installed."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

LIBRARIES = (
    "numpy",
    "scipy",
    "scikit-fem",
    "matplotlib",
    "build123d",
    "cadquery",
    "cadquery-ocp",
    "manifold3d",
    "trimesh",
    "ezdxf",
    "scikit-sparse",
)
MISSING = "not installed"


def machine() -> dict:
    """Processor model, cores, memory (GB), system, and how busy it was when the run began (load average)."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "processor": processor(),
        "cores": usable,
        "memory_GB": round(memory / 1e9, 1),
        "system": f"{platform.system()} {platform.machine()}",
        "load": round(os.getloadavg()[0], 2),
    }


def versions() -> dict[str, str]:
    """Python, tactcad, its libraries; "not installed" where one is missing."""
    from tactcad import __version__

    return {"python": platform.python_version(), "tactcad": __version__} | {n: _version(n) for n in LIBRARIES}


def peers() -> dict[str, str]:
    """Other programs to measure beside: their version, "not installed" where one is missing."""
    from tactcad.fem import calculix

    from .freecad import version as freecad

    version = _said([calculix.executable() or "ccx", "-v"], r"Version ([\d.]+)")
    return {"CalculiX": version or MISSING, "FreeCAD": freecad() or MISSING}


def processor() -> str:
    info = Path("/proc/cpuinfo")
    match = re.search(r"model name\s*:\s*(.+)", info.read_text()) if info.is_file() else None
    return match[1].strip() if match else platform.processor() or platform.machine()


def _version(library: str) -> str:
    try:
        return importlib.metadata.version(library)
    except importlib.metadata.PackageNotFoundError:
        return MISSING


def _said(command: Sequence[str], pattern: str) -> str:
    try:
        run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    except OSError:
        return ""
    match = re.search(pattern, run.stdout)
    return match[1] if match else ""
