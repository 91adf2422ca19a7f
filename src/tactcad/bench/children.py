"""Tasks that run in a process of their own, so that their memory and imports can be measured separately:
`python -m tactcad.bench.children TASK ARGUMENTS.json` prints its result as JSON on its last line.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tactcad.export.step_text import Header
from tactcad.scenes import make_scene
from tactcad.scenes.scene import Scene

from . import arrays, prototypes

HEADER = Header("bench", "bench", "A", "2026-01-01", "", "")


class Clock:
    """Seconds of named stages."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def __call__(self, name: str, action: Callable[[], Any]) -> Any:
        start = time.perf_counter()
        result = action()
        self.seconds[name] = time.perf_counter() - start
        return result


def kernel() -> dict:
    """The kernel is loaded, nothing else."""
    import tactcad.export.step_file
    import tactcad.solids.build  # noqa: F401

    return {}


def assembly(scene: str, detail: str, path: str) -> dict:
    """Parts of one scene of the published design built, and its STEP assembly written and read back."""
    from tactcad.scenes.detail import at_detail

    kernel()
    clock = Clock()
    made = clock("describe", lambda: at_detail(make_scene(arrays.published(), scene), detail))
    shapes = clock("build", lambda: _shapes(made))
    data = clock("step", lambda: _step(made, shapes))
    Path(path).write_bytes(data)
    return {
        "seconds": clock.seconds,
        "bytes": len(data),
        "parts": len(made.parts),
        "solids": len(made.placements),
    }


def step(elements: int, shared: bool) -> dict:
    """The array's STEP assembly with one prototype a part, or with every placed part a shape of its own."""
    kernel()
    scene = make_scene(arrays.of(elements), "array")
    shapes = _shapes(scene)
    if not shared:
        scene, shapes = prototypes.unshared(scene, shapes)
    clock = Clock()
    data = clock("step", lambda: _step(scene, shapes))
    return {"seconds": clock.seconds, "bytes": len(data), "solids": len(scene.placements)}


def stages(elements: int) -> dict:
    """What an export and a check of the array consist of, each stage's time."""
    from tactcad.checks.interference import check_interference
    from tactcad.parts.rules import refuse_broken

    kernel()
    clock = Clock()
    design = arrays.of(elements)
    clock("rules between fields", lambda: refuse_broken(design))
    scene = clock("placements and contacts", lambda: make_scene(design, "array"))
    shapes = clock("solids of its parts", lambda: _shapes(scene))
    data = clock("STEP assembly", lambda: _step(scene, shapes))
    for name in PICTURES:
        clock(f"picture, {name}", lambda: _picture(scene, shapes, name))  # noqa: B023
    findings = clock("interference", lambda: check_interference(scene, shapes))
    return {
        "seconds": clock.seconds,
        "bytes": len(data),
        "solids": len(scene.placements),
        "findings": len(findings),
    }


def element(designator: str, repeats: int, files: dict[str, str]) -> dict:
    """One element built and written `repeats` times, as an export does it, to the file of "tactcad"; then the
    volume (mm3) of the one solid in each file."""
    from tactcad.export.step_file import part_step
    from tactcad.solids.build import build
    from tactcad.solids.step_models import model_file

    part = next(
        p.part for p in make_scene(arrays.published(), "array").placements if p.designator == designator
    )
    times: dict[str, Any] = {"build": [], "write": []}
    for _ in range(repeats):
        clock = Clock()
        solid = clock("build", lambda: build(part))
        data = clock("write", lambda: part_step(part, solid.wrapped, HEADER))  # noqa: B023
        for name, seconds in clock.seconds.items():
            times[name].append(seconds)
    Path(files["tactcad"]).write_bytes(data)
    return times | {
        "volume": solid.volume,
        "read": {name: model_file(path).volume for name, path in files.items()},
    }


PICTURES = ("above", "open")


def _shapes(scene: Scene) -> dict:
    from tactcad.solids.build import build

    return {part.part_no: build(part).wrapped for part in scene.parts}


def _step(scene: Scene, shapes: dict) -> bytes:
    from tactcad.export.step_file import scene_step

    return scene_step(scene, shapes, HEADER)


def _picture(scene: Scene, shapes: dict, name: str) -> bytes:
    from tactcad.drawing.engine import picture
    from tactcad.solids.place import placed_shape

    shown = [p for p in scene.placements if name == "above" or p.designator not in scene.cover]
    drawn = picture.drawing(
        [placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in shown], picture.ABOVE
    )
    data = picture.svg(drawn, "bench", "bench")
    picture.check_picture(data, shown, picture.ABOVE)
    return data


TASKS: dict[str, Callable[..., dict]] = {f.__name__: f for f in (kernel, assembly, step, stages, element)}

if __name__ == "__main__":
    print(json.dumps(TASKS[sys.argv[1]](**json.loads(sys.argv[2]))))
