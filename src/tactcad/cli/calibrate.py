"""tactcad calibrate FILE [--load-cell K | --design DESIGN] [--level P] [--drop-outliers] [--out FILE]
[--json]"""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from tactcad.design.messages import InputError

from .parser import add_needless_allowance, allowance
from .readings import add_map, from_log

if TYPE_CHECKING:
    from tactcad.design.tree import Design
    from tactcad.lab.load_cell import LoadCell


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE")
    add_map(parser)
    parser.add_argument("--load-cell", metavar="K[+-U]")
    parser.add_argument("--design", metavar="DESIGN")
    parser.add_argument("--run-scatter", type=float, metavar="S")
    parser.add_argument("--level", type=float, default=0.95, metavar="P")
    parser.add_argument("--drop-outliers", action="store_true")
    parser.add_argument("-o", "--out", metavar="FILE")
    parser.add_argument("--json", action="store_true")
    add_needless_allowance(parser)


def run(args: argparse.Namespace) -> int:
    from tactcad.design.family import family_of
    from tactcad.design.files import refuse_overwriting
    from tactcad.parts.rules import load

    allowance(args)
    if args.out:
        refuse_overwriting(args.out, args.file, args.map)
    if args.design is None:
        return calibrate_rows(args, None)
    design = load(args.design)
    return family_of(design).must("readings", "calibrate --design").calibrate(args, design)


def calibrate_rows(args: argparse.Namespace, design: Design | None) -> int:
    """Calibrate facing rows: one component an element."""
    from tactcad.design.files import write_whole
    from tactcad.lab import calibration, calibration_file, column_units, log_readings, readings

    from .streams import slow_work

    load_cell = _load_cell(args.load_cell, args.design, design)
    with slow_work(sys.stderr) as tell:
        tell(0, 1, f"reading {args.file}")
        if args.map:
            table = log_readings.calibration(from_log(args.file, args.map))
        else:
            table = readings.calibration(args.file)
        rows = calibration.calibrate(
            table,
            load_cell,
            level=args.level,
            drop_outliers=args.drop_outliers,
            run_scatter=args.run_scatter,
            tell=tell,
        )
    warnings = column_units.against_design(table, rows, load_cell, design) if design else []
    if args.out:
        write_whole(args.out, calibration_file.to_csv(rows, load_cell).encode())
    if args.json:
        sys.stdout.write(calibration_file.to_json(rows, load_cell, args.level, warnings))
    else:
        above = "".join(f"warning: {warning}\n" for warning in warnings)
        sys.stdout.write(above + calibration_file.to_text(rows, load_cell, args.level))
    return 0


def _load_cell(given: str | None, source: str | None, design: Design | None) -> LoadCell:
    """The load cell of --load-cell or of the design's [calibration]; without either the paper's, with limits
    that are assumed."""
    from tactcad.lab.load_cell import LoadCell, of_design

    if design is None:
        from tactcad.paper import published

        return LoadCell.parse(given or str(published.load().figure["load_cell_stiffness"]))
    if given is not None:
        raise InputError(
            "--load-cell", "is in the design's [calibration], too; leave one of them out", value=given
        )
    cell = of_design(design)
    if cell is None:
        raise InputError(f"design {source}", "has no [calibration] table, which would name the load cell")
    return cell
