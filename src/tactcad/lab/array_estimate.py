"""Stiffness, strain, stress and strength of every element of a design, by one rung of the ladder."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.mechanics import ladder, strain, strength
from tactcad.mechanics.accuracy import expected_error_of
from tactcad.mechanics.section import Array, HingeSection, friction_factor
from tactcad.mechanics.strain import StrainErrors
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import design_alloy, hinge_section, not_reached
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.report.figures import Figure, Figures


@dataclass(frozen=True)
class ElementEstimate:
    """One element at one force. Deflection, strain and stress are None above yield."""

    number: int
    arm: float  # mm
    load_arm: float  # mm
    stiffness: float  # N/mm
    stiffness_ratio: float  # K_r/K_m: the stiffest element's stiffness over this one's
    force: float  # N
    deflection: float | None  # mm
    gauge_strain: float | None  # mean under the gauge's grid
    peak_strain: float | None  # at the slot-side fillet
    stress: float | None  # MPa, the largest principal one there
    gauge_strain_error: float | None  # relative, at most; None if none was measured
    peak_strain_error: float | None
    stress_error: float | None
    elastic: bool
    yield_factor_fillet: float
    yield_factor_face: float
    goodman_factor: float | None  # at 5e8 cycles between 0 and the force
    yield_force: float  # N
    yield_deflection: float  # mm
    rated_force: float  # N, in use
    rated_deflection: float  # mm, never passed: overload and calibration stay below
    expected_error: float | None  # of the stiffness, relative, at most; None if none was measured


ELEMENT = Figures(
    ElementEstimate,
    Figure("number", "no.", "", 1.0, "d"),
    Figure("arm", "arm", "mm", 1.0, "g"),
    Figure("load_arm", "load arm", "mm", 1.0, "g"),
    Figure("stiffness", "K", "N/mm", 1.0, ".4g"),
    Figure("expected_error", "error of K at most", "%", 100.0, ".2g"),
    Figure("stiffness_ratio", "K_r/K_m", "", 1.0, ".3g"),
    Figure("force", "force", "N", 1.0, "g"),
    Figure("deflection", "deflection", "um", 1e3, ".4g"),
    Figure("gauge_strain", "gauge strain", "1e-6", 1e6, ".0f"),
    Figure("peak_strain", "fillet strain", "1e-6", 1e6, ".0f"),
    Figure("stress", "fillet stress", "MPa", 1.0, ".0f"),
    Figure("gauge_strain_error", "gauge", "%", 100.0, ".1f"),
    Figure("peak_strain_error", "fillet", "%", 100.0, ".1f"),
    Figure("stress_error", "stress", "%", 100.0, ".1f"),
    Figure("yield_factor_fillet", "yield/stress", "", 1.0, ".2f"),
    Figure("yield_factor_face", "face yield/stress", "", 1.0, ".2f"),
    Figure("goodman_factor", "Goodman", "", 1.0, ".2f"),
    Figure("yield_force", "yield force", "N", 1.0, ".3g"),
    Figure("yield_deflection", "yield defl.", "um", 1e3, ".4g"),
    Figure("rated_force", "rated force", "N", 1.0, ".3g"),
    Figure("rated_deflection", "rated defl.", "um", 1e3, ".4g"),
)


def estimate(
    layout: Layout,
    rung: str,
    force: float | None = None,
    mesh: int | None = None,
    numbers: Collection[int] = (),
) -> list[ElementEstimate]:
    """Estimate every element of a design.

    Parameters
    ----------
    layout : Layout
    rung : str
        Of the ladder.
    force : float, optional
        On each pad, N; by default the design's rating.
    mesh : int, optional
        Density of rung fem-solid's finer mesh.
    numbers : collection of int, optional
        Only these elements; ratios are then to the stiffest of them.

    Returns
    -------
    list of ElementEstimate
        By number.

    Raises
    ------
    CheckFailure
        An element lies outside the rung's range.
    """
    design = layout.design
    force = design.rating.force if force is None else force
    places = tuple(p for p in layout.elements if not numbers or p.number in numbers)
    section = hinge_section(layout, places)
    if why := not_reached(layout, places, section, rung):
        raise CheckFailure(why)
    if rung not in ladder.FINITE_ELEMENTS:
        return by_closed_form(layout, places, section, rung, force)
    K, per_newton = _by_elements(layout, places, section, rung, design.gauge.grid_length, mesh)
    errors = strain.stated(section, design.gauge.grid_length, rung)
    promised = expected_error_of(section, rung, mesh)
    return _estimates(layout, places, section, K, per_newton, promised, errors, force)


def by_closed_form(
    layout: Layout, places: Sequence[ElementPlace], section: HingeSection, rung: str, force: float
) -> list[ElementEstimate]:
    """`estimate` with the dimensions in `section` (arrays over the places) instead of the design's."""
    K, grid = np.asarray(ladder.stiffness(section, rung)), layout.design.gauge.grid_length
    errors = strain.stated(section, grid, rung)
    peak = strain.peak(section, 1.0, rung)
    try:
        gauge = strain.gauge(section, 1.0, grid, rung)
    except CheckFailure:  # the grid reaches onto a two-sided hinge's fillets: only the gauge has no estimate
        gauge = np.array(np.nan)
    stress = strain.leaf_stress(section, 1.0, rung)
    face = strain.face_stress(section, 1.0) if rung in ladder.FITTED else stress
    strains = _PerNewton(*(np.broadcast_to(x, section.shape) for x in (gauge, peak, stress, face)))
    return _estimates(layout, places, section, K, strains, expected_error_of(section, rung), errors, force)


def distinct_sections(layout: Layout) -> tuple[HingeSection, list[str]]:
    """Elements that differ, the first of each kind, and their names for messages."""
    places = {(p.arm, p.hinge, p.body_length): p for p in layout.elements}
    return hinge_section(layout, tuple(places.values())), [f"element {p.number}" for p in places.values()]


@dataclass(frozen=True)
class _PerNewton:
    """Arrays over the elements: strains in 1/N and stresses in MPa/N."""

    gauge: Array
    fillet: Array
    fillet_stress: Array  # largest over the width
    face_stress: Array


def _by_elements(
    layout: Layout,
    places: tuple[ElementPlace, ...],
    section: HingeSection,
    rung: str,
    grid: float,
    mesh: int | None,
) -> tuple[Array, _PerNewton]:
    """Stiffness (N/mm) and strains by finite elements on each distinct contour, cut at clamp edge and load
    line."""
    from tactcad.fem import fem_ladder as elements
    from tactcad.fem.fem_ladder import SOLID_MESH
    from tactcad.fem.shape import cut_element

    solved: dict[tuple, elements.ElementResult] = {}
    solutions = []
    for i, place in enumerate(places):
        key = (place.arm, place.hinge, place.body_length)
        if key not in solved:
            contour = element(layout, place).extrusion.outer
            shape = cut_element(contour, layout.clamp_edge, place.hinge_x - place.load_arm)
            solved[key] = elements.solve(section.rows(i), rung, grid, shape, mesh or SOLID_MESH)
        solutions.append(solved[key])
    read, flat = [r.readings for r in solutions], [r.flat for r in solutions]
    share = strain.peak_share(section) if rung == "fem-plane" else 1.0
    return np.array([r.stiffness for r in solutions]), _PerNewton(
        np.array([float(r.gauge) for r in read]) / friction_factor(section),
        np.array([r.fillet_strain for r in read]),
        # at mid-width, but no less than the width's mean; in plane stress there is nothing but the mean
        share * np.array([max(a.fillet_stress, b.fillet_stress) for a, b in zip(read, flat)]),
        share * np.array([max(a.face_stress, b.face_stress) for a, b in zip(read, flat)]),
    )


def _estimates(
    layout: Layout,
    places: Sequence[ElementPlace],
    section: HingeSection,
    K: Array,
    per_newton: _PerNewton,
    stiffness_error: Array,
    errors: StrainErrors,
    force: float,
) -> list[ElementEstimate]:
    alloy, rating = design_alloy(layout.design), layout.design.rating
    stiffness_error = np.broadcast_to(stiffness_error, len(places))
    rated_deflection = strength.rated_deflection(alloy.yield_strength / per_newton.fillet_stress, K, rating)
    rows = []
    for i, place in enumerate(places):
        stress = float(per_newton.fillet_stress[i])
        yield_force = alloy.yield_strength / stress
        face_yield = alloy.yield_strength / float(per_newton.face_stress[i])
        elastic = force <= min(yield_force, face_yield)

        def at(value: float, elastic: bool = elastic) -> float | None:
            return float(value) * force if elastic and np.isfinite(value) else None

        rows.append(
            ElementEstimate(
                number=place.number,
                arm=place.arm,
                load_arm=float(section.load_arm[i]),
                stiffness=float(K[i]),
                stiffness_ratio=float(K.max() / K[i]),
                force=force,
                deflection=at(1.0 / K[i]),
                gauge_strain=at(per_newton.gauge[i]),
                peak_strain=at(per_newton.fillet[i]),
                stress=at(stress),
                gauge_strain_error=_known(errors.gauge[i]),
                peak_strain_error=_known(errors.fillet_strain[i]),
                stress_error=_known(errors.fillet_stress[i]),
                elastic=elastic,
                yield_factor_fillet=yield_force / force,
                yield_factor_face=face_yield / force,
                goodman_factor=float(strength.goodman(alloy, np.array(stress * force))) if elastic else None,
                yield_force=yield_force,
                yield_deflection=yield_force / float(K[i]),
                rated_force=min(force, yield_force / rating.yield_factor),
                rated_deflection=float(rated_deflection[i]),
                expected_error=_known(stiffness_error[i]),
            )
        )
    return rows


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


@dataclass(frozen=True)
class UncutComparison:
    """Plane-stress stiffness (N/mm) of one element: of its whole contour, and of the model cut from it."""

    number: int
    uncut: float
    model: float


def compare_uncut(layout: Layout) -> UncutComparison:
    """Compare the model with the whole contour at the element where they differ most, the shortest arm's.

    The whole contour has pad, land and holes, is held between its spacers and pressed evenly on the pad; the
    model is held at the clamp edge, and its arm is cut off at the load line.
    """
    from tactcad.fem.fem_ladder import converged_plane
    from tactcad.fem.free_mesh import uncut_compliance
    from tactcad.fem.shape import cut_element

    place = min(layout.elements, key=lambda p: p.arm)
    d, part = layout.design, element(layout, place)
    shape = cut_element(part.extrusion.outer, layout.clamp_edge, place.hinge_x - place.load_arm)
    alloy = design_alloy(d)
    material = alloy.youngs_modulus, alloy.poisson, d.sheet.thickness
    compliance = uncut_compliance(
        part.extrusion.outer,
        part.extrusion.openings,
        shape,
        (layout.clamp_edge, *layout.spacer_z),
        (layout.pad_inner, layout.pad_outer, -d.element.pad_height),
        *material,
    )
    return UncutComparison(place.number, 1.0 / compliance, converged_plane(shape, *material).stiffness)


def material_lines(design: Design, stiffness: Sequence[float]) -> list[str]:
    """A line for each property that differs, with its source; for Young's modulus also the largest and the
    smallest stiffness (N/mm) with either modulus."""
    differing = [f"material: {d}" + (f" ({d.origin})" if d.origin else "") for d in design.differences]
    factor = design.stiffness_factor
    if factor is not None:
        most, least = max(stiffness), min(stiffness)
        differing.append(
            f"with {design.material.alloy}'s own modulus every K is {factor - 1:+.1%}: {most * factor:.4g} "
            f"instead of {most:.4g} N/mm"
            + (f", {least * factor:.4g} instead of {least:.4g}" if least != most else "")
        )
    return differing


def material_record(design: Design) -> dict[str, Any]:
    """The differences for JSON: `material_differences`, and `stiffness_factor` where the modulus differs."""
    differences = [
        {"property": d.name, "value": d.value, "table": d.table, "relative": d.relative, "origin": d.origin}
        for d in design.differences
    ]
    factor = design.stiffness_factor
    return {"material_differences": differences} | ({"stiffness_factor": factor} if factor else {})
