"""`tactcad estimate`: stiffness, strain and strength of a design's elements, or of a table of designs."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, replace
from typing import TYPE_CHECKING

from tactcad.design.allowance import Allowance, Picked, pick, read_within
from tactcad.design.messages import InputError
from tactcad.mechanics.ladder import DEFAULT_RUNG, FINITE_ELEMENTS, FITTED, RUNGS

from .parser import UNLISTED, add_allowance, allowance, refuse_named

if TYPE_CHECKING:
    from tactcad.design.tree import CommonTables, Design, Tolerance
    from tactcad.lab.array_estimate import ElementEstimate
    from tactcad.mechanics.accuracy import Candidate
    from tactcad.mechanics.section import HingeSection
    from tactcad.parts.array.layout import Layout


# An element's figures that the table for the terminal leaves out.
UNSHOWN = ("load_arm", "expected_error", "force", "gauge_strain_error", "peak_strain_error", "stress_error")


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("design", nargs="?")
    parser.add_argument(
        "--model",
        choices=RUNGS,
        metavar="RUNG",
        help=f"one of {', '.join(RUNGS)} (default {DEFAULT_RUNG}); never falls back to another",
    )
    add_allowance(parser, "error of K, against solid elements refined to their limit,", "rung")
    parser.add_argument("--accuracy", help=UNLISTED)  # --within by its older name
    parser.add_argument("--force", type=float, metavar="N")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--batch", metavar="IN.csv")
    parser.add_argument("-o", "--out", metavar="OUT.csv")
    parser.add_argument("--inspection", metavar="FILE")


def run(args: argparse.Namespace) -> int:
    if args.force is not None:
        from tactcad.design.tree import ASKED_FORCE

        ASKED_FORCE.read(args.force, "--force")
    # --accuracy is --within by its older name
    asked = allowance(args)
    if args.accuracy is not None:
        if args.within is not None:
            raise InputError("--accuracy", "is the same as --within; leave one out", value=args.accuracy)
        asked = replace(asked, within=read_within(args.accuracy, "--accuracy"))
    refuse_named(asked, "--model", args.model)
    if args.batch is not None:
        return _batch(args, asked)
    if args.out is not None:
        raise InputError("--out", "goes with --batch only", value=args.out)
    from tactcad.design.family import family_of
    from tactcad.parts.rules import load

    design = load(args.design or "macro-array")
    return family_of(design).estimate.run(args, asked, design)


def plain_estimate(args: argparse.Namespace, asked: Allowance, design: CommonTables) -> int:
    """Estimate a family with one model: its elements' figures."""
    from tactcad.design.family import family_of
    from tactcad.scenes import overall_size, stated_size

    family = family_of(design)
    for option, given in (("--model", args.model), ("--inspection", args.inspection), ("--within", asked)):
        if given:
            raise InputError(option, "does not take designs of this family", value=family.name)
    rows = [asdict(row) for row in family.estimate.rows(family.layout(design), DEFAULT_RUNG, args.force)]
    size = overall_size(design)
    if args.json:
        document = {"design": design.name, "family": family.name, "size_mm": size, "elements": rows}
        print(json.dumps(document, indent=2))
        return 0
    print(f"{design.name} {design.design.revision}, {design.material.alloy}, {stated_size(size)} overall")
    for row in rows:
        known = (f"{name} {v:.4g}" for name, v in row.items() if isinstance(v, int | float) and v is not True)
        print(f"  {', '.join(known)}")
    return 0


def estimate_design(args: argparse.Namespace, asked: Allowance, design: Design) -> int:
    """Estimate facing rows: by any rung, with tolerances; or as made, by the inspection sheet."""
    from tactcad.lab.array_estimate import compare_uncut, estimate
    from tactcad.parts.array.layout import Layout

    layout = Layout(design)
    if args.inspection is not None:
        return _as_made(args, asked, layout)
    chosen, picked = _chosen(layout, asked) if asked else (None, None)
    model, mesh = (chosen.rung, chosen.mesh) if chosen else (args.model or DEFAULT_RUNG, None)
    rows = estimate(layout, model, args.force, mesh)
    shares = _shares(layout, model)
    uncut = asdict(compare_uncut(layout)) if model in FINITE_ELEMENTS else None
    if args.json:
        document = _document(design, model, rows, uncut, shares)
        if picked:
            # the first two as --accuracy has always said them
            document |= {"accuracy_asked": asked.within, "expected_time_s": picked.grade.seconds}
            document |= {"mesh": mesh, "budget": picked.record()}
        print(json.dumps(document, indent=2))
    else:
        print(_report(layout, model, rows, uncut, shares))
        if picked:
            print(picked.text())
    return 0


def _chosen(layout: Layout, asked: Allowance) -> tuple[Candidate, Picked]:
    """The rung for all elements, equal ones solved once."""
    from tactcad.costs.grades import rung_grades
    from tactcad.lab.array_estimate import distinct_sections
    from tactcad.mechanics.accuracy import CANDIDATES, choose, require_measured

    section, names = distinct_sections(layout)
    require_measured(section, names)
    if asked.within is not None:
        choose(section, asked.within, names)  # refuses with the element that no rung answers
    picked = pick(rung_grades(section), asked, "K")
    return next(c for c in CANDIDATES if c.name == picked.grade.name), picked


def _batch(args: argparse.Namespace, asked: Allowance) -> int:
    from tactcad.design.files import refuse_overwriting
    from tactcad.lab.batch import estimate_file

    for name, given in (("DESIGN", args.design), ("--force", args.force), ("--inspection", args.inspection)):
        if given is not None:
            raise InputError("--batch", f"takes its designs from the table; leave out {name}", value=given)
    if args.json:
        raise InputError("--batch", "writes CSV; leave out --json")
    if args.out is None:
        raise InputError("--batch", "needs --out OUT.csv")
    refuse_overwriting(args.out, args.batch)
    said: list[Picked] = []

    def accuracy(section: HingeSection) -> float:
        from tactcad.costs.grades import row_grades

        grades = row_grades(section, asked.within) or row_grades(section)
        if not grades:
            return asked.within or 1.0  # no design has measured errors: each row notes it
        said.append(pick(grades, asked, "K"))
        return asked.within or said[0].grade.error

    rung = args.model or DEFAULT_RUNG
    valid, count = estimate_file(args.batch, args.out, rung, accuracy if asked else None)
    print(f"{args.out}: {count} designs, {count - valid} out of range" + (" or of reach" if asked else ""))
    for picked in said:
        print(picked.text())
    return 0


def _as_made(args: argparse.Namespace, asked: Allowance, layout: Layout) -> int:
    from tactcad.lab.as_made import as_made, document, report
    from tactcad.lab.inspection_sheet import read_sheet

    if asked:
        raise InputError(
            "--inspection", "takes no --within or --in: the cut's scatter is far above it; use --model"
        )
    if args.model in FINITE_ELEMENTS:
        closed = ", ".join(rung for rung in RUNGS if rung not in FINITE_ELEMENTS)
        raise InputError("--model", "--inspection takes closed forms only", value=args.model, legal=closed)
    model = args.model or DEFAULT_RUNG
    rows = as_made(layout, read_sheet(args.inspection, layout), model, args.force)
    if args.json:
        print(json.dumps(document(layout.design, model, rows), indent=2))
    else:
        print(report(layout.design, model, rows))
    return 0


def _worst(rows: list[ElementEstimate]) -> float | None:
    """Largest expected error of the elements; None if one element's was not measured."""
    errors = [row.expected_error for row in rows if row.expected_error is not None]
    return max(errors) if len(errors) == len(rows) else None


def _document(
    design: Design, model: str, rows: list[ElementEstimate], uncut: dict | None, shares: dict | None
) -> dict:
    from tactcad.lab.array_estimate import material_record
    from tactcad.mechanics.accuracy import accuracy_data
    from tactcad.parts.array.layout import Layout
    from tactcad.parts.array.stop_gap import overloads
    from tactcad.scenes import overall_size

    document = {
        "design": design.name,
        "revision": design.design.revision,
        "model": model,
        "alloy": design.material.alloy,
        "size_mm": overall_size(design),
        "force_N": rows[0].force,
        "units": {"length": "mm", "force": "N", "stiffness": "N/mm", "stress": "MPa", "strain": "1"},
        "expected_error": _worst(rows),
        "reference": accuracy_data()["reference"],
        "elements": [asdict(row) for row in rows],
        "as_built": [
            {"number": row.number} | {field: float(share[i]) for field, share in (shares or {}).items()}
            for i, row in enumerate(rows)
        ],
    }
    document["limits"] = [
        {"number": s.place.number, "endured_N": s.endured, "stop_N": s.earliest, "measurable_N": s.measurable}
        for s in overloads(Layout(design))
        if not s.refused
    ]
    return document | material_record(design) | ({"uncut": uncut} if uncut else {})


def _report(
    layout: Layout, model: str, rows: list[ElementEstimate], uncut: dict | None, shares: dict | None
) -> str:
    from tactcad.design.load import stale_origins
    from tactcad.lab.array_estimate import ELEMENT, material_lines
    from tactcad.mechanics.accuracy import stated
    from tactcad.parts.array.stop_gap import endurance, overloads, reach
    from tactcad.report.figures import text_table
    from tactcad.scenes import overall_size, stated_size

    from .streams import coloured

    design = layout.design
    lines = [
        f"{design.name} {design.design.revision}, {design.material.alloy}, rung {model}, "
        f"{rows[0].force:g} N on each pad, {stated_size(overall_size(design))} overall",
        *text_table(
            [f for name, f in ELEMENT.items() if name not in UNSHOWN],
            rows,
            lambda row: "-" if row.elastic else "invalid",
        ),
    ]
    lines += material_lines(design, [row.stiffness for row in rows])
    states = [state for state in overloads(layout) if not state.refused]
    said = [("fatigue", endurance(layout, states)), ("stop", reach(states))]
    said += [("origin", text) for text in stale_origins(design)]
    lines += [coloured(f"flag: {name}: {text}", "flag", sys.stdout) for name, text in said if text]
    plastic = [str(row.number) for row in rows if not row.elastic]
    if plastic:
        lines.append(
            f"invalid: above yield at this force, strain and stress not given: no. {', '.join(plastic)}"
        )
    if uncut:
        lines.append(
            f"uncut contour of no. {uncut['number']}, with pad, land and holes, held between spacers, in "
            f"plane stress: "
            f"{uncut['uncut']:.4g} N/mm, {uncut['uncut'] / uncut['model'] - 1:+.2%} against the model "
            "cut at load line and clamp edge"
        )
    if (worst := _worst(rows)) is not None:
        lines.append(stated(worst))
    if model in ("solid", "fem-solid"):
        lines.append(_errors(rows))
    if shares:
        lines += _spread(design.tolerance, shares)
    return "\n".join(lines)


def _errors(rows: list[ElementEstimate]) -> str:
    """Stated errors of strain and stress against refined solid elements, of the worst element."""
    from tactcad.lab.array_estimate import ELEMENT

    told = []
    for figure in ELEMENT.some("gauge_strain_error", "peak_strain_error", "stress_error"):
        known = [value for row in rows if (value := figure.of(row)) is not None]
        share = figure.written(max(known)) + figure.unit if len(known) == len(rows) else "not known"
        told.append(f"{figure.heading} {share}")
    return (
        f"error against refined elements, at most: strain {', '.join(told)} (at mid-width; docs/mechanics.md)"
    )


def _spread(tolerance: Tolerance, shares: dict) -> list[str]:
    """Spread of these numbers by the hinge's tolerance alone and by all of [tolerance], of the worst
    element.
    """
    from tactcad.mechanics.as_built import together

    alone = shares["hinge_thickness"]
    least, most = float(alone.min()), float(alone.max())
    share = f"{alone.mean():.1%}" if most < 1.1 * least else f"{least:.1%} to {most:.1%}"
    total = together(shares.values())
    worst = int(total.argmax())
    largest = sorted(shares, key=lambda field: -shares[field][worst])
    parts = ", ".join(
        f"{field} {shares[field][worst]:.1%}" for field in largest if shares[field][worst] > 0.0005
    )
    return [
        f"as cut: hinge thickness +-{1e3 * tolerance.hinge_thickness:g} um alone is K +-{share}; measure it",
        f"as built: all of [tolerance] together K +-{total[worst]:.1%} at no. {worst + 1} (95 %): {parts}",
    ]


def _shares(layout: Layout, model: str) -> dict | None:
    """Relative half-widths of every element's K, by field of [tolerance]; None for a rung without fillets."""
    if model not in FITTED:
        return None
    from tactcad.mechanics.as_built import half_widths
    from tactcad.parts.array.hinge_section import hinge_section

    return half_widths(hinge_section(layout, layout.elements), layout.design.tolerance, model)
