"""Bought shapes from STEP files."""

from __future__ import annotations

import hashlib
from pathlib import Path

from build123d import Solid, import_step

from tactcad.design.messages import InputError
from tactcad.parts.description import ModelFile

from .measure import measure


def read_step_solid(model: ModelFile) -> Solid:
    """The one solid of a STEP file. Raises InputError where file, hash or solid are not as described."""
    if _sha256(model.path) != model.sha256:
        raise InputError(
            model.path, "the STEP file has changed since it was described", legal=f"sha256 {model.sha256}"
        )
    return _only_solid(model.path)


def model_file(path: str | Path) -> ModelFile:
    """Describe a STEP file as a bought part's body: its hash, and its solid's volume (mm3) and box (mm).

    Raises InputError where there is no such file, or not one solid in it.
    """
    sha256 = _sha256(str(path))
    facts = measure(_only_solid(str(path)).wrapped)
    low, high = facts["box"]
    return ModelFile(str(path), sha256, facts["volume"], (tuple(low), tuple(high)))


def _sha256(path: str) -> str:
    if not Path(path).is_file():
        raise InputError(path, "no such STEP file")
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def _only_solid(path: str) -> Solid:
    try:
        solids = list(import_step(path).solids())
    except Exception as error:  # the importer raises many kinds of exceptions
        raise InputError(path, f"cannot be read as STEP: {error}") from None
    if len(solids) != 1:
        raise InputError(path, "not one solid", value=len(solids), legal="a STEP file with one solid")
    return solids[0]
