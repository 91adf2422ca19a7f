"""Triangles: what a finer tolerance gains in volume, and costs in time and size."""

from __future__ import annotations

import numpy as np

from tactcad.scenes import make_scene

from . import arrays
from .bench_tables import table
from .front import efficient
from .run_plan import RunPlan
from .timing import interleaved

TITLE = "Tessellation tolerance"
QUESTION = "How fine do triangles have to be, and what do they cost?"
LINEAR = 0.05  # mm, with every angular tolerance
ANGULAR = (1.0, 0.5, 0.35, 0.2, 0.1, 0.05, 0.02)  # rad; 0.35 pictures, 0.2 the mesh check
OTHER_LINEAR = ((0.5, 0.2), (0.005, 0.2), (0.0005, 0.2))  # to tell the two apart
STL_HEAD, STL_TRIANGLE = 84, 50  # bytes of a binary STL file


def measure(plan: RunPlan) -> dict:
    from tactcad.solids.build import build
    from tactcad.solids.mesh_overlap import volume
    from tactcad.solids.triangles import triangles

    scene = make_scene(arrays.published(), "array")
    plan.say(f"{len(scene.parts)} parts built")
    shapes = [(part, build(part).wrapped) for part in scene.parts]
    angular = plan.of((0.5, 0.2), ANGULAR[:5], ANGULAR)
    pairs = [(LINEAR, a) for a in angular] + list(plan.of((), OTHER_LINEAR[1:2], OTHER_LINEAR))
    rows = []
    for linear, angle in pairs:
        plan.say(f"linear {linear:g} mm, angular {angle:g} rad")
        meshes = [triangles(shape, linear, angle) for _, shape in shapes]
        errors = [abs(volume(mesh) / part.volume - 1.0) for mesh, (part, _) in zip(meshes, shapes)]
        total = sum(part.volume for part, _ in shapes)
        count = sum(len(faces) for _, faces in meshes)
        rows.append(
            {
                "linear": linear,
                "angular": angle,
                "triangles": count,
                "volume error": float(np.dot(errors, [part.volume for part, _ in shapes]) / total),
                "worst": max(errors),
                "stl_bytes": STL_HEAD * len(meshes) + STL_TRIANGLE * count,
                "mesh_bytes": sum(v.nbytes + f.nbytes for v, f in meshes),
            }
        )
    plan.say("times, in turns")
    actions = {pair: (lambda pair=pair: [triangles(shape, *pair) for _, shape in shapes]) for pair in pairs}
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
    return {"tables": {"tessellation": table(TITLE, columns, rows, note)}, "findings": findings(rows)}


def findings(rows: list[dict]) -> list[str]:
    main = [row for row in rows if row["linear"] == LINEAR]
    coarse, fine = main[0], main[-1]
    lines = [
        f"From {coarse['angular']:g} to {fine['angular']:g} rad the volume error falls from "
        f"{1e6 * coarse['volume error']:.0f} to {1e6 * fine['volume error']:.1f} ppm, for "
        f"{fine['triangles'] / coarse['triangles']:.0f} times the triangles and "
        f"{fine['seconds'] / coarse['seconds']:.1f} times the time."
    ]
    same = [row for row in rows if row["angular"] == 0.2]
    if len(same) > 1:
        worst, best = max(r["volume error"] for r in same), min(r["volume error"] for r in same)
        lines.append(
            f"At 0.2 rad the linear tolerance from {max(r['linear'] for r in same):g} to "
            f"{min(r['linear'] for r in same):g} mm changes the error "
            f"from {1e6 * worst:.0f} to {1e6 * best:.0f} ppm."
        )
    return lines
