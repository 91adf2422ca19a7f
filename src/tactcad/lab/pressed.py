"""An array pressed on an object: deflection, force and signal of every element, and R of every pair."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, radians, tan

import numpy as np

from tactcad.contact import springs
from tactcad.contact.elastic_body import Body
from tactcad.contact.press import PATCHES, Pads, PadsOnBody, Pressed, pad_stiffness
from tactcad.contact.rigid_pads import press_many
from tactcad.contact.stated_errors import (
    CHOSEN_FROM,
    DEFAULT_RUNG,
    LINEAR_REACH,
    REACH,
    depth_share,
    stated_error,
    tilt_error,
)
from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import CommonTables
from tactcad.mechanics import lumped
from tactcad.report.figures import Figure, Figures

MOST_PATCHES = 14_400  # a hundred pads, of which the law costs as much; 0.8 GB if no two pairs lie alike
# Growth of rung layer's stated error beyond them, for pads at least APART mm from each other, and nearer.
# Climbs of 52 pads against single patches (gaps from 0.02 mm, up to 30 degrees, layers from 0.3 pads thick)
# ended at 0.087 and 0.60; level pads a millimetre apart are off by 0.002.
MANY_PADS, NEAR_PADS, APART = 0.1, 0.8, 0.2
MOST_PADS = 2000  # by the law of whole pads: a matrix of 0.3 GB, and some copies
SAME = 1e-6  # relative difference of stiffness below which two elements are no pair
LARGEST_ANGLE = 30.0  # degrees; beyond it the inclined face's own sideways motion is no longer small


@dataclass(frozen=True)
class PressedElement:
    """One element under the load."""

    number: int
    stiffness: float  # N/mm
    deflection: float  # mm, of the pad's middle
    force: float  # N, on its pad
    signal: float  # change from no load, V, or what the family's pads say
    contact: float  # share of its pad's area that presses
    touches: bool
    stopped: bool


ELEMENT = Figures(
    PressedElement,
    Figure("number", "no.", "", 1.0, "d"),
    Figure("stiffness", "K", "N/mm", 1.0, ".4g"),
    Figure("deflection", "deflection", "um", 1e3, ".4g"),
    Figure("force", "force", "N", 1.0, ".4g"),
    Figure("signal", "signal", "mV", 1e3, ".4g"),
    Figure("contact", "contact", "%", 100.0, ".0f"),
)


@dataclass(frozen=True)
class PressedPair:
    """A measuring element against the reference: R, and K_obj by equation (3)."""

    measuring: int
    reference: int
    ratio: float
    by_springs: float  # N/mm


PAIR = Figures(
    PressedPair,
    Figure("measuring", "no.", "", 1.0, "d"),
    Figure("reference", "to no.", "", 1.0, "d"),
    Figure("ratio", "R", "", 1.0, ".4g"),
    Figure("by_springs", "K_obj by eq. (3)", "N/mm", 1.0, ".4g"),
)


@dataclass(frozen=True)
class PressedArray:
    """Rung, object and load, K_obj under a single level pad (N/mm), and each element's figures."""

    rung: str
    body: Body
    load: float  # N
    angle: tuple[float, float]  # degrees
    approach: float  # mm
    object_stiffness: float
    elements: tuple[PressedElement, ...]
    pairs: tuple[PressedPair, ...]
    patches: np.ndarray | None  # of the pads' pressure, `Pressed.patches`; None by springs
    expected_error: float  # stated for the rung: of a pad's force over the mean of those that touch
    signal_unit: tuple[str, str]  # and of a thousandth


def press_array(
    design: CommonTables,
    body: Body,
    load: float,
    angle: tuple[float, float] = (0.0, 0.0),
    rung: str | None = None,
    within: float | None = None,
) -> PressedArray:
    """Press an array on an object by a total load.

    Parameters
    ----------
    design
        A loaded design.
    body
        What is pressed.
    load
        On the whole array, N.
    angle
        Of the object's face, degrees: positive where it falls away toward +x, +y.
    rung
        One of `tactcad.contact.stated_errors.RUNGS`; None: DEFAULT_RUNG, or the cheapest that keeps `within`.
    within
        Largest error of the forces that is accepted.

    Raises
    ------
    InputError
        A load or angle out of range, a layer too thin, fewer than two pads that touch, too many pads.
    CheckFailure
        An element is out of the estimator's range; no rung, or not the named one, keeps `within`.
    """
    if not 0 < load < inf:
        raise InputError("--load", "out of range", value=load, legal="above 0 N, finite")
    for a in angle:
        if not abs(a) <= LARGEST_ANGLE:
            legal = f"from -{LARGEST_ANGLE:g} to {LARGEST_ANGLE:g} degrees"
            raise InputError("--angle", "out of range", value=a, legal=legal)
    of = family_of(design).must("pads", "grasp")
    number = of.places(design)[2]
    if len(number) < 2:
        raise InputError(design.name, "one pad makes no pair", value=1, legal="two elements or more")
    pads, per_sink = of.springs(design)
    alone = pad_stiffness(body, pads.length, pads.width, pads.disc)
    K = 1 / pads.compliance[:, 0, 0]
    candidates = (rung,) if rung else CHOSEN_FROM if within else (DEFAULT_RUNG,)
    rung, pressed, error = _chosen(candidates, within, pads, body, alone, load, angle)
    if (touching := int((pressed.contact > 0).sum())) < 2:
        what = f"only {touching} of {len(number)} pads touches, so no pair tells anything"
        legal = "less inclined, or a larger --load"
        raise InputError("--angle", what, value=f"{angle[0]:g},{angle[1]:g}", legal=legal)
    elements = [
        PressedElement(
            number=int(number[i]),
            stiffness=float(K[i]),
            deflection=float(pressed.sink[i]),
            force=float(pressed.force[i]),
            signal=float(per_sink[i] * pressed.sink[i]),
            contact=float(pressed.contact[i]),
            touches=bool(pressed.contact[i] > 0),
            stopped=bool(pressed.stopped[i]),
        )
        for i in np.argsort(number)
    ]
    touch = [e for e in elements if e.touches]
    reference = max(touch, key=lambda e: e.stiffness)
    softer = [e for e in touch if e.stiffness < reference.stiffness * (1 - SAME)]
    pairs = tuple(_pair(e, reference) for e in softer)
    shown = None if rung == "springs" else pressed.patches
    done = (pressed.approach, alone, tuple(elements), pairs, shown, error, of.unit)
    return PressedArray(rung, body, load, angle, *done)


def _pair(measuring: PressedElement, reference: PressedElement) -> PressedPair:
    ratio = measuring.deflection / reference.deflection
    by_springs = float(lumped.object_stiffness(reference.stiffness, measuring.stiffness, ratio))
    return PressedPair(measuring.number, reference.number, ratio, by_springs)


def _chosen(
    candidates: tuple[str, ...],
    within: float | None,
    pads: Pads,
    body: Body,
    alone: float,
    load: float,
    angle: tuple[float, float],
) -> tuple[str, Pressed, float]:
    """The first candidate within the error, its result, and its stated error."""
    best = inf
    for rung in candidates:
        if rung == "springs":
            pressed = _on_springs(pads, alone, load, angle)
        else:
            pressed = _on_body(pads, body, load, angle, rung)
        deep = depth_share(pads, body, pressed.force)
        if rung != "large" and deep > LINEAR_REACH:
            if rung != candidates[-1]:
                continue
            what = f"presses a pad {deep:.2g} of its radius or the thickness deep, too deep for rung {rung}"
            legal = f"at most {LINEAR_REACH:g}; rung large reaches {REACH:g}"
            raise InputError("--load", what, value=load, legal=legal)
        error = stated_error(rung, pads, body, pressed.force)
        if rung != "springs":  # whose climbs were of tilted pads
            error += tilt_error(pads, body, pressed, angle)
        if rung == "layer" and len(pads.x) * PATCHES**2 > MOST_PATCHES:
            error += MANY_PADS if _gap(pads) > APART - SAME else NEAR_PADS
        if within is None or error <= within:
            return rung, pressed, error
        best = min(best, error)
    raise CheckFailure(
        f"no rung is stated to keep the forces within {within:.3g}: the best of {', '.join(candidates)} "
        f"keeps {best:.2g} here"
    )


def _gap(pads: Pads) -> float:
    """Least distance of two pads, mm, along x or along y."""
    along, across = np.abs(pads.x[:, None] - pads.x), np.abs(pads.y[:, None] - pads.y)
    gap = np.maximum(along - pads.length, across - pads.width)
    return float(gap[~np.eye(len(gap), dtype=bool)].min())


def _on_body(pads: Pads, body: Body, load: float, angle: tuple[float, float], rung: str) -> Pressed:
    most = MOST_PATCHES // PATCHES**2
    if len(pads.x) > (MOST_PADS if rung == "layer" else most):
        legal = f"at most {most}, {MOST_PADS} by rung layer; --rung springs takes any number"
        raise InputError(f"--rung {rung}", "too many pads", value=len(pads.x), legal=legal)
    if len(pads.x) > most:
        return press_many(pads, body, load, angle)
    contact = PadsOnBody(pads, body, rung)
    if rung == "large":
        from tactcad.contact import large_strain  # scikit-fem takes a while to load

        return large_strain.press(contact, load, angle)
    return contact.press(load=load, angle=angle)


def _on_springs(pads: Pads, alone: float, load: float, angle: tuple[float, float]) -> Pressed:
    """Each pad alone, loaded at its middle: no tilt, no coupling."""
    back = pads.height + pads.x * tan(radians(angle[0])) + pads.y * tan(radians(angle[1]))
    K, at = 1 / pads.compliance[:, 0, 0], np.array([load])
    (approach,), force, sink = springs.press(K, alone, at, back, pads.stop)
    force, sink = force[:, 0], sink[:, 0]
    level, none = np.zeros((len(force), 2)), np.empty((5, 0, 0))
    return Pressed(float(approach), force, sink, level, (force > 0) * 1.0, sink >= pads.stop, none)
