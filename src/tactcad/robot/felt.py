"""From joint positions to forces and to the touched object's stiffness, as in `tactcad stiffness`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf, nan

import numpy as np
from numpy.typing import ArrayLike

from tactcad.design.messages import InputError
from tactcad.lab.calibration_file import Sensitivity
from tactcad.lab.combine import Interval, combine_each, hull
from tactcad.lab.grasp import coupled, slopes_of
from tactcad.lab.load_cell import RIGID
from tactcad.lab.pads import INCOMPRESSIBLE
from tactcad.lab.regression import KNOWN, require_level
from tactcad.mechanics.lumped import shares_between

from .taxel_table import Taxels

TOUCHES = 5.0  # standard deviations of a reading from which on a pad is taken to touch; chosen
NEAR_STOP = 0.999  # of the range: beyond it the stop bears


@dataclass(frozen=True)
class Felt:
    """The taxels' readings, in the table's order; with several frames, a row a frame.

    deflection  of the pads' middles, mm
    force       across the pads, N; at its stop a pad bears more
    shear       along x and y of the pads' frames, N, [.., taxel, 2]; not a number if none is felt
    used        pads that touch and are off their stops
    """

    deflection: np.ndarray
    force: np.ndarray
    shear: np.ndarray
    used: np.ndarray
    _objects: tuple[Interval | None, ...] | None

    @property
    def object(self) -> tuple[Interval | None, ...]:
        """K_obj of each frame, N/mm, with its interval; None if fewer than two pads are used.

        Raises InputError for taxels of a family whose readings `tactcad stiffness` does not take either.
        """
        if self._objects is None:
            raise InputError(
                "K_obj", "is read from volts only", value="taxels without signal_V_per_mm", legal="volts"
            )
        return self._objects


def read(taxels: Taxels, joints: ArrayLike, level: float = 0.95, coupling: float = 1.0) -> Felt:
    """Forces and K_obj from the elements' joint positions, from one frame or from many.

    Positions are from rest, in the table's order, rad (of slides m): [joint], or [frame, joint]. The
    interval, at that level, is by the read-out's noise, by the uncertainty of K and of the pads' heights of
    an array as made, and by any coupling of the pads from 0 (separate springs) to `coupling` (1: a
    half-space). Raises InputError for positions that are not finite or not one for each joint, and a level or
    share out of range.
    """
    require_level(level)
    if not 0 <= coupling <= 1:
        raise InputError("coupling", "out of range", value=coupling, legal="from 0 to 1")
    sinks = [t.sink_mm_per_rad for t in taxels.taxels]
    try:
        q = np.asarray(joints, float)
    except (TypeError, ValueError):
        raise InputError(
            "joints", "not an array of numbers", value=type(joints).__name__, legal="numbers"
        ) from None
    count, first = sum(map(len, sinks)), np.cumsum([0, *map(len, sinks)])[:-1]
    if q.ndim not in (1, 2) or q.shape[-1] != count or not q.size or not np.isfinite(q).all():
        legal = f"[{count}] or [frame, {count}], finite"
        raise InputError("joints", "not a position for each joint", value=q.shape, legal=legal)
    deflection = np.add.reduceat(q * np.concatenate(sinks), first, axis=-1)
    quiet = TOUCHES * taxels.column("noise_mm")
    used = (deflection > quiet) & (deflection < NEAR_STOP * taxels.column("range_mm"))
    sideways = [(t.shear_x_N_per_rad, t.shear_y_N_per_rad, len(t.joints)) for t in taxels.taxels]
    per_joint = np.hstack([(x, y) if x and y else np.full((2, n), nan) for x, y, n in sideways])
    shear = np.moveaxis(np.add.reduceat(q[..., None, :] * per_joint, first, axis=-1), -2, -1)
    objects = None
    if None not in taxels.column("signal_V_per_mm"):
        frames = zip(np.atleast_2d(deflection), np.atleast_2d(used))
        objects = tuple(_object(taxels, s, u, level, coupling) for s, u in frames)
    return Felt(deflection, taxels.column("stiffness_N_per_mm") * deflection, shear, used, objects)


def _object(taxels: Taxels, s: np.ndarray, used: np.ndarray, level: float, share: float) -> Interval | None:
    """K_obj of one frame: each pad's travel replaces its slope over the approach."""
    rows = np.flatnonzero(used)
    if len(rows) < 2:
        return None
    volts, zero = taxels.column("signal_V_per_mm"), np.zeros(len(s))
    K, variance = taxels.column("stiffness_N_per_mm"), taxels.column("variance_stiffness_N2_per_mm2")
    many, rigid = zero + KNOWN, zero + RIGID
    known = Sensitivity(taxels.column("number"), K, variance**0.5, volts, zero, zero, many, rigid, zero)
    noise = float(taxels.column("noise_V").max()) ** 2
    slopes = slopes_of(known.element[rows], (volts * s)[rows], known, noise, int(KNOWN))
    # a lower pad is pressed less: its height enters as an error of s
    part = slopes.from_calibration.copy()
    part[:, 1, 1] += taxels.column("variance_offset_mm2")[rows]
    part[:, [0, 1], [1, 0]] -= (s * taxels.column("covariance_stiffness_offset_N"))[rows, None]
    slopes = replace(slopes, from_calibration=part)
    cases = [slopes]
    if share != 0:
        cases += coupled([slopes], share * _shares(taxels)[np.ix_(rows, rows)])
    best, *others = (found for found, _, _ in combine_each([(at, None) for at in cases], level))
    return hull(best, others)


@lru_cache(maxsize=16)
def _shares(taxels: Taxels) -> np.ndarray:
    """Effect of one pad's force on another on a half-space, relative to its effect on the first."""
    x, y, length, width = (taxels.column(f"{name}_mm") for name in ("x", "y", "length", "width"))
    return shares_between(x, y, float(length[0]), float(width[0]), inf, INCOMPRESSIBLE)
