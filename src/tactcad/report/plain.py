"""Records as values that JSON can hold."""

from __future__ import annotations

import dataclasses
from math import isfinite

import numpy as np

# Metadata of a field that only pictures are drawn from: it is left out of the JSON.
UNREPORTED = {"unreported": True}


def plain(value: object) -> object:
    """Dataclasses, arrays and NumPy numbers as dicts, lists and numbers; 'nan', 'inf', '-inf' as text, which
    JSON has no numbers for."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {
            f.name: plain(getattr(value, f.name))
            for f in dataclasses.fields(value)
            if not f.metadata.get("unreported")
        }
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not isfinite(value):
        return str(value)
    return value
