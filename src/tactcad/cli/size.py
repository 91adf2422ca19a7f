"""`tactcad size`: the hinge thickness (or length) that gives a wanted stiffness at a load arm."""

from __future__ import annotations

import argparse
import json
import math
from contextlib import suppress
from typing import TYPE_CHECKING

from tactcad.design.load import DEFAULT_DESIGN
from tactcad.design.messages import CheckFailure, InputError, one_of
from tactcad.design.text_values import as_number
from tactcad.mechanics.ladder import CLOSED_FORMS, DEFAULT_RUNG
from tactcad.mechanics.section import REQUIRED, HingeSection

from .parser import BY_NAME, UNLISTED, add_allowance, allowance, refuse_named

if TYPE_CHECKING:
    from tactcad.design.tree import Design


# Lengths that --with takes besides the load arm, which has its own option.
LENGTHS = tuple(name for name in REQUIRED if name not in ("load_arm", "poisson", "youngs_modulus"))
OWN = ("sides", *LENGTHS, "youngs_modulus", "poisson", "alloy")


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--stiffness", type=float, required=True, metavar="K")
    parser.add_argument("--load-arm", type=float, required=True, metavar="L")
    parser.add_argument("--solve", choices=("thickness", "length"), default="thickness")
    parser.add_argument(
        "design", nargs="?", default=DEFAULT_DESIGN, help=f"gives all other values (default {DEFAULT_DESIGN})"
    )
    parser.add_argument(
        "--with",
        dest="changes",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help=f"instead of the design's; may be repeated: {', '.join(OWN)}",
    )
    parser.add_argument("--design", dest=f"design{BY_NAME}", help=UNLISTED)
    for name in OWN:  # each as an option of its own, as before
        kind = str if name in ("sides", "alloy") else float
        parser.add_argument(f"--{name.replace('_', '-')}", type=kind, help=UNLISTED)
    parser.add_argument("--force", type=float, metavar="N")
    parser.add_argument("--tolerance", type=float, metavar="MM")
    parser.add_argument(
        "--model",
        choices=CLOSED_FORMS,
        metavar="RUNG",
        help=f"one of {', '.join(CLOSED_FORMS)} (default {DEFAULT_RUNG})",
    )
    add_allowance(parser, "error of K, against solid elements refined to their limit,", "rung")
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    _take(args)
    for option in ("stiffness", "load_arm", "tolerance", "youngs_modulus", *LENGTHS):
        value = getattr(args, option)
        if value is not None and not 0.0 < value < math.inf:
            raise InputError(f"--{option.replace('_', '-')}", "not a positive number", value=value)
    if args.force is not None:
        from tactcad.design.tree import ASKED_FORCE

        ASKED_FORCE.read(args.force, "--force")
    if args.poisson is not None and not 0.0 <= args.poisson < 0.5:
        raise InputError("--poisson", "not a Poisson's ratio", value=args.poisson, legal="0 to 0.5")
    parameter = f"hinge_{args.solve}"
    if getattr(args, parameter) is not None:
        raise InputError(
            f"--hinge-{args.solve}", "is the result; leave it out", value=getattr(args, parameter)
        )
    from tactcad.design.family import taken_as
    from tactcad.design.tree import Design
    from tactcad.lab.array_estimate import material_lines, material_record
    from tactcad.parts.rules import load

    asked = allowance(args)
    refuse_named(asked, "--model", args.model)
    design = taken_as(load(args.design), Design, "size")
    if asked.within is None:
        answer = _answer(args, design, parameter, args.model or DEFAULT_RUNG)
    else:
        answer = _answer_within(args, design, parameter, asked.within)
    own = args.youngs_modulus is None and args.alloy is None  # else the design's material is not needed
    if args.json:
        print(json.dumps(answer | (material_record(design) if own else {}), indent=2))
    else:
        further = material_lines(design, [answer["stiffness"]]) if own else []
        print("\n".join([_report(answer), *further]))
    return 0


def _take(args: argparse.Namespace) -> None:
    """The values of --with, as if each were an option of its own."""
    for change in args.changes:
        name, equals, value = (part.strip() for part in change.partition("="))
        if not equals or name not in OWN:
            raise InputError("--with", "unknown", value=change, legal=f"NAME=VALUE, NAME {one_of(name, OWN)}")
        try:
            setattr(args, name, value if name in ("sides", "alloy") else as_number(value))
        except ValueError:
            raise InputError(f"--with {name}", "not a number", value=value) from None
    if args.sides not in (None, "one", "two"):
        raise InputError("sides", "unknown", value=args.sides, legal="one or two")


def _answer_within(args: argparse.Namespace, design: Design, parameter: str, within: float) -> dict:
    """By the cheapest rung whose error of K, for the hinge found, is within that."""
    from tactcad.design.allowance import percent

    best, least = _answer(args, design, parameter, DEFAULT_RUNG), math.inf
    for rung in CLOSED_FORMS:
        with suppress(CheckFailure):
            answer = _answer(args, design, parameter, rung)
            error = math.inf if answer["expected_error"] is None else answer["expected_error"]
            if error <= within:
                return answer
            best, least = (answer, error) if error < least else (best, least)
    known = (
        f"the best is {best['model']}, {percent(least)}" if least < math.inf else "no error was measured here"
    )
    raise CheckFailure(f"nothing keeps K within {percent(within)}: {known}")


def _answer(args: argparse.Namespace, design: Design, parameter: str, model: str) -> dict:
    from tactcad.design.materials import alloy as alloy_named
    from tactcad.mechanics import ladder, strain, strength
    from tactcad.mechanics.accuracy import expected_error_of
    from tactcad.mechanics.ladder import size
    from tactcad.parts.array.hinge_section import design_alloy

    section = _section(args, design)
    alloy = alloy_named(args.alloy) if args.alloy else design_alloy(design)
    tolerance = args.tolerance or getattr(design.tolerance, parameter)
    force = args.force or design.rating.force
    value = size(section, args.stiffness, parameter, model)
    ends = [_stiffness_at(section, parameter, value + sign * tolerance, model) for sign in (-1, 1)]
    sized = section.with_(**{parameter: value})
    elastic = bool(strength.elastic(sized, alloy, force))
    per_cut = (strain.peak(sized, force, model), strain.gauge(sized, force, design.gauge.grid_length, model))
    yields_at = float(strength.yield_force(sized, alloy))
    error = float(expected_error_of(sized, model))
    return {
        "model": model,
        "solved": parameter,
        "value": value,
        "tolerance": tolerance,
        "stiffness": float(ladder.stiffness(sized, model)),
        "expected_error": error if math.isfinite(error) else None,
        "stiffness_interval": sorted(ends),
        "section": {
            name: float(getattr(sized, name)) for name in ("load_arm", "poisson", "youngs_modulus", *LENGTHS)
        }
        | {"sides": "two" if bool(sized.two_sided) else "one"},
        "alloy": alloy.name,
        "force": force,
        "elastic": elastic,
        "peak_strain": float(per_cut[0]) if elastic else None,
        "gauge_strain": float(per_cut[1]) if elastic else None,
        "stress": float(strain.peak_stress(sized, force)) if elastic else None,
        "yield_force": yields_at,
        "yield_deflection": yields_at / args.stiffness,
        "rated_force": float(min(force, yields_at / design.rating.yield_factor)),
    }


def _stiffness_at(section: HingeSection, parameter: str, value: float, model: str) -> float:
    from tactcad.mechanics import ladder

    try:
        return float(ladder.stiffness(section.with_(**{parameter: value}), model))
    except CheckFailure as refusal:
        raise CheckFailure(f"at the tolerance's end, {parameter} {value:.4g} mm: {refusal}") from None


def _section(args: argparse.Namespace, design: Design) -> HingeSection:
    """The design's element with what the options change, at the asked load arm."""
    from tactcad.parts.array.hinge_section import own_parameters, shared_parameters
    from tactcad.parts.array.layout import Layout

    layout = Layout(design)
    e = design.element
    given = {name: getattr(args, name) for name in REQUIRED if getattr(args, name) is not None}
    if args.sides:
        given["two_sided"] = args.sides == "two"
    slot = given.get("hinge_length", e.hinge_length)
    hinge_x = layout.pad_inner + e.pad_length / 2.0 + args.load_arm
    # an arm longer than the array's moves the clamp edge out and keeps the seat behind its slot
    body_length = max(layout.clamp_edge - hinge_x - slot / 2.0, e.seat_length)
    usual = own_parameters(layout.common_hinge, args.load_arm, body_length) | shared_parameters(design)
    return HingeSection.of(**(usual | given))


def _report(a: dict) -> str:
    from tactcad.mechanics.accuracy import stated

    low, high = a["stiffness_interval"]
    name = a["solved"].replace("_", " ")
    strained = (
        f"strain gauge {1e6 * a['gauge_strain']:.0f}e-6, fillet {1e6 * a['peak_strain']:.0f}e-6, "
        f"stress {a['stress']:.0f} MPa"
        if a["elastic"]
        else "invalid: above yield"
    )
    s = a["section"]
    return "\n".join(
        (
            f"{name} {a['value']:.4f} mm for {a['stiffness']:.4g} N/mm at L {s['load_arm']:g} mm "
            f"({s['sides']}-sided, rung {a['model']})",
            *([stated(a["expected_error"])] if a["expected_error"] is not None else []),
            f"as cut: +-{a['tolerance']:g} mm leaves {low:.4g} to {high:.4g} N/mm "
            f"({low / a['stiffness'] - 1:+.1%} to {high / a['stiffness'] - 1:+.1%})",
            f"at {a['force']:g} N, {a['alloy']}: {strained}",
            f"yields at {a['yield_force']:.3g} N and {1e3 * a['yield_deflection']:.4g} um; "
            f"rated force {a['rated_force']:.3g} N",
        )
    )
