"""The ladder's rungs as grades: the error that each promises of these designs, and what it costs here."""

from __future__ import annotations

import numpy as np

from tactcad.design.allowance import Grade
from tactcad.fem.mapped_mesh import layers, plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics.accuracy import (
    CANDIDATES,
    MEASURED_FOR,
    Candidate,
    accuracy_data,
    expected_error,
    zones,
)
from tactcad.mechanics.register import BY_NAME
from tactcad.mechanics.section import Array, HingeSection
from tactcad.mechanics.validity import reasons

from .this_machine import here, power_law, published

SIZED = 64  # designs whose meshes are counted, evenly taken of many; a count takes a millisecond


def rung_grades(s: HingeSection) -> list[Grade]:
    """One candidate of `mechanics.accuracy` for all designs, each: the error of the worst one.

    Parameters
    ----------
    s
        One design or many, all where errors were measured (`accuracy.require_measured`).

    Returns
    -------
    list of Grade
        In the order of work, for `design.allowance.pick`.
    """
    count, each = int(np.prod(s.shape)), seconds_each(s)
    return [
        Grade(c.name, float(expected_error(s, c).max()), here(_start(c) + count * each[c]))
        for c in CANDIDATES
    ]


def row_grades(s: HingeSection, within: float | None = None) -> list[Grade]:
    """A candidate for every design, its own: the one of least work that keeps an error, for every error that
    makes a difference.

    Parameters
    ----------
    s
        Many designs in a row; those where errors were not measured are left out.
    within
        The error asked for; designs that no candidate answers to it are left out, too.

    Returns
    -------
    list of Grade
        Empty where all designs are left out.
    """
    inside = np.flatnonzero(reasons(s, MEASURED_FOR).ravel() == "")
    zone = zones(s).ravel()[inside]
    data = accuracy_data()["zones"]
    promised = {z: [data[z]["promised"][c.name] for c in CANDIDATES] for z in np.unique(zone).tolist()}
    promised = {z: errors for z, errors in promised.items() if within is None or min(errors) <= within}
    counts = {z: int((zone == z).sum()) for z in promised}
    each = {z: seconds_each(s.rows(inside[zone == z])) for z in promised}
    least = max((min(errors) for errors in promised.values()), default=0.0)
    levels = sorted({e for errors in promised.values() for e in errors if e >= least}, reverse=True)
    grades = []
    for level in levels:
        taken = {z: next(i for i, e in enumerate(errors) if e <= level) for z, errors in promised.items()}
        by = {c: sum(counts[z] for z, i in taken.items() if CANDIDATES[i] == c) for c in CANDIDATES}
        seconds = sum(counts[z] * each[z][CANDIDATES[i]] for z, i in taken.items())
        start = max(_start(c) for c, n in by.items() if n)
        names = [
            f"{c.name} for {n}" if len(taken) > 1 and n < len(zone) else c.name for c, n in by.items() if n
        ]
        error = max(promised[z][i] for z, i in taken.items())
        rows = published()["row"] * int(np.prod(s.shape))
        grades.append(Grade(" and ".join(names), error, here(start + rows + seconds)))
    return grades


def _start(candidate: Candidate) -> float:
    """Until a command computes, and what it does beside."""
    start = published()["start"]
    return start["numpy"] + (0.0 if BY_NAME[candidate.rung].compliance else start["elements"])


def seconds_each(s: HingeSection) -> dict[Candidate, float]:
    """Seconds of one design, mean over them, on the published machine."""
    sizes = mesh_sizes(s)
    seconds = {}
    for c in CANDIDATES:
        if BY_NAME[c.rung].compliance:
            seconds[c] = max(zone["seconds"][c.name] for zone in accuracy_data()["zones"])
        else:
            seconds[c] = float(power_law(published()["elements"][c.name], *sizes).mean())
    return seconds


def mesh_sizes(s: HingeSection) -> tuple[Array, Array]:
    """Elements of the coarsest mesh in the plane, and layers over half the width: of SIZED designs at most,
    evenly taken."""
    count = int(np.prod(s.shape))
    taken = np.unique(np.linspace(0, count - 1, min(count, SIZED)).round().astype(int))
    return tuple(np.array([_mesh_size(s.rows(int(i))) for i in taken], float).T)


def _mesh_size(one: HingeSection) -> tuple[int, int]:
    mesh = plane_mesh(reference_shape(one), order=1)
    return len(mesh.cells), len(layers(float(one.width) / 2.0, mesh.shape.thickness, 1)) - 1
