"""The design file: the parameter tree with unit, range and meaning of every field, alloys, messages of
refusal.

In: TOML text, CSV tables. Out: a frozen `Design`, or one line with the fault, its place, and the legal
values.

Called like a function, as `tactcad.design(target)`, it is `tactcad.face.design`: Python has one place for the
name of a room and of a function.
"""

import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any


class _Room(ModuleType):
    def __call__(self, target: str | Path, **options: Any) -> Any:
        return import_module("tactcad.face").design(target, **options)


sys.modules[__name__].__class__ = _Room
