"""From one text file to a tactile array that a shop can cut and numbers that say how stiff it is.

    import tactcad as tc

    d = tc.load("macro-array").with_(hinge_thickness=0.3)
    d.estimate()

The names below are loaded when they are used; docs/python.md has an example of each. Units throughout: mm,
N, MPa; stiffness in N/mm, strain as a plain ratio, angles in radians.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .design.messages import CheckFailure as CheckFailure
    from .design.messages import InputError as InputError
    from .face import LoadedDesign as LoadedDesign
    from .face import OpenScene as OpenScene
    from .face import Reply as Reply
    from .face import calibrate as calibrate
    from .face import circle as circle
    from .face import design as design
    from .face import designs as designs
    from .face import load as load
    from .face import new as new
    from .face import rectangle as rectangle
    from .face import stiffness as stiffness
    from .parts.language.description import Extrusion as Extrusion
    from .parts.language.description import Hole as Hole
    from .parts.language.description import Material as Material
    from .parts.language.description import Part as Part

__version__ = "0.1.0"

# By name the module that has it. `design` is the room of that name, which is called like a function.
_PLACES = {
    **dict.fromkeys(
        ("load", "designs", "new", "calibrate", "stiffness", "rectangle", "circle"), "tactcad.face"
    ),
    **dict.fromkeys(("Reply", "LoadedDesign", "OpenScene"), "tactcad.face"),
    **dict.fromkeys(("Part", "Extrusion", "Hole", "Material"), "tactcad.parts.language.description"),
    **dict.fromkeys(("InputError", "CheckFailure"), "tactcad.design.messages"),
}
__all__ = sorted((*_PLACES, "design"))


def __getattr__(name: str) -> Any:
    if name == "design":
        return import_module("tactcad.design")
    if name not in _PLACES:
        raise AttributeError(f"module 'tactcad' has no {name!r}; it has {', '.join(__all__)}")
    found = getattr(import_module(_PLACES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
