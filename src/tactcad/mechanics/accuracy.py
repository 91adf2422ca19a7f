"""The cheapest rung that keeps a requested accuracy at a design, by the largest errors measured near it.

"Error" is that of the tip stiffness K against one reference for all rungs: three-dimensional linear
elasticity of the element cut at load line and clamp edge, solved by solid elements to their limit. It
excludes what the reference leaves out, such as the real hinge's thickness and the real position of the load.

`data/accuracy.json`, written by `benchmarks/ladder_fit.py`, divides the envelope into zones by notch form and
dimensionless groups. For each zone it holds the largest error of every candidate, the error that is promised,
and the time an element takes.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from tactcad.design.messages import CheckFailure, InputError

from . import validity
from .register import rungs
from .section import Array, HingeSection

MEASURED_FOR = "solid"  # the rung whose range is the envelope: errors were measured on its sample


@dataclass(frozen=True)
class Candidate:
    """A choice of rung; `mesh` is half the order of fem-solid's elements in the plane, None for rungs without
    that choice."""

    rung: str
    mesh: int | None = None

    @property
    def name(self) -> str:
        return self.rung if self.mesh is None else f"{self.rung}, mesh {self.mesh}"


# In the order of the work per element: operations of the closed forms, unknowns of the finite elements. An
# order by measured time would put the finer of two meshes first whenever one run was disturbed.
CANDIDATES = tuple(Candidate(rung.name, mesh) for rung in rungs().values() for mesh in rung.meshes)


@dataclass(frozen=True)
class Choice:
    """The choice: its promised worst error |K/K_reference - 1|, and the zones of the envelope that the
    designs lie in."""

    candidate: Candidate
    expected_error: float
    zones: tuple[str, ...]


@lru_cache(maxsize=1)
def accuracy_data() -> dict:
    """data/accuracy.json as written by the fit. Raises InputError if a registered rung is not in it."""
    data = json.loads((Path(__file__).parent / "data" / "accuracy.json").read_text("utf-8"))
    measured = set.intersection(*(set(zone["promised"]) for zone in data["zones"]))
    for name in (c.name for c in CANDIDATES if c.name not in measured):
        legal = "mechanics/data as `python benchmarks/ladder_fit.py src/tactcad/mechanics/data` writes it"
        raise InputError(f"rung {name} of mechanics/rungs", "its errors are not measured", legal=legal)
    return data


def choose(s: HingeSection, accuracy: float, names: Sequence[str] = ()) -> Choice:
    """The candidate of least work that keeps an accuracy at every one of the designs.

    Parameters
    ----------
    s
        One design or many.
    accuracy
        Largest relative error of K that is accepted, such as 0.01.
    names
        Of the designs, in the order of the flattened section, for the message of a refusal.

    Raises
    ------
    CheckFailure
        If a design lies outside the envelope in which errors were measured, or no candidate keeps the
        accuracy.
    """
    require_measured(s, names)
    zone = zones(s).ravel()
    if choice := _least_work(zone, accuracy):
        return choice
    best, error = _best(zone)
    worst = int(np.argmax(error))
    raise CheckFailure(_none_keeps(accuracy, best, float(error[worst])) + _named(names, worst))


def require_measured(s: HingeSection, names: Sequence[str] = ()) -> None:
    """Raise CheckFailure if a design lies outside the envelope in which errors were measured; `names` as
    for `choose`."""
    outside = validity.reasons(s, MEASURED_FOR).ravel()
    for i in np.flatnonzero(outside != ""):
        raise CheckFailure(_not_measured(outside[i]) + _named(names, int(i)))


def choose_each(s: HingeSection, accuracy: float) -> list[Choice | str]:
    """For every design its own choice, or the reason for having none.

    Parameters
    ----------
    s
        One design or many.
    accuracy
        Largest relative error of K that is accepted.

    Returns
    -------
    list of Choice or str
        One entry a design, in the order of the flattened section.
    """
    by_zone: dict[int, Choice | str] = {}
    zone = zones(s).ravel()
    for z in np.unique(zone):
        one = np.array([z])
        best, error = _best(one)
        by_zone[z] = _least_work(one, accuracy) or _none_keeps(accuracy, best, float(error[0]))
    reasons = validity.reasons(s, MEASURED_FOR).ravel()
    return [_not_measured(why) if why else by_zone[z] for why, z in zip(reasons, zone)]


def zones(s: HingeSection) -> np.ndarray:
    """Index of every design's zone in the data's list; sensible only inside the envelope."""
    with np.errstate(all="ignore"):
        groups = validity.groups(s)
    index = np.zeros(s.shape, dtype=int)
    for i, zone in enumerate(accuracy_data()["zones"]):
        index[np.broadcast_to(in_zone(zone, groups, s.two_sided), s.shape)] = i
    return index


def in_zone(zone: dict, groups: dict[str, Array], two_sided: np.ndarray) -> np.ndarray:
    """Mask of the designs in a zone: of its notch form, and within its bounds."""
    return (two_sided == (zone["sides"] == "two")) & validity.in_bounds(zone["bounds"], groups)


def expected_error(s: HingeSection, candidate: Candidate) -> Array:
    """Promised worst error of a candidate at every design, NaN outside the envelope."""
    return np.where(validity.within(s, MEASURED_FOR), _promised(zones(s), candidate), np.nan)


def expected_error_of(s: HingeSection, rung: str, mesh: int | None = None) -> Array:
    """Promised largest relative error of a rung at every design, NaN outside the envelope.

    Parameters
    ----------
    s
        One design or many.
    rung
        The rung's name.
    mesh
        Half the order of fem-solid's elements in the plane, by default the rung's own.

    Returns
    -------
    Array
        Of the section's shape.
    """
    return expected_error(s, Candidate(rung, mesh or rungs()[rung].meshes[0]))


def stated(error: float) -> str:
    """The wording of an expected error."""
    return f"K within {100.0 * error:.2g} % of solid elements refined to their limit (docs/accuracy.md)"


def zone_name(zone: dict) -> str:
    bounds = (
        f"{name} from {low:g}" if high is None else f"{name} {low:g} to {high:g}"
        for name, (low, high) in zone["bounds"].items()
    )
    return ", ".join((f"{zone['sides']}-sided", *bounds))


def _promised(zone: np.ndarray, candidate: Candidate) -> Array:
    return np.array([z["promised"][candidate.name] for z in accuracy_data()["zones"]])[zone]


def _least_work(zone: np.ndarray, accuracy: float) -> Choice | None:
    """The first of the candidates that keeps the accuracy in all these zones."""
    data = accuracy_data()
    for candidate in CANDIDATES:
        error = float(_promised(zone, candidate).max())
        if error <= accuracy:
            names = tuple(zone_name(data["zones"][z]) for z in np.unique(zone))
            return Choice(candidate, error, names)
    return None


def _best(zone: np.ndarray) -> tuple[Candidate, Array]:
    """The candidate with the least worst promise over the designs, and its promise for each."""
    return min(((c, _promised(zone, c)) for c in CANDIDATES), key=lambda pair: pair[1].max())


def _named(names: Sequence[str], i: int) -> str:
    return f" ({names[i]})" if names else ""


def _not_measured(rule: str) -> str:
    return f"the errors of the rungs were not measured for this design: {rule}; name a rung with --model"


def _none_keeps(accuracy: float, best: Candidate, error: float) -> str:
    return (
        f"no rung is known to keep {100 * accuracy:.3g} % at this design; "
        f"the best is {best.name}, measured to keep {100 * error:.2g} %"
    )
