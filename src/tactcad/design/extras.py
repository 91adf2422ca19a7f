"""The extras of pyproject.toml, which the base install leaves out, and the refusal if one is needed."""

from __future__ import annotations

from importlib.util import find_spec

from .messages import InputError

EXTRAS = {  # and the packages of each that are imported
    "cad": ("OCP", "build123d", "manifold3d", "trimesh"),
    "logs": ("nptdms",),
    "review": ("ocp_viewer",),
    "robot": ("mujoco", "yourdfpy"),
    "sweep": ("dask", "distributed", "pyarrow"),
}


def missing(*extras: str) -> list[str]:
    """The packages of these extras that are not installed."""
    return [package for extra in extras for package in EXTRAS[extra] if find_spec(package) is None]


def refuse_missing(what: str, *extras: str) -> None:
    """Raise InputError if a package of these extras, which `what` needs, is not installed."""
    if packages := missing(*extras):
        lacking = [extra for extra in extras if missing(extra)]
        raise InputError(what, f"needs {', '.join(packages)}, not installed here", legal=install(*lacking))


def install(*extras: str) -> str:
    """How to get these extras: tactcad is on no package index."""
    return f"pip install '.[{','.join(extras)}]' in a checkout of tactcad"


def refusal(error: ImportError) -> InputError | None:
    """The message for a package of an extra that cannot be imported; None if it belongs to none."""
    name = error.name or ""
    extra = next((extra for extra, packages in EXTRAS.items() if name.split(".")[0] in packages), None)
    if extra is None:
        return None
    if isinstance(error, ModuleNotFoundError):
        return InputError(name, "needed, but not installed here", legal=install(extra))
    system = "on Debian or Ubuntu: apt-get install libgl1 libx11-6"
    return InputError(name, f"cannot be loaded: {error}", legal=system)
