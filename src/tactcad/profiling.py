"""A run's products, their times and the modules loaded, for TACTCAD_PROFILE; and the progress of its work.

Code that makes something expensive (solids, meshes, finite-element solutions, scenes) reports it through
`making`; without a profile that costs one comparison.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

# Packages that are slow to import or large, and what for.
HEAVY = {
    "numpy": "arrays",
    "scipy": "sparse solver, statistics",
    "skfem": "finite elements",
    "matplotlib": "plots",
    "ezdxf": "DXF",
    "reportlab": "PDF",
    "pypdf": "PDF read back",
    "OCP": "CAD kernel",
    "build123d": "CAD kernel",
    "cadquery": "CAD kernel",
    "bd_warehouse": "CAD kernel",
    "vtkmodules": "CAD kernel",
    "trimesh": "meshes",
    "manifold3d": "meshes",
}


@dataclass
class Made:
    """One thing made: kind ("solid", "mesh", "elements", "scene"), name, and processor seconds it took."""

    kind: str
    name: str
    seconds: float


@dataclass
class Profile:
    """Products of one run; `made` in the order of finishing."""

    made: list[Made] = field(default_factory=list)
    started: float = field(default_factory=time.perf_counter)

    def record(self) -> dict:
        """The profile for JSON: loaded packages with their number of modules, products, time and memory."""
        by_kind: dict[str, dict[str, dict]] = {}
        for m in self.made:
            entry = by_kind.setdefault(m.kind, {}).setdefault(m.name, {"times": 0, "seconds": 0.0})
            entry["times"] += 1
            entry["seconds"] = round(entry["seconds"] + m.seconds, 6)
        return {
            "seconds": round(time.perf_counter() - self.started, 3),
            "peak_memory_mb": _peak_memory_mb(),
            "modules": len(sys.modules),
            "loaded": _loaded(),
            "made": by_kind,
        }


_open: Profile | None = None


@contextmanager
def profiled() -> Iterator[Profile]:
    """Everything made inside the block is entered in the profile that this yields."""
    global _open
    before, _open = _open, Profile()
    try:
        yield _open
    finally:
        _open = before


@contextmanager
def making(kind: str, name: str) -> Iterator[None]:
    """Record the making of one product in the open profile, if any, unless it fails.

    Parameters
    ----------
    kind
        "solid", "mesh", "elements" or "scene".
    name
        What was made; things of one name are counted together.
    """
    own = _open
    if own is None:
        yield
        return
    start = time.process_time()
    yield
    own.made.append(Made(kind, name, time.process_time() - start))


def is_counted() -> bool:
    """Whether a profile is open."""
    return _open is not None


def add(made: Iterable[Made]) -> None:
    """Enter what another process made in the open profile, if any."""
    if _open:
        _open.made += made


_listener: Callable[[str], None] | None = None


@contextmanager
def listening(hear: Callable[[str], None]) -> Iterator[None]:
    """Inside the block `hear` is called with every message of `under_way`."""
    global _listener
    before, _listener = _listener, hear
    try:
        yield
    finally:
        _listener = before


def under_way(how_far: str) -> None:
    """Report how far a long piece of work has come ("strip 3 of 7"); does nothing where nobody listens."""
    if _listener:
        _listener(how_far)


def text(record: dict) -> str:
    """The record for a terminal."""
    loaded = (
        ", ".join(f"{name} ({count})" for name, count in record["loaded"].items()) or "none of the heavy ones"
    )
    lines = [
        f"profile: {record['seconds']:.2f} s, {record['peak_memory_mb']:.0f} MB at most, "
        f"{record['modules']} modules",
        f"  loaded (modules): {loaded}",
    ]
    for kind, things in record["made"].items():
        times, seconds = (sum(t[key] for t in things.values()) for key in ("times", "seconds"))
        lines.append(f"  {kind}: {len(things)} made, {times} times, {seconds:.2f} s")
        lines += [f"    {name:50} {t['times']:4} x {t['seconds']:8.3f} s" for name, t in things.items()]
    return "\n".join(lines)


def _loaded() -> dict[str, int]:
    counts = dict.fromkeys(HEAVY, 0)
    for module in sys.modules:
        top = module.split(".", 1)[0]
        if top in counts:
            counts[top] += 1
    return {name: count for name, count in counts.items() if count}


def _peak_memory_mb() -> float:
    """Largest memory that this process has used."""
    kibibytes = _high_water()
    if kibibytes is None:
        import resource  # not on every system, and only a profile needs it

        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        # bytes there, kibibytes elsewhere
        return round(most * (1e-6 if sys.platform == "darwin" else 1.024e-3), 1)
    return round(kibibytes * 1.024e-3, 1)


def _high_water() -> int | None:
    """Linux's VmHWM in kibibytes. getrusage's figure there begins with that of the process that started this
    one."""
    try:
        lines = Path("/proc/self/status").read_text("ascii").splitlines()
    except OSError:
        return None
    return next((int(line.split()[1]) for line in lines if line.startswith("VmHWM:")), None)
