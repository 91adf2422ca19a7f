"""Assembly guide of a scene: an exploded view, the steps with their parts and torques, all read off the
scene.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from html import escape
from math import ceil

from tactcad.design.tree import Design
from tactcad.parts import seating
from tactcad.parts.description import Part
from tactcad.parts.layout import Layout
from tactcad.parts.library.screws import METRIC
from tactcad.scenes.scene import Placement, Scene, Step

from .extent import moved_by
from .sensing_face import array_of, face_map
from .svg import svg_bytes

_SCREW = re.compile(r"ISO(4762|4026|4032)-(M[\d.]+)[x-]")
MAP = "sensing-face"  # label of the picture that shows which element stands where
_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #10161d; max-width: 62rem; margin: 2rem auto; \
padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: 0; } h2 { font-size: 1.2rem; margin: 2.5rem 0 .3rem; }
img { max-width: 100%; max-height: 34rem; display: block; margin: 1rem auto; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { text-align: left; padding: .25rem .6rem .25rem 0; border-bottom: 1px solid #d5dae0; \
vertical-align: top; }
figure { margin: 0; } figcaption { text-align: center; color: #556; font-size: .9rem; }
td.n { text-align: right; } .note { color: #556; font-size: .9rem; } .new { color: #0b62c4; }
@media print { section { break-inside: avoid; } }
"""


def page_path(scene: Scene) -> str:
    return f"guide/{scene.name}.html"


def picture_path(scene: Scene, label: str) -> str:
    return f"guide/{scene.name}-{label}.svg"


def exploded(scene: Scene) -> tuple[Placement, ...]:
    """Every part moved out by its step."""
    moved = {p.designator: p for step in scene.steps for p in _coming(scene, step)}
    return tuple(moved[p.designator] for p in scene.placements)


def at_step(scene: Scene, number: int) -> tuple[tuple[Placement, ...], tuple[Placement, ...]]:
    """What stands already before step `number` (from 1), and what the step adds, still out of its place."""
    earlier = {d for step in scene.steps[: number - 1] for d in step.designators}
    standing = tuple(p for p in scene.placements if p.designator in earlier)
    return standing, _coming(scene, scene.steps[number - 1])


def _coming(scene: Scene, step: Step) -> tuple[Placement, ...]:
    placed = {p.designator: p for p in scene.placements}
    count = len(step.designators)
    ranks = ceil(count / step.fan) if step.fan else 1
    shares = [0.5 + (n // step.fan + 1) / ranks / 2 if step.fan else 1.0 for n in range(count)]
    return tuple(
        moved_by(placed[d], [share * w for w in step.explode]) for d, share in zip(step.designators, shares)
    )


def torque(part: Part, design: Design) -> float | None:
    """Tightening torque of a cap screw, nut or set screw, N m; None for other parts, 0 for a set screw that
    only touches."""
    match = _SCREW.match(part.part_no)
    if not match:
        return None
    return seating.torque(Layout(design)) if match[1] == "4026" else METRIC[match[2]].torque


def tools(design: Design, scene: Scene) -> list[str]:
    """What the steps need: drivers of the screws and nuts that they place, torques, and their other tools."""
    ready = {d for step in scene.steps for d in step.ready}
    drivers: dict[tuple[str, float], list[str]] = {}
    torques: dict[float, None] = {}
    for part in {p.part.part_no: p.part for p in scene.placements if p.designator not in ready}.values():
        if match := _SCREW.match(part.part_no):
            m = METRIC[match[2]]
            sizes = {
                "4762": ("hex key", m.key),
                "4026": ("hex key", m.set_key),
                "4032": ("two spanners", m.nut),
            }
            threads = drivers.setdefault(sizes[match[1]], [])
            kind = {"4762": "cap screws", "4026": "set screws", "4032": "nuts"}[match[1]]
            if f"{match[2]} {kind}" not in threads:
                threads.append(f"{match[2]} {kind}")
            if tight := torque(part, design):
                torques[tight] = None
    lines = [f"{kind} {size:g} mm: {', '.join(whose)}" for (kind, size), whose in sorted(drivers.items())]
    if torques:
        lines.append(f"torque driver for {', '.join(f'{t:g}' for t in sorted(torques))} N m, with these bits")
    return [*lines, *dict.fromkeys(tool for step in scene.steps for tool in step.tools)]


def sensing_face_map(scene: Scene) -> bytes | None:
    """The map of the array's elements as SVG, where a step of the scene handles them."""
    array = array_of(scene)
    if array is None or not any(step.elements for step in scene.steps):
        return None
    return svg_bytes(face_map(array, f"{scene.name}-{MAP}"))


def page(design: Design, scene: Scene) -> bytes:
    """The guide as one HTML page; its pictures lie beside it."""
    d = design.design
    title = f"{d.title}: {scene.name}"
    body = [
        f"<h1>{escape(title)}</h1>",
        f'<p class="note">Assembly guide, revision {escape(d.revision)}, {escape(d.date)}'
        + (f", {escape(d.organisation)}" if d.organisation else "")
        + ". Made from the scene; parts as in its bill of materials.</p>",
        f'<img src="{_name(scene, "exploded")}" alt="exploded view">',
        _list("Tools", tools(design, scene)),
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
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        + "\n".join(body)
        + "\n</body>\n</html>\n"
    ).encode()


def _list(title: str, lines: Iterable[str]) -> str:
    return (
        f"<section><h2>{title}</h2><ul>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul></section>"
    )


def _section(design: Design, scene: Scene, number: int, step: Step) -> str:
    lines = [f"<section><h2>{number}. {escape(step.title)}</h2>", f"<p>{escape(step.text)}</p>"]
    if step.designators:
        lines += [
            _table(design, scene, step),
            f'<img src="{_name(scene, f"{number:02d}")}" alt="step {number}; blue: the parts of this step">',
        ]
    if step.elements:
        lines.append(
            f'<figure><img src="{_name(scene, MAP)}" alt="where each element stands">'
            "<figcaption>Where each element stands: the sensing face, pads towards you.</figcaption></figure>"
        )
    return "\n".join([*lines, "</section>"])


def _table(design: Design, scene: Scene, step: Step) -> str:
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
