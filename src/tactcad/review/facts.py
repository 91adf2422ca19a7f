"""Contents of the page and of FreeCAD's document, as plain data: scenes, parts, elements with their pairs,
findings.

Parts are read off their descriptions: no kernel, no mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
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
from tactcad.scenes.scene import Motion, Pose, Scene
from tactcad.stacks.stack import SEED, StackLine
from tactcad.stacks.virtual_build import Builds, Sensor, sensor

# Checks of a whole scene give places in its frame; a motion's is an offset, no place; all others the part's.
IN_SCENE = ("interference", "tools", "configurations")
NO_PLACE = ("motion",)
BUILT = 1000  # arrays of each distribution, as `tactcad build` and the stack's page have


Facts = dict[str, Any]  # plain data, as page and document have it; lengths in mm


def scene_facts(design: CommonTables, scene: Scene) -> Facts:
    """One scene.

    placed   of each designator part, place (with the rows of its rotation), `way` out in the exploded view,
             `step` of the guide (from 0), and sub-assemblies (`under`)
    motions  of each group its designators and the offsets that it goes from and to; `rest`: the scene's own
             place as a share of the way, None if it is not on it
    poses    an element under the force sensor: for each moved group of designators the offset from rest
    bill     by item, each row as the bill of materials has it
    """
    ways = _ways(scene)
    steps = {d: n for n, step in enumerate(scene.steps) for d in step.designators}
    groups = dict(scene.groups)
    return {
        "name": scene.name,
        "placed": tuple(
            {
                "designator": p.designator,
                "part_no": p.part.part_no,
                "origin": p.origin,
                "rotation": p.rotation,
                "way": ways[p.designator],
                "step": steps.get(p.designator, 0),
                "under": _under(scene, p.designator),
            }
            for p in scene.placements
        ),
        "steps": tuple((step.title, step.text) for step in scene.steps),
        "motions": tuple(
            {
                "name": m.name,
                "ways": tuple((tuple(sorted(groups.get(g, ()))), a, b) for g, a, b in m.ways),
                "rest": _rest(m),
            }
            for m in scene.motions
        ),
        "poses": tuple(
            _pose(design, scene, pose) for pose in rig_of(design, scene.name).under_sensor(design)
        ),
        "cover": tuple(sorted(scene.cover)),
        "bill": tuple(asdict(row) for row in bom_rows(scene, design.design, {})),
    }


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


def _pose(design: CommonTables, scene: Scene, pose: Pose) -> Facts:
    there = {p.designator: p.origin for p in make_scene(design, scene.name, pose).placements}
    groups: dict[Vector, list[str]] = {}
    for p in scene.placements:
        offset = vector(round(b - a, 9) for a, b in zip(p.origin, there[p.designator]))
        if any(offset):
            groups.setdefault(offset, []).append(p.designator)
    ways = tuple((tuple(group), offset) for offset, group in groups.items())
    return {"name": f"E{pose.element}", "ways": ways}


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


def part_facts(part: Part, variables: dict[str, DimensionLimits], lines: Sequence[StackLine]) -> Facts:
    """One part number; volume None of a model file's envelope.

    Parameters
    ----------
    part
        Its description.
    variables, lines
        Of the assembled sensor, as `stacks.virtual_build.Sensor` has them: what depends on the part.
    """
    return {
        "part_no": part.part_no,
        "name": part.name,
        "process": part.process,
        "material": str(part.material),
        "mass_g": part.mass,
        "volume_mm3": part.volume,
        "colour": part.colour,
        "finish": part.finish,
        "notes": part.notes,
        "designation": part.purchase.designation if part.purchase else "",
        "limits": tuple(map(_limit, part.characteristics)),
        "geometric": tuple(
            {name: getattr(g, name) for name in ("name", "symbol", "zone", "round", "features", "datums")}
            for g in part.geometric
        ),
        "datums": tuple((d.letter, d.feature) for d in part.datums),
        "features": _features(part),
        "shares": _shares(part, variables, lines),
    }


def _limit(c: Characteristic) -> Facts:
    # to a nanometre: 0.25 - 0.005 is a binary fraction
    ends = {name: round(getattr(c, name), 6) for name in ("nominal", "lower", "upper")}
    return {"name": c.name, **ends, "key": c.key, "between": c.between}


def _features(part: Part) -> list[Facts]:
    """Pieces of every named feature's surface, exact and in the part's frame, equal ones once: a plane
    through `point` square to `direction`, or a cylinder about the axis through `point` along `direction`;
    `middle` lies on it. An extrusion's alone."""
    if not isinstance(part.body, Extrusion):
        return []
    return [
        {
            "name": name,
            "kind": "plane" if diameter is None else "cylinder",
            "point": point,
            "direction": direction,
            "diameter": diameter,
            "middle": middle,
        }
        for name in sorted(part.feature_names - {""})
        for point, direction, diameter, middle in dict.fromkeys(
            (p.point, p.direction, p.diameter, p.middle) for p in pieces(part, name)
        )
    ]


def _of_element(v: DimensionLimits, part: Part) -> tuple[tuple[str, str], ...]:
    """The limit of an element that a variable is of: it names no part, being the same of every length."""
    own = {c.name for c in part.characteristics} | {g.name for g in part.geometric}
    found = part.kind == "element" and v.element in own
    return ((part.part_no, v.element),) if found else ()


def _shares(part: Part, variables: dict[str, DimensionLimits], lines: Iterable[StackLine]) -> list[Facts]:
    """Requirements of the assembled sensor that depend on the part, the largest share first: the share of
    their variance that its limits have, the arrays that keep them, and the limits with their own shares."""
    found = []
    for line in lines:
        limits: dict[str, float] = {}
        for c in line.contributors:
            for number, name in (*variables[c.name].stated, *_of_element(variables[c.name], part)):
                if number == part.part_no:
                    limits[name] = max(limits.get(name, 0.0), c.share)
        if limits:
            found.append(
                {
                    "requirement": line.requirement.name,
                    "unit": line.requirement.unit,
                    "nominal": line.nominal,
                    "worst_low": line.worst_low,
                    "worst_high": line.worst_high,
                    "kept": line.kept,
                    "share": max(limits.values()),
                    "limits": tuple(sorted(limits.items(), key=lambda item: (-item[1], item[0]))),
                }
            )
    return sorted(found, key=lambda fact: (-fact["share"], fact["requirement"]))


def element_facts(design: CommonTables, scenes: tuple[Scene, ...]) -> tuple[Facts, Sensor, list[StackLine]]:
    """All elements, and the sensor with its stack from which the facts of the parts are read.

    elements  by designator: the estimate's fields and those of the virtual builds
    pairs     each element that measures with the reference, the stiffest: K_m and K_r (N/mm), their `ratio`
              K_r/K_m, and `best_for`, the stiffness of the object that the pair finds best, sqrt(K_r K_m),
              with the `condition` there: the relative error of K_obj per that of the deflections' ratio
    why_not   the reason for a missing estimate, else ""
    fit       arrays built virtually, as `stacks.virtual_build.Builds` has them
    """
    made = sensor(design, scenes)
    return _facts(design, made.built(BUILT)), made, made.stack()


def estimate_facts(design: CommonTables) -> Facts:
    """The facts without virtual builds: of no array."""
    return _facts(design, Builds(0, SEED, {}, {}, ()))


def _facts(design: CommonTables, builds: Builds) -> Facts:
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
    fit = {name: getattr(builds, name) for name in ("count", "seed", "kept", "failures")}
    pairs = _pairs(rows)
    return {"rung": DEFAULT_RUNG, "elements": elements, "pairs": pairs, "why_not": why_not, "fit": fit}


def _pairs(rows: list[ElementEstimate]) -> list[Facts]:
    """Each element softer than the stiffest, paired with it: one as stiff cannot measure an object."""
    if not rows:
        return []
    r, pairs = max(rows, key=lambda r: (r.stiffness, -r.number)), []
    for m in (row for row in rows if row.stiffness < r.stiffness):
        best = sqrt(r.stiffness * m.stiffness)
        condition = abs(float(condition_in_ratio(r.stiffness, m.stiffness, best)))
        pairs.append(
            {
                "measuring": f"E{m.number}",
                "reference": f"E{r.number}",
                "K_m": m.stiffness,
                "K_r": r.stiffness,
                "ratio": r.stiffness / m.stiffness,
                "best_for": best,
                "condition": condition,
            }
        )
    return pairs


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
