"""The files of an export: for each what it is made from, and how it is made and checked.

Nothing here runs until a file is needed: the kernel is imported inside the makers.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.parts.description import NOT_MADE, Extrusion, ModelFile, Part, Revolution
from tactcad.scenes import make_scene
from tactcad.scenes.scene import Placement, Scene
from tactcad.solids.meshing import Meshing

from .cache import Cache
from .contents import sha256_of
from .formats import PART_FORMATS, PartFormat
from .inputs import digest
from .shapes import Shapes, picture_bytes
from .step_text import Header

if TYPE_CHECKING:
    from tactcad.drawing.engine.workers import Named, Written


@dataclass(frozen=True)
class Output:
    """One file of an export: path below its folder, kind and part number for the manifest, what it depends
    on, and the function that makes its bytes and has checked them."""

    path: str
    kind: str
    part_no: str
    key: str
    make: Callable[[], bytes]


def header(design: Design, name: str, description: str) -> Header:
    d = design.design
    return Header(name, description, d.revision, d.date, d.author or "", d.organisation or "")


def part_products(design: Design, part: Part, shapes: Shapes) -> list[Output]:
    """A file of every format that the part has one in (formats.py)."""
    head = header(design, part.part_no, part.name)

    def product(form: PartFormat) -> Output:
        path = form.path.format(part_no=part.part_no, revision=head.revision)
        key = digest((form.kind, shapes.made_by, part, head))
        return Output(path, form.kind, part.part_no, key, partial(form.make, part, shapes, head))

    return [product(form) for form in PART_FORMATS if form.has(part)]


def mesh_products(design: Design, parts: Sequence[Part], shapes: Shapes, meshing: Meshing) -> list[Output]:
    """The mesh of every part made here, as STL."""
    revision = design.design.revision
    return [
        Output(
            f"stl/{part.part_no}_{revision}.stl",
            "stl",
            part.part_no,
            digest(("stl", shapes.made_by, part, meshing)),
            partial(_stl, part, shapes, meshing),
        )
        for part in parts
        if not part.bought
    ]


def _stl(part: Part, shapes: Shapes, meshing: Meshing) -> bytes:
    from .stl import part_stl

    return part_stl(part.part_no, shapes.of(part), meshing)


def scene_products(design: Design, scene: Scene, shapes: Shapes) -> list[Output]:
    """The assembly as STEP, and its pictures: from above, from below, and opened."""
    name = f"{design.name}-{scene.name}"
    revision = design.design.revision
    head = header(design, name, f"{design.design.title}: {scene.name}")
    products = [
        Output(
            f"step/{name}_{revision}.step",
            "step-assembly",
            "",
            digest(("step-assembly", shapes.made_by, scene, head)),
            lambda: _scene_step(scene, shapes, head),
        )
    ]
    opened = tuple(p for p in scene.placements if p.designator not in scene.cover)
    for label, view, placements in (
        ("above", "above", scene.placements),
        ("below", "below", scene.placements),
        ("open", "above", opened),
    ):
        seen = "cover taken off" if label == "open" else f"from {label}"
        text = f"{design.design.title}: {scene.name}, {seen}"
        products.append(
            Output(
                f"pictures/{name}-{label}.svg",
                "picture",
                "",
                digest(("picture", shapes.made_by, placements, view, text, head)),
                partial(picture_bytes, placements, view, shapes, text, f"{name} revision {revision}"),
            )
        )
    return products


def stack_products(design: Design, names: Sequence[str], shapes: Shapes) -> list[Output]:
    """How the limits of all parts add up: a table, a page with bars, and what to measure on which part of the
    scenes named; from one run of virtual builds. Envelopes and poses have no limits of their own."""
    scenes = [make_scene(design, name) for name in names]

    @cache
    def run() -> tuple[bytes, bytes, bytes]:
        from tactcad.assembly.stack import stack_bytes
        from tactcad.assembly.stack_page import stack_page
        from tactcad.assembly.virtual_build import sensor

        from . import part_inspection

        made = sensor(design, scenes)
        lines = made.stack()
        title = f"{design.design.title}, revision {design.design.revision}"
        parts = (p for scene in scenes for p in scene.parts)
        measured = part_inspection.part_inspection_bytes(design, parts, made.variables, lines)
        return stack_bytes(lines), stack_page(title, made.built(1000), lines), measured

    made_by = digest(("stack", shapes.made_by, design, scenes))
    return [
        Output("stack.csv", "report", "", digest((made_by, "csv")), lambda: run()[0]),
        Output("stack.html", "report", "", digest((made_by, "html")), lambda: run()[1]),
        Output("inspection-parts.csv", "report", "", digest((made_by, "parts")), lambda: run()[2]),
    ]


def circuit_products(design: Design, shapes: Shapes) -> list[Output]:
    """The circuit that reads the array: its netlist in three forms, and the leads to cut."""
    from tactcad.circuit.bridges import netlist
    from tactcad.parts.layout import Layout

    from . import circuit_files as files

    stem = f"circuit/{design.name}-circuit_{design.design.revision}"
    circuit = netlist(Layout(design))
    key = digest(("circuit", shapes.made_by, circuit, design.design))
    return [
        Output(path, kind, "", f"{key} {path}", partial(make, design, circuit))
        for path, kind, make in (
            (f"{stem}.net", "netlist", files.kicad_file),
            (f"{stem}.csv", "netlist", files.table_file),
            (f"{stem}.cir", "netlist", files.deck_file),
            (f"circuit/{design.name}-wiring_{design.design.revision}.csv", "wiring", files.wiring_file),
        )
    ]


def guide_products(design: Design, scene: Scene, shapes: Shapes) -> list[Output]:
    """The scene's assembly guide: an exploded view, a picture a step, and the page that shows them."""
    from tactcad.drawing import guide

    if not scene.steps:
        return []
    name, revision = f"{design.name}-{scene.name}", design.design.revision
    description = f"{name} revision {revision}"

    def picture(
        label: str, title: str, placements: Sequence[Placement], marked: Sequence[Placement]
    ) -> Output:
        key = digest(("guide picture", shapes.made_by, placements, marked, title, description))
        make = partial(picture_bytes, placements, "above", shapes, title, description, marked)
        return Output(guide.picture_path(scene, label), "picture", "", key, make)

    products = [
        picture("exploded", f"{design.design.title}: {scene.name}, exploded", guide.exploded(scene), ())
    ]
    for n, step in enumerate(scene.steps, start=1):
        if step.designators:
            standing, coming = guide.at_step(scene, n)
            products.append(
                picture(f"{n:02d}", f"{scene.name}, step {n}: {step.title}", (*standing, *coming), coming)
            )
    if face := guide.sensing_face_map(scene):
        path = guide.picture_path(scene, guide.MAP)
        products.append(Output(path, "picture", "", digest(("guide map", face)), lambda: face))
    page = guide.page(design, scene)
    products.append(Output(guide.page_path(scene), "report", "", digest(("guide", page)), lambda: page))
    return products


@dataclass(frozen=True)
class _Wanted:
    """A drawing to make: its file's name, the part that it shows ("" for a scene), what it depends on, its
    order.
    """

    stem: str
    part_no: str
    key: str
    order: Callable[[], Named]


def drawing_products(
    design: Design,
    parts: Sequence[Part],
    shapes: Shapes,
    products: Sequence[Output],
    say: Callable[[int, int, str], None],
    draft: bool = False,
    sample: bool = False,
) -> list[Output]:
    """A sheet for every part made here, as PDF and SVG; `products` hold the files that the sheets name."""
    from tactcad.drawing.engine.fonts import font_file
    from tactcad.drawing.parts.part_sheet import MadeFrom, Order, written

    font_file()  # a missing font is reported before anything is made
    sources = {(p.part_no, p.kind): p for p in products}
    revision = design.design.revision
    common = (design.design, design.tolerance, design.holes, draft, sample)

    def order(part: Part, files: Sequence[Output]) -> Order:
        from tactcad.solids.bytes import to_bytes

        made_from = [MadeFrom(f.path, sha256_of(shapes.cache.get_or_make(f.key, f.make))) for f in files]
        return Order(design, part, to_bytes(shapes.of(part)), tuple(made_from), draft, sample)

    wanted = []
    for part in parts:
        if part.process not in NOT_MADE:
            files = _made_from(part, sources)
            key = digest(("drawing", shapes.made_by, part, [f.key for f in files], *common))
            wanted.append(
                _Wanted(f"{part.part_no}_{revision}", part.part_no, key, partial(order, part, files))
            )
    return _drawn(wanted, written, shapes, say)


def assembly_products(
    design: Design,
    scenes: Sequence[Scene],
    shapes: Shapes,
    say: Callable[[int, int, str], None],
    draft: bool = False,
    sample: bool = False,
) -> list[Output]:
    """An assembly drawing of every scene, as PDF and SVG."""
    from tactcad.drawing.assemblies.assembly_sheets import AssemblyOrder, assembly_written
    from tactcad.scenes.bom import bom_rows

    revision, common = design.design.revision, (design.design, design.tolerance, draft, sample)

    def order(scene: Scene) -> AssemblyOrder:
        from tactcad.solids.bytes import to_bytes

        solids = {part.part_no: to_bytes(shapes.of(part)) for part in scene.parts}
        return AssemblyOrder(design, scene, bom_rows(scene, revision, {}), solids, draft, sample)

    wanted = []
    for scene in scenes:
        key = digest(("assembly drawing", shapes.made_by, scene, *common))
        wanted.append(_Wanted(f"{design.name}-{scene.name}_{revision}", "", key, partial(order, scene)))
    return _drawn(wanted, assembly_written, shapes, say)


def circuit_drawing(
    design: Design,
    shapes: Shapes,
    say: Callable[[int, int, str], None],
    draft: bool = False,
    sample: bool = False,
) -> list[Output]:
    """The circuit's sheets, as PDF and SVG."""
    from tactcad.drawing.circuit.circuit_sheets import CircuitOrder, circuit_written

    stem = f"{design.name}-circuit_{design.design.revision}"
    key = digest(("circuit drawing", shapes.made_by, design, draft, sample))
    return _drawn(
        [_Wanted(stem, "", key, lambda: CircuitOrder(design, draft, sample))], circuit_written, shapes, say
    )


def _drawn(
    wanted: Sequence[_Wanted],
    make: Callable[..., Written],
    shapes: Shapes,
    say: Callable[[int, int, str], None],
) -> list[Output]:
    """Both files of each drawing. The first one that is needed makes all that the cache does not hold, in
    parallel.
    """
    from tactcad.drawing.engine.workers import all_written

    endings = ("pdf", "svg")
    drawn: dict[str, Written] = {}

    def made(key: str, ending: str) -> bytes:
        if not drawn:
            missing = [w for w in wanted if any(shapes.cache.get(f"{w.key} {e}") is None for e in endings)]
            drawn.update(zip((w.key for w in missing), all_written([w.order() for w in missing], make, say)))
        return getattr(drawn[key], ending)

    return [
        Output(f"drawings/{w.stem}.{e}", "drawing", w.part_no, f"{w.key} {e}", partial(made, w.key, e))
        for w in wanted
        for e in endings
    ]


def _made_from(part: Part, sources: Mapping[tuple[str, str], Output]) -> list[Output]:
    """The files that a shop makes the part from: wire-cut parts from the DXF alone, others from the model,
    and their blank from the DXF where there is one."""
    kinds = ("dxf",) if part.process == "wire-cut" else ("step-part", "dxf")
    return [sources[part.part_no, kind] for kind in kinds if (part.part_no, kind) in sources]


def part_facts(part: Part, shapes: Shapes, cache: Cache) -> dict:
    """What the kernel measures on a part (mm): surface area, volume, centre, box; compared with the closed
    forms."""
    key = f"facts {shapes.made_by} {digest(part)}"
    return json.loads(cache.get_or_make(key, lambda: json.dumps(_measured(part, shapes)).encode()))


def _measured(part: Part, shapes: Shapes) -> dict:
    from tactcad.solids.measure import measure

    facts = measure(shapes.of(part))
    if not isinstance(part.body, ModelFile):
        off = max(abs(a - b) for a, b in zip(facts["centre"], part.centre))
        if off > 1e-6:
            raise CheckFailure(f"{part.part_no}: centre of mass is {off:.3g} mm from the description's")
        if isinstance(part.body, Extrusion | Revolution):
            _compare_box(part, facts["box"])
    return facts


def _compare_box(part: Part, box: Sequence[Sequence[float]]) -> None:
    from tactcad.drawing.engine.extent import part_box

    off = max(abs(a - b) for got, meant in zip(box, part_box(part)) for a, b in zip(got, meant))
    if off > 1e-6:
        raise CheckFailure(f"{part.part_no}: bounding box is {off:.3g} mm from the description's")


def _scene_step(scene: Scene, shapes: Shapes, head: Header) -> bytes:
    from .step_file import scene_step

    return scene_step(scene, {part.part_no: shapes.of(part) for part in scene.parts}, head)
