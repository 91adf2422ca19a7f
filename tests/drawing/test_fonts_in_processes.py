"""Letters measure the same in processes that were forked with the font already open."""

from __future__ import annotations

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

from tactcad.drawing.engine import ink

LETTERS = [
    chr(code)
    for code in (*range(0x21, 0x7F), *range(0xA1, 0x180), *range(0x391, 0x3CA))
    if code not in (0xAD, 0x3A2)
]


def measured(_round: int) -> list[tuple]:
    ink._glyph.cache_clear()
    return [ink._glyph(letter) for letter in LETTERS]


def test_forked_processes_do_not_share_a_place_in_the_file():
    """One open file would be read by all of them at once, each moving the others' place in it."""
    alone = measured(0)
    with ProcessPoolExecutor(4, multiprocessing.get_context("fork")) as pool:
        for widths in pool.map(measured, range(24)):
            assert widths == alone
