"""The bounds that an answer lies on, each field of the target eased alone, the base design's own result for
the target, and the fields that decide an array's size."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from tactcad.design.fields import Whole, spec_of, with_value
from tactcad.design.load import paths
from tactcad.design.tree import Design
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import broken_rules

from .candidates import SEARCHED, SIZES, Stand, stands
from .made_arrays import MadeSensor
from .search import Found, refusals, search
from .target import TABLES, Target

BESIDE = 4.0  # s, for each further search if the object is a body
NEAR = 0.02  # relative; a limit with less room left is one that the answer lies on
# Fields of the base design that bound the search, and the factor of a step that eases them.
OF_BASE = {
    "element.hinge_length": 1.1,
    "element.fillet_radius": 1.1,
    "element.corner_radius": 1 / 1.1,
    "gauge.grid_length": 1 / 1.1,
    "rating.yield_factor": 1 / 1.1,
    "readout.gain": 1 / 1.1,
    "readout.force_resolution": 1.1,
    "calibration.step": 1 / 1.1,
}
# The field that eases a limit of `Candidates.misses`, for limits that do not bear a field's name.
EASED_BY = {
    "strength": "rating.yield_factor",
    "stop": "grasp.overload",
    "readout": "readout.gain",
    "calibration": "calibration.step",
}
# A clamp of M2 screws and 2 mm dowels: plates that M2 screws and set screws reach through, and the shortest
# rear body that keeps the rules of holes, webs and heads. Long stacks use tie rods; short ones cap screws,
# whose heads need more room, with the axis's threads outside the carrier's screws.
COMPACT: dict[str, Any] = {
    "holes.dowel_hole": 2.012,
    "holes.web": 1.0,
    "clamp.screw": "M2",
    "clamp.dowel": "2",
    "clamp.end_plate_thickness": 5.0,
    "clamp.stop_plate_thickness": 6.0,
    "clamp.carrier_margin": 0.5,
    "clamp.carrier_screw_offset": 5.5,
    "clamp.mount_thread": "M3",
}
RODS: dict[str, Any] = {
    "element.rear_length": 11.6,
    "holes.screw_offsets": (2.2, 9.1),
    "holes.dowel_offsets": (5.65,),
    "clamp.end_plate_margin": 0.0,
    "clamp.mount_pitch_y": 16.0,
}
CAP_SCREWS: dict[str, Any] = {
    "element.rear_length": 12.0,
    "holes.screw_offsets": (2.2, 9.6),
    "holes.dowel_offsets": (5.9,),
    "clamp.end_plate_margin": 0.75,
    "clamp.mount_pitch_y": 28.0,
}
FROM_COMPACT = "chosen: a clamp of M2 screws, as the room asked for has no design with the base's"


@dataclass(frozen=True)
class Bound:
    """A bound that the answer lies on.

    field, value  its value in the target or in the base design
    whose         "written" in the target file, "default" of it, or "base design"
    beyond        the value one step further; None if no such value is legal
    half_width    relative, of the best around the answer there; None if none keeps the rules
    """

    field: str
    value: Any
    whose: str
    beyond: Any = None
    half_width: float | None = None


def touched(found: Found) -> list[str]:
    """Fields whose values bound the candidate."""
    c, stand = found.candidate, found.candidate.stand
    target, e, numbers = stand.target, stand.base.element, found.row
    wish, room, (low, high) = target.elements, target.room, stand.limits
    arm, thickness, count = (numbers[i : 3 * stand.kinds : 3] for i in range(3))
    longest = (
        "elements.arms[1]" if high[0] * SEARCHED[0].step > wish.arms[1] - SEARCHED[0].step else "room.length"
    )
    slot_low = (
        "gauge.grid_length" if stand.base.gauge.grid_length >= e.corner_radius else "element.corner_radius"
    )
    at = {
        "elements.arms[0]": (arm <= low[0]).any(),
        longest: (arm >= high[0]).any(),
        "elements.hinges[0]": (thickness <= low[1]).any(),
        "elements.hinges[1]": (thickness >= high[1]).any(),
        "elements.kinds": stand.kinds == wish.kinds,
        "elements.of_a_kind": (count <= wish.of_a_kind).any(),
        "room.elements[0]": c.total[0] <= room.elements[0],
        "room.elements[1]": c.total[0] >= room.elements[1],
        "room.width": c.total[0] >= stand.most < room.elements[1],
        slot_low: numbers[-2] <= low[-2],
        "element.hinge_length": numbers[-2] >= high[-2],
        "element.corner_radius": numbers[-1] <= low[-1],
        "element.fillet_radius": numbers[-1] >= high[-1],
    }
    names = [name for name, holds in at.items() if holds]
    limits = {name: float(miss[0]) for name, miss in c.misses.items() if name != "room.height"}
    names += [EASED_BY.get(name, name) for name, miss in limits.items() if -NEAR < miss <= 1e-9]
    if target.known.how == "drawn":
        names.append("stock.hinge_tolerances")
    return list(dict.fromkeys(names))


def bound(found: Found, field: str) -> Bound | None:
    """A bound with the result one step beyond it; None if the field cannot go further."""
    target = found.candidate.stand.target
    if field in OF_BASE:
        value = paths(target.base)[field]
        further = round(value * OF_BASE[field], 4)
        stepped, whose = replace(target, base=with_value(target.base, field, further)), "base design"
    else:
        further_on = dict(eased(target)).get(field)
        if further_on is None:
            return None
        stepped = further_on
        value, further = value_of(target, field), value_of(stepped, field)
        whose = "written" if field.partition("[")[0] in target.written else "default"
    until = soon(target)
    got = [
        search(s, narrowest, rules=refusals, start=numbers(found, s), evolve=False, until=until)
        for s in near(stepped, found)
    ]
    best = min((f.half_width for f in got if f.accepted), default=None)
    return Bound(field, value, whose, further, best)


def narrowest(c: Any) -> Any:
    """The goal of all searches but the answer's."""
    return c.half_width


def soon(target: Target) -> float:
    """End of a further search, of `time.perf_counter`."""
    return time.perf_counter() + BESIDE if target.on_layer else inf


def near(target: Target, found: Found) -> list[Stand]:
    """The target's stands that equal the found one but for tolerances or more kinds."""
    here = found.candidate.stand
    own = here.base.sheet, here.base.material.alloy, here.base.gauge, here.base.readout

    def alike(s: Stand) -> bool:
        kinds = s.kinds == here.kinds or s.kinds > here.target.elements.kinds
        return kinds and own == (s.base.sheet, s.base.material.alloy, s.base.gauge, s.base.readout)

    return [_placed(s, here) for s in stands(target) if alike(s)] or stands(target)


def _placed(stand: Stand, here: Stand) -> Stand:
    """The stand with the found one's pad places, or the nearest that its room allows."""
    if not stand.on_layer:
        return stand
    d, array, least = stand.base, here.base.array, stand.target.room.pitch
    pitch, across = max(array.pitch, least), max(array.row_pitch, least)
    moved = replace(d.array, pitch=pitch, row_pitch=across, spacer=round(pitch - d.sheet.thickness, 6))
    base = replace(d, array=moved, element=replace(d.element, pad_length=here.base.element.pad_length))
    return replace(stand, base=base, pattern=here.pattern)


def numbers(found: Found, stand: Stand) -> Any:
    """The found candidate's numbers on another stand: an added kind takes half of the last one's elements;
    None for fewer kinds."""
    row, more = found.row, stand.kinds - found.candidate.stand.kinds
    if more < 0:
        return None
    own, shared = row[:-2], row[-2:]
    for _ in range(more):
        last = own[-3:].copy()
        last[2] = max(last[2] // 2, 1)
        own = np.concatenate([own, last])
        own[-4] = max(own[-4] - last[2], 1)
    return np.concatenate([own, shared])


def compact(found: Found) -> Target | None:
    """The target on its base with the compact clamp, if the room binds the candidate and that clamp is
    smaller and keeps every rule with as many elements; else None."""
    target, base, room = found.candidate.stand.target, found.design, ("room.length", "room.width")
    if all(found.candidate.misses[name][0] <= -NEAR for name in room):
        return None
    for clamp in (COMPACT | RODS, COMPACT | CAP_SCREWS):
        shorter = clamp["element.rear_length"] < base.element.rear_length
        if shorter and not broken_rules(_with_clamp(base, clamp)):
            return replace(target, base=_with_clamp(target.base, clamp), own_clamp=base.clamp.screw)
    return None


def _with_clamp(base: Design, clamp: dict[str, Any]) -> Design:
    for path, value in clamp.items():
        base = with_value(base, path, value)
    return replace(base, origin=base.origin | dict.fromkeys(clamp, FROM_COMPACT))


def base_breaks(target: Target) -> list[str]:
    """Why the unchanged base design misses the target: room, forces, half-width, and every broken rule."""
    base, room, layout = target.base, target.room, Layout(target.base)
    made, wanted = MadeSensor(target, base), target.target.half_width
    broken = [f"rule {f.check}: {f.broken}" for f in broken_rules(base, every=True)]
    sizes = {name: size(layout) for name, size in SIZES.items()}
    for name, is_ in sizes.items():
        most = getattr(room, name)
        if is_ > most + 1e-9:
            broken.append(f"room.{name}: {is_:g} mm, at most {most:g} mm ({deciding(base, name, most)})")
    count, (fewest, most) = len(layout.elements), room.elements
    if not fewest <= count <= most:
        broken.append(f"room.elements: {count}, {fewest:g} to {most:g}")
    if len(base.array.row_arms) > room.rows:
        broken.append(f"room.rows: {len(base.array.row_arms)}, at most {room.rows}")
    if base.array.pitch < room.pitch - 1e-9:
        broken.append(f"room.pitch: {base.array.pitch:g} mm, at least {room.pitch:g} mm")
    if base.sheet.thickness not in target.stock.sheets or base.material.alloy not in target.stock.alloys:
        broken.append(f"stock: a sheet of {base.sheet.thickness:g} mm {base.material.alloy}")
    if broken or not np.isfinite(made.drawn.stiffness).all():
        return broken or ["the estimator does not reach its elements"]
    width, forces = made.worst()
    largest, grip = float(forces.max()), target.grasp
    if largest > grip.element_force * (1.0 + 1e-9):
        broken.append(f"grasp.element_force: {largest:.3g} N, at most {grip.element_force:g} N")
    if made.cannot_bear:
        broken.append(f"grasp.force: {made.cannot_bear}")
    if wanted is not None and not 100.0 * width <= wanted:
        broken.append(f"target.half_width: {100 * width:.3g} %, at most {wanted:g} %")
    return broken


def deciding(base: Design, side: str, most: float) -> str:
    """Fields of the base that decide how long, wide or high its arrays are, the one of most effect first; and
    the rules that the first would break if it alone made room."""
    measure, parts = SIZES[side], list[str]()
    size = measure(Layout(base))
    for path, effect in sorted(_effects(base, measure), key=lambda pair: -pair[1] * paths(base)[pair[0]]):
        value = paths(base)[path]
        needed = round(value - (size - most) / effect, 3)
        broken = broken_rules(with_value(base, path, needed)) if needed > 0.0 else []
        if not parts and broken:
            first = "; ".join(f"{f.part}: {f.message}" for f in broken)
            parts.append(f"{path} {value:g}, at {needed:g} it breaks {first}")
        else:
            parts.append(f"{path} {value:g}")
    return "decided by " + ", ".join(parts)


def _effects(base: Design, measure: Callable[[Layout], float]) -> Iterator[tuple[str, float]]:
    """Fields on which a size hangs, with mm per mm; what the search itself chooses is left out."""
    searched, size = {s.field for s in SEARCHED}, measure(Layout(base))
    for path, value in paths(base).items():
        if isinstance(value, float) and path.count(".") == 1 and path not in searched:
            with np.errstate(all="ignore"):
                effect = (measure(Layout(with_value(base, path, value + 0.1))) - size) / 0.1
            if effect > 0.1:
                yield path, effect


# Sheets, alloys, gauges, powers, known.how and target.base are not tried: they have no order. For each field
# that can be eased, the direction of an easing step: 10 %, or 1 for a count, or 0.01 mm for a hinge.
STEP = 0.10
FURTHEST = 8.0  # largest factor by which a field is eased before it is reported not to help alone
CLOSE = 0.02  # relative; the least change is found to within this


NOT_NARROWING = ("target.half_width", "target.share", "room.height")  # eased, they change no interval

Ease = Callable[[Target, float], Target | None]


def value_of(target: Target, name: str) -> Any:
    """The value of a field, or of one end of a range, by the name that `eased` gives it."""
    path, _, end = name.partition("[")
    table, field = path.split(".")
    value = getattr(getattr(target, table), field)
    return value[int(end[:-1])] if end and value else value


def _spec(path: str) -> Any:
    """Of one value of a field."""
    table, name = path.split(".")
    spec = spec_of(TABLES[table], name)
    return getattr(spec, "item", spec)


def _legal(path: str, value: float) -> float:
    """The value, no further than a target file may say it."""
    spec = _spec(path)
    return min(max(value, spec.low), spec.high)


def _scaled(name: str, up: bool) -> Ease:
    """The value made larger or smaller by a factor; a count by one at least."""
    path, _, end = name.partition("[")

    def ease(target: Target, by: float) -> Target | None:
        value = value_of(target, name)
        if not value:
            return None
        other = value * by if up else value / by
        if isinstance(_spec(path), Whole):
            one = value + (1 if up else -1) * (by > 1.0)
            other = max(round(other), one) if up else min(round(other), one)
        other = _legal(path, other)
        if not end:
            return target.with_(path, other)
        pair = list(value_of(target, path))
        pair[int(end[:-1])] = other
        return target.with_(path, tuple(pair)) if pair[0] <= pair[1] else None

    return ease


def _share(target: Target, by: float) -> Target:
    """Arrays that need not meet the target: by so much more."""
    return target.with_("target.share", _legal("target.share", 1.0 - (1.0 - target.target.share) * by))


def _tolerances(target: Target, by: float) -> Target:
    finest = _legal("stock.hinge_tolerances", min(target.stock.hinge_tolerances) / by)
    finer = tuple(sorted({*target.stock.hinge_tolerances, finest}))
    return target.with_("stock.hinge_tolerances", finer)


# By field: the ease, or whether a larger value is easier.
EASIER: dict[str, Ease | bool] = {
    "target.half_width": True,
    "target.share": _share,
    "object.stiffness[0]": True,
    "object.stiffness[1]": False,
    "object.modulus[0]": True,
    "object.modulus[1]": False,
    "grasp.force": True,
    "grasp.element_force": True,
    "grasp.overload": False,
    "grasp.loads": True,
    "room.rows": True,
    "room.elements[0]": False,
    "room.elements[1]": True,
    "room.pitch": False,
    "room.length": True,
    "room.width": True,
    "room.height": True,
    "elements.kinds": True,
    "elements.of_a_kind": False,
    "elements.arms[0]": False,
    "elements.arms[1]": True,
    "elements.hinges[0]": False,
    "elements.hinges[1]": True,
    "stock.hinge_tolerances": _tolerances,
    "known.thickness": False,
    "known.gauge_factor": False,
    "known.runs": True,
    "known.run_scatter": False,
    "known.force_noise": False,
    "known.displacement_noise": False,
    "known.contact": False,
}
EASES = {name: _scaled(name, way) if isinstance(way, bool) else way for name, way in EASIER.items()}
# Fields that matter to one kind of knowledge only.
ONLY = {
    "drawn": ("stock.hinge_tolerances", "known.gauge_factor"),
    "inspected": ("known.thickness", "known.gauge_factor"),
    "calibrated": ("known.runs", "known.run_scatter", "known.force_noise", "known.displacement_noise"),
}


def eased(target: Target, by: float = 1.0 + STEP) -> Iterator[tuple[str, Target]]:
    """The target with each of its fields eased alone, by a factor."""
    unused = {name for how, names in ONLY.items() if how != target.known.how for name in names}
    unused -= set(ONLY[target.known.how])
    for name, ease in EASES.items():
        if name not in unused:
            other = ease(target, by)
            if other is not None and other != target:
                yield name, other


def least_change(target: Target, name: str, possible: Callable[[Target], bool]) -> tuple[Any, Target] | None:
    """The value nearest to the present one with which a target is possible, found by halving.

    Parameters
    ----------
    target
        An impossible target.
    name
        The field, of EASES.
    possible
        Whether a target is possible; called for each value tried.

    Returns
    -------
    tuple or None
        The value and the target with it, for which `possible` holds, but not for one nearer by CLOSE; None if
        FURTHEST times the value does not suffice.
    """
    low, high = 1.0, FURTHEST
    furthest = EASES[name](target, high)
    if furthest is None or furthest == target or not possible(furthest):
        return None
    best = furthest
    while high / low > 1.0 + CLOSE:
        middle = (low * high) ** 0.5
        tried = EASES[name](target, middle)
        if tried is not None and (tried == best or possible(tried)):
            high, best = middle, tried
        else:
            low = middle
    return value_of(best, name), best
