"""Benchmarks of geometry: triangles at each tolerance, and whether two placed parts overlap, by meshes and by
the kernel."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from known_pairs import known_pairs
from measuring import RunPlan, array_of, benchmark, interleaved, published
from tables import efficient, table

from tactcad.costs.grades import ANGULAR
from tactcad.parts.language.description import Part
from tactcad.scenes import make_scene
from tactcad.scenes.scene import Placement, Scene

if TYPE_CHECKING:
    from manifold3d import Manifold
    from OCP.TopoDS import TopoDS_Shape

LINEAR = 0.05  # mm, with every angular tolerance
OTHER_LINEAR = ((0.5, 0.2), (0.005, 0.2), (0.0005, 0.2))  # mm, rad: to tell the two apart
STL_HEAD, STL_TRIANGLE = 84, 50  # bytes of a binary STL file
JUDGING = (0.5, 0.2, 0.1, 0.05)  # rad, angular tolerances of the meshes that judge
T = TypeVar("T")
Placed = tuple[Placement, Placement]


def volume(mesh: tuple[np.ndarray, np.ndarray]) -> float:
    """Volume (mm3) that triangles enclose: a sixth of the sum of a . (b x c)."""
    a, b, c = (mesh[0][mesh[1][:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


# --- triangles ---


@benchmark(
    "tessellation", "Tessellation tolerance", "How fine do triangles have to be, and what do they cost?"
)
def tessellation(plan: RunPlan) -> dict:
    from tactcad.solids.build import build
    from tactcad.solids.triangles import triangles

    scene = make_scene(published(), "array")
    plan.say(f"{len(scene.parts)} parts built")
    shapes = [build(part) for part in scene.parts]
    exact = np.array([part.volume for part in scene.parts])
    pairs = [(LINEAR, a) for a in plan.of((0.5, 0.2), ANGULAR[:5], ANGULAR)]
    pairs += plan.of((), OTHER_LINEAR[1:2], OTHER_LINEAR)
    rows = []
    for linear, angle in pairs:
        plan.say(f"linear {linear:g} mm, angular {angle:g} rad")
        made = [triangles(shape, linear, angle) for shape in shapes]
        errors = np.abs([volume(mesh) for mesh in made] / exact - 1.0)
        count = sum(len(faces) for _, faces in made)
        rows.append(
            {
                "linear": linear,
                "angular": angle,
                "triangles": count,
                "volume error": float(errors @ exact / exact.sum()),
                "worst": float(errors.max()),
                "stl_bytes": STL_HEAD * len(made) + STL_TRIANGLE * count,
                "mesh_bytes": sum(v.nbytes + f.nbytes for v, f in made),
            }
        )
    plan.say("times, in turns")
    actions = {pair: (lambda pair=pair: [triangles(shape, *pair) for shape in shapes]) for pair in pairs}
    timed = interleaved(actions, plan.of(1, 2, 3))
    for row, pair in zip(rows, pairs):
        row |= vars(timed[pair])
        row["time ratio"] = row["seconds"] / timed[LINEAR, 0.2].seconds
    front = efficient([(row["seconds"], row["worst"]) for row in rows])
    for i, row in enumerate(rows):
        row["front"] = i in front
    columns = (
        "linear [mm]; angular [rad]; triangles; volume error [ppm]; worst: worst part [ppm]; "
        "stl_bytes: STL [kB]; mesh_bytes: in memory [kB]; seconds: time [ms]; median [ms]; "
        "time ratio: over 0.2 rad; front: on the front"
    )
    note = (
        f"All {len(shapes)} parts of the array, each once; volume error against the closed form. STL: "
        "binary, 84 + 50 n bytes a part."
    )
    main = [row for row in rows if row["linear"] == LINEAR]
    coarse, fine = main[0], main[-1]
    findings = [
        f"From {coarse['angular']:g} to {fine['angular']:g} rad the volume error falls from "
        f"{1e6 * coarse['volume error']:.0f} to {1e6 * fine['volume error']:.1f} ppm, for "
        f"{fine['triangles'] / coarse['triangles']:.0f} times the triangles and "
        f"{fine['seconds'] / coarse['seconds']:.1f} times the time."
    ]
    same = [row for row in rows if row["angular"] == 0.2]
    if len(same) > 1:
        worst, best = max(r["volume error"] for r in same), min(r["volume error"] for r in same)
        findings.append(
            f"At 0.2 rad the linear tolerance from {max(r['linear'] for r in same):g} to "
            f"{min(r['linear'] for r in same):g} mm changes the error "
            f"from {1e6 * worst:.0f} to {1e6 * best:.0f} ppm."
        )
    return {"tables": {"tessellation": table(columns, rows, note)}, "findings": findings}


# --- overlaps: on pairs with known verdicts, on the array's own near pairs, and the whole check against every
# near pair by the kernel ---


@benchmark(
    "interference",
    "Interference by meshes and by the kernel",
    "How often is a mesh's verdict wrong, and what does the kernel's cost?",
)
def interference(plan: RunPlan) -> dict:
    known = [(pair.placements, pair.verdict) for pair in known_pairs(plan.of(1, 2, 20), plan.seed)]
    own = near(make_scene(published(), "array"))[:: plan.of(30, 3, 1)]
    angular = plan.of(JUDGING[:1], JUDGING[:3], JUDGING)
    rows = _compared(plan, "known pairs", known, angular)
    rows += _compared(plan, "the array's near pairs", [(pair, None) for pair in own], angular)
    situations = _situations(plan)
    columns = (
        "pairs; by; count: number; wrong: wrong verdicts; missed: missed overlaps; false: false overlaps; "
        "others: touch and clear mistaken; seconds: time a pair [ms]; median [ms]; "
        "time ratio: over the kernel's; meshing: meshing a part [ms]"
    )
    note = (
        "Known pairs: boxes and pins at gaps of 0.1 mm to 0.1 um, touching, and overlapping by as much, "
        "verdicts in closed form. The array's near pairs: all whose boxes meet, the kernel's verdict taken "
        "as true. Mean and median time; meshes are made once a part."
    )
    others = (
        "elements; placed: placed parts; findings: contacts judged; seconds: tactcad check [s]; "
        "kernel seconds: every near pair [s]; time ratio: times as long; same verdicts"
    )
    all_contacts = "The scene's declared contacts are taken out, so that every contact wants a verdict."
    title = "Each situation once, against every near pair by the kernel"
    kernel, coarsest, finest = rows[0], rows[1], rows[len(angular)]
    last = situations[-1]
    return {
        "tables": {
            "interference": table(columns, rows, note),
            "situations": table(others, situations, all_contacts, title),
        },
        "findings": [
            f"On {kernel['count']} pairs with known verdicts the kernel is wrong {kernel['wrong']} times, "
            f"{finest['by']} {finest['wrong']} times: "
            f"{finest['missed']} overlaps missed, {finest['false']} seen where there are none.",
            f"At {coarsest['angular']:g} rad meshes, once made, take {coarsest['time ratio']:.2g} of the "
            f"kernel's time a pair, at {finest['angular']:g} rad {finest['time ratio']:.2g}; making one "
            f"takes {1e3 * coarsest['meshing']:.0f} and {1e3 * finest['meshing']:.0f} ms.",
            f"{last['elements']} elements: the check judges {last['findings']} contacts in "
            f"{last['seconds']:.1f} s, every near pair by the kernel takes {last['kernel seconds']:.1f} s, "
            f"{last['time ratio']:.1f} times as long; "
            f"{'the same verdicts' if last['same verdicts'] else 'VERDICTS DIFFER'}.",
        ],
    }


def near(scene: Scene) -> list[Placed]:
    """Pairs of the scene whose boxes meet."""
    from tactcad.checks.on_solids.interference import near_pairs, placed_box
    from tactcad.solids.build import build
    from tactcad.solids.measure import bounding_box

    local = {part.part_no: bounding_box(build(part)) for part in scene.parts}
    boxes = np.array([placed_box(p, local[p.part.part_no]) for p in scene.placements])
    return [(scene.placements[i], scene.placements[j]) for i, j in near_pairs(boxes)]


def count_wrong(verdicts: list[str], true: list[str]) -> dict[str, int]:
    """Number of wrong verdicts, and by kind: overlaps missed, overlaps that are none, touch and clear
    confused."""
    pairs = Counter(zip(verdicts, true))
    missed = sum(n for (f, t), n in pairs.items() if t == "overlap" != f)
    false = sum(n for (f, t), n in pairs.items() if f == "overlap" != t)
    wrong = sum(n for (f, t), n in pairs.items() if f != t)
    return {"wrong": wrong, "missed": missed, "false": false, "others": wrong - missed - false}


@dataclass
class Prepared:
    """What each method of judging makes once for every part number: the kernel's shape with its box and its
    faces' boxes, and closed meshes by angular tolerance."""

    shapes: dict = field(default_factory=dict)
    boxes: dict = field(default_factory=dict)
    faces: dict = field(default_factory=dict)
    meshes: dict = field(default_factory=dict)

    def add(self, part: Part, angular: tuple[float, ...], meshing: dict[float, list[float]]) -> None:
        from tactcad.solids.build import build
        from tactcad.solids.measure import Faces, bounding_box

        number = part.part_no
        if number in self.shapes:
            return
        shape = self.shapes[number] = build(part)
        self.boxes[number], self.faces[number] = bounding_box(shape), Faces(shape)
        for a in angular:
            self.meshes[number, a] = _timed(meshing.setdefault(a, []), partial(_closed_mesh, shape, a))


def _closed_mesh(shape: TopoDS_Shape, angular: float) -> Manifold:
    from tactcad.solids.changed import closed
    from tactcad.solids.triangles import triangles

    return closed(triangles(shape, LINEAR, angular))


def kernel_verdict(pair: Placed, made: Prepared) -> str:
    """As `tactcad check` decides: by the kernel's distance, and by its common solid where that is 0."""
    from tactcad.checks.on_solids.interference import meeting, placed_box

    a, b = (placed_box(p, made.boxes[p.part.part_no]) for p in pair)
    met = meeting(pair, (a, b), made.shapes, made.faces)
    return _verdict(met.overlap, met.distance)


def mesh_verdict(pair: Placed, made: Prepared, angular: float) -> str:
    """By the same limits, from the triangles' common volume and distance."""
    from tactcad.checks.on_solids.interference import TOUCH_MM

    a, b = (
        made.meshes[p.part.part_no, angular].transform(np.column_stack([p.rotation, p.origin])) for p in pair
    )
    return _verdict((a ^ b).volume(), a.min_gap(b, 10 * TOUCH_MM))


def _verdict(overlap: float, gap: float) -> str:
    from tactcad.checks.on_solids.interference import OVERLAP_MM3, TOUCH_MM

    return "overlap" if overlap > OVERLAP_MM3 else "touch" if gap < TOUCH_MM else "clear"


def _compared(
    plan: RunPlan, name: str, pairs: Sequence[tuple[Placed, str | None]], angular: tuple[float, ...]
) -> list[dict]:
    """A row for the kernel and one for each tolerance; every pair is judged by all of them in turn."""
    ways: list[float | None] = [None, *angular]  # None: the kernel
    verdicts: dict[float | None, list[str]] = {w: [] for w in ways}
    seconds: dict[float | None, list[float]] = {w: [] for w in ways}
    meshing: dict[float, list[float]] = {}
    made, true = Prepared(), []
    for n, (pair, verdict) in enumerate(pairs):
        if n % 20 == 0:
            plan.say(f"{name}: {n} of {len(pairs)}")
        if verdict is not None:  # every known pair has parts of its own
            made = Prepared()
        for p in pair:
            made.add(p.part, angular, meshing)
        for w in ways:
            judge = partial(kernel_verdict, pair, made) if w is None else partial(mesh_verdict, pair, made, w)
            verdicts[w].append(_timed(seconds[w], judge))
        true.append(verdict or verdicts[None][-1])
    rows = []
    for w in ways:
        by = "kernel" if w is None else f"meshes, {w:g} rad"
        row: dict[str, Any] = {"pairs": name, "by": by, "angular": w, "count": len(pairs)}
        if w is not None or pairs[0][1]:  # the kernel is not compared with itself
            row |= count_wrong(verdicts[w], true)
        row |= {"seconds": float(np.mean(seconds[w])), "median": float(np.median(seconds[w]))}
        row["time ratio"] = row["seconds"] / float(np.mean(seconds[None]))
        row["meshing"] = None if w is None else float(np.mean(meshing[w]))
        rows.append(row)
    return rows


def _timed(into: list[float], action: Callable[[], T]) -> T:
    start = time.perf_counter()
    result = action()
    into.append(time.perf_counter() - start)
    return result


class _Forgetful(dict):
    """Remembers no situation: every pair is judged anew."""

    def get(self, key: object, default: object = None) -> None:
        return None


def _situations(plan: RunPlan) -> list[dict]:
    from tactcad.checks.on_solids.interference import check_interference
    from tactcad.solids.build import build

    def said(findings: list) -> list[tuple[str, str]]:
        return sorted((f.check, f.part) for f in findings)

    rows = []
    for elements in plan.of((2,), (10,), (10, 100, 1000)):
        scene = replace(make_scene(array_of(elements), "array"), contacts=())
        shapes = {part.part_no: build(part) for part in scene.parts}
        seconds: list[float] = []
        plan.say(f"{elements} elements: each situation once")
        mine = _timed(seconds, partial(check_interference, scene, shapes))
        plan.say(f"{elements} elements: every near pair by the kernel")
        all_pairs = _timed(seconds, partial(check_interference, scene, shapes, _Forgetful()))
        rows.append(
            {
                "elements": elements,
                "placed": len(scene.placements),
                "findings": len(mine),
                "seconds": seconds[0],
                "kernel seconds": seconds[1],
                "time ratio": seconds[1] / seconds[0],
                "same verdicts": said(mine) == said(all_pairs),
            }
        )
    return rows
