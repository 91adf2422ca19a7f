"""Table 1's stiffness against every closed-form rung: residuals, what would explain each, expected spread.

One change at a time is sought that makes the best rung give the measured K: of the hinge thickness alone, or
of the load point alone. Both are compared with what wire cutting and the pad allow. The Monte Carlo draws
every toleranced dimension.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.mechanics import ladder
from tactcad.mechanics.as_built import in_clamp, without_layer
from tactcad.mechanics.section import HingeSection
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.published import Published

DRAWS = 40_000  # the bands' ends repeat within 0.5 %
EDGE = 0.02  # ln K closer than this to a band's end is reported at its edge, neither inside nor outside
BAND = (0.025, 0.975)


@dataclass(frozen=True)
class Residuals:
    """By element of Table 1 that the design has too. Stiffness N/mm, lengths mm."""

    element: np.ndarray
    arm: np.ndarray
    measured: np.ndarray
    predicted: dict[str, np.ndarray]  # by rung
    rung: str  # the one that explanations and bands use
    residual: np.ndarray  # ln(measured/predicted) of that rung
    thickness: np.ndarray  # nominal
    thickness_needed: np.ndarray  # NaN where none within the rung's range does
    load_arm: np.ndarray
    load_arm_needed: np.ndarray
    pad_half: float
    band_cut: np.ndarray  # [2, element], predicted K's 95 % band from cutting and clamping tolerances
    band_pad: np.ndarray  # the same, and the contact anywhere on the pad

    @property
    def mean(self) -> float:
        """Mean of the log residuals: the model's common factor."""
        return float(self.residual.mean())

    @property
    def scatter(self) -> float:
        """Standard deviation of the log residuals about their mean."""
        return float(self.residual.std(ddof=1))

    @property
    def furthest(self) -> int:
        """Row of the element whose stiffness is furthest off."""
        return int(np.argmax(np.abs(self.residual)))

    @property
    def scatter_of_others(self) -> float:
        """The same without the element that is furthest off."""
        return float(np.delete(self.residual, self.furthest).std(ddof=1))

    @property
    def thickness_change(self) -> np.ndarray:
        return self.thickness_needed - self.thickness

    @property
    def load_arm_change(self) -> np.ndarray:
        return self.load_arm_needed - self.load_arm

    def outside(self, band: np.ndarray) -> np.ndarray:
        """Which elements' measured stiffness lies outside a band, further than EDGE."""
        return np.minimum(np.log(self.measured / band[0]), np.log(band[1] / self.measured)) < -EDGE

    def at_edge(self, band: np.ndarray) -> np.ndarray:
        """Which elements' measured stiffness lies within EDGE of an end of a band."""
        return np.abs(np.log(self.measured / band)).min(0) <= EDGE


def matched(data: Published, array: ArrayModel) -> tuple[np.ndarray, HingeSection]:
    """Rows of Table 1 whose element the design has, by number and arm length, and their hinge sections."""
    place = array.rows(data.table1.element)
    printed = data.table1.arm
    same = np.abs(array.arm[place] - printed.value) <= printed.half_step
    here = np.flatnonzero((place >= 0) & same)
    return here, array.section.rows(place[here])


def residuals(
    data: Published,
    array: ArrayModel,
    rng: np.random.Generator,
    rung: str = "solid",
    more: dict[str, np.ndarray] | None = None,
) -> Residuals:
    """Table 1 against the design as it stands; `more` adds stiffnesses of slower rungs, for the matched
    elements.
    """
    here, s = matched(data, array)
    K = data.table1.stiffness.value[here]
    predicted = {name: ladder.evaluate(s, name).stiffness for name in ladder.CLOSED_FORMS}
    predicted |= more or {}
    t, L = s.hinge_thickness, np.broadcast_to(s.load_arm, s.shape)
    return Residuals(
        data.table1.element[here],
        data.table1.arm.value[here],
        K,
        predicted,
        rung,
        np.log(K / predicted[rung]),
        np.broadcast_to(t, s.shape),
        solve(s, "hinge_thickness", K, 0.3, 3.0, rung),
        L,
        solve(s, "load_arm", K, 0.2, 3.0, rung),
        array.pad_length / 2,
        _band(s, array, rng, rung, 0.0),
        _band(s, array, rng, rung, array.pad_length / 2),
    )


def solve(s: HingeSection, name: str, K: np.ndarray, least: float, most: float, rung: str) -> np.ndarray:
    """Value of one dimension that gives each stiffness, searched from `least` to `most` times its own.

    NaN where there is none. A scan brackets the value nearest to the dimension's own; secant steps on ln K
    against its logarithm, which is nearly straight, then converge to it.
    """
    own = np.broadcast_to(getattr(s, name), s.shape).reshape(-1)
    factor = np.geomspace(least, most, 400)
    solution = np.full(own.shape, np.nan)
    for i in range(len(own)):
        one = s.rows([i])

        def misfit(log_factor: np.ndarray, i: int = i, one: HingeSection = one) -> np.ndarray:
            trial = one.with_(**{name: own[i] * np.exp(np.atleast_1d(log_factor))})
            return np.log(ladder.evaluate(trial, rung).stiffness / K[i])

        scan = misfit(np.log(factor))
        cross = np.flatnonzero(np.sign(scan[:-1]) * np.sign(scan[1:]) <= 0)
        if not len(cross):
            continue
        j = cross[np.argmin(np.abs(np.log(factor[cross])))]
        slope = (scan[j + 1] - scan[j]) / np.log(factor[j + 1] / factor[j])
        root = np.log(factor[j]) - scan[j] / slope
        for _ in range(4):
            root -= misfit(root)[0] / slope
        solution[i] = own[i] * np.exp(root)
    return solution.reshape(s.shape)


def spread(
    s: HingeSection,
    array: ArrayModel,
    rng: np.random.Generator,
    rung: str,
    contact: float = 0.0,
    draws: int = DRAWS,
) -> np.ndarray:
    """Stiffness [draw, element] with every dimension of [tolerance] drawn: half-widths are two standard
    deviations.

    NaN where a draw is out of the rung's range. `contact` is the half-width (mm) over which the load's
    position on the pad is uniform. Dimensions that one sheet and one cut share have one draw for all elements
    of an array, the others one for each. Layer and clamp only soften.
    """
    tol = array.tolerance
    shape, shared = (draws, *s.shape), (draws, 1)
    each = lambda half, shape=shape: half / 2 * rng.standard_normal(shape)  # noqa: E731
    length = s.hinge_length + each(tol.hinge_length)
    cut = _one_each(s, draws).with_(
        hinge_thickness=s.hinge_thickness + each(tol.hinge_thickness),
        hinge_length=length,
        fillet_radius=np.clip(s.fillet_radius + each(tol.fillet_radius), 0.0, length / 2),
        arm_height=s.arm_height + each(tol.arm_height),
        load_arm=s.load_arm + each(tol.load_arm) + contact * rng.uniform(-1, 1, shape),
        width=s.width + each(tol.sheet_thickness, shared),
        youngs_modulus=s.youngs_modulus * (1 + each(tol.youngs_modulus, shared)),
    )
    left = without_layer(cut, np.abs(each(tol.recast_layer, shared)))
    return in_clamp(left, ladder.evaluate(left, rung).stiffness, np.abs(each(tol.clamp_compliance)))


def _band(
    s: HingeSection, array: ArrayModel, rng: np.random.Generator, rung: str, contact: float
) -> np.ndarray:
    return np.nanquantile(spread(s, array, rng, rung, contact), BAND, axis=0)


def _one_each(s: HingeSection, draws: int) -> HingeSection:
    """The same sections, repeated in `draws` rows."""
    changes = {}
    for name in s.__dataclass_fields__:
        value = getattr(s, name)
        changes[name] = np.broadcast_to(value, (draws, *s.shape)) if value.size > 1 else value
    return s.with_(**changes)
