"""Every different board of an array, laid out: bare they are all alike, and differ in what is fitted."""

from __future__ import annotations

from tactcad.parts.array.board_outline import board_outline
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import boards, leads

from .board_layout import lay_out
from .copper import BoardCopper
from .read_board import board_netlist


def laid_out(layout: Layout) -> tuple[BoardCopper, ...]:
    """One for each number of elements that a board reads, the largest first. Raises CheckFailure where the
    outline is too small."""
    used = sorted({len(board.places) for board in boards(layout)}, reverse=True)
    outline = board_outline(layout)
    return tuple(lay_out(board_netlist(layout.design, n, leads(layout)), outline) for n in used)
