"""Contents of the page and of FreeCAD's document, as plain data: scenes, parts, elements with their pairs,
findings.

Parts are read off their descriptions: no kernel, no mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from math import sqrt
from typing import Any

from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.drawing.guide import exploded
from tactcad.export.kept_checks import checked
from tactcad.export.shapes import Shapes
from tactcad.lab.array_estimate import ElementEstimate
from tactcad.mechanics.ladder import DEFAULT_RUNG
from tactcad.mechanics.lumped import condition_in_ratio
from tactcad.parts.language.description import Extrusion, Part, Vector, vector
from tactcad.parts.language.finding import Finding
from tactcad.parts.language.limits import Characteristic
from tactcad.parts.language.surface import pieces
from tactcad.scenes import make_scene
from tactcad.scenes.bom import bom_rows
from tactcad.scenes.requirement import DimensionLimits
from tactcad.scenes.rig import rig_of
from tactcad.scenes.scene import Motion, Pose, Rotation, Scene
from tactcad.stacks.stack import SEED, StackLine
from tactcad.stacks.virtual_build import Builds, Sensor, sensor

# Checks of a whole scene give places in its frame; a motion's is an offset, no place; all others the part's.
IN_SCENE = ("interference", "tools", "configurations")
NO_PLACE = ("motion",)
BUILT = 1000  # arrays of each distribution, as `tactcad build` and the stack's page have


@dataclass(frozen=True)
class PlacedFact:
    """One designator: its part, place (mm; rows of its rotation), way out in the exploded view (mm), step of
    the guide (from 0), and sub-assemblies."""

    designator: str
    part_no: str
    origin: Vector
    rotation: Rotation
    way: Vector
    step: int
    under: tuple[str, ...]


@dataclass(frozen=True)
class MotionFact:
    """A declared motion: of each group its designators and the offsets (mm) that it goes from and to, and the
    scene's own place as a share of the way, None if it is not on it."""

    name: str
    ways: tuple[tuple[tuple[str, ...], Vector, Vector], ...]
    rest: float | None


@dataclass(frozen=True)
class PoseFact:
    """An element under the force sensor: for each moved group of designators the offset from rest, mm."""

    name: str
    ways: tuple[tuple[tuple[str, ...], Vector], ...]


@dataclass(frozen=True)
class SceneFacts:
    """One scene; `bill` by item, each row as the bill of materials has it."""

    name: str
    placed: tuple[PlacedFact, ...]
    steps: tuple[tuple[str, str], ...]
    motions: tuple[MotionFact, ...]
    poses: tuple[PoseFact, ...]
    cover: tuple[str, ...]
    bill: tuple[dict[str, Any], ...]


def scene_facts(design: CommonTables, scene: Scene) -> SceneFacts:
    """The facts of one scene."""
    ways = _ways(scene)
    steps = {d: n for n, step in enumerate(scene.steps) for d in step.designators}
    placed = tuple(
        PlacedFact(
            p.designator,
            p.part.part_no,
            p.origin,
            p.rotation,
            ways[p.designator],
            steps.get(p.designator, 0),
            _under(scene, p.designator),
        )
        for p in scene.placements
    )
    groups = dict(scene.groups)
    return SceneFacts(
        scene.name,
        placed,
        tuple((step.title, step.text) for step in scene.steps),
        tuple(
            MotionFact(
                m.name, tuple((tuple(sorted(groups.get(g, ()))), a, b) for g, a, b in m.ways), _rest(m)
            )
            for m in scene.motions
        ),
        tuple(_pose(design, scene, pose) for pose in rig_of(design, scene.name).under_sensor(design)),
        tuple(sorted(scene.cover)),
        tuple(asdict(row) for row in bom_rows(scene, design.design, {})),
    )


def _ways(scene: Scene) -> dict[str, Vector]:
    """Displacement in the guide's exploded view by designator, mm."""
    if not scene.steps:
        return {p.designator: (0.0, 0.0, 0.0) for p in scene.placements}
    pairs = zip(scene.placements, exploded(scene), strict=True)
    return {p.designator: vector(round(b - a, 9) for a, b in zip(p.origin, q.origin)) for p, q in pairs}


def _under(scene: Scene, designator: str) -> tuple[str, ...]:
    """Names of its sub-assemblies, the outer one first: the guide's unit, or its step if the scene is one
    unit; then the ready scene."""
    step = next((s for s in scene.steps if designator in s.designators), None)
    if step is None:
        return ()
    before = [s.name for s in scene.ready if designator in {p.designator for p in s.placements}]
    return (step.unit or step.title, *before)


def _pose(design: CommonTables, scene: Scene, pose: Pose) -> PoseFact:
    there = {p.designator: p.origin for p in make_scene(design, scene.name, pose).placements}
    groups: dict[Vector, list[str]] = {}
    for p in scene.placements:
        offset = vector(round(b - a, 9) for a, b in zip(p.origin, there[p.designator]))
        if any(offset):
            groups.setdefault(offset, []).append(p.designator)
    return PoseFact(f"E{pose.element}", tuple((tuple(group), offset) for offset, group in groups.items()))


def _rest(motion: Motion) -> float | None:
    """The share of its way at which every group's offset is nothing."""
    shares = set()
    for _, start, end in motion.ways:
        way = [b - a for a, b in zip(start, end)]
        if not any(way):
            if any(start):
                return None
            continue
        along = -sum(w * a for w, a in zip(way, start)) / sum(w * w for w in way)
        if not 0.0 <= along <= 1.0 or any(abs(a + along * w) > 1e-9 for a, w in zip(start, way)):
            return None
        shares.add(round(along, 9))
    return shares.pop() if len(shares) == 1 else None


@dataclass(frozen=True)
class LimitFact:
    """A toleranced dimension: nominal and limits in mm, and its features."""

    name: str
    nominal: float
    lower: float
    upper: float
    key: bool
    between: tuple[str, ...]


@dataclass(frozen=True)
class GeometricFact:
    """A geometric tolerance: zone in mm."""

    name: str
    symbol: str
    zone: float
    round: bool
    features: tuple[str, ...]
    datums: tuple[str, ...]


@dataclass(frozen=True)
class FeatureFact:
    """A piece of a named feature's surface, exact and in the part's frame (mm): a plane through `point`
    square to `direction`, or a cylinder about the axis through `point` along `direction`. `middle` lies on
    it."""

    name: str
    kind: str
    point: Vector
    direction: Vector
    diameter: float | None
    middle: Vector


@dataclass(frozen=True)
class ShareFact:
    """A requirement of the assembled sensor that depends on the part: the share of its variance that the
    part's limits have, the arrays that keep it, and the limits with their own shares."""

    requirement: str
    unit: str
    nominal: float
    worst_low: float
    worst_high: float
    kept: float
    share: float
    limits: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class PartFacts:
    """One part number. Mass in g; volume in mm3, None of a model file's envelope."""

    part_no: str
    name: str
    process: str
    material: str
    mass_g: float
    volume_mm3: float
    colour: str
    finish: str
    notes: tuple[str, ...]
    designation: str
    limits: tuple[LimitFact, ...]
    geometric: tuple[GeometricFact, ...]
    datums: tuple[tuple[str, str], ...]
    features: tuple[FeatureFact, ...]
    shares: tuple[ShareFact, ...]


def part_facts(part: Part, variables: dict[str, DimensionLimits], lines: Sequence[StackLine]) -> PartFacts:
    """The facts of one part.

    Parameters
    ----------
    part
        Its description.
    variables, lines
        Of the assembled sensor, as `stacks.virtual_build.Sensor` has them: what depends on the part.
    """
    return PartFacts(
        part_no=part.part_no,
        name=part.name,
        process=part.process,
        material=str(part.material),
        mass_g=part.mass,
        volume_mm3=part.volume,
        colour=part.colour,
        finish=part.finish,
        notes=part.notes,
        designation=part.purchase.designation if part.purchase else "",
        limits=tuple(map(_limit, part.characteristics)),
        geometric=tuple(
            GeometricFact(g.name, g.symbol, g.zone, g.round, g.features, g.datums) for g in part.geometric
        ),
        datums=tuple((d.letter, d.feature) for d in part.datums),
        features=tuple(_features(part)),
        shares=tuple(_shares(part, variables, lines)),
    )


def _limit(c: Characteristic) -> LimitFact:
    # to a nanometre: 0.25 - 0.005 is a binary fraction
    nominal, lower, upper = (round(value, 6) for value in (c.nominal, c.lower, c.upper))
    return LimitFact(c.name, nominal, lower, upper, c.key, c.between)


def _features(part: Part) -> Iterator[FeatureFact]:
    """Every named feature's pieces, equal ones once; an extrusion's alone."""
    if not isinstance(part.body, Extrusion):
        return
    for name in sorted(part.feature_names - {""}):
        kinds = [(p, "plane" if p.diameter is None else "cylinder") for p in pieces(part, name)]
        yield from dict.fromkeys(
            FeatureFact(name, kind, p.point, p.direction, p.diameter, p.middle) for p, kind in kinds
        )


def _of_element(v: DimensionLimits, part: Part) -> tuple[tuple[str, str], ...]:
    """The limit of an element that a variable is of: it names no part, being the same of every length."""
    own = {c.name for c in part.characteristics} | {g.name for g in part.geometric}
    found = part.kind == "element" and v.element in own
    return ((part.part_no, v.element),) if found else ()


def _shares(
    part: Part, variables: dict[str, DimensionLimits], lines: Iterable[StackLine]
) -> Iterator[ShareFact]:
    """Requirements on which the part's limits have a share, the largest share first."""
    found = []
    for line in lines:
        limits: dict[str, float] = {}
        for c in line.contributors:
            for number, name in (*variables[c.name].stated, *_of_element(variables[c.name], part)):
                if number == part.part_no:
                    limits[name] = max(limits.get(name, 0.0), c.share)
        if limits:
            r, ranked = line.requirement, sorted(limits.items(), key=lambda item: (-item[1], item[0]))
            span, most = (line.nominal, line.worst_low, line.worst_high), max(limits.values())
            found.append(ShareFact(r.name, r.unit, *span, line.kept, most, tuple(ranked)))
    yield from sorted(found, key=lambda fact: (-fact.share, fact.requirement))


@dataclass(frozen=True)
class PairFact:
    """An element that measures with the reference, the stiffest of the array: stiffness in N/mm.

    ratio       K_r/K_m
    best_for    N/mm: the object whose stiffness the pair finds best, sqrt(K_r K_m)
    condition   there, the relative error of K_obj per relative error of the deflections' ratio
    """

    measuring: str
    reference: str
    K_m: float
    K_r: float
    ratio: float
    best_for: float
    condition: float


@dataclass(frozen=True)
class FitFacts:
    """Arrays built virtually: how many of each distribution, the share that meets every requirement, and by
    distribution the arrays that miss one."""

    count: int
    seed: int
    kept: dict[str, float]
    failures: dict[str, dict[str, int]]


@dataclass(frozen=True)
class ElementFacts:
    """All elements, by designator: the estimate's fields and those of the virtual builds; their pairs.

    `why_not`: the reason for a missing estimate, else "".
    """

    rung: str
    elements: dict[str, dict[str, Any]]
    pairs: tuple[PairFact, ...]
    why_not: str
    fit: FitFacts


def element_facts(
    design: CommonTables, scenes: tuple[Scene, ...]
) -> tuple[ElementFacts, Sensor, list[StackLine]]:
    """The facts, and the sensor with its stack from which those of the parts are read."""
    made = sensor(design, scenes)
    return _facts(design, made.built(BUILT)), made, made.stack()


def estimate_facts(design: CommonTables) -> ElementFacts:
    """The facts without virtual builds: of no array."""
    return _facts(design, Builds(0, SEED, {}, {}, ()))


def _facts(design: CommonTables, builds: Builds) -> ElementFacts:
    family, why_not = family_of(design), ""
    layout, estimate = family.layout(design), family.estimate.rows
    rows: list[ElementEstimate] = []
    gentle: list[ElementEstimate] = []
    try:
        rows = estimate(layout, DEFAULT_RUNG, None)
        # no strain is given above yield: what all elements are rated for is below it
        gentle = estimate(layout, DEFAULT_RUNG, min(row.rated_force for row in rows))
    except CheckFailure as error:
        why_not = str(error)
    built = {e.number: e for e in builds.elements}
    per_newton = lambda strain, force: None if strain is None else strain / force  # noqa: E731
    elements = {}
    for n, place in enumerate(layout.elements):
        row, low = (rows[n], gentle[n]) if gentle else (None, None)
        elements[place.designator] = {
            "row": place.row,
            "estimate": asdict(row) if row else None,
            "gauge_per_newton": per_newton(low.gauge_strain, low.force) if low else None,
            "fillet_per_newton": per_newton(low.peak_strain, low.force) if low else None,
            "built": built[place.number].known() if place.number in built else None,
        }
    fit = FitFacts(builds.count, builds.seed, builds.kept, builds.failures)
    return ElementFacts(DEFAULT_RUNG, elements, tuple(_pairs(rows)), why_not, fit)


def _pairs(rows: list[ElementEstimate]) -> list[PairFact]:
    """Each element softer than the stiffest, paired with it: one as stiff cannot measure an object."""
    if not rows:
        return []
    reference = max(rows, key=lambda r: (r.stiffness, -r.number))
    return [_pair(row, reference) for row in rows if row.stiffness < reference.stiffness]


def _pair(m: ElementEstimate, r: ElementEstimate) -> PairFact:
    best = sqrt(r.stiffness * m.stiffness)
    condition = abs(float(condition_in_ratio(r.stiffness, m.stiffness, best)))
    return PairFact(
        f"E{m.number}", f"E{r.number}", m.stiffness, r.stiffness, r.stiffness / m.stiffness, best, condition
    )


@dataclass(frozen=True)
class FindingFact:
    """One finding.

    about        as the check names it
    scene        its scene, "" for all that hold the part
    designators  of the parts that it is about; of a part number all of its
    place        mm, in the scene's frame if there is a scene, else in the part's own; empty: all of it
    """

    check: str
    severity: str
    about: str
    message: str
    scene: str
    designators: tuple[str, ...]
    place: tuple[float, ...]


def finding_facts(
    design: CommonTables, scenes: Sequence[Scene], shapes: Shapes, say: Callable[[int, int, str], None]
) -> list[FindingFact]:
    """Every finding of every check on these scenes, failures first; kept in the cache of the shapes."""
    report = checked(design, [scene.name for scene in scenes], shapes.cache, say=say)
    found = [_fact(case.check, case.subject, f, scenes) for case in report.cases for f in case.findings]
    return sorted(found, key=lambda f: f.severity != "fail")


def _fact(check: str, subject: str, finding: Finding, scenes: Sequence[Scene]) -> FindingFact:
    placed = [(p.designator, p.part.part_no) for scene in scenes for p in scene.placements]
    who = [d for d, _ in placed if d == finding.part] or [d for d, number in placed if number == finding.part]
    in_scene = check in IN_SCENE and subject in {scene.name for scene in scenes}
    return FindingFact(
        finding.check,
        finding.severity,
        finding.about,
        finding.message,
        subject if in_scene else "",
        tuple(dict.fromkeys(who)),
        () if check in NO_PLACE else tuple(finding.place),
    )
