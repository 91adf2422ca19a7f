"""The files of an export, kind by kind: what each is made from, and how it is made and checked.

Every kind is a function from a `Plan` to jobs, marked with @product and its option. Nothing runs until a file
is needed: its modules are imported then.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.parts.language.description import NOT_MADE, Extrusion, ModelFile, Part, Revolution
from tactcad.scenes import make_scene
from tactcad.scenes.rig import ARRAY
from tactcad.scenes.scene import Placement, Scene

from .formats import ExportOptions, PartFormat, part_formats
from .inputs import digest
from .manifest import sha256_of
from .shapes import Shapes, picture_bytes
from .step_text import Header

if TYPE_CHECKING:
    from tactcad.drawing.engine.sheet_files import Written

# The order: parts' files need solids, and sheets need parts' files, whose digests they state.
SOLIDS, FILES, SHEETS = range(3)


@dataclass(frozen=True)
class Output:
    """One file of an export: path below its folder, kind and part number for the manifest, and its
    dependencies."""

    path: str
    kind: str
    part_no: str
    key: str


@dataclass(frozen=True)
class Batch:
    """Files made together, and the function that makes and checks their bytes. `size`: rough duration
    relative to others of its turn; long ones start first."""

    files: tuple[Output, ...]
    make: Callable[[], Sequence[bytes]]
    turn: int = FILES
    size: int = 0


@dataclass(frozen=True)
class Plan:
    """An export's plan: design, options, scenes at their detail, the parts' shapes."""

    design: CommonTables
    options: ExportOptions
    scenes: Sequence[Scene]
    shapes: Shapes

    @cached_property
    def parts(self) -> list[Part]:
        """Each once, in order of first placement."""
        return list({part.part_no: part for scene in self.scenes for part in scene.parts}.values())

    @property
    def revision(self) -> str:
        return self.design.design.revision

    def header(self, name: str, description: str) -> Header:
        """Header of a STEP file: of a part, the circuit boards or a scene, by its name."""
        d = self.design.design.of_part(name)
        return Header(name, description, d.revision, d.date, d.author or "", d.organisation or "")

    def jobs(self) -> list[Batch]:
        """All jobs of the options."""
        return [job for asked, jobs in PRODUCTS if asked(self) for job in jobs(self)]


Jobs = Callable[[Plan], Iterator[Batch]]
PRODUCTS: list[tuple[Callable[[Plan], bool], Jobs]] = []  # every kind of files: its option, and what makes it


def product(asked: Callable[[Plan], bool] = lambda _: True) -> Callable[[Jobs], Jobs]:
    """Marks the function of a kind of files. The manifest has kinds in the order of these functions."""

    def enter(jobs: Jobs) -> Jobs:
        PRODUCTS.append((asked, jobs))
        return jobs

    return enter


def _one(file: Output, make: Callable[[], bytes], size: int = 0) -> Batch:
    return Batch((file,), lambda: (make(),), FILES, size)


@product()
def part_files(plan: Plan) -> Iterator[Batch]:
    """A file for each of a part's formats, part by part (formats.py); optional ones come after those of every
    export."""
    forms = [(form, form.asked(plan.options)) for form in part_formats()]
    asked = [(form, settings) for form, settings in forms if settings is not None]
    for part in plan.parts:
        usual = (form for form, settings in asked if settings == () and form.has(part))
        yield from (_part_file(plan, part, form, ()) for form in usual)
    for form, settings in asked:
        if settings != ():
            yield from (_part_file(plan, part, form, settings) for part in plan.parts if form.has(part))


def _part_file(plan: Plan, part: Part, form: PartFormat, settings: object) -> Batch:
    head, shapes = plan.header(part.part_no, part.name), plan.shapes
    path = form.path.format(part_no=part.part_no, revision=head.revision)
    key = digest((form.kind, shapes.made_by, part, head, settings))
    return _one(Output(path, form.kind, part.part_no, key), partial(form.make, part, shapes, head, settings))


@product()
def scene_files(plan: Plan) -> Iterator[Batch]:
    """Each assembly as STEP, and its pictures: from above, from below, and opened."""
    shapes, title = plan.shapes, plan.design.design.title
    for scene in plan.scenes:
        name = f"{plan.design.name}-{scene.name}"
        head = plan.header(name, f"{title}: {scene.name}")
        key = digest(("step-assembly", shapes.made_by, scene, head))
        path = f"step/{name}_{plan.revision}.step"
        many = len(scene.placements)
        yield _one(Output(path, "step-assembly", "", key), partial(_scene_step, scene, shapes, head), many)
        opened = tuple(p for p in scene.placements if p.designator not in scene.cover)
        for label, view, placements in (
            ("above", "above", scene.placements),
            ("below", "below", scene.placements),
            ("open", "above", opened),
        ):
            seen = "cover taken off" if label == "open" else f"from {label}"
            text = f"{title}: {scene.name}, {seen}"
            key = digest(("picture", shapes.made_by, placements, view, text, head))
            make = partial(picture_bytes, placements, view, shapes, text, f"{name} revision {plan.revision}")
            yield _one(Output(f"pictures/{name}-{label}.svg", "picture", "", key), make, many)


def _scene_step(scene: Scene, shapes: Shapes, head: Header) -> bytes:
    from .step_file import scene_step

    return scene_step(scene, {part.part_no: shapes.of(part) for part in scene.parts}, head)


@product()
def stack_files(plan: Plan) -> Iterator[Batch]:
    """The tolerance stack of all parts: a table, a page with bars, and the measurements on the scenes' parts;
    from one run of virtual builds. Envelopes and poses have no limits of their own."""
    design, scenes = plan.design, [make_scene(plan.design, name) for name in plan.options.scenes]

    def run() -> Sequence[bytes]:
        from tactcad.stacks.stack import stack_bytes, stack_page
        from tactcad.stacks.virtual_build import sensor

        from . import inspection

        made = sensor(design, scenes)
        lines = made.stack()
        title = f"{design.design.title}, revision {design.design.revision}"
        parts = (p for scene in scenes for p in scene.parts)
        measured = inspection.part_inspection_bytes(design, parts, made.variables, lines)
        return stack_bytes(lines), stack_page(title, made.built(1000), lines), measured

    made_by = digest(("stack", plan.shapes.made_by, design, scenes))
    files = (("stack.csv", "csv"), ("stack.html", "html"), ("inspection-parts.csv", "parts"))
    outputs = tuple(Output(path, "report", "", digest((made_by, what))) for path, what in files)
    yield Batch(outputs, run, FILES, 300)


def _read(plan: Plan) -> bool:
    """Whether it shows the array, and a circuit reads that."""
    return ARRAY in plan.options.scenes and family_of(plan.design).readout is not None


@product(_read)
def circuit_files(plan: Plan) -> Iterator[Batch]:
    """The circuit that reads the array: its netlist in three forms, and the leads to cut."""
    from tactcad.circuit.digital_readout import settings_header, settings_json

    from . import board_files as files

    design, family = plan.design, family_of(plan.design)
    circuit = family.must("readout", "export").netlist(family.layout(design))
    key = digest(("circuit", plan.shapes.made_by, circuit, design.design))
    converter = getattr(getattr(design, "readout", None), "converter", "card")
    for name, kind, make in (
        ("circuit_{}.csv", "netlist", files.table_file),
        ("circuit_{}.cir", "netlist", files.deck_file),
        ("wiring_{}.csv", "wiring", files.wiring_file),
        ("harness_{}.csv", "wiring", files.harness_file),
    ):
        path = f"circuit/{design.name}-{name.format(plan.revision)}"
        yield _one(Output(path, kind, "", f"{key} {path}"), partial(make, design, circuit))
    for ending, settings in (("h", settings_header), ("json", settings_json)) if converter != "card" else ():
        path = f"circuit/{design.name}-{converter}_{plan.revision}.{ending}"
        made_of = digest(("converter", plan.shapes.made_by, design, path))
        written = partial(settings, family.layout(design), converter)
        yield _one(Output(path, "netlist", "", made_of), written)


@product(lambda plan: ARRAY in plan.options.scenes and family_of(plan.design).boards is not None)
def board_files(plan: Plan) -> Iterator[Batch]:
    """The boards that read the array: fitted, and bare for the board maker."""
    from . import board_files as files

    design, family = plan.design, family_of(plan.design)
    layout = family.layout(design)
    boards = family.must("boards", "export")
    made, supplies = boards.made(layout), boards.supplies(layout)
    of = design.design.of_board
    key = digest(("boards", plan.shapes.made_by, made, supplies, of))

    def batch(stem: str, ends: Sequence[str], make: Callable[[], Sequence[bytes]]) -> Batch:
        paths = [f"circuit/boards/{stem}{end}" for end in ends]
        kinds = ["gerber" if "gerber/" in path else "board" for path in paths]
        outputs = (Output(path, kind, "", f"{key} {path}") for path, kind in zip(paths, kinds))
        return Batch(tuple(outputs), make, FILES, 10)

    for board in made:
        head = plan.header(of.board_no, f"{of.title}: {board.netlist.name}")
        head = replace(head, name=board.netlist.name)
        make = partial(files.files_of, board, design, supplies, plan.shapes, head)
        yield batch(f"{board.netlist.name}_{of.revision}", files.ENDS, make)
    if made:
        yield batch("", files.BARE, partial(files.bare_files, made[0], design))


@product(lambda plan: plan.options.guides)
def guide_files(plan: Plan) -> Iterator[Batch]:
    """Each scene's assembly guide: an exploded view, a picture a step, the page that shows them; and every
    move as data."""
    from tactcad.drawing import guide
    from tactcad.scenes.moves import guide_json, moments

    def picture(
        scene: Scene,
        label: str,
        title: str,
        placements: Sequence[Placement],
        marked: Sequence[Placement] = (),
        view: str = "above",
    ) -> Batch:
        description = f"{plan.design.name}-{scene.name} revision {plan.revision}"
        key = digest(("guide picture", plan.shapes.made_by, placements, marked, title, description, view))
        make = partial(picture_bytes, placements, view, plan.shapes, title, description, marked)
        path = guide.picture_path(scene, label)
        return _one(Output(path, "picture", "", key), make, len(placements))

    for scene in plan.scenes:
        if not scene.steps:
            continue
        title = f"{plan.design.design.title}: {scene.name}, exploded"
        yield picture(scene, "exploded", title, guide.exploded(scene))
        order = moments(scene)
        for n, step in enumerate(scene.steps, start=1):
            if guide.pictured(step):
                standing, coming = guide.at_step(scene, order, n)
                title = f"{scene.name}, step {n}: {step.title}"
                yield picture(scene, f"{n:02d}", title, (*standing, *coming), coming, step.view)
        if face := guide.sensing_face_map(scene):
            path = guide.picture_path(scene, guide.MAP)
            yield _one(Output(path, "picture", "", digest(("guide map", face))), partial(bytes, face))
        page = guide.page(plan.design, scene)
        key = digest(("guide", page))
        yield _one(Output(guide.page_path(scene), "report", "", key), partial(bytes, page))
        told = guide_json(scene)
        made = Output(f"guide/{scene.name}.json", "report", "", digest(("guide moves", told)))
        yield _one(made, partial(bytes, told))


@product(lambda plan: plan.options.robot)
def robot_files(plan: Plan) -> Iterator[Batch]:
    """The array for robots and their simulators."""
    yield from family_of(plan.design).must("robot", "export --robot").jobs(plan)


@product(lambda plan: plan.options.drawings)
def part_sheets(plan: Plan) -> Iterator[Batch]:
    """A sheet for every part made here, as PDF and SVG, which names the files that the part is made from."""
    from tactcad.drawing.engine.ink import font_file, refuse_letters_it_lacks

    design, shapes, options = plan.design, plan.shapes, plan.options
    identity = design.design
    names = ("title", "author", "organisation", "revision")
    refuse_letters_it_lacks({f"design.{name}": getattr(identity, name) or "" for name in names})
    font_file()  # a missing font is reported before anything is made
    known = {(job.files[0].part_no, job.files[0].kind): job for job in part_files(plan)}

    def make(part: Part, files: Sequence[Batch]) -> Written:
        from tactcad.drawing.parts import part_sheet

        def digest_of(job: Batch) -> str:
            return sha256_of(shapes.cache.get_or_make(job.files[0].key, lambda: job.make()[0]))

        made_from = tuple(part_sheet.MadeFrom(job.files[0].path, digest_of(job)) for job in files)
        shape = shapes.text_of(part)
        return part_sheet.written(
            part_sheet.Order(design, part, shape, made_from, options.draft, options.sample)
        )

    for part in plan.parts:
        if part.process in NOT_MADE:
            continue
        # parts cut by their contour are made from the DXF alone, others from the model, and their blank
        # from the DXF
        kinds = ("dxf",) if part.by_contour else ("step-part", "dxf")
        files = [known[part.part_no, kind] for kind in kinds if (part.part_no, kind) in known]
        made_from = [job.files[0].key for job in files]
        of = identity.of_part(part.part_no)
        common = (of, _tables(design, "tolerance", "holes"), options.draft, options.sample)
        key = digest(("drawing", shapes.made_by, part, made_from, *common))
        stem = f"{part.part_no}_{of.revision}"
        yield _drawing(stem, part.part_no, key, partial(make, part, files), SHEETS)


@product(lambda plan: plan.options.drawings)
def assembly_sheets(plan: Plan) -> Iterator[Batch]:
    """An assembly drawing of every scene, as PDF and SVG."""
    design, options, shapes = plan.design, plan.options, plan.shapes

    def make(scene: Scene) -> Written:
        from tactcad.drawing.assemblies import assembly_sheets as assembly
        from tactcad.scenes.bom import bom_rows
        from tactcad.solids.step import from_bytes

        rows = bom_rows(scene, design.design, {})
        solids = {part.part_no: from_bytes(shapes.text_of(part)) for part in scene.parts}
        sheets = assembly.assembly_sheets(design, scene, rows, solids, options.draft, options.sample)
        return assembly.assembly_written(sheets, design, scene, rows)

    for scene in plan.scenes:
        common = (design.design, _tables(design, "tolerance"), options.draft, options.sample)
        key = digest(("assembly drawing", shapes.made_by, scene, *common))
        stem = f"{design.name}-{scene.name}_{plan.revision}"
        yield _drawing(stem, "", key, partial(make, scene), FILES, 10 * len(scene.placements))


@product(lambda plan: plan.options.drawings and _read(plan))
def circuit_sheets(plan: Plan) -> Iterator[Batch]:
    """The circuit's sheets, as PDF and SVG."""
    draft, sample = plan.options.draft, plan.options.sample

    def make() -> Written:
        return family_of(plan.design).must("readout", "export").sheets(plan.design, draft, sample)

    key = digest(("circuit drawing", plan.shapes.made_by, plan.design, draft, sample))
    yield _drawing(f"{plan.design.name}-circuit_{plan.revision}", "", key, make, FILES, 100)


def _tables(design: CommonTables, *names: str) -> tuple:
    """The ones of these tables that the family's designs have."""
    return tuple(getattr(design, name, None) for name in names)


def _drawing(
    stem: str, part_no: str, key: str, make: Callable[[], Written], turn: int, size: int = 0
) -> Batch:
    """Both files of a drawing."""
    files = (Output(f"drawings/{stem}.{e}", "drawing", part_no, f"{key} {e}") for e in ("pdf", "svg"))
    return Batch(tuple(files), make, turn, size)


def solid(part: Part, shapes: Shapes) -> bool:
    """Leave the part's solid, and its measures, in the cache; whether it had to be built."""
    before = len(shapes.built)
    shapes.text_of(part)
    part_facts(part, shapes)
    return len(shapes.built) > before


def part_facts(part: Part, shapes: Shapes) -> dict:
    """The kernel's measurements on a part (solids/measure.py), compared with the closed forms."""
    key = f"facts {shapes.made_by} {digest(part)}"
    return json.loads(shapes.cache.get_or_make(key, lambda: json.dumps(_measured(part, shapes)).encode()))


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

    off = max(abs(a - b) for got, meant in zip(box, part.body.box) for a, b in zip(got, meant))
    if off > 1e-6:
        raise CheckFailure(f"{part.part_no}: bounding box is {off:.3g} mm from the description's")
