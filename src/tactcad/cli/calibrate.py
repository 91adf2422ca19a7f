"""tactcad calibrate FILE [--load-cell K] [--level P] [--drop-outliers] [--out FILE] [--json]"""

from __future__ import annotations

import argparse
import sys

EXAMPLES = """\
  tactcad calibrate hardware/examples/calibration.csv                     Table 1's columns with intervals
  tactcad calibrate mine.csv --load-cell 57.04 --out cal.csv      and write them for `tactcad stiffness`
  tactcad calibrate mine.csv --load-cell inf --json                       a rigid force sensor; JSON

FILE is CSV with the columns element, run, displacement, force, signal: the stage's displacement, in mm, N
and V; or with the unit in the name: displacement_um, force_mN, signal_mV. Lines that start with # are
comments; semicolons or tabs between columns, and decimal commas with them, are read too."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE", help="readings (CSV)")
    parser.add_argument(
        "--load-cell",
        type=float,
        default=None,
        metavar="K",
        help="the force sensor's own stiffness in N/mm, which took its share of the displacement "
        "(inf for a rigid one; default the paper's 57.04)",
    )
    parser.add_argument(
        "--level", type=float, default=0.95, metavar="P", help="level of the intervals (default 0.95)"
    )
    parser.add_argument("--drop-outliers", action="store_true", help="leave named outliers out of the fit")
    parser.add_argument("--out", metavar="FILE", help="write the calibration as CSV, for `tactcad stiffness`")
    parser.add_argument("--json", action="store_true", help="print as JSON")


def run(args: argparse.Namespace) -> int:
    from tactcad.design.files import refuse_overwriting, write_whole
    from tactcad.lab import calibration, calibration_text, readings
    from tactcad.paper import published

    from .progress import slow_work

    if args.out:
        refuse_overwriting(args.out, args.file)
    load_cell = published.load().figure["load_cell_stiffness"] if args.load_cell is None else args.load_cell
    with slow_work(sys.stderr) as tell:
        tell(0, 1, f"reading {args.file}")
        read = readings.calibration(args.file)
        rows = calibration.calibrate(
            read, load_cell, level=args.level, drop_outliers=args.drop_outliers, tell=tell
        )
    if args.out:
        write_whole(args.out, calibration_text.to_csv(rows, load_cell).encode())
    sys.stdout.write(
        calibration_text.to_json(rows, load_cell, args.level)
        if args.json
        else calibration_text.to_text(rows, load_cell, args.level)
    )
    return 0
