"""Bought shapes from STEP files."""

from __future__ import annotations

import hashlib
from pathlib import Path

from build123d import Solid, import_step

from tactcad.design.messages import InputError
from tactcad.parts.description import ModelFile


def read_step_solid(model: ModelFile) -> Solid:
    """The one solid of a STEP file. Raises InputError where file, hash or solid are not as described."""
    path = Path(model.path)
    if not path.is_file():
        raise InputError(model.path, "no such STEP file")
    if hashlib.sha256(path.read_bytes()).hexdigest() != model.sha256:
        raise InputError(model.path, "the STEP file has changed since it was described", legal=f"sha256 {model.sha256}")
    solids = list(import_step(model.path).solids())
    if len(solids) != 1:
        raise InputError(model.path, "not one solid", value=len(solids), legal="a STEP file with one solid")
    return solids[0]


def model_file(path: str | Path) -> ModelFile:
    """Describe a STEP file as a bought part's body: its hash, and its solid's volume (mm3)."""
    data = Path(path).read_bytes()
    probe = ModelFile(str(path), hashlib.sha256(data).hexdigest(), 0.0)
    return ModelFile(probe.path, probe.sha256, read_step_solid(probe).volume)
