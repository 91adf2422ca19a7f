"""Models with limits: read as text by a parser of our own, whose faces are looked for in the description."""

from __future__ import annotations

import faulthandler
import os
import re
import signal
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from part21 import Text
from variants import FACING_ROWS, variant

from tactcad.contour import rectangle
from tactcad.design.messages import CheckFailure
from tactcad.export import step_pmi
from tactcad.export.formats import has_limits, part_formats
from tactcad.export.step_text import Header
from tactcad.export.workers import Task, side_by_side
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, Pocket, Revolution
from tactcad.parts.language.limits import FACES, DatumFeature, Geometric, within
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names

pytestmark = pytest.mark.cad

HEADER = Header("part", "a part", "B", "2026-11-22", "author", "organisation")
DESIGNS = [*FACING_ROWS, "jaw-array"]  # the other planar design has parts of the same functions
SYMBOLS = ("POSITION", "FLATNESS", "PARALLELISM", "PERPENDICULARITY")


class Limits(Text):
    """Dimensions, tolerances and datums in a file, along the references between its entities."""

    def words(self, n: int) -> list[str]:
        return [word.replace("''", "'") for word in super().words(n)]

    def args(self, n: int, kind: str) -> str:
        """What stands in the brackets of that kind, alone or within a complex entity."""
        return re.search(rf"(?<![A-Z_]){kind}\(((?:'(?:[^']|'')*'|\([^()]*\)|[^()])*)\)", self.entities[n])[1]

    def all(self, kind: str) -> list[int]:
        return [n for n, line in self.entities.items() if re.search(rf"(?<![A-Z_]){kind}\(", line)]

    def length(self, n: int) -> float:
        """A measure in mm."""
        unit = self.references(n)[-1]
        assert re.search(r"SI_UNIT\((\.MILLI\.|\$),\.METRE\.\)", self.entities[unit]), "no length"
        value = re.search(r"LENGTH_MEASURE\(([-+.\dE]+)\)", self.entities[n])[1]
        return float(value) * (1.0 if ".MILLI." in self.entities[unit] else 1000.0)

    def dimensions(self) -> dict[str, dict]:
        """Name -> kind, numbers in mm, note, and the faces of each side."""
        bounds = {}
        for n in self.all("PLUS_MINUS_TOLERANCE"):
            value, dimension = self.references(n)
            bounds[dimension] = [self.length(m) for m in self.references(value)]
        found = {}
        for n in self.all("DIMENSIONAL_CHARACTERISTIC_REPRESENTATION"):
            dimension, shown = self.references(n)
            items = self.references(shown)[:-1]
            record = {self.words(m)[-1]: self.length(m) for m in items if "MEASURE" in self.entities[m]}
            (note,) = (self.words(m) for m in items if m in self.of("DESCRIPTIVE_REPRESENTATION_ITEM"))
            assert note[0] == "dimensional note"
            if dimension in bounds:
                low, high = bounds[dimension]
                record |= {"lower limit": record["nominal value"] + low}
                record |= {"upper limit": record["nominal value"] + high}
            kind = self.words(dimension)[0]
            sides = [self.faces(m) for m in self.references(dimension)]
            name = self.words(self.references(dimension)[0])[0]
            assert name not in found
            found[name] = record | {"kind": kind, "note": note[1], "sides": sides}
        return found

    def tolerances(self) -> dict[str, tuple]:
        """Name -> symbol, zone in mm, whether it is round, letters of its datums, faces."""
        forms = {}
        for n in self.all("TOLERANCE_ZONE"):
            tolerance, form = self.references(n)[-2:]
            forms[tolerance] = self.words(form)[0]
        found = {}
        for symbol in SYMBOLS:
            for n in self.all(f"{symbol}_TOLERANCE"):
                simple = self.entities[n].startswith(symbol)
                args = self.args(n, f"{symbol}_TOLERANCE" if simple else "GEOMETRIC_TOLERANCE")
                zone, aspect = (int(r) for r in re.findall(r"#(\d+)", args))
                letters = () if simple else self.letters(n)
                rounded = forms.get(n) == "cylindrical or circular"
                name = self.words(aspect)[0]
                assert name not in found
                found[name] = (symbol.lower(), self.length(zone), rounded, letters, self.faces(aspect))
        return found

    def letters(self, n: int) -> tuple[str, ...]:
        args = self.args(n, "GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE")
        (system,) = (int(r) for r in re.findall(r"#(\d+)", args))
        compartments = re.findall(r"#(\d+)", self.args(system, "DATUM_SYSTEM").partition("(")[2])
        return tuple(self.words(self.references(int(c))[-1])[-1] for c in compartments)

    def datums(self) -> dict[str, list[int]]:
        """Letter -> its faces."""
        found = {}
        for n in self.of("DATUM"):
            (feature,) = (a for a, b in self.related() if b == n)
            assert "DATUM_FEATURE" in self.entities[feature]
            found[self.words(n)[-1]] = self.faces(feature)
        return found

    def related(self) -> list[tuple[int, int]]:
        return [tuple(self.references(n)) for n in self.of("SHAPE_ASPECT_RELATIONSHIP")]

    def faces(self, aspect: int) -> list[int]:
        """Faces of a shape aspect, or of all that a composite one consists of."""
        parts = [b for a, b in self.related() if a == aspect and b not in self.of("DATUM")]
        uses = [self.references(n) for n in self.of("GEOMETRIC_ITEM_SPECIFIC_USAGE")]
        own = [face for one, _, face in uses if one == aspect]
        return own + [face for part in parts for face in self.faces(part)]

    def surface(self, face: int) -> tuple[str, np.ndarray, float]:
        """Kind of a face's surface, its 4 x 4 axes, and its radius."""
        surface = self.references(face)[-1]
        kind = self.entities[surface].partition("(")[0]
        return kind, self.axes(self.references(surface)[0]), (self.numbers(surface) or [0.0])[-1]


def lies_on(text: Limits, face: int, part: Part, feature: str) -> bool:
    """Whether a face lies on a feature of the description: a plane through the ends of an edge, a pocket's
    floor, a cylinder about a hole's axis or an arc's centre."""
    kind, axes, radius = text.surface(face)
    at, z, body = axes[:3, 3], axes[:3, 2], part.extrusion

    def through(*points) -> bool:
        return kind == "PLANE" and all(abs(z @ (np.array(p) - at)) < 1e-7 for p in points)

    def about(point, axis, r) -> bool:
        away = np.cross(np.array(point) - at, axis)
        same = np.linalg.norm(np.cross(z, axis)) < 1e-9 and np.linalg.norm(away) < 1e-7
        return kind == "CYLINDRICAL_SURFACE" and same and abs(radius - r) < 1e-7

    if feature in FACES:
        level = body.thickness * FACES.index(feature)
        return through((0, 0, level), (1, 0, level), (0, 1, level))
    edges = [s for c in (body.outer, *body.openings) for s in c if s.name == feature]
    for f in part.features:
        if isinstance(f, Hole) and f.name == feature and about(f.at, f.axis, f.diameter / 2):
            return True
        if not isinstance(f, Hole):  # its frame is the part's: tip-flat
            floor = np.array(f.at) + f.depth * np.array(f.axis)
            if f.name == feature and through(floor, floor + f.x_axis, floor + np.cross(f.axis, f.x_axis)):
                return True
            edges += [s for c in f.island for s in c if f"{f.name} {s.name}" == feature]
    for s in edges:
        if hasattr(s, "centre"):
            if about((*s.centre, 0), (0, 0, 1), s.radius):
                return True
        elif through((*s.start, 0), (*s.end, 0), (*s.start, 1)):
            return True
    return False


def nearest(nominal: float, face: tuple, others: list[tuple]) -> tuple[float, float]:
    """The distance to a face parallel to this one, mm, that is nearest the nominal one, and how far off."""
    (_, here, _), n = face, face[1][:3, 2]
    across = [abs(n @ (a[:3, 3] - here[:3, 3])) for _, a, _ in others if abs(n @ a[:3, 2]) > 1 - 1e-9]
    return min(((d, abs(d - nominal)) for d in across), key=lambda found: found[1])


def measured(text: Limits, record: dict) -> float:
    """What the faces themselves measure, mm: a diameter, a radius, or the distance of planes and axes."""
    first, *second = ([text.surface(f) for f in side] for side in record["sides"])
    if not second:
        (r,) = {round(radius, 9) for _, _, radius in first}
        return 2 * r if record["kind"] == "diameter" else r
    points = [np.mean([axes[:3, 3] for _, axes, _ in side], axis=0) for side in (first, second[0])]
    normals = [axes[:3, 2] for kind, axes, _ in (*first, *second[0]) if kind == "PLANE"]
    if min(len(first), len(second[0])) > 1:  # a cell's beams, turned and repeated: the worst face
        found = (nearest(record["nominal value"], face, second[0]) for face in first)
        return max(found, key=lambda pair: pair[1])[0]
    assert all(np.linalg.norm(np.cross(normals[0], n)) < 1e-9 for n in normals)
    return abs(normals[0] @ (points[1] - points[0]))


def holds(part: Part, data: bytes) -> None:
    """Assert that the file says what the part says: values, limits, datums, and the faces they stand on."""
    text = Limits(data)
    dimensions = text.dimensions()
    assert set(dimensions) == {c.name for c in part.characteristics}
    for c in part.characteristics:
        record = dimensions[c.name]
        got = record["lower limit"], record["upper limit"]
        assert got == pytest.approx((c.lower, c.upper), rel=0, abs=1e-9), c
        if c.lower <= c.nominal <= c.upper:
            assert record["nominal value"] == pytest.approx(c.nominal, rel=0, abs=1e-9), c
        else:
            assert f"nominal {c.nominal:g}" in record["note"]
        assert record["note"].startswith(c.name) and ("key characteristic" in record["note"]) == c.key
        faces = {f for side in record["sides"] for f in side}
        assert all(any(lies_on(text, f, part, name) for name in c.between) for f in faces), c
        assert all(any(lies_on(text, f, part, name) for f in faces) for name in c.between), c
        if record["kind"] != "diameter":
            assert measured(text, record) == pytest.approx(c.nominal, rel=0, abs=1e-6), c
    tolerances = text.tolerances()
    assert set(tolerances) == {g.name for g in part.geometric}
    for g in part.geometric:
        symbol, zone, rounded, letters, faces = tolerances[g.name]
        assert (symbol, rounded, letters) == (g.symbol, g.round, g.datums)
        assert zone == pytest.approx(g.zone, rel=0, abs=1e-9)
        assert all(any(lies_on(text, f, part, name) for name in g.features) for f in faces)
        openings = [c.segments[0] for c in getattr(part.body, "openings", ())]
        holes = [f for f in (*part.features, *openings) if f.name in g.features]
        assert len(faces) == (len(holes) or len(g.features)) == len(set(faces))
    datums = text.datums()
    assert set(datums) == {d.letter for d in part.datums}
    for d in part.datums:
        assert datums[d.letter] and all(lies_on(text, f, part, d.feature) for f in datums[d.letter])


def model(part: Part) -> bytes:
    from tactcad.solids.build import build
    from tactcad.solids.step import to_bytes

    return step_pmi.part_step_pmi(part, to_bytes(build(part)), HEADER)


def of_scene(scene, ending: str) -> Part:
    return next(p for p in scene.parts if p.part_no.endswith(ending))


@pytest.mark.parametrize("ending", ["element-a4mm", "end-plate-head", "end-plate-tapped", "stop-plate"])
def test_a_model_says_what_the_part_says(macro_scene, ending):
    part = of_scene(macro_scene, ending)
    data = model(part)
    assert b"AP242_MANAGED_MODEL_BASED_3D_ENGINEERING" in data
    assert b"RUNOUT" not in data and not re.search(rb"MEASURE_WITH_UNIT\([-+.\d]", data)
    holds(part, data)


@pytest.mark.nightly
@pytest.mark.parametrize("name", DESIGNS)
def test_every_made_part_of_every_design(name):
    design = load(name)
    parts = {p.part_no: p for s in scene_names(design) for p in make_scene(design, s).parts}
    stated = [p for p in parts.values() if has_limits(p) and not isinstance(p.body, Revolution)]
    assert len(stated) > 5
    for part in stated:
        holds(part, model(part))


@pytest.mark.parametrize("sides", ["one", "two"])
def test_a_full_round_stands_for_the_floor_that_it_used_up(sides):
    scene = make_scene(variant({"element.hinge_length": 0.6, "element.sides": sides}), "array")
    part = of_scene(scene, "element-a4mm")
    assert "slot_floor" not in {s.name for s in part.extrusion.outer}
    record = Limits(model(part)).dimensions()["hinge thickness"]
    assert len(record["sides"]) == 2 and all(record["sides"])


def plate(**stated) -> Part:
    hole = Hole("bore", (3, 2, 0), (0, 0, 1), 2.0, 5.0, True)
    body = Extrusion(rectangle(0, 0, 10, 8), 5.0)
    return Part(
        "P-1", "Plate", "milled", Material("steel", 7850), body, (hole, replace(hole, at=(7, 2, 0))), **stated
    )


@pytest.mark.parametrize(
    "stated",
    [
        {"geometric": (Geometric("flat", "flatness", 0.02, (FACES[0],)),)},
        {
            "geometric": (Geometric("bores", "position", 0.05, ("bore",), ("A", "B"), True),),
            "datums": (DatumFeature("B", "left edge"), DatumFeature("A", FACES[1])),
        },
        {"datums": (DatumFeature("A", "bore"),)},
        {
            "characteristics": (within("bores apart", 4, 0.1, between=("bore", "bore")),),
            "geometric": (
                Geometric("upper", "parallelism", 0.02, ("upper edge",), ("A",)),
                Geometric("left", "perpendicularity", 0.03, ("left edge",), ("A",)),
            ),
            "datums": (DatumFeature("A", "lower edge"),),
        },
    ],
    ids=["no dimension", "datums out of order", "datum alone", "two that share a datum"],
)
def test_any_set_of_limits(stated):
    """Without a dimension the kernel writes zones in metres; lone datums it does not read."""
    part = plate(**stated)
    if not part.characteristics:
        holds(part, model(part))
        return
    data = model(part)
    record = Limits(data).dimensions()["bores apart"]
    assert len({f for side in record["sides"] for f in side}) == 2
    assert {n: t[:4] for n, t in Limits(data).tolerances().items()} == {
        "upper": ("parallelism", 0.02, False, ("A",)),
        "left": ("perpendicularity", 0.03, False, ("A",)),
    }


@pytest.mark.parametrize(
    ("between", "said"),
    [
        (
            ("left edge", "right edge"),
            "width of 9 mm refers to left edge and right edge, which has no such size",
        ),
        (("left edge", "upper edge"), "no such size"),
        (("left edge",), "refers to left edge, which has no such size"),
        ((), "refers to no feature"),
    ],
)
def test_a_dimension_that_its_features_do_not_have_is_refused(between, said):
    with pytest.raises(CheckFailure, match=f"P-1: .*{said}"):
        model(plate(characteristics=(within("width", 9, 0.1, between=between),)))


def test_a_feature_that_is_cut_away_is_refused():
    width = plate(characteristics=(within("length", 10, 0.1, between=("left edge", "right edge")),))
    away = Pocket("step", (0, 0, 5), (0, 0, -1), (1, 0, 0), rectangle(0, -8, 1, 0), 5.0)
    with pytest.raises(CheckFailure, match="P-1: length refers to a face that the solid does not have"):
        model(replace(width, features=(*width.features, away)))


TAMPERED = {
    "a limit": lambda d: d.replace(b"LENGTH_MEASURE(0.1)", b"LENGTH_MEASURE(0.2)"),
    "a nominal size": lambda d: d.replace(b"POSITIVE_LENGTH_MEASURE(10.)", b"POSITIVE_LENGTH_MEASURE(11.)"),
    "a zone": lambda d: d.replace(b"LENGTH_MEASURE(5.E-02)", b"LENGTH_MEASURE(6.E-02)"),
    "a datum's letter": lambda d: d.replace(b",.F.,'A')", b",.F.,'C')"),
    "the part": lambda d: d.replace(b"PRODUCT('P-1','P-1'", b"PRODUCT('P-2','P-2'"),
    "a symbol": lambda d: d.replace(b"POSITION_TOLERANCE", b"PARALLELISM_TOLERANCE"),
    "a face": lambda d: re.sub(
        rb"(GEOMETRIC_ITEM_SPECIFIC_USAGE\('length','',#\d+,#\d+,)#\d+", rb"\1" + _a_face(d), d, count=1
    ),
}


def _a_face(data: bytes) -> bytes:
    """A face that no dimension stands on: the last one, a bore's."""
    return b"#" + re.findall(rb"#(\d+)=ADVANCED_FACE", data)[-1]


@pytest.mark.parametrize("what", [None, *TAMPERED])
def test_a_model_that_reads_back_otherwise_is_refused(what, monkeypatch):
    part = plate(
        characteristics=(within("length", 10, 0.1, between=("left edge", "right edge")),),
        geometric=(Geometric("bores", "position", 0.05, ("bore",), ("A",), True),),
        datums=(DatumFeature("A", FACES[0]),),
    )
    if what is None:
        holds(part, model(part))
        return
    write = step_pmi.written

    def tampered(*arguments) -> bytes:
        data = write(*arguments)
        assert TAMPERED[what](data) != data
        return TAMPERED[what](data)

    monkeypatch.setattr(step_pmi, "written", tampered)
    with pytest.raises(CheckFailure, match="P-1: "):
        model(part)


def test_a_limit_too_many_is_refused(monkeypatch):
    read = step_pmi._annotations
    monkeypatch.setattr(step_pmi, "_annotations", lambda document: read(document) * 2)
    with pytest.raises(CheckFailure, match="P-1: the AP242 model has 1 limits too many"):
        model(plate(characteristics=(within("thickness", 5, 0.1, between=FACES),)))


def test_a_lone_datum_of_another_letter_is_refused(monkeypatch):
    write = step_pmi.written
    monkeypatch.setattr(step_pmi, "written", lambda *a: write(*a).replace(b",.F.,'A')", b",.F.,'C')"))
    with pytest.raises(CheckFailure, match="P-1: .* datums C instead of A"):
        model(plate(datums=(DatumFeature("A", "bore"),)))


def crash(*_) -> bytes:
    faulthandler.disable()  # no report of what is meant to happen
    os.kill(os.getpid(), signal.SIGSEGV)
    return b""


def test_a_crash_of_the_kernel_is_reported_with_the_file(monkeypatch):
    from tactcad.solids.build import build
    from tactcad.solids.occt import end_threads
    from tactcad.solids.step import to_bytes

    class Built:
        def text_of(self, part):
            return to_bytes(build(part))

    monkeypatch.setattr(step_pmi, "part_step_pmi", crash)
    (form,) = (f for f in part_formats() if f.kind == "step-pmi")
    part = plate(datums=(DatumFeature("A", "bore"),))
    task = Task("step/P-1_A-ap242.step", partial(form.make, part, Built(), HEADER, ()))
    end_threads()  # as the export does: a fork waits for ever for those that earlier tests started
    with pytest.raises(CheckFailure, match=r"step/P-1_A-ap242.step: the process .* crashed"):
        list(side_by_side([task]))
    assert form.has(part) and not form.has(plate()) and not form.has(replace(part, process="bought"))
