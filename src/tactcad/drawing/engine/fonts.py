"""The font of all sheets, DejaVu Sans from the pinned matplotlib, and the widths of its letters.

Heights are those of ISO 3098-1: the height h of capital letters, in mm.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, lru_cache
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure, InputError

from .boxes import Box, bounds, scaled

if TYPE_CHECKING:
    from matplotlib.ft2font import FT2Font

FAMILY = "DejaVu Sans"
_FILE = Path("mpl-data", "fonts", "ttf", "DejaVuSans.ttf")


def font_file() -> Path:
    """The font's file in the matplotlib package. Raises CheckFailure where it is missing."""
    spec = find_spec("matplotlib")
    for folder in (spec.submodule_search_locations if spec else None) or ():
        if (Path(folder) / _FILE).is_file():
            return Path(folder) / _FILE
    raise CheckFailure(
        f"drawings: the font {FAMILY} ({_FILE.as_posix()} of the package matplotlib) is missing; "
        "no drawing was written; install matplotlib again"
    )


@cache
def _face() -> FT2Font:
    from matplotlib.ft2font import FT2Font

    # from memory: processes that are forked would share an open file, and move each other's place in it
    return FT2Font(BytesIO(font_file().read_bytes()))


@cache
def _glyph(letter: str) -> tuple[float, Box]:
    """Advance and ink box of one letter, in units of the em."""
    from matplotlib.ft2font import LoadFlags

    face = _face()
    if not face.get_char_index(ord(letter)):
        raise CheckFailure(f"drawings: the font {FAMILY} has no letter {letter!r} (U+{ord(letter):04X})")
    glyph = face.load_char(ord(letter), LoadFlags.NO_SCALE)
    em = face.units_per_EM
    x0, y0, x1, y1 = glyph.bbox
    return glyph.horiAdvance / em, (x0 / em, y0 / em, x1 / em, y1 / em)


def refuse_letters_it_lacks(texts: Mapping[str, str]) -> None:
    """Raises InputError for the first letter of a design's texts, by their path, that the font lacks."""
    for path, text in texts.items():
        for letter in text:
            if not _face().get_char_index(ord(letter)):
                raise InputError(
                    path,
                    f"the drawings' font {FAMILY} lacks a letter of it",
                    value=f"{letter} (U+{ord(letter):04X})",
                    legal="letters of the font, or an export without drawings",
                )


@cache
def em(height: float) -> float:
    """Size of the font (mm) whose capital letters are `height` mm high."""
    return height / _glyph("H")[1][3]


@lru_cache(maxsize=4096)  # a sheet's layout is tried in many ways
def width(text: str, height: float) -> float:
    """Sum of the letters' advances, mm."""
    return sum(_glyph(letter)[0] for letter in text) * em(height)


@lru_cache(maxsize=4096)
def ink_box(text: str, height: float) -> Box:
    """x_min, y_min, x_max, y_max of the ink (mm), baseline from (0, 0); a text of blanks has no area.

    Raises CheckFailure where the font lacks a letter.
    """
    pen, corners = 0.0, []
    for letter in text:
        advance, (x0, y0, x1, y1) = _glyph(letter)
        if x1 > x0:
            corners += [(pen + x0, y0), (pen + x1, y1)]
        pen += advance
    return scaled(bounds(corners), em(height)) if corners else (0.0, 0.0, 0.0, 0.0)
