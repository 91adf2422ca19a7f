"""tactcad stiffness FILE --calibration FILE [--reference N] [--level P] [--json]"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

from .parser import add_needless_allowance, allowance
from .readings import add_map, from_log

if TYPE_CHECKING:
    from tactcad.design.tree import Design


def configure(parser: argparse.ArgumentParser) -> None:
    from tactcad.design.load import DEFAULT_DESIGN

    parser.add_argument("file", metavar="FILE")
    add_map(parser)
    parser.add_argument("--calibration", required=True, metavar="FILE")
    parser.add_argument("--reference", type=int, default=None, metavar="N")
    parser.add_argument("--level", type=float, default=0.95, metavar="P")
    parser.add_argument(
        "--design",
        metavar="DESIGN",
        default=None,
        help="the array that was pressed; the places of its pads decide their coupling through the object "
        f"(default {DEFAULT_DESIGN})",
    )
    parser.add_argument("--coupling", type=float, default=None, metavar="C")
    parser.add_argument("--thickness", metavar="H[+-DH]")
    parser.add_argument("--nu", type=float, default=None, metavar="NU")
    parser.add_argument("--picture", metavar="FILE.svg")
    parser.add_argument("--json", action="store_true")
    add_needless_allowance(parser)


def run(args: argparse.Namespace) -> int:
    from tactcad.design.family import family_of
    from tactcad.design.load import DEFAULT_DESIGN
    from tactcad.parts.rules import load

    allowance(args)
    args.design = args.design or DEFAULT_DESIGN
    design = load(args.design)
    return family_of(design).must("readings", "stiffness --design").stiffness(args, design)


def stiffness_rows(args: argparse.Namespace, design: Design) -> int:
    """Evaluate facing rows: one component an element."""
    from tactcad.design.messages import InputError
    from tactcad.lab import calibration_file, grasp, log_readings, pads, readings

    from .streams import slow_work

    if args.picture:
        legal = "a planar design; grasp --out draws the pressure under facing rows"
        raise InputError("--picture", "does not take designs of this family", value=args.picture, legal=legal)
    if args.coupling is not None and (args.thickness or args.nu) is not None:
        raise InputError("--coupling", "takes the object as springs", legal="without --thickness and --nu")
    known = calibration_file.read(args.calibration)
    results: list[grasp.Grasp] = []
    with slow_work(sys.stderr) as tell:
        tell(0, 1, f"reading {args.file}")
        samples = (
            log_readings.grasps(from_log(args.file, args.map)) if args.map else readings.grasps(args.file)
        )
        tell(0, len(samples), "layers under the pads")
        layers = pads.layers(design, args.thickness, args.nu) if args.coupling is None else []
        for g in samples:
            tell(len(results), len(samples), f"sample {g.sample}")
            shares = pads.coupling(args.design, g, args.coupling or 0.0)
            stopped: tuple[str, ...] = ()
            if layers:
                pads.refuse_strangers(args.design, g)
                g, stopped = grasp.below_stops(g, known, layers[0])
            found = grasp.evaluate(
                g,
                known,
                reference=args.reference,
                level=args.level,
                coupling=shares,
                overload_force=design.rating.overload_force,
                elements=sum(map(len, design.array.row_arms)),
            )
            if layers:
                found = grasp.on_layers(found, g, known, layers, args.level)
            results.append(replace(found, notes=(*stopped, *found.notes)))
    sys.stdout.write((grasp.to_json if args.json else grasp.to_text)(results, args.level))
    unbounded = [g.sample for g in results if g.layer and g.layer.modulus and not g.layer.modulus.bounded]
    if unbounded:
        print(
            f"the readings do not bound the modulus of sample {', '.join(map(str, unbounded))}",
            file=sys.stderr,
        )
    return 1 if unbounded else 0
