"""The check of a written drawing: its PDF is read with another library and compared with the part."""

from __future__ import annotations

import io
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import lru_cache

from tactcad.parts.description import Characteristic, Part

from .ink import DrawnSheet
from .layout_check import layout_faults
from .limit_marks import frame_of, times

SAME = 1e-9  # mm
_VALUE = re.compile(
    r"^[⌀R]?(?P<nominal>\d+(?:\.\d+)?) (?:±(?P<both>[\d.]+)|(?P<upper>[+-]?[\d.]+)/(?P<lower>[+-]?[\d.]+))$"
)


@lru_cache(maxsize=16)  # a release asks several things of each of its sheets
def pdf_texts(data: bytes) -> tuple[tuple[tuple[str, float], ...], ...]:
    """Texts of every page with the size of their letters (points), in the order in which they were drawn, as
    pypdf reads them."""
    from pypdf import PdfReader

    pages = []
    for page in PdfReader(io.BytesIO(data)).pages:
        texts: list[tuple[str, float]] = []

        def take(text: str, _matrix: object, _text_matrix: object, _font: object, size: float) -> None:
            texts.extend((run.strip(), size) for run in text.splitlines() if run.strip())

        page.extract_text(visitor_text=take)
        pages.append(tuple(texts))
    return tuple(pages)


def pdf_runs(data: bytes) -> list[list[str]]:
    """Texts of every page in the order in which they were drawn."""
    return [[text for text, _ in page] for page in pdf_texts(data)]


def drawing_faults(data: bytes, sheet: DrawnSheet, part: Part, revision: str) -> list[str]:
    """What is wrong with a part's PDF: pages, number and revision, layout, or a key characteristic."""
    pages = pdf_runs(data)
    if len(pages) != 1:
        return [f"{len(pages)} pages instead of 1"]
    runs = pages[0]
    wrong = [f"{text!r} is missing" for text in (revision, "1/1") if text not in runs]
    if part.part_no not in "".join(runs):  # a long one is broken
        wrong.append(f"{part.part_no!r} is missing")
    texts = [t.text for t in sheet.texts if t.role != "watermark"]
    lost = [t for t in set(texts) if runs.count(t) < texts.count(t)]
    wrong += [f"{t!r} is not found again" for t in sorted(lost)]
    wrong += key_faults(runs, [c for c in part.characteristics if c.key])
    elsewhere = Counter(t.text for t in sheet.texts if t.role != "symbol")
    return wrong + geometric_faults(runs, part, elsewhere) + layout_faults(sheet)


def geometric_faults(runs: Sequence[str], part: Part, elsewhere: Mapping[str, int]) -> list[str]:
    """What is wrong with tolerance frames and datum letters on a sheet.

    Parameters
    ----------
    runs
        Texts of the page in the order in which they were drawn.
    part
        Whose geometric tolerances and datums have to stand there, at each feature once, and no others.
    elsewhere
        How often a text stands on the sheet outside of frames and datum symbols, as letters of the paper's
        zones do.

    Returns
    -------
    list of str
        Zones with their datums, and letters, that stand more often or less.
    """
    frames = Counter(frame_of(part, g).cells for g in part.geometric for _ in range(times(part, g)))
    wrong = []
    for cells, meant in sorted(frames.items()):
        n = len(cells)
        found = sum(tuple(runs[i : i + n]) == cells for i in range(len(runs) - n + 1))
        found -= elsewhere.get(cells[0], 0) if n == 1 else 0
        longer = sum(k for other, k in frames.items() if len(other) > n and other[:n] == cells)
        if found - longer != meant:
            wrong.append(f"tolerance frame {' '.join(cells)} stands {found - longer} times, not {meant}")
    wanted = Counter(
        [*(d.letter for d in part.datums), *(x for cells in frames.elements() for x in cells[1:])]
    )
    for letter in sorted({*wanted, *(run for run in runs if len(run) == 1 and run.isupper())}):
        found = runs.count(letter) - elsewhere.get(letter, 0)
        if found != wanted[letter]:
            wrong.append(f"datum {letter} stands {found} times in frames, not {wanted[letter]}")
    return wrong


def key_faults(runs: Sequence[str], keys: Sequence[Characteristic]) -> list[str]:
    """What is wrong with the key characteristics on a sheet.

    Parameters
    ----------
    runs
        Texts of the page in the order in which they were drawn.
    keys
        The part's key characteristics, in order.

    Returns
    -------
    list of str
        Those that do not stand exactly once, framed with their number, or not with the model's value.
    """
    wrong, shown = [], []
    for n, c in enumerate(keys, start=1):
        at = [i for i, run in enumerate(runs) if run == f"K{n}"]
        if len(at) != 1 or at[0] + 1 >= len(runs):
            wrong.append(f"key characteristic K{n} ({c.name}) stands {len(at)} times")
            continue
        text = runs[at[0] + 1]
        shown.append(text)
        match = _VALUE.match(text)
        if not match:
            wrong.append(f"K{n}: {text!r} is no value with limits")
            continue
        nominal = float(match["nominal"])
        upper, lower = (
            (float(match["both"]), -float(match["both"]))
            if match["both"]
            else (float(match["upper"]), float(match["lower"]))
        )
        read, meant = (nominal, nominal + upper, nominal + lower), (c.nominal, c.upper, c.lower)
        if max(abs(a - b) for a, b in zip(read, meant)) > SAME:
            wrong.append(
                f"K{n} ({c.name}) says {text}, the model has {c.nominal:g} in {c.lower:g} to {c.upper:g}"
            )
    wrong += [
        f"{text!r} stands {runs.count(text)} times, for {shown.count(text)} key characteristics"
        for text in sorted(set(shown))
        if runs.count(text) != shown.count(text)
    ]
    return wrong
