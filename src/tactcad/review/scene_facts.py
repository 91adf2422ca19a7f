"""A scene as the page shows it: tree, places, ways out for the exploded view, motions, steps and bill."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from tactcad.design.tree import Design
from tactcad.drawing.guide import exploded
from tactcad.parts.description import Vector, vector
from tactcad.scenes import make_scene
from tactcad.scenes.bom import bom_rows
from tactcad.scenes.rig import all_rigs
from tactcad.scenes.scene import Motion, Pose, Rotation, Scene


@dataclass(frozen=True)
class PlacedFact:
    """One designator: its part, where it stands (mm; rows of its rotation), its way out in the exploded view
    (mm), the step of the guide that puts it there (from 0), and the sub-assemblies that it belongs to."""

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
    share of the way at which the scene stands, None where it does not stand on it."""

    name: str
    ways: tuple[tuple[tuple[str, ...], Vector, Vector], ...]
    rest: float | None


@dataclass(frozen=True)
class PoseFact:
    """An element under the force sensor: of each group of designators that stands elsewhere than at rest the
    offset, mm."""

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


def scene_facts(design: Design, scene: Scene) -> SceneFacts:
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
        tuple(_motion(m, groups) for m in scene.motions),
        tuple(_pose(design, scene, pose) for pose in all_rigs()[scene.name].under_sensor(design)),
        tuple(sorted(scene.cover)),
        tuple(asdict(row) for row in bom_rows(scene, design.design.revision, {})),
    )


def _ways(scene: Scene) -> dict[str, Vector]:
    """By designator how far the guide's exploded view moves it, mm."""
    if not scene.steps:
        return {p.designator: (0.0, 0.0, 0.0) for p in scene.placements}
    pairs = zip(scene.placements, exploded(scene), strict=True)
    return {p.designator: vector(round(b - a, 9) for a, b in zip(p.origin, q.origin)) for p, q in pairs}


def _under(scene: Scene, designator: str) -> tuple[str, ...]:
    """Names of the sub-assemblies that hold it, the outer one first: the guide's unit, or its step where the
    scene is one unit; then the scene that was put together before."""
    step = next((s for s in scene.steps if designator in s.designators), None)
    if step is None:
        return ()
    before = [s.name for s in scene.ready if designator in {p.designator for p in s.placements}]
    return (step.unit or step.title, *before)


def _motion(motion: Motion, groups: Mapping[str, frozenset[str]]) -> MotionFact:
    ways = tuple((tuple(sorted(groups.get(g, ()))), start, end) for g, start, end in motion.ways)
    return MotionFact(motion.name, ways, _rest(motion))


def _pose(design: Design, scene: Scene, pose: Pose) -> PoseFact:
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
