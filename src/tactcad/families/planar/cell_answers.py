"""What `tactcad design` says of a planar target: yield, bounds, limits, the base compared; text, JSON, a page
and the design, in a folder written in one step."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from html import escape
from math import ceil, inf
from typing import Any

import numpy as np

from tactcad.design.design_text import design_text
from tactcad.stacks.virtual_build import of_share
from tactcad.synthesis import target_report as page
from tactcad.synthesis.bounds import Bound

from . import cell_targets as targets
from .beam import Array
from .cell_board import why_none
from .cell_layout import PlanarLayout
from .cell_targets import KINDS, CellAnswer, CellFound, CellTarget, designed, evaluated, fits, half_width
from .rules import design_rules

LEVEL = 0.95  # of the intervals
SHARE = 0.5  # of the seconds asked for, for the search
NEAR = 1e-9  # relative; a value nearer to a bound lies on it
ARRAYS = 200  # built virtually where no number is asked for
# Fields whose step beyond eases the target, and the factor of that step; counts go by one.
EASED = {
    "planar.pitch[0]": 1 / 1.1,
    "planar.pitch[1]": 1.1,
    "planar.foils[0]": 1 / 1.1,
    "planar.foils[1]": 1.1,
    "planar.length": 1.1,
    "planar.width": 1.1,
    "planar.force": 1.1,
    "planar.shear": 0.9,
    "planar.readings": 1.2,
    "planar.matrices": 0.9,
    "rating.yield_factor": 1 / 1.1,
}
LIMITS = ("planar.shear", "planar.readings", "planar.matrices")  # of every answer: no bound to lie on
VARIED = ("planar.pitch", "measuring.beam_width", "reference.beam_width", "reference.island", "hall.gap")
FIELDS = dict(zip(targets.STEPS, VARIED))  # of the design, by what the search varies


def stepped(t: CellTarget, field: str) -> tuple[Any, Any, CellTarget]:
    """A field's value, its value one step beyond, and the target with that."""
    table, _, name = field.partition(".")
    name, _, end = name.partition("[")
    own = getattr(t if table == "planar" else t.base, table)
    value = new = getattr(own, name)
    if end:
        at, ends = int(end[0]), [min(value), max(value)]
        value, further = ends[at], round(ends[at] * EASED[field], 6)
        ends[at] = further
        new = tuple(ends) if name == "pitch" else (*new, further)
    elif isinstance(value, int):
        new = further = round(value * EASED[field] + 0.5)
    else:
        new = further = round(value * EASED[field], 9 if table == "planar" else 4)
    changed = {table: replace(own, **{name: new})}
    eased = changed if own is t.planar else {"base": replace(t.base, **changed)}
    return value, further, replace(t, **eased)


def around(t: CellTarget, best: CellFound) -> float | None:
    """The best half-width around a found design under another target; None if none keeps the rules there."""
    found = [evaluated(t, replace(best.choice, foil=foil)) for foil in t.planar.foils or ()]
    if not any(isinstance(f, CellFound) for f in found):
        found = [evaluated(t, choice) for _, choice in targets.beside(t, best.choice)]
    starts = [f for f in found if isinstance(f, CellFound)]
    return min((targets.refined(t, f, 1).half_width for f in starts), default=None)


def touched(t: CellTarget, best: CellFound) -> list[str]:
    """Fields whose values bound the answer."""
    m, c = t.planar, best.choice
    foils, rated = m.foils or (c.foil,), [best.soft.rated, best.stiff.rated]
    wider = replace(c, pitch=c.pitch + targets.STEPS["pitch"] / 2.0**targets.ROUNDS)
    full = c.pitch < m.pitch[1] and designed(t, wider) is None
    at = {
        "planar.pitch[0]": c.pitch <= m.pitch[0] * (1 + NEAR),
        "planar.pitch[1]": c.pitch >= m.pitch[1] * (1 - NEAR),
        "planar.length": full and designed(stepped(t, "planar.length")[2], wider) is not None,
        "planar.width": full and designed(stepped(t, "planar.width")[2], wider) is not None,
        "planar.foils[0]": c.foil <= min(foils),
        "planar.foils[1]": c.foil >= max(foils),
        "planar.force": max(rated) >= m.force * (1 - NEAR),
        "rating.yield_factor": min(rated) < m.force * (1 - NEAR),
    }
    return [name for name, holds in at.items() if holds]


def bounds(t: CellTarget, best: CellFound) -> list[Bound]:
    """Bounds that the answer lies on: of target and base design with the result one step beyond, and rules
    that refuse a better design beside it."""
    out = []
    for field in touched(t, best):
        value, further, eased = stepped(t, field)
        whose = "default" if field.startswith("planar.") else "base design"
        whose = "written" if field.partition("[")[0] in t.written else whose
        out.append(Bound(field, value, whose, further, around(eased, best)))
    refused: dict[str, Bound] = {}
    for name, choice in targets.beside(t, best.choice, 0.5 ** (targets.ROUNDS - 1)):
        found, drawn = evaluated(t, choice), designed(t, choice)
        if isinstance(found, CellFound) or drawn is None or not fits(layout := PlanarLayout(drawn), *KINDS):
            continue
        width = targets.pair_half_width(t, layout)
        rule = found.check
        if width < best.half_width and (rule not in refused or width < (refused[rule].half_width or inf)):
            value, further = (getattr(c, name) for c in (best.choice, choice))
            whose = f"rule {rule} refuses the step"
            refused[rule] = Bound(FIELDS[name], value, whose, further, width)
    return out + list(refused.values())


def binding(t: CellTarget, best: CellFound) -> Iterator[dict[str, Any]]:
    """Fields that limit besides the bounds: each eased alone by a step."""
    for field in LIMITS:
        value, further, eased = stepped(t, field)
        width = around(eased, best)
        if width is not None and (gain := best.half_width - width) > 1e-3 * best.half_width:
            yield {"field": field, "value": value, "eased": further, "half_width": width, "gain": gain}


def made(t: CellTarget, best: CellFound, count: int, seed: int = 1) -> Array:
    """Half-widths of arrays built virtually, each read at the drawn design's rated forces: foil, etching, gap
    and remanence are one cause each for both kinds."""
    rng, d = np.random.default_rng(seed), best.design
    cut, out = PlanarLayout(d).process.tolerance(d.planar.thickness), []
    for foil, width, gap, remanence in rng.standard_normal((count, 4)) / 2.0:
        as_made = replace(
            d,
            planar=replace(d.planar, thickness=d.planar.thickness + d.foil_tolerance * foil),
            hall=replace(d.hall, gap=d.hall.gap + 2.0 * d.tolerance.stop_gap * gap),
            magnet=replace(d.magnet, remanence=d.magnet.remanence * (1.0 + d.magnet.tolerance * remanence)),
            **{k: replace(v := getattr(d, k), beam_width=v.beam_width + cut * width) for k in KINDS},
        )
        layout = PlanarLayout(as_made)
        drawn = zip(KINDS, (best.soft, best.stiff))
        cells = [targets.of_kind(layout, name, cell.rated) for name, cell in drawn]
        out.append(targets.widest(t, *cells))
    return np.array(out)


def of_base(t: CellTarget) -> dict[str, Any]:
    """The base design as it is, under the target's forces and knowledge: half-width, and why it misses."""
    b, m = t.base, t.planar
    layout = PlanarLayout(replace(b, rating=replace(b.rating, force=m.force, shear=m.shear)))
    width = targets.pair_half_width(t, layout) if fits(layout, *KINDS) else None
    rules: list[Any] = [*design_rules().values()]
    breaks = [f"rule {f.check}: {f.broken}" for rule in rules for f in rule(layout)]
    for name, half, most in (("length", layout.half[0], m.length), ("width", layout.half[1], m.width)):
        if 2.0 * half > most + 1e-9:
            breaks.append(f"planar.{name}: {2.0 * half:g} mm, at most {most:g} mm")
    p = b.planar
    if len(layout.elements) < m.cells:
        breaks.append(f"planar.cells: {len(layout.elements)}, at least {m.cells}")
    if not m.pitch[0] - 1e-9 <= p.pitch <= m.pitch[1] + 1e-9:
        breaks.append(f"planar.pitch: {p.pitch:g} mm, {m.pitch[0]:g} to {m.pitch[1]:g} mm")
    if p.thickness not in (m.foils or ()):
        breaks.append(f"planar.foils: {p.thickness:g} mm, not at hand")
    if width is not None and t.target.half_width is not None and not 100.0 * width <= t.target.half_width:
        breaks.append(f"target.half_width: {100 * width:.3g} %, at most {t.target.half_width:g} %")
    return {"name": b.name, "half_width": width, "breaks": breaks}


def record(a: CellAnswer, count: int, until: float = inf) -> dict[str, Any]:
    """The answer as plain data: the keys of a target of facing rows, as far as they mean something here.

    Parts that the time does not allow (`until` of `time.perf_counter`) are named in `left_out`.
    """
    t, best = a.target, a.best
    out: dict[str, Any] = {
        "name": t.target.name,
        "family": "planar",
        "met": False,
        "wanted_half_width": a.wanted,
        "half_width": best.half_width if best else None,
        "base": of_base(t),
        "bounds": [],
        "room": {},
        "yield_wanted": t.target.share,
        "level": LEVEL,
        "object_range": list(t.object.stiffness),
        "refused": "" if best else a.refused,
        "object_interval": [],
        "pairs": [],
        "binding": [],
        "shares": [],
        "front": [{"thickness": f, "pitch": p, "half_width": w} for f, p, w in a.front],
        "left_out": ["a longer search"] if a.cut else [],
        "notes": [],
    }
    if best is None:
        return out
    arrays, limit = made(t, best, count), a.wanted
    if limit is None:  # the least that the share asked for keeps
        limit = max(best.half_width, float(np.sort(arrays)[ceil(t.target.share * count) - 1]))
    kept = int((arrays <= limit).sum())
    reached = best.half_width <= limit and kept / count >= t.target.share
    k, layout, pair = t.points, PlanarLayout(best.design), (best.soft, best.stiff)
    width = half_width(*pair, t.planar, k)
    spread = targets.variances(*pair, t.planar.readings, t.planar.matrices, k)
    parts = [float(v[int(np.argmax(width))]) for v in spread]
    causes = ("noise of the measuring cell", "noise of the reference cell", "matrices")
    why = why_none(layout)
    out |= {
        "met": (None if a.wanted is None else True) if reached else False,
        "wanted_half_width": limit,
        "yield": kept / count,
        "yield_interval": [*of_share(kept, count)],
        "yield_arrays": count,
        "object_interval": [
            {"object": float(x), "low": float(x * (1 - w)), "high": float(x * (1 + w))}
            for x, w in zip(k, width)
        ],
        "shares": [{"cause": c, "share": v / sum(parts)} for c, v in zip(causes, parts)],
        "choice": asdict(best.choice),
        "buses": best.design.hall.buses,
        "elements": len(layout.elements),
        "size_mm": [round(2.0 * half, 3) for half in layout.half],
        "cells": {name: asdict(cell) for name, cell in zip(KINDS, pair)},
        "notes": [f"no circuit board is laid out for it: {why}"] if why else [],
    }
    if time.perf_counter() > until:
        out["left_out"].append("bounds and limits")
        return out
    out["bounds"] = [asdict(bound) for bound in bounds(t, best)]
    out["binding"] = sorted(binding(t, best), key=lambda limit: -limit["gain"])
    return out


def answer(r: dict[str, Any]) -> str:
    """The result in a few sentences."""
    (low, high), base = r["object_range"], r["base"]
    if r["half_width"] is None:
        none = "None found in this time" if r["left_out"] else "Impossible as asked"
        return f"{none}: no design keeps every rule; {r['refused']}"
    c = r["choice"]
    first = {True: "", None: "Best to be had: ", False: "Impossible as asked; the best candidate: "}[r["met"]]
    than = f"within {page.percent(base['half_width'])}" if base["half_width"] else "not at all"
    if base["breaks"]:
        than = f"does not meet the target: {'; '.join(base['breaks'])}"
    limit = f"of {r['yield_arrays']} arrays made keep {page.percent(r['wanted_half_width'])}"
    size = " x ".join(f"{v:g}" for v in r["size_mm"])
    return (
        f"{first}a pair feels {low:.3g} to {high:.3g} N/mm within {100 * r['half_width']:.2g} % (half the "
        f"95 % interval, as drawn); {100 * r['yield']:.3g} % {limit} ({100 * r['yield_interval'][0]:.3g} to "
        f"{100 * r['yield_interval'][1]:.3g} %). {r['elements']} cells on {size} mm: foil {c['foil']:g}, "
        f"pitch {c['pitch']:g}, beams {c['soft']:g} and {c['stiff']:g} wide, reference island "
        f"{c['island']:g}, chips' gap {c['gap']:g} mm; buses: {r['buses']}. {base['name']} as it is: {than}."
    )


def to_text(r: dict[str, Any]) -> str:
    """As people read it."""
    left = ", ".join(r["left_out"])
    return "\n".join(
        [
            answer(r),
            *(
                f"  {name}: {v['stiffness']:.3g} N/mm, rated {v['rated']:.3g} N, noise "
                f"{1e3 * v['noise']:.3g} mN"
                for name, v in r.get("cells", {}).items()
            ),
            *(f"  {s['cause']}: {100 * s['share']:.3g} % of the variance" for s in r["shares"]),
            *(f"  {page.bound_line(b)}" for b in r["bounds"]),
            *(f"  {page.limit_line(b)}" for b in r["binding"]),
            *(f"  note: {note}" for note in r["notes"]),
            *([f"  left out for time: {left}"] if left else []),
        ]
    )


def as_page(a: CellAnswer, r: dict[str, Any]) -> bytes:
    """The page with its pictures."""
    title = f"{r['name']}: a planar sensor from a target"
    parts = [
        f"<h1>{escape(title)}</h1>",
        f'<p class="answer{"" if r["met"] is not False else " no"}">{escape(answer(r))}</p>',
        *(f"<p>Note: {escape(note)}.</p>" for note in r["notes"]),
        page.bounds_part(r),
        f"<h2>Cells</h2>{cells_picture(PlanarLayout(a.best.design))}" if a.best else "",
    ]
    kinds = [(name, v["stiffness"], v["rated"], 1e3 * v["noise"]) for name, v in r["cells"].items()]
    rows = [(name, *(f"{v:.3g}" for v in values)) for name, *values in kinds]
    shares = [(s["cause"], page.percent(s["share"])) for s in r["shares"]]
    best = [(f"{f['thickness']:g}", f"{f['pitch']:g}", page.percent(f["half_width"])) for f in r["front"]]
    parts += [
        page.table(("kind", "K, N/mm", "rated, N", "noise of a reading, mN"), rows),
        "<h2>How surely a pair feels</h2>",
        page.interval_picture(r, "one pair"),
        "<p>Two neighbours on separate springs, pressed until one of them is at its rated force.</p>"
        "<h2>What limits it</h2>" + page.binding_part(r),
        page.table(("cause", "share of the variance"), shares),
        "<h2>Foils and pitches of the grid, before rules are tried</h2>",
        page.table(("foil, mm", "pitch, mm", "half-width"), best),
    ]
    if r["left_out"]:
        parts.append(f"<p>Left out for time: {escape(', '.join(r['left_out']))}.</p>")
    return page.page(title, parts)


def cells_picture(layout: PlanarLayout) -> str:
    """The foil from above (SVG): openings white, pads as circles."""
    from matplotlib.patches import Circle, Polygon

    from tactcad.report.plots import BLUE, GREY, ORANGE, panels, svg

    (x, y), pad = layout.half, layout.design.post.pad / 2.0
    with panels(1, 1, (8.0, max(2.0, 8.0 * y / x))) as (figure, ax):
        ax.add_patch(Polygon([(-x, -y), (x, -y), (x, y), (-x, y)], facecolor=GREY, alpha=0.6))
        for e in layout.elements:
            for slot in e.kind.slots(layout.corner, (e.x, e.y)):
                points = [s.at(u) for s in slot for u in np.linspace(0.0, 1.0, 6)]
                ax.add_patch(Polygon(points, facecolor="white"))
            colour = BLUE if e.kind.name == KINDS[0] else ORANGE
            ax.add_patch(Circle((e.x, e.y), pad, fill=False, edgecolor=colour, lw=1.5))
        ax.set(xlim=(-x, x), ylim=(-y, y), xlabel="x, mm", ylabel="y, mm", aspect="equal")
        ax.grid(False)
        picture = svg(figure, "cells")
    return f"{picture}<p>The foil from above; pads of measuring cells blue, of reference cells orange.</p>"


def files(a: CellAnswer, r: dict[str, Any]) -> dict[str, bytes]:
    """The folder's files by name."""
    assert a.best
    heading = f"{r['name']}: by `tactcad design`.\n{answer(r)}"
    return {
        "design.toml": design_text(a.best.design, heading).encode(),
        "report.json": (json.dumps(r, indent=1) + "\n").encode(),
        "report.html": as_page(a, r),
    }


def design(
    args: argparse.Namespace, seconds: float | None, count: int | None, ready: Callable[[], str]
) -> int:
    """`tactcad design` of a planar target: 0 if it is met or asks for no half-width, else 1; `ready` gives
    the next command."""
    t = targets.read_target(args.target)
    page.refuse_unwritable(args.out)
    now = time.perf_counter()
    until = now + SHARE * seconds if seconds else inf
    a = targets.search(t, until)
    r = record(a, count or ARRAYS, until)
    written = a.best is not None and (r["met"] is not False or args.best)
    if written:
        page.write_folder(args.out, lambda: files(a, r))
    took = {"in_s": seconds, "took_s": round(time.perf_counter() - now, 1)}
    print(json.dumps(r | ({"budget": took} if seconds else {}), indent=1) if args.json else to_text(r))
    if written and not args.json:
        print(f"{args.out}: written\nnext: {ready()}")
    return 1 if r["met"] is False else 0
