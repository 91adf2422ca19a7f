"""Arrays on a body: the result that `tactcad stiffness --thickness` would give, and the search for the best.

The interval is that of lab/layer_fit.py, linear about the truth (`layer_fit.expected`): rigid pads that tilt
and lift, coupled through the layer, its thickness within limits. The body's large strain, which the fit does
not know, is added as the linear rungs state it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np

from tactcad.contact.press import Pads
from tactcad.contact.stated_errors import LINEAR_REACH, pad_radius, strain_error
from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.lab import layer_fit
from tactcad.lab.calibration_file import Sensitivity
from tactcad.lab.load_cell import RIGID
from tactcad.mechanics.section import Array

from .candidates import POINTS, Candidates, Stand, order
from .interval import even_loads
from .knowledge import Knowledge
from .target import Target

LOADS = 4  # representatives of all loads that are read
AROUND = 8  # directions in which the face falls away
UNTRIED = 10.0  # depth of a candidate that is not tried: worse than all that are
CLEAR = 0.3  # mm between facing pads at least: arms turn, and rules refuse less
PATTERNS = 24  # of chance, in which kinds are dealt out
STEPS = {
    "pitch": (-1.0, -0.25, 0.25, 1.0),
    "row_pitch": (-1.0, -0.25, 0.25, 1.0),
    "pad_length": (-0.25, 0.25),
}


@dataclass(frozen=True)
class Poses:
    """Moduli, MPa, and slopes of the face at which an array is tried, [pose] and [pose, 2]."""

    modulus: Array
    slope: Array


def poses(target: Target, design: Design, angles: int = 1) -> Poses:
    """Level over the range of the modulus, and at its ends inclined by up to the largest angle, any way."""
    E = np.geomspace(*target.moduli(design), POINTS)
    least, most = np.tan(np.radians(target.object.angle))
    turn = 2 * np.pi * np.arange(AROUND) / AROUND
    modulus, slope = [*E] if least == 0 else [], [(0.0, 0.0)] * (len(E) if least == 0 else 0)
    for tilt in np.linspace(least, most, angles + 1)[1 if least == 0 else 0 :] if most > 0 else ():
        for end in (E[0], E[-1]):
            modulus += [end] * AROUND
            slope += [(tilt * np.cos(a), tilt * np.sin(a)) for a in turn]
    return Poses(np.array(modulus), np.array(slope))


def level(modulus: Array) -> Poses:
    """Poses of faces without inclination."""
    return Poses(modulus, np.zeros((len(modulus), 2)))


@dataclass(frozen=True)
class LayerGrasps:
    """One array on the target's body: places (mm), K (N/mm) and K_v (V/mm) of its elements by number, their
    uncertainties, and the noise of a reading, V."""

    target: Target
    design: Design
    x: Array
    y: Array
    load_arm: Array
    stiffness: Array
    signal: Array
    known: Knowledge
    noise: float

    @cached_property
    def pads(self) -> Pads:
        away, K = np.sign(self.x) / self.load_arm, self.stiffness
        move = np.stack([np.ones(len(K)), -away, np.zeros(len(K))], axis=1)
        compliance = move[:, :, None] * move[:, None, :] / K[:, None, None]
        size = self.design.element.pad_length, self.design.sheet.thickness
        return Pads(self.x, self.y, *size, compliance, np.zeros(len(K)), np.full(len(K), inf))

    @cached_property
    def array(self) -> layer_fit.LayeredArray:
        o, number = self.target.object, np.arange(1, len(self.x) + 1)
        h = o.thickness or inf
        half = 0.0 if h == inf else h * o.thickness_limits / 100.0
        tolerance = self.design.tolerance.pad_height
        return layer_fit.layer(number, self.pads, tolerance, o.poisson, h, half)

    @cached_property
    def calibration(self) -> Sensitivity:
        """Each element's values and errors, in the form of a lab's calibration."""
        k, one, rig = self.known, np.ones(len(self.x)), self.design.calibration
        se, se_v = np.sqrt(k.of_k * one), np.sqrt(k.of_v * one)
        cell, half = (
            (rig.load_cell_stiffness, rig.load_cell_accuracy * rig.load_cell_stiffness)
            if (rig and k.load_cell)
            else (RIGID, 0.0)
        )
        return Sensitivity(
            np.arange(1, len(one) + 1),
            self.stiffness,
            se * self.stiffness,
            self.signal,
            se_v * self.signal,
            k.cross * one / np.maximum(se * se_v, 1e-300),
            k.dof * one,
            cell * one,
            half * one,
        )

    def expected(
        self, at: Poses, loads: int = LOADS, stiffness: Array | None = None, height: Array | None = None
    ) -> layer_fit.Expected:
        grip, one = self.target.grasp, np.ones(len(self.x))
        load, _ = even_loads(grip.force, loads)
        shared = tuple(np.stack([k * one, v * one], -1) for k, v in self.known.common.values())
        return layer_fit.expected(
            self.array,
            load,
            self.calibration,
            at.modulus,
            at.slope,
            self.noise,
            readings=grip.loads,
            shared=shared,
            stiffness=stiffness,
            height=height,
        )

    def half_width(self, at: Poses, got: layer_fit.Expected) -> Array:
        """Half-width of K_obj or the modulus, relative, [pose]; with the error of a linear body."""
        of = got.modulus if self.target.object.reference == "modulus" else got.object_
        deep = self.depth(at, got)
        strain = strain_error(self.pads, self.array.contact.body, np.minimum(deep, LINEAR_REACH))
        return (of[:, 2] - of[:, 1]) / 2 / of[:, 0] + strain

    def depth(self, at: Poses, got: layer_fit.Expected) -> Array:
        """Depth of the deepest pad under its force, over the lesser of its radius and the thickness."""
        least = min(pad_radius(self.pads), self.array.contact.body.thickness)
        return got.force.max(1) / (at.modulus * self.array.unit) / least


def of_elements(known: Knowledge, pick: Callable[[Array], Array]) -> Knowledge:
    """The knowledge of the arrays' elements chosen by `pick`."""
    place, common = known.place, known.common
    return replace(
        known,
        of_k=pick(known.of_k),
        of_v=pick(known.of_v),
        cross=pick(known.cross),
        place=(pick(place[0]), pick(place[1])),
        common={name: (pick(k), pick(v)) for name, (k, v) in common.items()},
    )


class CandidatesOnLayer(Candidates):
    """Candidates with interval and forces of rigid pads on a body."""

    def feel(self) -> tuple[Array, Array, Array]:
        """Results on the body; for candidates that break other limits anyway, on springs and marked too
        deep."""
        width, force, _ = super().feel()
        deep = np.full(len(width), UNTRIED)
        broken = sum(np.maximum(v, 0.0) for v in self.of_shape.values()) > 0.0
        usable = np.isfinite(self.elements.stiffness).all(axis=1) & self.known_as_made & ~broken
        for i in np.flatnonzero(usable):
            try:
                widths, depths, of_kinds = self.pressed(int(i))
            except (InputError, np.linalg.LinAlgError):  # no stiffer than the load cell
                width[i] = inf
                continue
            width[i], deep[i], force[i] = widths.max(), depths.max(), of_kinds.max(axis=0)
            decide = (widths, depths, *of_kinds.T)
            self.decided_by[int(i)] = tuple({int(np.argmax(each)) for each in decide})
        return width, force, deep

    @cached_property
    def at(self) -> Poses:
        """Poses that are tried."""
        at, tried = poses(self.stand.target, self.stand.base), list(self.stand.tried)
        return Poses(at.modulus[tried], at.slope[tried]) if tried else at

    def pressed(self, i: int) -> tuple[Array, Array, Array]:
        """Half-width and depth of one candidate at every pose that is tried, [pose], and the largest force of
        each kind, N, [pose, kind]."""
        s, shape, known = self.stand, self.arm.shape, self.known
        dealt = order([int(n) for n in self.count[i]], s.target.room.rows, s.pattern)
        kind = np.array([k for row in dealt for k in row])
        pick = lambda of: np.broadcast_to(of, shape)[i, kind]  # noqa: E731
        x, y = s.places(tuple(len(row) for row in dealt))
        arm = pick(self.arm) - s.base.element.pad_length / 2
        K, V = pick(self.elements.stiffness), pick(self.elements.signal)
        made = LayerGrasps(s.target, s.base, x, y, arm, K, V, of_elements(known, pick), s.noise)
        got = made.expected(self.at)
        of_kinds = [got.force[:, kind == k].max(1, initial=0.0) for k in range(shape[1])]
        return made.half_width(self.at, got), made.depth(self.at, got), np.stack(of_kinds, axis=1)


def others(stand: Stand, rng: np.random.Generator) -> Iterator[Stand]:
    """Variants of the stand: another order of kinds, another pitch along or across the rows, or other
    pads."""
    for pattern in rng.choice(PATTERNS, 4, replace=False):
        if pattern != stand.pattern:
            yield replace(stand, pattern=int(pattern))
    d, room, pads = stand.base, stand.target.room, stand.target.elements.pads
    for name, steps in STEPS.items():
        for step in steps:
            array, element = d.array, d.element
            if name == "pad_length":
                length = round(element.pad_length + step, 6)
                if not (pads and pads[0] <= length <= pads[1]):
                    continue
                element = replace(element, pad_length=length)
            else:
                least = max(room.pitch, d.sheet.thickness + 0.2) if name == "pitch" else room.pitch
                value = round(getattr(array, name) + step, 6)
                if value < least - 1e-9:
                    continue
                array = replace(array, **{name: value})
                array = replace(array, spacer=round(array.pitch - d.sheet.thickness, 6))
            if array.row_pitch >= element.pad_length + CLEAR:
                yield replace(stand, base=replace(d, array=array, element=element))
