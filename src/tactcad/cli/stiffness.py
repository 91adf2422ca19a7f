"""tactcad stiffness FILE --calibration FILE [--reference N] [--level P] [--json]"""

from __future__ import annotations

import argparse
import sys

from .parser import add_needless_allowance, allowance

EXAMPLES = """\
  tactcad calibrate hardware/examples/calibration.csv --out calibration.csv
  tactcad stiffness hardware/examples/grasp.csv --calibration calibration.csv
  tactcad stiffness mine.csv --calibration calibration.csv --reference 1 --json

FILE is CSV with the columns load, element, signal (N and V, or load_mN, signal_mV), and where there are
several, run and sample: every element at every load. The calibration is what `tactcad calibrate` wrote
(--out, or --json)."""


def configure(parser: argparse.ArgumentParser) -> None:
    from tactcad.design.load import DEFAULT_DESIGN

    parser.add_argument("file", metavar="FILE", help="grasp readings (CSV)")
    parser.add_argument(
        "--calibration", required=True, metavar="FILE", help="calibration of the elements (CSV or JSON)"
    )
    parser.add_argument(
        "--reference",
        type=int,
        default=None,
        metavar="N",
        help="the reference element (default: the stiffest of those read)",
    )
    parser.add_argument(
        "--level", type=float, default=0.95, metavar="P", help="level of the intervals (default 0.95)"
    )
    parser.add_argument(
        "--design",
        metavar="DESIGN",
        default=None,
        help="the array that was pressed: where its pads stand says how far they feel each other through "
        "the object "
        f"(default {DEFAULT_DESIGN})",
    )
    parser.add_argument(
        "--coupling",
        type=float,
        default=1.0,
        metavar="C",
        help="the object couples the pads by at most this share of what an elastic half-space does (default "
        "1; 0: each "
        "pad on an object of its own); the intervals hold for all up to it",
    )
    parser.add_argument(
        "--thickness",
        type=float,
        metavar="MM",
        help="of the object, an incompressible layer on a rigid base (inf: a half-space): its Young's "
        "modulus is printed too",
    )
    parser.add_argument("--json", action="store_true", help="print as JSON")
    add_needless_allowance(parser)


def run(args: argparse.Namespace) -> int:
    from tactcad.design.family import family_of
    from tactcad.design.load import DEFAULT_DESIGN
    from tactcad.lab import calibration_file, grasp, pads, readings
    from tactcad.parts.designs import load

    from .streams import slow_work

    allowance(args)
    known = calibration_file.read(args.calibration)
    results: list[grasp.Grasp] = []
    source = args.design or DEFAULT_DESIGN
    design = load(source)
    family = family_of(design)
    readings_of = family.must("readings", "stiffness --design")
    unit = None
    if args.thickness is not None:
        unit = pads.stiffness_per_modulus(design, args.thickness, "--thickness")
    with slow_work(sys.stderr) as tell:
        tell(0, 1, f"reading {args.file}")
        samples = readings.grasps(args.file)
        for g in samples:
            tell(len(results), len(samples), f"sample {g.sample}")
            results.append(
                grasp.evaluate(
                    g,
                    known,
                    reference=args.reference,
                    level=args.level,
                    coupling=pads.coupling(source, g, args.coupling),
                    overload_force=readings_of.overload(design),
                    elements=len(family.layout(design).elements),
                )
            )
    sys.stdout.write((grasp.to_json if args.json else grasp.to_text)(results, args.level, unit))
    return 0
