"""Assembly guide of a scene: an exploded view, the steps with their parts and torques, all read off the
scene; and the map of the sensing face: elements, end plates, axes.

The sensing face is seen from below, as the object sees it: x runs to the right, y down. It is drawn from
descriptions, without a kernel.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape
from math import ceil
from pathlib import Path

import numpy as np

from tactcad.design.family import family_of
from tactcad.design.tree import CommonTables
from tactcad.parts.array import seating
from tactcad.parts.language.description import Part, Vector, vector
from tactcad.parts.language.metric import METRIC
from tactcad.scenes.moves import Moment, settles
from tactcad.scenes.scene import Placement, Scene, Step

from .engine.boxes import Box, bounds, bounds_of, box_of, corners, moved_by, placed
from .engine.ink import (
    LETTERS,
    THIN,
    DrawnSheet,
    Fill,
    Item,
    Point,
    Stroke,
    Text,
    arrow,
    bounds_of_items,
    moved,
    segment,
)
from .engine.sheet_files import svg_bytes

MAP = "sensing-face"  # label of the map of the elements
FACE_EYE: Vector = (0.0, 0.0, -1.0)
FACE_UP: Vector = (0.0, -1.0, 0.0)
FAR = 80.0  # mm that a step's parts are shown before their place, at most
MAP_SIZE = (130.0, 110.0)  # of the map's outlines, mm of paper
NUMBERS = (2.5, 1.8)  # of numbers, ISO 3098: the larger if all find room
BELOW_EACH_OTHER = 0.8  # between numbers below each other, mm of paper
BESIDE = 1.5  # from lines to a number, mm of paper
_STACKED = re.compile(r"(E|BL)\d+")


def page_path(scene: Scene) -> str:
    return f"guide/{scene.name}.html"


def picture_path(scene: Scene, label: str) -> str:
    return f"guide/{scene.name}-{label}.svg"


def exploded(scene: Scene) -> tuple[Placement, ...]:
    """Every part moved out by its step."""
    moved = {p.designator: p for step in scene.steps for p in _coming(scene, step)}
    return tuple(moved[p.designator] for p in scene.placements)


def at_step(
    scene: Scene, order: Sequence[Moment], number: int
) -> tuple[tuple[Placement, ...], tuple[Placement, ...]]:
    """Parts in place before step `number` (from 1), or on the bench for a bench step; and the step's own
    parts at the start of its first move, or FAR before its end. `order`: the scene's moments."""
    placed = {p.designator: p for p in (*scene.placements, *scene.aids)}
    there: dict[str, Vector] = {}
    coming: dict[str, Vector] = {}
    benched: set[str] = set()
    for moment in order:
        if moment.step > number - 1:
            break
        move = moment.move
        benched -= set(move.designators)
        if scene.steps[moment.step].bench:
            benched |= set(move.designators)
        if moment.step < number - 1:
            there |= dict.fromkeys(move.designators, move.path[-1])
            continue
        way, end = np.subtract(move.start, move.path[-1]), np.array(move.path[-1])
        near = end + way * min(1.0, FAR / max(float(np.linalg.norm(way)), FAR))
        coming = {**dict.fromkeys(move.designators, vector(near.tolist())), **coming}
    step = scene.steps[number - 1]
    coming = {name: at for name, at in coming.items() if name in step.designators or any(at)}
    if step.bench:
        own = {d for s in scene.steps if s.bench and s.unit == step.unit for d in s.designators}
        there = {name: at for name, at in there.items() if name in own}
    else:
        there = {name: at for name, at in there.items() if name not in benched}
    away = {p.designator for p in scene.aids if any(there.get(p.designator, ()))}
    standing = tuple(moved_by(placed[d], at) for d, at in there.items() if d not in coming and d not in away)
    return standing, tuple(moved_by(placed[d], at) for d, at in coming.items())


def pictured(step: Step) -> bool:
    """Whether a step brings or moves something."""
    return bool(step.designators or step.order)


def _coming(scene: Scene, step: Step) -> tuple[Placement, ...]:
    placed = {p.designator: p for p in scene.placements}
    count = len(step.designators)
    ranks = ceil(count / step.fan) if step.fan else 1
    shares = [0.5 + (n // step.fan + 1) / ranks / 2 if step.fan else 1.0 for n in range(count)]
    return tuple(
        moved_by(placed[d], [share * w for w in step.explode]) for d, share in zip(step.designators, shares)
    )


def torque(part: Part, design: CommonTables) -> float | None:
    """Tightening torque of a screw or nut, N m; None for other parts, 0 for a set screw that only touches."""
    if part.kind == "set screw":
        return seating.torque(family_of(design).layout(design))
    return METRIC[part.thread].torque if part.thread else None


def tools(design: CommonTables, scene: Scene) -> list[str]:
    """Tools of the steps: drivers of the screws and nuts that they place, torques, and their other tools."""
    ready = {d for step in scene.steps for d in step.ready}
    drivers: dict[tuple[str, float], list[str]] = {}
    torques: set[float] = set()
    for part in {p.part.part_no: p.part for p in scene.placements if p.designator not in ready}.values():
        if part.thread:
            m = METRIC[part.thread]
            sizes = {"set screw": ("hex key", m.set_key), "nut": ("two nut drivers", m.nut)}
            driver, turned = sizes.get(part.kind, ("hex key", m.key)), f"{part.thread} {part.kind}s"
            if turned not in drivers.setdefault(driver, []):
                drivers[driver].append(turned)
            if tight := torque(part, design):
                torques.add(tight)
    lines = [f"{kind} {size:g} mm: {', '.join(whose)}" for (kind, size), whose in sorted(drivers.items())]
    if torques:
        said = ", ".join(f"{t:g}" for t in sorted(torques))
        lines.append(f"torque driver for {said} N m, with these bits; oil every thread")
    return [*lines, *dict.fromkeys(tool for step in scene.steps for tool in step.tools)]


def sensing_face_map(scene: Scene) -> bytes | None:
    """The map of the array's elements as SVG, if a step of the scene handles them."""
    array = array_of(scene)
    if array is None or not any(step.elements for step in scene.steps):
        return None
    return svg_bytes(face_map(array, f"{scene.name}-{MAP}"))


def page(design: CommonTables, scene: Scene) -> bytes:
    """The guide as one HTML page; its pictures are in the same folder."""
    style = Path(__file__).with_suffix(".css").read_text("utf-8")
    d = design.design
    title = f"{d.title}: {scene.name}"
    needed = "".join(f"<li>{escape(line)}</li>" for line in tools(design, scene))
    body = [
        f"<h1>{escape(title)}</h1>",
        f'<p class="note">Assembly guide, revision {escape(d.revision)}, {escape(d.date)}'
        + (f", {escape(d.organisation)}" if d.organisation else "")
        + ". Its parts are those of the scene's bill of materials.</p>",
        f'<img src="{_name(scene, "exploded")}" alt="exploded view">',
        f"<section><h2>Tools</h2><ul>{needed}</ul></section>",
    ]
    body += [_section(design, scene, n, step) for n, step in enumerate(scene.steps, start=1)]
    before = [s for ready in scene.ready for s in ready.supplies]
    if supplies := [s for s in scene.supplies if s not in before]:
        lines = "".join(
            f"<tr><td>{escape(s.description)}</td><td class=n>{s.qty:g} {escape(s.unit)}</td></tr>"
            for s in supplies
        )
        body.append(f"<section><h2>Supplies</h2><table>{lines}</table></section>")
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{style}</style>\n</head>\n<body>\n"
        + "\n".join(body)
        + "\n</body>\n</html>\n"
    ).encode()


def _section(design: CommonTables, scene: Scene, number: int, step: Step) -> str:
    lines = [f"<section><h2>{number}. {escape(step.title)}</h2>", f"<p>{escape(step.text)}</p>"]
    for said, what in zip(("Fixes", "Leaves adjustable"), settles(scene, number - 1)):
        if what:
            lines.append(f'<p class="note">{said}: {escape("; ".join(what))}.</p>')
    if step.designators:
        lines.append(_table(design, scene, step))
    if pictured(step):
        picture = _name(scene, f"{number:02d}")
        lines.append(f'<img src="{picture}" alt="step {number}; blue: the parts of this step">')
    if step.elements:
        lines.append(
            f'<figure><img src="{_name(scene, MAP)}" alt="where each element is">'
            "<figcaption>Where each element is: the sensing face, pads towards you.</figcaption></figure>"
        )
    return "\n".join([*lines, "</section>"])


def _table(design: CommonTables, scene: Scene, step: Step) -> str:
    rows: dict[str, tuple[Part, list[str]]] = {}
    for p in scene.placements:
        if p.designator in step.designators and p.designator not in step.ready:
            rows.setdefault(p.part.part_no, (p.part, []))[1].append(p.designator)
    lines = ["<table><tr><th>qty</th><th>part</th><th>name</th><th>designators</th><th>torque</th></tr>"]
    for ready in scene.ready:
        if step.ready & {p.designator for p in ready.placements}:
            lines.append(
                f"<tr><td class=n>1</td><td></td><td>{escape(ready.name)}, put together by its own guide</td>"
                "<td></td><td></td></tr>"
            )
    for number, (part, names) in rows.items():
        tight = torque(part, design)
        lines.append(
            f"<tr><td class=n>{len(names)}</td><td>{escape(number)}</td><td>{escape(part.name)}</td>"
            f"<td>{escape(' '.join(names))}</td><td>{f'{tight:g} N m' if tight else ''}</td></tr>"
        )
    return "".join([*lines, "</table>"])


def _name(scene: Scene, label: str) -> str:
    return picture_path(scene, label).removeprefix("guide/")


def array_of(scene: Scene) -> Scene | None:
    """The array in a scene, in its own axes; None if there is none."""
    return next((s for s in (scene, *scene.ready) if s.name == "array"), None)


def in_stack(scene: Scene) -> list[Placement]:
    """Elements and blanks, from -y to +y: from the top of the view down."""
    own = [p for p in scene.placements if _STACKED.fullmatch(p.designator)]
    return sorted(own, key=lambda p: round(middle(p), 6), reverse=True)


def seen_box(p: Placement) -> Box:
    """The part's box in the view, mm."""
    (x0, y0, _), (x1, y1, _) = box_of(p).tolist()
    return x0, -y1, x1, -y0


def middle(p: Placement) -> float:
    """Middle of its sheet in the view, mm upwards."""
    return -(p.origin[1] + p.rotation[1][2] * p.part.extrusion.thickness / 2)


def pad(p: Placement) -> Box | None:
    """The element's contact pad in the view, mm; None for a blank."""
    if p.part.kind != "element":
        return None
    body = p.part.extrusion
    face = body.outer.named("pad_face")
    ends = [placed(p, (*end, z)) for end in (face.start, face.end) for z in (0.0, body.thickness)]
    return bounds((x, -y) for x, y, _ in ends)


def numbers(scene: Scene, f: float, half: float, arms: bool = False) -> list[Text]:
    """Designators of the two rows, `half` mm of paper from the middle line, at the scale f.

    If they would be too close, some are left out, but never the first and last of a row.
    """
    rows = [[p for p in in_stack(scene) if p.rotation[0][0] * sign > 0] for sign in (1.0, -1.0)]
    fitting = [h for h in NUMBERS if all(_spaced(row, (h + BELOW_EACH_OTHER) / f) == row for row in rows)]
    height = fitting[0] if fitting else NUMBERS[-1]
    texts = []
    for row, sign in zip(rows, (1.0, -1.0)):
        shown, least = _spaced(row, (height + BELOW_EACH_OTHER) / f), height + BELOW_EACH_OTHER
        levels = [middle(p) * f for p in shown]
        if len(levels) == 2 and levels[0] - levels[1] < least:  # a short row: its two names move apart
            centre = sum(levels) / 2
            levels = [centre + least / 2, centre - least / 2]
        for p, level in zip(shown, levels):
            at = (sign * (half + BESIDE), level - height / 2)
            arm = f", {p.part.name.rpartition(', ')[2]}" if pad(p) else " (blank)"
            name = f"{p.designator}{arm if arms else ''}"
            texts.append(Text(at, name, height, "start" if sign > 0 else "end"))
    return texts


def _spaced(row: Sequence[Placement], least: float) -> list[Placement]:
    """First, last, and between them those at least so far from the previous one kept, mm."""
    kept = list(row[:1])
    for p in row[1:]:
        if abs(middle(p) - middle(kept[-1])) >= least - 1e-9:
            kept.append(p)
    if row and kept[-1] is not row[-1]:
        kept[max(1, len(kept) - 1) :] = [row[-1]]
    return kept


def axes(at: Point, length: float = 8.0) -> list[Item]:
    """x to the right and y down from a corner, named."""
    x, y = at
    right, down = (x + length, y), (x, y - length)
    return [
        segment(at, right, THIN, "symbol"),
        segment(at, down, THIN, "symbol"),
        arrow(right, at, role="symbol"),
        arrow(down, at, role="symbol"),
        Text((x + length + 1.0, y - LETTERS / 2), "+x", LETTERS),
        Text((x + 1.5, y - length), "+y", LETTERS),  # not to its left: there are the elements' numbers
    ]


def face_map(array: Scene, name: str) -> DrawnSheet:
    """The map of an array: outlines of elements, blanks and end plates; pads filled, numbers and arms."""
    plates = [p for p in array.placements if p.designator in ("EP1", "EP2")]
    x0, y0, x1, y1 = bounds_of(corners(seen_box(p)) for p in [*plates, *in_stack(array)])
    f = min(MAP_SIZE[0] / (x1 - x0), MAP_SIZE[1] / (y1 - y0))

    def outline(box: Box) -> tuple[Point, ...]:
        return tuple((x * f, y * f) for x, y in corners(box))

    items: list[Item] = [Stroke(outline(seen_box(p)), THIN, closed=True) for p in [*plates, *in_stack(array)]]
    items += [Fill(outline(box), "symbol") for p in in_stack(array) if (box := pad(p))]
    items += numbers(array, f, x1 * f, arms=True)
    over, under = y1 * f + BESIDE, y0 * f - BESIDE - LETTERS
    items += [
        Text((x1 * f + BESIDE, over), "row 1", LETTERS),
        Text((x0 * f - BESIDE, over), "row 2", LETTERS, "end"),
    ]
    for plate in plates:
        y = over + 2 * LETTERS if middle(plate) > 0 else under
        items.append(Text((0.0, y), f"{plate.designator}: {plate.part.name.lower()}", LETTERS, "middle"))
    items += axes((x0 * f, under - LETTERS))
    bx0, by0, bx1, by1 = bounds_of_items(items)
    size = (round(bx1 - bx0 + 4.0, 3), round(by1 - by0 + 4.0, 3))
    shown = tuple(moved(i, 2.0 - bx0, 2.0 - by0) for i in items)
    return DrawnSheet(name, "Sensing face, pads towards you", size, shown)
