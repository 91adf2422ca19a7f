"""Interference of a scene: tactcad's check against every pair by the kernel, same verdicts asked of both.

    python benchmarks/checks.py            2 x 500 elements
    python benchmarks/checks.py --smoke    2 x 5 elements

All two million pairs of 2 x 500 by the kernel would take hours. It is given the box screen: every pair whose
boxes meet goes to it, whether or not a pair like it was seen before. The scene's declared contacts are taken out,
so that there is a verdict on every contact.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import time
from pathlib import Path

from tactcad.checks import interference
from tactcad.design.tree import Design
from tactcad.parts.designs import load
from tactcad.parts.rules import refuse_broken
from tactcad.scenes import make_scene
from tactcad.scenes.scene import Scene
from tactcad.solids.build import build


def long_array(repeats: int) -> Design:
    """The macro array with its rows repeated; room for the tie rods that hold longer stacks."""
    design = load("macro-array")
    rows = tuple(tuple(row) * repeats for row in design.array.row_arms)
    if repeats > 1:
        design = dataclasses.replace(
            design,
            holes=dataclasses.replace(design.holes, screw_offsets=(4.0, 14.2)),
            clamp=dataclasses.replace(design.clamp, end_plate_bottom=0.2, end_plate_margin=0.6),
        )
    design = dataclasses.replace(design, array=dataclasses.replace(design.array, row_arms=rows))
    refuse_broken(design)
    return design


def every_pair_by_the_kernel(scene: Scene, shapes: dict) -> list:
    """The same check with no situation taken for another one."""
    count = iter(range(10**9))
    situation = interference._situation
    interference._situation = lambda *args: ((next(count),), 0)
    try:
        return interference.check_interference(scene, shapes)
    finally:
        interference._situation = situation


def verdicts(findings: list) -> list[tuple[str, str]]:
    return sorted((f.check, f.message.split(" by ")[0]) for f in findings)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--smoke", action="store_true", help="the shipped 2 x 5 array only")
    parser.add_argument("--json", metavar="FILE", help="write the figures there")
    args = parser.parse_args()
    scene = make_scene(long_array(1 if args.smoke else 100), "array")
    shapes = {part.part_no: build(part).wrapped for part in scene.parts}
    # without its declared contacts a scene has a verdict on every contact: more to agree on than "clean"
    scene = dataclasses.replace(scene, contacts=())
    start = time.perf_counter()
    mine = interference.check_interference(scene, shapes)
    ours = time.perf_counter() - start
    print(f"{len(scene.placements)} placed parts, {len(mine)} findings; tactcad {ours:.2f} s", flush=True)
    start = time.perf_counter()
    kernel = every_pair_by_the_kernel(scene, shapes)
    theirs = time.perf_counter() - start
    same = verdicts(mine) == verdicts(kernel)
    print(f"kernel {theirs:.2f} s: {theirs / ours:.1f} x; {'same verdicts' if same else 'VERDICTS DIFFER'}")
    if args.json:
        figures = {
            "placed": len(scene.placements), "findings": len(mine), "seconds": round(ours, 3),
            "kernel_seconds": round(theirs, 3), "times_faster": round(theirs / ours, 2), "same_verdicts": same,
        }  # fmt: skip
        Path(args.json).write_text(json.dumps(figures, indent=1) + "\n")
    return 0 if same else 1


if __name__ == "__main__":
    raise SystemExit(main())
