"""The report of a synthesis: in a few words, as JSON, as one page with its pictures, and as a folder with the
design and its alternatives."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from tactcad.design.design_text import design_text
from tactcad.design.files import absolute, flush_entry, make_folder, refusal, write_whole
from tactcad.design.messages import InputError
from tactcad.design.staging import MAKING, staged_folder
from tactcad.parts.array.layout import Layout
from tactcad.report.plots import BLACK, BLUE, GREY, ORANGE, SKY, log_ticks, panels, series, svg
from tactcad.scenes.rigs.calibration import RIG as CALIBRATION

from .bounds import deciding
from .candidates import SIZES, dealt
from .interval import LEVEL
from .made_arrays import SLIGHT
from .on_layer import Poses
from .synthesise import CURVE, PAPERS_RATIO, Synthesis

COUPLINGS = (0.0, SLIGHT, 1.0)
GRID = 9  # angles a side of the map
USEFUL = 0.5  # half-width of K_obj beyond which an array tells hardly more than that something is there
LISTED = 8  # rows of limits and shares on the page
STYLE = """
body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:62em;padding:0 1em;color:#1c2733}
table{border-collapse:collapse;margin:.5em 0 1.2em}
th,td{text-align:left;padding:.25em .8em .25em 0;border-bottom:1px solid #d8dee4}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}svg{max-width:100%;height:auto}
@media(max-width:700px){table{display:block;overflow-x:auto}}
.answer{font-size:1.25em;border-left:5px solid #31618f;padding-left:.8em}
.no{border-color:#b3372b}small{color:#4a5866}
"""


def record(got: Synthesis) -> dict[str, Any]:
    """Everything of a synthesis as plain data; lengths mm, forces N, stiffnesses N/mm, shares of 1."""
    out: dict[str, Any] = {
        "name": got.target.target.name,
        "met": None if got.met and got.target.target.half_width is None else got.met,
        "wanted_half_width": got.wanted,
        "half_width": got.found.half_width if got.found.accepted else None,
        "base": {"name": _base_name(got), "half_width": got.base_half_width, "breaks": got.base_breaks},
        "bounds": [asdict(bound) for bound in got.bounds],
        "yield": got.made.share,
        "yield_wanted": got.target.target.share,
        "yield_interval": list(got.made.interval),
        "yield_arrays": got.made.count,
        "yield_distribution": got.made.distribution,
        "yield_lacks": got.made.why,
        "level": LEVEL,
        "object_range": list(got.object_range),
        "object": _object(got),
        "evaluations": got.evaluations,
        "searched_to_its_end": got.found.in_time,
        "changes": [asdict(c) for c in got.changes],
        "left_out": list(got.left_out),
        "beyond": _beyond(got),
        "room": _room(got),
        "out_of_range": list(got.found.candidate.out_of_range),
        "refused": got.found.refused,
        "notes": _notes(got),
    }
    if not got.found.accepted:
        return out | {"object_interval": [], "binding": [], "shares": [], "front": []}
    x = np.geomspace(*got.object_range, CURVE)
    whole = got.sensor.interval(x)
    pairs = [
        {
            "measuring": m + 1,
            "reference": r + 1,
            "half_width": [float(v) for v in got.sensor.interval(x, [m, r]).half_width(x)],
        }
        for m, r in ([] if got.target.on_layer else _pairs(got))
    ]
    return out | {
        "object_interval": [
            {"object": float(a), "low": float(b), "high": float(c)}
            for a, b, c in zip(x, whole.low, whole.high)
        ],
        "pairs": pairs,
        "binding": [asdict(limit) for limit in got.binding],
        "shares": [asdict(s) for s in got.shares],
        "front": [entry.record() for entry in got.front],
        "coupling": []
        if got.target.on_layer
        else [{"share": c, "shift": got.coupling(c)} for c in COUPLINGS],
        "inclined": _inclined(got),
        "ratio": got.ratio,
        "ratios": [{"ratio": q, "half_width": w} for q, w in got.ratios],
        "papers_ratio": PAPERS_RATIO,
        "elements": _elements(got),
        "size_mm": [round(size(Layout(got.found.design)), 3) for size in SIZES.values()],
        "read_from": got.target.grasp.force / got.target.grasp.loads,
    }


def _base_name(got: Synthesis) -> str:
    base = got.target.base
    return f"{base.name} with {base.clamp.screw} screws" if got.target.own_clamp else base.name


def _object(got: Synthesis) -> str:
    """The object, if it is a body: "0.4 to 1.4 MPa, a layer of 10 mm within 5 %, inclined up to 3
    degrees"."""
    if not got.target.on_layer:
        return ""
    o, (low, high) = got.target.object, got.target.moduli(got.found.design)
    known = f" within {o.thickness_limits:g} %" if o.thickness_limits else ""
    layer = f"a layer of {o.thickness:g} mm{known}" if o.thickness else "a half-space"
    inclined = f", inclined up to {o.angle[1]:g} degrees" if o.angle[1] else ""
    return f"{low:.3g} to {high:.3g} MPa, {layer}{inclined}"


def _inclined(got: Synthesis) -> list[dict[str, Any]]:
    """Half-width over both angles of the face, degrees, at the softest, middle and stiffest object; None if
    an element would be overloaded."""
    most = got.target.object.angle[1]
    if not most:
        return []
    s, side = got.sensor, np.linspace(-most, most, GRID)
    angles = np.array([(a, b) for b in side for a in side])
    slope, E, out = np.tan(np.radians(angles)), s.points / s.target.unit(s.design), []
    for x, modulus in zip(s.points, E):
        at = Poses(np.full(len(slope), modulus), slope)
        got_there = s.on_body.expected(at)
        width, within = s.on_body.half_width(at, got_there), np.hypot(*angles.T) <= most * (1 + 1e-9)
        out.append(
            {
                "object": float(x),
                "angles": [float(a) for a in side],
                "half_width": [[float(w) for w in row] for row in width.reshape(GRID, GRID)],
                "within": [[bool(w) for w in row] for row in within.reshape(GRID, GRID)],
            }
        )
    return out


def _inclined_part(r: dict[str, Any]) -> str:
    if not r["inclined"]:
        return ""
    tables = [100 * np.where(m["within"], m["half_width"], np.nan) for m in r["inclined"]]
    low, high = np.nanmin(tables), np.nanmax(tables)
    with panels(1, len(tables), (3.8 * len(tables), 3.8)) as (figure, axes):
        for ax, table, m in zip(axes, tables, r["inclined"]):
            a = m["angles"]
            shown = ax.pcolormesh(a, a, table, cmap="viridis", vmin=low, vmax=high, shading="nearest")
            ax.set(xlabel="along the arms, degrees", ylabel="along the rows, degrees", aspect="equal")
            ax.set_title(f"{m['object']:.3g} N/mm")
        figure.colorbar(shown, ax=list(axes), label="half-width of K_obj, %")
        picture = svg(figure, "inclined")
    return (
        "<h2>On an inclined face</h2>"
        f"<p>Half the 95 % interval over both angles of the object's face: {percent(low / 100)} to "
        f"{percent(high / 100)}. Within the circle every hinge, stop and signal keeps its limits.</p>"
        f"{picture}"
    )


def _beyond(got: Synthesis) -> dict[str, float]:
    """Relative excess of the best candidate over each limit that it misses; its half-width only if it keeps
    all others, and nothing that depends on its elements if they are out of the estimator's range."""
    c = got.found.candidate
    misses = {name: float(v[0]) for name, v in c.misses.items()}
    if c.out_of_range:
        low, high = c.stand.limits
        of_room = ["room.height", *(["room.length"] if low[0] > high[0] else [])]
        misses = {name: misses[name] for name in of_room}
    elif got.found.accepted:
        misses["target.half_width"] = got.found.half_width / got.wanted - 1.0 if got.wanted else 0.0
    return {name: v for name, v in misses.items() if v > 1e-9 and np.isfinite(v)}


def _room(got: Synthesis) -> dict[str, str]:
    """For each size of the room that the answer lies on or misses, the base's fields that decide it."""
    names = [b.field for b in got.bounds] + list(_beyond(got))
    sides = [name.removeprefix("room.") for name in names if name.removeprefix("room.") in SIZES]
    room, design = got.target.room, got.found.design
    return {f"room.{side}": deciding(design, side, getattr(room, side)) for side in dict.fromkeys(sides)}


def _notes(got: Synthesis) -> list[str]:
    """Notes that are not in the design."""
    notes, was = list(got.unknown), got.target.own_clamp
    if was:
        now = got.target.base.clamp
        by = f"clamped by {now.screw} screws and {now.dowel} mm dowels"
        notes.append(f"{by}: with {was} nothing fits the room")
    for left in got.scenes_left_out:
        unlike = left.scene == CALIBRATION.name and got.target.known.how == "calibrated"
        why = "its elements count as calibrated, but not on the rig of this design; " if unlike else ""
        notes.append(f"{why}{left}")
    if got.met and got.target.target.half_width is None and got.wanted > USEFUL:
        notes.append(
            f"an interval of {percent(got.wanted)} either way is no useful sensor: allow more force, more "
            "elements, or a narrower range"
        )
    return notes


def _pairs(got: Synthesis) -> list[tuple[int, int]]:
    """Indices of the first element of each two kinds, the softer first."""
    K = got.sensor.drawn.stiffness
    first = sorted({round(float(k), 9): i for i, k in reversed(list(enumerate(K)))}.items())
    return [(a[1], b[1]) for i, a in enumerate(first) for b in first[i + 1 :]]


def _elements(got: Synthesis) -> list[dict[str, Any]]:
    s, c = got.sensor, got.found.candidate
    kinds = [kind for row in dealt(c) for kind in row]
    return [
        {
            "number": place.number,
            "row": place.row,
            "arm": place.arm,
            "hinge_thickness": place.hinge.t,
            "stiffness": float(s.drawn.stiffness[i]),
            "stiffness_by_solid_elements": got.solid[i] if got.solid else None,
            "signal_V_per_mm": float(s.drawn.signal[i]),
            "largest_force": float(c.largest_force[0, kinds[i]]),
        }
        for i, place in enumerate(Layout(got.found.design).elements)
    ]


def report_page(got: Synthesis) -> bytes:
    """The page (HTML, UTF-8), pictures inside."""
    r = record(got)
    title = f"{got.target.target.name}: a sensor from a target"
    parts = [f"<h1>{escape(title)}</h1>", _answer(got, r), bounds_part(r)]
    if got.found.accepted:
        parts += [_size_part(got, r), _interval_part(got, r)]
        shown = (_inclined_part, _yield_part, _limits_part, _ratio_part, _front_part, _elements_part)
        parts += [part(r) for part in shown]
    if r["left_out"]:
        parts.append(f"<p>Left out for time: {escape(', '.join(r['left_out']))}.</p>")
    return page(title, parts)


def page(title: str, parts: Sequence[str]) -> bytes:
    """An offline page (HTML, UTF-8) of these parts."""
    body = "\n".join(parts)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f"<style>{STYLE}</style></head>\n<body>\n{body}\n</body></html>\n"
    ).encode()


def _answer(got: Synthesis, r: dict[str, Any]) -> str:
    text = f'<p class="answer{"" if r["met"] else " no"}">{escape(answer(r))}</p>'
    text += "".join(f"<p>Note: {escape(note)}.</p>" for note in r["notes"])
    if got.met:
        return text
    rows = [(c["field"], value(c["value"]), value(c["needed"])) for c in r["changes"]]
    if rows:
        text += "<p>Each of these changes alone makes it possible:</p>"
        text += table(("field", "asked", "needed"), rows)
    return text + f"<p>{escape(no_other_change(got).capitalize())}.</p>"


def bounds_part(r: dict[str, Any]) -> str:
    """The bounds that the answer lies on."""
    if not r["bounds"]:
        return ""
    rows = [(b["field"], value(b["value"]), b["whose"], value(b["beyond"]), beyond(b)) for b in r["bounds"]]
    heads = ("field", "value", "whose", "one step beyond", "half-width there, as drawn")
    text = "<h2>Bounds that the answer lies on</h2>" + table(heads, rows)
    return text + "".join(f"<p>{escape(field)}: {escape(by)}.</p>" for field, by in r["room"].items())


def beyond(b: dict[str, Any]) -> str:
    """The half-width one step beyond a bound."""
    return "no design there" if b["half_width"] is None else percent(b["half_width"])


def bound_line(b: dict[str, Any]) -> str:
    """A bound in one line, for the terminal."""
    return (
        f"bound: {b['field']} {said(b['value'])} ({b['whose']}); one step beyond, {said(b['beyond'])}: "
        f"{beyond(b) if b['half_width'] is None else f'half-width as drawn {beyond(b)}'}"
    )


def limit_line(limit: dict[str, Any]) -> str:
    """A field that limits the answer in one line, for the terminal."""
    return (
        f"{limit['field']}: {said(limit['value'])} eased to {said(limit['eased'])}: half-width as drawn "
        f"{100 * limit['half_width']:.3g} % ({-100 * limit['gain']:.2g} %)"
    )


def said(of: object) -> str:
    """A field's value as the terminal has it."""
    if isinstance(of, (list, tuple)):
        return "[" + ", ".join(map(said, of)) + "]"
    return f"{of:.4g}" if isinstance(of, float) else str(of)


def _size_part(got: Synthesis, r: dict[str, Any]) -> str:
    """The array from above: the carrier's outline, and every element from its pad to its rear end."""
    layout, (length, width, height) = Layout(got.found.design), r["size_mm"]
    thick = got.found.design.sheet.thickness
    with panels(1, 1, (9.0, max(2.2, 7.5 * width / length))) as (figure, ax):
        ax.broken_barh([(-length / 2, length)], (-width / 2, width), facecolor="none", edgecolor=GREY)
        for e in layout.elements:
            side, y = (1.0 if e.row == 1 else -1.0), (e.y if e.row == 1 else -e.y)
            for start, end, colour in (
                (layout.pad_inner, layout.pad_outer, ORANGE),
                (layout.pad_outer, e.hinge_x - e.hinge.l / 2, SKY),
                (e.hinge_x - e.hinge.l / 2, e.hinge_x + e.hinge.l / 2, BLACK),
                (e.hinge_x + e.hinge.l / 2, layout.rear_end, GREY),
            ):
                along = [(min(side * start, side * end), end - start)]
                ax.broken_barh(along, (y - thick / 2, thick), color=colour)
            ax.annotate(f"E{e.number}", (side * layout.rear_end * 0.8, y), ha="center", va="center")
        ax.set(xlabel="along the arms, mm", ylabel="along the rows, mm", aspect="equal")
        picture = svg(figure, "size")
    return (
        f"<h2>Size</h2><p>{length:g} x {width:g} x {height:g} mm (along the arms, along the rows, from the "
        "pads to the carrier's top). From above: pads orange, arms blue, hinges black, clamped bodies "
        f"grey.</p>{picture}"
    )


def value(of: Any) -> str:
    """A field's value as the page has it."""
    if of is None:
        return ""
    if isinstance(of, (list, tuple)):
        return ", ".join(f"{v:.4g}" for v in of)
    return f"{of:.4g}" if isinstance(of, float) else str(of)


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of the page."""
    head = "".join(f"<th>{escape(h)}</th>" for h in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _interval_part(got: Synthesis, r: dict[str, Any]) -> str:
    picture = interval_picture(r, "all elements")
    touching = "" if r["inclined"] else ", where all pads touch"
    read_from = f"Read from {r['read_from']:.3g} N on{touching}."
    return f"<h2>How surely it feels</h2>{picture}<p>{_pressed_how(r)} {read_from}</p>"


def interval_picture(r: dict[str, Any], of: str) -> str:
    """The interval over the object's stiffness, of all elements and of pairs (SVG)."""
    x, low, high = (np.array([p[key] for p in r["object_interval"]]) for key in ("object", "low", "high"))
    with panels(1, 1, (9.0, 4.2)) as (figure, ax):
        ax.fill_between(x, 100 * (low / x - 1), 100 * (high / x - 1), color=SKY, alpha=0.45, lw=0)
        ax.plot(x, 100 * (high - low) / 2 / x, color=BLUE, lw=2, label=f"half-width, {of}")
        for i, pair in enumerate(r["pairs"]):
            width, one = 100 * np.array(pair["half_width"]), f"{pair['measuring']} and {pair['reference']}"
            ax.plot(x, width, ("--", ":", "-.")[i % 3], color=ORANGE, label=f"one pair, elements {one}")
        if r["wanted_half_width"] is not None:
            ax.axhline(100 * r["wanted_half_width"], color=GREY, lw=1, label="half-width to keep")
        ax.set(xscale="log", xlabel="object's stiffness, N/mm", ylabel="95 % interval, % of K_obj")
        log_ticks(ax.xaxis, _ticks(float(x[0]), float(x[-1])))
        ax.legend()
        return svg(figure, "interval")


def _pressed_how(r: dict[str, Any]) -> str:
    if r["object"]:
        return (
            f"Rigid pads on a body ({r['object']}), as <code>tactcad stiffness --thickness</code> evaluates "
            "them: level in the picture. The error of a linear body at this depth is in it."
        )
    lines = ", ".join(f"{percent(c['share'])}: {c['shift']:+.1%}" for c in r["coupling"][1:])
    return (
        "Pads are taken to press on separate springs. If the object couples them, K_obj comes out too "
        f"large, at a share of a half-space's coupling of {lines}; <code>tactcad stiffness</code> widens "
        "its interval for that unless <code>--coupling</code> gives the share."
    )


def _ticks(low: float, high: float) -> list[float]:
    """Both ends, and round numbers between that do not touch them."""
    steps = [a * 10.0**n for n in range(-4, 5) for a in (1, 1.5, 2, 3, 5, 7)]
    clear = (high / low) ** 0.06
    return [low, *(v for v in steps if low * clear <= v <= high / clear), high]


def _yield_part(r: dict[str, Any]) -> str:
    rows = [(name, str(n)) for name, n in r["yield_lacks"].items()]
    text = (
        f"<h2>Yield</h2><p>Of {r['yield_arrays']} arrays made ({r['yield_distribution']} parts, one sheet "
        f"and one machine's offset each) {percent(r['yield'])} go together, stay within their hinges' "
        "strength, keep their stops open and give an interval within "
        f"{percent(r['wanted_half_width'])} everywhere on the range.</p>"
    )
    return text + (table(("lacking", "arrays"), rows) if rows else "")


def _limits_part(r: dict[str, Any]) -> str:
    if not r["binding"] and not r["shares"]:
        return ""
    text = f"<h2>What limits it</h2>{binding_part(r)}"
    if not r["shares"]:
        return text
    shown = [s for s in r["shares"] if s["total"] > 0][:LISTED]
    with panels(1, 1, (9.0, 0.5 * len(shown) + 1.2)) as (figure, ax):
        at = np.arange(len(shown))[::-1]
        sides = ((0.2, "total", SKY, "with interactions"), (-0.2, "first", BLUE, "alone"))
        for off, key, colour, label in sides:
            share, error = ([100 * s[key + e] for s in shown] for e in ("", "_error"))
            ax.barh(at + off, share, 0.38, xerr=error, color=colour, ecolor=GREY, label=label)
        ax.set_yticks(at, [s["cause"] for s in shown])
        ax.set(xlabel="% of the variance of K_obj, at the middle of the range", xlim=(0, None))
        ax.legend(loc="lower right")
        text += svg(figure, "shares")

    def whole_percent(share: dict[str, Any], key: str) -> str:
        return f"{100 * share[key]:.0f} \u00b1 {max(100 * share[key + '_error'], 1):.0f} %"

    rows = [(s["cause"], whole_percent(s, "first"), whole_percent(s, "total")) for s in shown]
    text += table(("cause", "alone", "with interactions"), rows)
    none = [s["cause"] for s in r["shares"] if s["total"] <= 0]
    below = f" Below 0.05 %: {escape('; '.join(none))}." if none else ""
    return text + f"<p><small>\u00b1: standard error of the sampling.{below}</small></p>"


def binding_part(r: dict[str, Any]) -> str:
    """What limits the answer besides its bounds."""
    if not r["binding"]:
        return ""
    best = r["binding"][0]
    rows = [
        (
            b["field"],
            f"{value(b['value'])} to {value(b['eased'])}",
            percent(b["half_width"]),
            f"-{percent(b['gain'])}",
        )
        for b in r["binding"][:LISTED]
    ]
    return (
        f"<p>The one change that helps most: <code>{escape(best['field'])}</code>. Each field eased by one "
        "step, the rest searched anew:</p>" + table(("field", "eased", "half-width", "change"), rows)
    )


def _ratio_part(r: dict[str, Any]) -> str:
    if not r["ratios"]:
        return ""
    with panels(1, 1, (9.0, 3.6)) as (figure, ax):
        q = [p["ratio"] for p in r["ratios"]]
        ax.plot(q, [100 * p["half_width"] for p in r["ratios"]], color=BLUE, marker="o")
        series(ax, 0, [r["ratio"]], [100 * r["half_width"]], label="chosen")
        ax.axvline(r["papers_ratio"], color=GREY, lw=1, label="the paper's about 10")
        ax.set(xscale="log", xlabel="K_r/K_m", ylabel="half-width, %", ylim=(0, None))
        log_ticks(ax.xaxis, sorted({*q, round(r["ratio"])}))
        ax.legend()
        picture = svg(figure, "ratio")
    at = {p["ratio"]: p["half_width"] for p in r["ratios"]}
    paper = at.get(r["papers_ratio"])
    than = f", against {percent(paper)} at the paper's 10" if paper else ""
    return (
        f"<h2>Stiffness ratio</h2>{picture}<p>Best here: {r['ratio']:.3g}, half-width "
        f"{percent(r['half_width'])}{than}. The paper looks at a pair's ratio alone: the larger K_r/K_m, the "
        "better conditioned, with diminishing returns from 10 on. Here a stiffer reference is also read with "
        "less signal and calibrated less well behind the load cell, a softer element is limited by its stop "
        "and its strength, and both sides are weighed over the whole range.</p>"
    )


def _front_part(r: dict[str, Any]) -> str:
    front = r["front"]
    if not front:
        return ""
    with panels(1, 2, (11.0, 3.8)) as (figure, (left, right)):
        for ax, key, label in ((left, "elements", "elements"), (right, "carrier_area_mm2", "carrier, mm2")):
            ax.plot([f[key] for f in front[1:]], [100 * f["half_width"] for f in front[1:]], "o", color=BLUE)
            ax.plot([front[0][key]], [100 * front[0]["half_width"]], "s", color=BLACK, label="chosen")
            ax.set(xlabel=label, ylabel="half-width, %", ylim=(0, None))
            ax.legend()
        left.xaxis.set_major_locator(MaxNLocator(integer=True))
        picture = svg(figure, "front")
    rows = [
        (
            f["name"],
            percent(f["half_width"]),
            str(f["elements"]),
            f"{f['carrier_area_mm2'] / 100:.1f}",
            f"{f['hinge_tolerance_mm']:g}",
            value(f["stiffness_N_per_mm"]),
        )
        for f in front
    ]
    heads = ("design", "half-width", "elements", "carrier, cm2", "hinge +-, mm", "K of its kinds, N/mm")
    return f"<h2>Alternatives</h2>{picture}{table(heads, rows)}"


def _elements_part(r: dict[str, Any]) -> str:
    solid = bool(r["elements"][0]["stiffness_by_solid_elements"])
    rows = [
        (
            f"E{e['number']}",
            str(e["row"]),
            f"{e['arm']:g}",
            f"{e['hinge_thickness']:g}",
            f"{e['stiffness']:.4g}",
            *([f"{e['stiffness_by_solid_elements']:.4g}"] if solid else []),
            f"{e['largest_force']:.3g}",
        )
        for e in r["elements"]
    ]
    by_solid = ["by solid elements"] if solid else []
    heads = ("element", "row", "arm, mm", "hinge, mm", "K, N/mm", *by_solid, "largest force, N")
    return "<h2>Elements</h2>" + table(heads, rows)


def percent(share: float) -> str:
    return f"{100 * share:.3g} %"


def answer(r: dict[str, Any]) -> str:
    """The result in a few sentences."""
    (low, high), base = r["object_range"], r["base"]
    if r["met"] is False:
        rules = "; ".join(line for line in base["breaks"] if line.startswith("rule "))
        told = f" {base['name']} as it is breaks {rules}." if rules else ""
        none = "Impossible as asked" if r["searched_to_its_end"] else "None found in this time"
        return f"{none}: the best candidate {_why_not(r)}.{told}"
    e = r["elements"]
    if base["breaks"]:
        than = f"{base['name']} as it is does not meet the target: {'; '.join(base['breaks'])}"
    else:
        than = f"{base['name']} as it is: {percent(base['half_width'])}"
    pressed = f" ({r['object']})" if r["object"] else ""
    best = "Best to be had: no half-width was asked. " if r["met"] is None else ""
    return (
        f"{best}{len(e)} elements feel {low:.3g} to {high:.3g} N/mm{pressed} within "
        f"{percent(r['wanted_half_width'])} (half the 95 % interval; as drawn {percent(r['half_width'])}). "
        f"{percent(r['yield'])} of arrays made within their tolerances keep that "
        f"({' to '.join(map(percent, r['yield_interval']))}). "
        f"Size {' x '.join(f'{v:g}' for v in r['size_mm'])} mm. {than}."
    )


def _why_not(r: dict[str, Any]) -> str:
    why = [
        f"misses {name} by {percent(v) if v < 10 else 'more than ten times'}"
        + (f" ({r['room'][name]})" if name in r["room"] else "")
        for name, v in r["beyond"].items()
    ]
    if r["out_of_range"]:
        why.append(f"has elements that the estimator does not reach ({'; '.join(r['out_of_range'])})")
    if why:
        return "; ".join(why)
    if r["half_width"] is None:
        return f"keeps all limits, but is refused: {'; '.join(f'{k}: {v}' for k, v in r['refused'].items())}"
    kept, wanted = percent(r["yield"]), percent(r["yield_wanted"])
    return f"keeps it as drawn, but of the arrays made only {kept} do, not {wanted}"


def no_other_change(got: Synthesis) -> str:
    """Single fields whose change does not suffice, or a note that not all were tried."""
    if got.left_out:
        return f"not tried for time: {'; '.join(got.left_out)}"
    other = "other " if got.changes else ""
    return f"no {other}single field changed up to eight times makes it possible"


def refuse_taken(out: str | Path) -> None:
    """Raise InputError if `out` is no new or empty folder, which is replaced in one step."""
    path = absolute(out)
    if os.path.islink(path):
        legal = "the folder that it leads to, or a new folder"
        raise InputError("--out", "is a link", value=str(out), legal=legal)
    if os.path.lexists(path) and not (path.is_dir() and not os.listdir(path)):
        what = "is there already and not an empty folder"
        raise InputError("--out", what, value=str(out), legal="a new folder")


def refuse_unwritable(out: str | Path) -> None:
    """Raise as `write` would for a place that is taken or cannot be written to, and leave nothing there."""
    refuse_taken(out)
    folder = absolute(out)
    place = folder.parent
    while not os.path.lexists(place):
        place = place.parent
    try:
        with staged_folder(place, folder.name):
            pass
    except OSError as error:
        raise refusal(str(out), error) from error


def write(got: Synthesis, out: str | Path) -> None:
    """design.toml, report.json and report.html, as `write_folder`."""
    heading = f"{got.target.target.name}: by `tactcad design`.\n{answer(record(got))}"
    write_folder(out, lambda: {"design.toml": design_text(got.design, heading).encode(), **_report(got)})


def write_folder(out: str | Path, make: Callable[[], dict[str, bytes]]) -> None:
    """The files that `make` gives, by name: the whole folder in one step, or nothing.

    Raises InputError if `out` is taken or cannot be written to, CheckFailure if there is no room.
    """
    folder = absolute(out)
    refuse_taken(out)
    make_folder(folder.parent)
    try:
        files = make()
        with staged_folder(folder.parent, folder.name) as own:
            making = own / MAKING
            making.mkdir()
            for name, data in files.items():
                (making / name).write_bytes(data)
                flush_entry(making / name)
            making.rename(folder)  # an empty folder is replaced, any other is refused
            flush_entry(folder.parent)
    except OSError as error:
        raise refusal(str(out), error) from error


def complete(got: Synthesis, out: str | Path) -> None:
    """front/NAME.toml and the whole report in the folder that `write` made, each file in one step.

    Raises as `write`.
    """
    folder, target = absolute(out), got.target.target.name
    for entry in got.front[1:]:
        name = f"{target[:24].rstrip('-')}-{entry.name.replace('.', '-')}"
        text = design_text(got.as_design(entry.found, name), f"{name}: {entry.what}.")
        make_folder(folder / "front")
        write_whole(folder / "front" / f"{entry.name}.toml", text.encode())
    for name, data in _report(got).items():
        write_whole(folder / name, data)


def _report(got: Synthesis) -> dict[str, bytes]:
    text = json.dumps(record(got), indent=1) + "\n"
    return {"report.json": text.encode(), "report.html": report_page(got)}
