"""`tactcad grasp`: an array pressed on a soft body: each element's force and deflection, and K_obj by
equation (3)."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from tactcad.design.messages import InputError, one_of
from tactcad.design.text_values import as_number

from .parser import add_design

if TYPE_CHECKING:
    from tactcad.contact.elastic_body import Body
    from tactcad.lab.pressed import PressedArray


PAPERS_LOAD = 3.235  # N; the paper's axis without weights
RUNGS = ("springs", "layer", "fem-object", "large")
OBJECT = ("E", "nu", "thickness", "base")


def configure(parser: argparse.ArgumentParser) -> None:
    add_design(parser)
    parser.add_argument("--object", required=True, metavar="E=..,nu=..,thickness=..")
    parser.add_argument(
        "--load",
        type=float,
        default=PAPERS_LOAD,
        metavar="N",
        help=f"on the whole array (default {PAPERS_LOAD:g}, the paper's axis without weights)",
    )
    parser.add_argument("--angle", default="0,0", metavar="AX,AY")
    parser.add_argument("--rung", choices=RUNGS)
    parser.add_argument("--within", metavar="P")
    parser.add_argument("-o", "--out", metavar="FILE.svg")
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from tactcad.design.allowance import read_within
    from tactcad.design.files import refuse_overwriting, write_whole
    from tactcad.design.load import find
    from tactcad.lab.pressed import press_array
    from tactcad.parts.rules import load

    within = None if args.within is None else read_within(args.within, "--within")
    body, angle = read_object(args.object), read_angle(args.angle)
    if args.out:
        refuse_overwriting(args.out, find(args.design))
    design = load(args.design)
    done = press_array(design, body, args.load, angle, args.rung, within)
    if args.out:
        if done.patches is None:
            raise InputError("--out", "springs have no pressure to draw", legal="another --rung")
        write_whole(args.out, picture(done, design.name).encode())
    print(json.dumps(as_json(done, design.name), indent=2) if args.json else as_text(done))
    return 0


def read_object(text: str) -> Body:
    """The body that --object names. Raises InputError if something is missing, unknown or out of range."""
    from tactcad.contact.elastic_body import Body

    given: dict[str, str] = {}
    for item in text.split(","):
        name, equals, value = (part.strip() for part in item.partition("="))
        if not equals or name not in OBJECT:
            raise InputError(
                "--object", "unknown", value=item, legal=one_of(name, OBJECT) + ", each as NAME=VALUE"
            )
        if name in given:
            raise InputError("--object", "twice", value=name, legal="once")
        given[name] = value
    if missing := [name for name in OBJECT[:3] if name not in given]:
        raise InputError(
            "--object", f"lacks {', '.join(missing)}", value=text, legal="E=..,nu=..,thickness=.."
        )
    modulus, poisson, thickness = (_number(f"--object {name}", given[name]) for name in OBJECT[:3])
    return Body(modulus, poisson, thickness, given.get("base", "bonded"))


def read_angle(text: str) -> tuple[float, float]:
    """Both angles of --angle, degrees."""
    parts = text.split(",")
    if len(parts) != 2:
        raise InputError(
            "--angle", "two numbers are wanted", value=text, legal="AX,AY in degrees, such as 0.5,0"
        )
    x, y = (_number("--angle", part) for part in parts)
    return x, y


def _number(where: str, text: str) -> float:
    try:
        return as_number(text)
    except ValueError:
        raise InputError(where, "not a number", value=text, legal="a number") from None


def as_json(done: PressedArray, design: str) -> object:
    """The document of --json: mm, N, degrees, and signal_unit."""
    from tactcad.report.report import plain

    return plain(
        {
            "design": design,
            "rung": done.rung,
            "object": done.body,
            "object_stiffness": done.object_stiffness,
            "load": done.load,
            "angle": done.angle,
            "approach": done.approach,
            "signal_unit": done.signal_unit[0],
            "expected_error": done.expected_error,
            "elements": [
                {"no" if name == "number" else name: value for name, value in vars(e).items()}
                for e in done.elements
            ],
            "pairs": done.pairs,
        }
    )


def as_text(done: PressedArray) -> str:
    """Tables of elements and pairs, as people read them."""
    from tactcad.lab.pressed import ELEMENT, PAIR
    from tactcad.report.figures import listed, text_table

    body, h = done.body, done.body.thickness
    layer = "half-space" if h == inf else f"layer of {h:g} mm, {body.base}"
    shown = [replace(f, unit=done.signal_unit[1]) if f.name == "signal" else f for f in ELEMENT.values()]
    lines = [
        f"object: {layer}, E {body.modulus:g} MPa, nu {body.poisson:g}; "
        f"K_obj {done.object_stiffness:.4g} N/mm under a single level pad",
        f"load {done.load:g} N, inclined {done.angle[0]:g}, {done.angle[1]:g} degrees; rung {done.rung}: "
        f"forces within {100 * done.expected_error:.2g} % of their mean",
        "",
        *text_table(shown, done.elements),
        "",
    ]
    away = [e.number for e in done.elements if not e.touches]
    stopped = [e.number for e in done.elements if e.stopped]
    lines += [f"without contact: no. {listed(away)}"] if away else []
    lines += [f"on their stops: no. {listed(stopped)}"] if stopped else []
    return "\n".join([*lines, *text_table(list(PAIR.values()), done.pairs)])


def picture(done: PressedArray, design: str) -> str:
    """The pressure under every pad, seen from the object, as SVG."""
    import numpy as np
    from matplotlib.collections import PolyCollection

    from tactcad.report.plots import note, panels, svg

    assert done.patches is not None  # springs are refused
    x, y, a, b, force = done.patches
    corners = [(x + s * a / 2, y + t * b / 2) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    outlines = list(np.moveaxis(np.array(corners), (0, 1), (-2, -1)).reshape(-1, 4, 2))
    pressure = 1e3 * (force / (a * b)).ravel()
    with panels(size=(6.0, 7.0)) as (figure, axes):
        # the pressure at a rigid pad's edges is singular: the scale ends with a tenth of the pads' area above
        order = np.argsort(pressure)
        area = np.cumsum((a * b).ravel()[order])
        top = float(pressure[order][np.searchsorted(area, 0.9 * area[-1])]) or float(pressure.max())
        shown = PolyCollection(outlines, array=pressure, cmap="viridis", clim=(0.0, top), linewidth=0)
        axes.add_collection(shown)
        for i, e in enumerate(done.elements):
            note(axes, f"no. {e.number}", (x[i].mean(), y[i].max() + 0.05), (0, 3), ha="center", fontsize=9)
        axes.set(xlabel="x, along the arms, mm", ylabel="y, along the rows, mm", aspect="equal")
        inclined = f"inclined {done.angle[0]:g} and {done.angle[1]:g} degrees"
        figure.suptitle(f"{design}: {done.load:g} N, {inclined}", fontsize=12)
        axes.autoscale_view()
        axes.margins(0.15)
        figure.colorbar(shown, ax=axes, label="pressure, kPa", extend="max")
        return svg(figure, "pressure")
