"""tactcad readings FILE --map MAP --out CSV [--json]"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tactcad.lab.log_readings import Taken


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE")
    parser.add_argument("--map", required=True, metavar="MAP")
    parser.add_argument("-o", "--out", required=True, metavar="CSV")
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from tactcad.design.files import refuse_overwriting, write_whole
    from tactcad.design.messages import InputError
    from tactcad.lab import log_readings

    refuse_overwriting(args.out, args.file, args.map)
    plot = Path(args.out).with_suffix(".svg")
    if Path(args.out).suffix.lower() == ".svg":
        raise InputError("--out", "the plot would overwrite the readings", value=args.out, legal="a .csv")
    refuse_overwriting(plot, args.file, args.map, args.out)
    taken = from_log(args.file, args.map)
    (log_readings.calibration if taken.kind == "calibration" else log_readings.grasps)(taken)  # they read it
    picture = log_readings.picture(taken)
    write_whole(args.out, taken.table.encode())
    write_whole(plot, picture.encode())
    if args.json:
        sys.stdout.write(log_readings.to_json(taken))
    else:
        sys.stdout.write(log_readings.to_text(taken) + f"\n{args.out}, {plot}\n")
    return 0


def from_log(file: str, by: str) -> Taken:
    """A log's readings by its map; elements left out are named on standard error."""
    from tactcad.lab.log_files import read_log
    from tactcad.lab.log_map import read_map
    from tactcad.lab.log_readings import take

    asked = read_map(by)
    taken = take(read_log(file), asked)
    for n, why in taken.left_out.items():
        print(f"warning: {file}: element {n} ({taken.columns[n]}) left out: {why}", file=sys.stderr)
    return taken


def add_map(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--map",
        metavar="MAP",
        help="FILE is a lab's log (CSV, .lvm, .tdms); MAP describes its columns: tactcad readings --help",
    )
