"""The declaration of a format of parts' files, one module each.

Every module in export/part_formats declares one or more, each a `PartFormat`; nothing lists them. A module
without, a declaration that lacks something, or two of one kind are refused when they are imported. Manifest,
bill, cache and release follow.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from tactcad.parts.language.description import NOT_MADE, Part
from tactcad.solids import Meshing

if TYPE_CHECKING:
    from tactcad.scenes.scene import Pose

    from .shapes import Shapes
    from .step_text import Header


@dataclass(frozen=True)
class ExportOptions:
    """The options of an export. With the design, they are its only inputs.

    `pose`: a rig's configuration, None for its rest pose. `guides`: with assembly guides. `detail`: `full` or
    `envelope`. `drawings`: with sheets, marked PRELIMINARY if a `draft`, not for order if a `sample`.
    `meshing`: with an STL mesh of every part made, of that fineness. `robot`: with the files for robots and
    their simulators.
    """

    scenes: tuple[str, ...]
    pose: Pose | None = None
    guides: bool = False
    detail: str = "full"
    drawings: bool = False
    draft: bool = False
    sample: bool = False
    meshing: Meshing | None = None
    robot: bool = False


@dataclass(frozen=True)
class PartFormat:
    """One kind of file that a part has.

    kind      in the manifest
    path      below the export's folder, with {part_no} and {revision}
    place     among the formats: what every export holds first, by number
    has       which parts have such a file
    asked     the options it depends on, part of its key in the cache; None: not asked for
    make      the part, the shapes, the file's header, and what was asked, to bytes that were read back and
              compared with the part; raises CheckFailure if they differ. It imports what it needs when it
              runs: formats are known without kernel
    released  the release README's text on the path's folder; "": shops do not get such a file
    ordered   its rank among the files for making the part: the bill names the highest; 0: none
    """

    kind: str
    path: str
    place: int
    has: Callable[[Part], bool]
    asked: Callable[[ExportOptions], object]
    make: Callable[[Part, Shapes, Header, object], bytes]
    released: str
    ordered: int

    def __post_init__(self) -> None:
        if "{part_no}" not in self.path or "/" not in self.path:
            raise TypeError(f"format {self.kind}: {self.path!r} has no folder, or no {{part_no}}")
        if wrong := [name for name in ("has", "asked", "make") if not callable(getattr(self, name))]:
            raise TypeError(f"format {self.kind}: {', '.join(wrong)} must be callable")
        if self.released and "_{revision}" not in self.path:
            raise TypeError(f"format {self.kind}: a released file's name ends in _{{revision}}")

    @property
    def folder(self) -> str:
        """The path's folder, with its "/"."""
        return self.path.partition("/")[0] + "/"


def always(options: ExportOptions) -> object:
    """For a format that every export has."""
    return ()


def has_limits(part: Part) -> bool:
    """Whether it is made here and states any limit."""
    made = part.process not in NOT_MADE
    return made and any((part.characteristics, part.geometric, part.datums))


@cache
def part_formats() -> tuple[PartFormat, ...]:
    """Every format by its place."""
    from . import part_formats as folder

    found = []
    for _, name, _ in pkgutil.iter_modules(folder.__path__):
        module = import_module(f"{folder.__name__}.{name}")
        if not (own := [f for f in vars(module).values() if isinstance(f, PartFormat)]):
            raise TypeError(f"no PartFormat is declared in {module.__name__}")
        found += own
    if len({form.kind for form in found}) < len(found):
        raise TypeError(f"two formats are of one kind, of {', '.join(form.kind for form in found)}")
    return tuple(sorted(found, key=lambda form: (form.place, form.kind)))
