"""Every different board of an array, laid out: bare boards are equal, the fitted components differ."""

from __future__ import annotations

from tactcad.parts.array.board_plate import BOARD_OUTLINE
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import boards, leads
from tactcad.parts.bought.electronic_parts import converter_of

from .board_layout import lay_out
from .copper import BoardCopper
from .digital_board import digital_netlist
from .netlist import Netlist
from .read_board import board_netlist


def netlist_of_board(layout: Layout, used: int) -> Netlist:
    """Netlist of the board for so many elements: with amplifier and card, or with a converter."""
    converter = converter_of(layout.design)
    if converter:
        return digital_netlist(layout, converter, used)
    return board_netlist(layout.design, used, leads(layout))


def laid_out(layout: Layout) -> tuple[BoardCopper, ...]:
    """One for each number of elements that a board reads, the largest first. Raises CheckFailure if the
    outline is too small."""
    used = sorted({len(board.places) for board in boards(layout)}, reverse=True)
    return tuple(lay_out(netlist_of_board(layout, n), BOARD_OUTLINE) for n in used)
