"""`tactcad design` of planar targets: foil, pitch, beams and the chips' gap, for a range of objects.

A pair of neighbours, one cell of each kind, is pressed until one of them is at its rated force. The relative
error of K_obj is that of F_m/F_r over its slope: noise of the readings, and the error of both matrices. A
coarse grid over all that varies is refined from its best design that every rule accepts. What is said of the
answer is in `cell_answers`.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import astuple, dataclass, replace
from itertools import product
from math import ceil, floor, inf
from pathlib import Path
from typing import Any

import numpy as np

from tactcad.design.fields import Number, Numbers, TextLine, Whole, given, spec_of
from tactcad.design.files import read_text
from tactcad.design.load import MOST_BYTES, read
from tactcad.design.messages import InputError
from tactcad.design.text_values import parse_toml
from tactcad.design.tree import Identity
from tactcad.parts.language.finding import Finding
from tactcad.parts.rules.rule import misfit, wrong
from tactcad.synthesis.target import origins_of, tables_of

from .beam import Array
from .cell_board import why_none
from .cell_layout import PlanarLayout
from .cell_tables import Planar, PlanarDesign
from .parts import EDGE, LAND_DEPTH
from .rules import design_rules
from .sensor import chip_matrix, force_noise, lowest, pad_compliance, rated_force

Z = 1.959964  # the normal distribution's quantile, of a 95 % interval
POINTS = 9  # stiffnesses of the object at which the half-width is asked for, and of the curve
STEP = 0.005  # mm, of a stop's gap; beams and islands in twice that
WIDTHS = 6  # beams' widths of a kind that the grid tries, and half as many islands, gaps and pitches
KINDS = ("measuring", "reference")
TRIED = 300  # best choices of the grid that are tried with every rule
STEPS = {"pitch": 0.4, "soft": 0.04, "stiff": 0.08, "island": 0.1, "gap": 0.1}  # mm, the first ones
ROUNDS = 4  # of steps, each half of the one before


def _range(low: float, high: float, unit: str, meaning: str) -> Numbers:
    return Numbers(Number(unit, low, high, meaning), 2, 2, f"least and largest {meaning}")


@dataclass(frozen=True)
class CellWish:
    """[target]: what the sensor is to reach."""

    name: str = given(spec_of(Identity, "name"))
    base: str = given(
        TextLine(r"[^\x00-\x1f]{1,200}", "a planar design by name or path", "whose other values are kept"),
        "planar-array",
    )
    half_width: float | None = given(
        Number("%", 0.1, 50, "half-width of the 95 % interval of K_obj over the whole range, at most"),
        None,
        "the best to be had",
    )
    share: float = given(Number("", 0.5, 0.999, "share of arrays made that meet the target, at least"), 0.95)


@dataclass(frozen=True)
class CellObject:
    """[object]: what is felt."""

    stiffness: tuple[float, ...] = given(_range(1e-3, 1e4, "N/mm", "K_obj under one pad"))


@dataclass(frozen=True)
class CellMeans:
    """[planar]: forces, room, foils, and how well readings and matrices are known."""

    force: float = given(Number("N", 1e-3, 100, "largest force on a pad"))
    pitch: tuple[float, ...] = given(_range(1, 50, "mm", "distance of neighbouring cells"))
    length: float = given(Number("mm", 2, 2000, "room along x"))
    width: float = given(Number("mm", 2, 2000, "room along y"))
    cells: int = given(Whole(2, 1600, "cells, at least; the room is filled"), 2)
    foils: tuple[float, ...] | None = given(
        Numbers(spec_of(Planar, "thickness"), 1, 8, "foils at hand"), None, "the base design's"
    )
    shear: float = given(Number("", 0, 2, "largest tangential force, a share of the normal one"), 0.1)
    readings: int = given(Whole(1, 10000, "readings that are averaged at every load"), 10)
    matrices: float = given(
        Number("", 0, 0.2, "error of a calibrated matrix, relative, one standard deviation"), 0.005
    )


def tables() -> dict[str, type]:
    """Classes of a target file's tables, by name."""
    return {"target": CellWish, "object": CellObject, "planar": CellMeans}


@dataclass(frozen=True)
class CellTarget:
    """A target file; `written` are the paths of the fields that it has."""

    target: CellWish
    object: CellObject
    planar: CellMeans
    base: PlanarDesign
    written: frozenset[str] = frozenset()

    @property
    def points(self) -> Array:
        """N/mm"""
        low, high = self.object.stiffness
        return np.geomspace(low, high, POINTS)


def read_target(path: str | Path) -> CellTarget:
    """A planar target file. Raises InputError for what is missing, unknown, illegal or contradicts itself."""
    table = parse_toml(read_text(path, MOST_BYTES, "a target file (TOML)"), str(path))
    values, written = tables_of(table, tables())
    origins_of(table.get("origin", {}), values)
    wish, means = values["target"], values["planar"]
    named = wish.base
    base = read(Path(path).parent / named if "/" in named or named.endswith(".toml") else named)
    if not isinstance(base, PlanarDesign):
        raise InputError("target.base", "not a planar design", value=named, legal="a design with [planar]")
    for where, pair in (("object.stiffness", values["object"].stiffness), ("planar.pitch", means.pitch)):
        if pair[0] > pair[1]:
            above = "its first value is above its second"
            raise InputError(where, above, value=list(pair), legal="low, high")
    foils = means.foils or (base.planar.thickness,)
    return CellTarget(wish, values["object"], replace(means, foils=foils), base, written)


@dataclass(frozen=True)
class CellChoice:
    """What varies, mm: foil, pitch, beams' widths of both kinds, the reference island's side, chips' gap."""

    foil: float
    pitch: float
    soft: float
    stiff: float
    island: float
    gap: float


@dataclass(frozen=True)
class CellRead:
    """A cell as it is read: N/mm; rated force and noise of one reading, N."""

    stiffness: float
    rated: float
    noise: float


def designed(t: CellTarget, c: CellChoice) -> PlanarDesign | None:
    """The base design with this choice, as many cells as the room takes, and roots as its process leaves
    them; None if the room is too small."""
    b, m = t.base, t.planar
    rooms = zip((m.length, m.width), PlanarLayout(b).borders)
    inside = [room - 2.0 * border + b.planar.web for room, border in rooms]
    columns, rows = (min(40, floor(room / c.pitch + 1e-9)) for room in inside)
    if min(columns, rows) < 1 or columns * rows < m.cells:
        return None
    title = "Planar array from a target"
    own = replace(b.design, name=t.target.name, title=title, revision="A", unchanged={})
    planar = replace(b.planar, rows=rows, columns=columns, pitch=c.pitch, thickness=c.foil)
    d = replace(
        b,
        design=own,
        planar=planar,
        measuring=replace(b.measuring, beam_width=c.soft),
        reference=replace(b.reference, beam_width=c.stiff, island=c.island),
        hall=replace(b.hall, gap=c.gap),
        rating=replace(b.rating, force=m.force, shear=m.shear),
        origin={},
    )
    process, corner = PlanarLayout(d).process, PlanarLayout(d).corner
    for name in KINDS:
        kind = getattr(d, name)
        fillet = max(kind.fillet, corner + EDGE)
        slot = max(kind.slot, process.slot(c.foil), fillet + corner + EDGE)
        ear = max(kind.ear, 2.0 * corner + EDGE, process.web(c.foil))
        d = replace(d, **{name: replace(kind, fillet=fillet, slot=slot, ear=ear)})
    return replace(d, hall=replace(d.hall, buses=-(-columns * rows // PlanarLayout(d).chip.addresses)))


def with_buses(d: PlanarDesign) -> PlanarDesign:
    """As few buses as the chips need, or more if a board can only be laid out so."""
    least = d.hall.buses
    tries = (replace(d, hall=replace(d.hall, buses=n)) for n in range(least, least + d.planar.columns))
    return next((more for more in tries if not why_none(PlanarLayout(more))), d)


def with_stops(d: PlanarDesign) -> PlanarDesign:
    """Stops that close just above the rated force, as the rule on them asks."""
    layout = PlanarLayout(d)
    ways = {name: lowest(layout, kind, rated_force(layout, kind)[1]) for name, kind in layout.kinds.items()}
    for name, way in ways.items():
        sunk = LAND_DEPTH if way > min(ways.values()) else 0.0
        least = max(way + d.tolerance.stop_gap / 2.0 + sunk, layout.process.thinnest)
        gap = round(STEP * ceil(least / STEP - 1e-9), 6)
        d = replace(d, **{name: replace(getattr(d, name), stop_gap=gap)})
    return d


def of_kind(layout: PlanarLayout, name: str, rated: float | None = None) -> CellRead:
    """A kind of cell read at its own rated force or another."""
    kind = layout.kinds[name]
    rated = rated_force(layout, kind)[1] if rated is None else rated
    noise = force_noise(layout.chip, chip_matrix(layout, kind))
    return CellRead(float(1.0 / pad_compliance(kind, layout.pad_height)[2, 2]), rated, float(noise[2]))


def fits(layout: PlanarLayout, *names: str) -> bool:
    """Whether these kinds of cells keep the rules on contours and beams: they have no figures otherwise."""
    rules = ("islands_fit_pitch", "beams_can_be_cut", "beams_in_range", "island_takes_post")
    found = (f for rule in rules for f in design_rules()[rule].find(layout))
    return not any(f.part.startswith(tuple(f"{name}." for name in names)) for f in found)


def variances(
    soft: CellRead, stiff: CellRead, readings: int, matrices: float, k: Array
) -> tuple[Array, Array, Array]:
    """Of ln K_obj at stiffnesses k: noise of the measuring cell, of the reference cell, and both matrices."""
    way_m, way_r = 1.0 / soft.stiffness + 1.0 / k, 1.0 / stiff.stiffness + 1.0 / k
    way = np.minimum(soft.rated * way_m, stiff.rated * way_r)
    slope = (1.0 / way_r - 1.0 / way_m) / k
    with np.errstate(divide="ignore"):
        one, other = (
            (cell.noise * ways / way / slope) ** 2 / readings
            for cell, ways in ((soft, way_m), (stiff, way_r))
        )
        return one, other, 2.0 * (matrices / slope) ** 2


def half_width(soft: CellRead, stiff: CellRead, m: CellMeans, k: Array) -> Array:
    """Of the 95 % interval of K_obj, relative, at stiffnesses k; infinite where the kinds do not differ."""
    if stiff.stiffness <= soft.stiffness:
        return np.full(np.shape(k), np.inf)
    return Z * np.sqrt(sum(variances(soft, stiff, m.readings, m.matrices, k)))


def pair_half_width(t: CellTarget, layout: PlanarLayout) -> float:
    """The largest half-width over the target's range of a pair of the layout's kinds."""
    return widest(t, *(of_kind(layout, name) for name in KINDS))


def widest(t: CellTarget, soft: CellRead, stiff: CellRead) -> float:
    """The largest half-width over the target's range."""
    return float(half_width(soft, stiff, t.planar, t.points).max())


@dataclass(frozen=True)
class CellFound:
    """A design that keeps every rule."""

    choice: CellChoice
    design: PlanarDesign
    soft: CellRead
    stiff: CellRead
    half_width: float


def evaluated(t: CellTarget, c: CellChoice) -> CellFound | Finding:
    """What a choice gives, or the rule that it breaks."""
    d = designed(t, c)
    if d is None:
        return wrong("planar.length", f"no room for {t.planar.cells} cells", t.planar.length, "more")
    layout: Any = PlanarLayout(d)
    if fits(layout, *KINDS):
        d = with_stops(d)
        layout = PlanarLayout(d)
    if broken := misfit(layout, design_rules().values()):
        return broken
    soft, stiff = (of_kind(layout, name) for name in KINDS)
    return CellFound(c, with_buses(d), soft, stiff, widest(t, soft, stiff))


def grid(t: CellTarget) -> Iterator[tuple[float, CellChoice]]:
    """Coarse choices with their half-widths: every kind by itself, then all pairs."""
    b, half = t.base, WIDTHS // 2
    gaps = [round(float(b.hall.gap * f), 2) for f in np.linspace(0.8, 1.2, half)]
    low, high = t.planar.pitch
    for foil in t.planar.foils or ():
        for pitch in sorted({round(float(p), 2) for p in np.linspace(low, high, half)}):
            widths = [round(float(w), 2) for w in np.geomspace(max(2.0 * foil, 0.1), 0.16 * pitch, WIDTHS)]
            islands = [round(float(i), 2) for i in np.linspace(b.reference.island, 0.55 * pitch, half)]
            first = CellChoice(foil, pitch, widths[0], widths[0], islands[0], gaps[0])
            soft = [p for w, g in product(widths, gaps) for p in _of(t, replace(first, soft=w, gap=g), 0)]
            tried = (replace(first, stiff=w, island=i, gap=g) for w, i, g in product(widths, islands, gaps))
            stiff = [pair for c in tried for pair in _of(t, c, 1)]
            for (c, m), (o, r) in product(soft, stiff):
                if c.gap == o.gap:
                    yield widest(t, m, r), replace(o, soft=c.soft)


def _of(t: CellTarget, c: CellChoice, kind: int) -> Iterator[tuple[CellChoice, CellRead]]:
    if (d := designed(t, c)) and fits(layout := PlanarLayout(d), KINDS[kind]):
        yield c, of_kind(layout, KINDS[kind])


def beside(t: CellTarget, c: CellChoice, shorter: float = 1.0) -> Iterator[tuple[str, CellChoice]]:
    """Choices one step away along each value, with its name."""
    for name, by in STEPS.items():
        for sign in (1.0, -1.0):
            value = round(getattr(c, name) + sign * by * shorter, 3)
            low, high = t.planar.pitch if name == "pitch" else (STEP, 40.0)
            if low <= value <= high:
                yield name, replace(c, **{name: value})


def refined(t: CellTarget, best: CellFound, rounds: int = ROUNDS, until: float = inf) -> CellFound:
    """Steps along one value at a time, halved when none helps."""
    for halved in range(rounds):
        better = True
        while better:
            better = False
            for _, choice in beside(t, best.choice, 0.5**halved):
                if time.perf_counter() > until:
                    return best
                found = evaluated(t, choice)
                if isinstance(found, CellFound) and found.half_width < best.half_width * (1 - 1e-4):
                    best, better = found, True
                    break
    return best


@dataclass(frozen=True)
class CellAnswer:
    """Of a search; `best` is None where no choice keeps every rule, and `refused` says of which the last one
    broke. `cut`: the clock ended it."""

    target: CellTarget
    best: CellFound | None
    refused: str
    front: tuple[tuple[float, float, float], ...]
    cut: bool = False

    @property
    def wanted(self) -> float | None:
        w = self.target.target.half_width
        return None if w is None else w / 100.0


def search(t: CellTarget, until: float = inf) -> CellAnswer:
    """The best design, and the grid's best half-width by foil and pitch, before rules are tried; `until` of
    `time.perf_counter`."""
    every: list[tuple[float, CellChoice]] = []
    for pair in grid(t):
        if every and pair[1].foil != every[0][1].foil and time.perf_counter() > until:
            break  # at least the first foil's whole grid
        every.append(pair)
    every.sort(key=lambda pair: (pair[0], astuple(pair[1])))
    front: dict[tuple[float, float], float] = {}
    for width, c in every:
        front.setdefault((c.foil, c.pitch), width)
    refused, best = "no beams fit this pitch", None
    for _, c in every[:TRIED]:
        found = evaluated(t, c)
        if isinstance(found, CellFound):
            best = refined(t, found, until=until)
            break
        refused = str(found)
    shown = tuple((f, p, w) for (f, p), w in sorted(front.items()))
    return CellAnswer(t, best, refused, shown, time.perf_counter() > until)
