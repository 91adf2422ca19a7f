"""Exploded views: which a scene of several sub-assemblies has, the visible lines of one view's pieces, and
its page with balloons.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from string import ascii_uppercase
from typing import TYPE_CHECKING

from tactcad.scenes.scene import Scene

from ..engine.boxes import Box, Polyline, bounds, bounds_of, corners, length, overlap
from ..engine.ink import Item, Text
from ..engine.paper import (
    A3,
    A3_UPRIGHT,
    A4,
    A4_LYING,
    HEIGHT,
    MARGIN,
    SERIES,
    WIDTH,
    Page,
    Paper,
    edges,
    factor,
    shown,
)
from . import balloons
from .apart import Piece, pieces_of

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

    from ..engine.picture import Viewpoint

RIM = 2 * balloons.RADIUS + 8.0  # around an exploded view, for its balloons
MOST_NUMBERED = 45  # items in one view; more would not find places around it
LINE = 5.0  # from line to line of a view's heading, mm
Label = int | str  # item number, or letter of a sub-assembly's own view


@dataclass(frozen=True)
class Exploded:
    """Visible lines (mm, picture plane) of everything drawn, and of the labelled parts, by label."""

    own: dict[Label, list[Polyline]]
    lines: tuple[Polyline, ...]

    @property
    def box(self) -> Box:
        return bounds_of(self.lines)

    def labelled(self, which: Callable[[Label], bool]) -> Exploded:
        """The same lines with the labels asked for, no more than MOST_NUMBERED."""
        chosen = [(label, lines) for label, lines in self.own.items() if which(label)]
        return Exploded(dict(chosen[:MOST_NUMBERED]), self.lines)


def seen_of_pieces(
    pieces: Sequence[Piece], shapes: Mapping[str, TopoDS_Shape], eye: Viewpoint
) -> list[list[Polyline]]:
    """Visible lines of each piece (mm, picture plane) at its place."""
    from tactcad.solids.occt import placed_shape

    from ..engine.picture import compound, seen_of_each

    solids = []
    for piece in pieces:
        some = [placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in piece.placements]
        solids.append(some[0] if len(some) == 1 else compound(some))
    return seen_of_each(solids, eye)


def lengths_alone(pieces: Sequence[Piece], shapes: Mapping[str, TopoDS_Shape], eye: Viewpoint) -> list[float]:
    """Length (mm) of each piece's visible lines with nothing in front of it."""
    unlike = {alike(piece): piece for piece in reversed(pieces)}
    known = {key: total_length(seen_of_pieces([piece], shapes, eye)[0]) for key, piece in unlike.items()}
    return [known[alike(piece)] for piece in pieces]


def alike(piece: Piece) -> tuple:
    """A key that is equal for pieces that look the same from one eye at any place."""
    first = piece.placements[0]
    return first.part.part_no, first.rotation, len(piece.placements), piece.letter


def exploded_view(
    pieces: Sequence[Piece],
    seen: Sequence[Sequence[Polyline]],
    item: Mapping[str, int],
    well: Container[int] | None = None,
) -> Exploded:
    """All visible lines, labelled: sub-assemblies by letter first, then items by number. Leaders go to all
    pieces, or only to those (by index) that are seen `well`.
    """
    own: dict[Label, list[Polyline]] = {}
    for n, (piece, some) in enumerate(zip(pieces, seen)):
        if some and (well is None or n in well):
            own.setdefault(piece.letter or item[piece.placements[0].part.part_no], []).extend(some)
    in_order = dict(sorted(own.items(), key=lambda pair: (isinstance(pair[0], int), pair[0])))
    return Exploded(in_order, tuple(sorted({line for some in seen for line in some})))


def total_length(lines: Iterable[Polyline]) -> float:
    """mm"""
    return sum(map(length, lines))


def exploded_page(
    view: Exploded, heading: Sequence[str], list_: balloons.Laid | None, small: bool = False
) -> tuple[Page, bool] | None:
    """The view at the largest scale at which its balloons find places, and whether the parts list is next to
    it.

    The list is next to the view if that does not reduce the scale; likewise the paper is A4 if allowed
    (`small`). None if the balloons find no place.
    """
    bx0, by0, bx1, by1 = view.box
    choices: list[tuple[Paper, balloons.Laid | None]] = [(A3, list_)] if list_ else []
    choices += [(paper, None) for paper in ((A4, A4_LYING) if small else ()) + (A3, A3_UPRIGHT)]
    for scale in SERIES:
        f = factor(scale)
        for paper, beside in choices:
            area = room(paper, bool(beside))
            if (bx1 - bx0) * f + 2 * RIM > area[2] - area[0] or (by1 - by0) * f + 2 * RIM > area[3] - area[1]:
                continue
            shift = ((area[0] + area[2] - (bx0 + bx1) * f) / 2, (area[1] + area[3] - (by0 + by1) * f) / 2)
            drawn = edges(view.lines, f, shift)
            own = {n: [e.points for e in edges(lines, f, shift)] for n, lines in view.own.items()}
            texts, taken = _heading(heading, area)
            if any(overlap(bounds(e.points), taken) for e in drawn):
                continue
            around = (*corners(taken), corners(taken)[0])
            placed = balloons.place(own, [*(e.points for e in drawn), around], area)
            if not placed:
                continue
            items: list[Item] = [*drawn, *balloons.drawn(placed), *texts]
            kind = "Assembly drawing"
            if beside:
                corner = (paper.area[2] - WIDTH, paper.area[3])
                items += balloons.list_drawn(beside, range(len(beside.cells)), corner)[0]
                kind += ", parts list"
            return Page(paper, shown(scale), tuple(items), kind), bool(beside)
    return None


def _heading(lines: Sequence[str], area: Box) -> tuple[list[Item], Box]:
    """The view's title, with smaller remarks below it, in the upper left corner; and the room they take."""
    x, y = area[0] + MARGIN, area[3] - MARGIN - 3.5
    texts = [Text((x, y - LINE * n), line, 2.5 if n else 3.5) for n, line in enumerate(lines)]
    wide = max(text.width for text in texts)
    return [*texts], (x, y - LINE * (len(lines) - 1) - 1.0, x + wide, y + 3.5)


def room(paper: Paper, with_list: bool) -> Box:
    """Room for an exploded view: left of the list, else left of or over the title block."""
    x0, y0, x1, y1 = paper.area
    beside, over = (x0, y0, x1 - WIDTH, y1), (x0, y0 + HEIGHT, x1, y1)
    sizes = [(b[2] - b[0]) * (b[3] - b[1]) for b in (beside, over)]
    return beside if with_list or sizes[0] > sizes[1] else over


@dataclass(frozen=True)
class UnitView:
    """A view's letter and title, the scene whose contacts join its pieces, and the pieces; no pieces if the
    whole scene is exploded by its steps.
    """

    letter: str
    title: str
    scene: Scene
    pieces: tuple[Piece, ...] = ()


def unit_views(scene: Scene) -> list[UnitView]:
    """The whole, with each sub-assembly assembled in it; then each sub-assembly by itself, followed by its
    ready scenes.

    None if the scene has fewer than two sub-assemblies.
    """
    units: dict[str, list[str]] = {}
    for step in scene.steps:
        if step.unit and step.designators:
            units.setdefault(step.unit, []).extend(step.designators)
    if len(units) < 2:
        return []
    at = {p.designator: p for p in scene.placements}
    letters = iter(ascii_uppercase)
    whole_letter = next(letters)
    views, blocks = [], []
    for title, names in units.items():
        letter, own = next(letters), [at[d] for d in names]
        ready_ones, inside = [], set()  # the ready scenes behind the other parts, each as one piece
        for ready in scene.ready:
            theirs = {p.designator for p in ready.placements}
            if theirs <= set(names):
                ready_ones.append(
                    (Piece(tuple(p for p in own if p.designator in theirs), next(letters)), ready)
                )
                inside |= theirs
        pieces = pieces_of(scene, [p for p in own if p.designator not in inside])
        views.append(UnitView(letter, title, scene, (*pieces, *(piece for piece, _ in ready_ones))))
        views += [UnitView(piece.letter, ready.name, ready) for piece, ready in ready_ones]
        blocks.append(Piece(tuple(own), letter))
    return [UnitView(whole_letter, "the sub-assemblies", scene, tuple(blocks)), *views]
