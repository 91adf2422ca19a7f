"""A part without a CAD kernel: one stock body, features cut into it, and its process.

Solids, cut files, drawings, tool rules, volumes and the bill of materials are all read from this.
Local frame: an extrusion's contour lies in x, y and its thickness along +z from 0; a revolution's
profile is (radius, z) and turns about z. All lengths in mm.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import pi, radians, tan
from typing import Literal

from tactcad.contour import Contour, circle
from tactcad.design.messages import CheckFailure

from .limits import FACES, Characteristic, DatumFeature, Geometric, contradictions

Vector = tuple[float, float, float]
Process = Literal["wire-cut", "etched", "milled", "turned", "ground", "reference", "bought", "included"]
Kind = Literal["", "element", "cells", "cap screw", "set screw", "nut"]
NOT_MADE = ("bought", "included", "reference")
NOT_ORDERED = ("included", "reference")


def vector(values: Iterable[float]) -> Vector:
    """Three numbers as a Vector."""
    x, y, z = values
    return (x, y, z)


@dataclass(frozen=True)
class Extrusion:
    """A contour with through openings, extruded along +z by its thickness (mm)."""

    outer: Contour
    thickness: float
    openings: tuple[Contour, ...] = ()

    @property
    def volume(self) -> float:
        """mm3"""
        return self.section_area * self.thickness

    @property
    def moment(self) -> Vector:
        """Volume times centre, mm4."""
        sections = [(self.outer, 1.0), *((c, -1.0) for c in self.openings)]
        mx, my = (sum(sign * c.area * c.centroid[i] for c, sign in sections) for i in (0, 1))
        return (mx * self.thickness, my * self.thickness, self.volume * self.thickness / 2)

    @property
    def section_area(self) -> float:
        """Area of the cut section, openings taken off, mm2."""
        return self.outer.area - sum(c.area for c in self.openings)

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Least and largest corner, mm."""
        x0, y0, x1, y1 = self.outer.box
        return (x0, y0, 0.0), (x1, y1, self.thickness)

    @property
    def cut_length(self) -> float:
        """Length of all contours that a wire or a mill has to follow, mm."""
        return self.outer.length + sum(c.length for c in self.openings)


@dataclass(frozen=True)
class Revolution:
    """A profile in (radius, z), radius >= 0, turned once about z."""

    profile: Contour

    @property
    def volume(self) -> float:
        """mm3, by Pappus: 2 pi times the centroid's radius times the area."""
        return 2 * pi * self.profile.centroid[0] * self.profile.area

    @property
    def moment(self) -> Vector:
        """Volume times centre, mm4: 2 pi times the profile's integral of r z."""
        return (0.0, 0.0, 2 * pi * self.profile.product_moment)

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Least and largest corner, mm."""
        _, z0, r, z1 = self.profile.box
        return (-r, -r, z0), (r, r, z1)


@dataclass(frozen=True)
class Hole:
    """A round hole from a face into the material, with an optional counterbore.

    `at` is on the face, `axis` the unit direction into the material. `depth` is the length of the
    full diameter, through the material where through is true. `drill_point` adds the 118 degree
    cone of a drill below a blind hole. A tapped hole has the tap drill's diameter and names its
    thread ("M3") and the length of full thread (mm).
    """

    name: str
    at: Vector
    axis: Vector
    diameter: float
    depth: float
    through: bool
    counterbore: tuple[float, float] | None = None  # diameter, depth
    thread: str = ""
    thread_depth: float = 0.0
    drill_point: bool = False
    tolerance: str = ""  # "H7" or "+0.006/0"

    @property
    def thread_diameter(self) -> float:
        """Nominal (major) diameter of its metric thread, mm; 0 without one."""
        return float(self.thread.removeprefix("M")) if self.thread else 0.0

    @property
    def volume(self) -> float:
        """Material taken off, mm3."""
        r = self.diameter / 2
        volume = pi * r * r * self.depth
        if self.counterbore:
            wide, deep = self.counterbore
            volume += pi * (wide * wide / 4 - r * r) * deep
        if self.drill_point:
            volume += pi * r * r * drill_point_height(self.diameter) / 3
        return volume

    @property
    def moment(self) -> Vector:
        """Volume times centre of the removed material, mm4."""
        r = self.diameter / 2
        depth_moment = pi * r * r * self.depth**2 / 2
        if self.counterbore:
            wide, deep = self.counterbore
            depth_moment += pi * (wide * wide / 4 - r * r) * deep**2 / 2
        if self.drill_point:
            height = drill_point_height(self.diameter)
            depth_moment += pi * r * r * height / 3 * (self.depth + height / 4)
        return _along(self.at, self.axis, self.volume, depth_moment)


@dataclass(frozen=True)
class Pocket:
    """A flat-bottomed pocket: a contour moved along an axis from a face into the material.

    The contour lies in the plane through `at` spanned by x_axis and y_axis = axis x x_axis, so that
    (x_axis, y_axis, axis) is right-handed; axis points into the material.
    """

    name: str
    at: Vector
    axis: Vector
    x_axis: Vector
    contour: Contour
    depth: float
    island: tuple[Contour, ...] = ()  # left standing, as inside an O-ring groove

    @property
    def volume(self) -> float:
        """Material taken off, mm3."""
        return (self.contour.area - sum(c.area for c in self.island)) * self.depth

    @property
    def moment(self) -> Vector:
        """Volume times centre of the removed material, mm4."""
        sections = [(self.contour, 1.0), *((c, -1.0) for c in self.island)]
        mx, my = (sum(sign * c.area * c.centroid[i] for c, sign in sections) * self.depth for i in (0, 1))
        y_axis = _cross(self.axis, self.x_axis)
        base = _along(self.at, self.axis, self.volume, self.volume * self.depth / 2)
        return vector(b + mx * u + my * v for b, u, v in zip(base, self.x_axis, y_axis))


Feature = Hole | Pocket


def _along(at: Vector, axis: Vector, volume: float, depth_moment: float) -> Vector:
    """Moment of a body on the axis from `at`: volume x at + depth_moment x axis."""
    return vector(volume * p + depth_moment * a for p, a in zip(at, axis))


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


DRILL_POINT = 118.0  # degrees between the cutting edges: DIN 1412, type N


def drill_point_height(diameter: float) -> float:
    """Height of the cone that a drill leaves, mm: half its diameter over tan(DRILL_POINT/2)."""
    return diameter / 2 * tan(radians(90 - DRILL_POINT / 2))


@dataclass(frozen=True)
class Material:
    """A part's material; density in kg/m3. `standard`: for ordering. `magnetic`: whether a magnet attracts
    it, "yes", "weakly" or "no"; "" if that is not known."""

    name: str
    density: float
    temper: str = ""
    standard: str = ""
    magnetic: str = ""

    def __str__(self) -> str:
        """The material as sheets and bills state it."""
        named = f"{self.name} {self.temper}".strip()
        return f"{named}, {self.standard}" if self.standard else named


@dataclass(frozen=True)
class Purchase:
    """The order data of a bought part. source_verified: its figures were checked in the maker's own data."""

    designation: str
    manufacturer: str = ""
    mpn: str = ""
    supplier: str = ""
    alternates: str = ""
    source_verified: bool = False


@dataclass(frozen=True)
class ModelFile:
    """A bought part whose shape is read from a STEP file; volume (mm3) and box (least and largest corner,
    mm) as measured on loading."""

    path: str
    sha256: str
    volume: float
    box: tuple[Vector, Vector]


@dataclass(frozen=True)
class Part:
    """One fabricated or bought part.

    Parameters
    ----------
    part_no, name
        Equal parts share a number.
    process
        Its process; "bought"; "included" with another bought part; "reference" for parts at hand.
    material
        With its density.
    body
        The stock, in the part's own frame, mm.
    features
        Holes and pockets cut into the stock; they may not overlap.
    colour
        sRGB, "#rrggbb".
    finish, notes
        For the drawing.
    characteristics, geometric, datums
        Toleranced dimensions, geometric tolerances, and their datums.
    purchase
        How a bought part is ordered.
    mass_override
        Mass, g, of a bought part whose body is only an envelope.
    spares
        Pieces to order beyond the scene's.
    kind
        Kind for steps, notes and sheets; "" for any other part.
    thread
        Metric thread of a screw or nut, "M3".

    Raises
    ------
    CheckFailure
        If its limits contradict each other, or refer to features that the part does not have.
    """

    part_no: str
    name: str
    process: Process
    material: Material
    body: Extrusion | Revolution | ModelFile
    features: tuple[Feature, ...] = ()
    colour: str = "#b0b4ba"  # sRGB
    finish: str = ""
    notes: tuple[str, ...] = ()
    characteristics: tuple[Characteristic, ...] = ()
    geometric: tuple[Geometric, ...] = ()
    datums: tuple[DatumFeature, ...] = ()
    purchase: Purchase | None = None
    mass_override: float | None = None
    spares: int = 0
    kind: Kind = ""
    thread: str = ""

    def __post_init__(self) -> None:
        limits = (self.characteristics, self.geometric, self.datums)
        if any(limits) and (wrong := list(contradictions(*limits, self.feature_names))):
            raise CheckFailure(f"{self.part_no}: {'; '.join(wrong)}")

    @property
    def feature_names(self) -> frozenset[str]:
        """Names of the features for limits and datums: contour edges, openings, holes, pockets and their
        edges, faces."""
        names = {f.name for f in self.features}
        pockets = [f for f in self.features if isinstance(f, Pocket)]
        names |= {f"{p.name} {s.name}" for p in pockets for c in (p.contour, *p.island) for s in c if s.name}
        if isinstance(self.body, Extrusion):
            names |= {s.name for c in (self.body.outer, *self.body.openings) for s in c} | {*FACES}
        elif isinstance(self.body, Revolution):
            names |= {s.name for s in self.body.profile}
        return frozenset(names)

    @property
    def extrusion(self) -> Extrusion:
        """The body of a part that is cut from a sheet, a plate or a bar. Raises TypeError for any other."""
        if not isinstance(self.body, Extrusion):
            raise TypeError(f"{self.part_no} is no extrusion")
        return self.body

    @property
    def volume(self) -> float:
        """Closed-form volume, mm3: the stock less its features, which may not overlap."""
        return self.body.volume - sum(f.volume for f in self.features)

    @property
    def centre(self) -> Vector:
        """Centre of mass in the part's own frame, mm, in closed form. A model file has none: TypeError."""
        if isinstance(self.body, ModelFile):
            raise TypeError(f"{self.part_no} is read from a model file, which has no closed form")
        taken = [f.moment for f in self.features]
        return vector((m - sum(t[i] for t in taken)) / self.volume for i, m in enumerate(self.body.moment))

    @property
    def mass(self) -> float:
        """Mass in g."""
        if self.mass_override is not None:
            return self.mass_override
        return self.volume * self.material.density * 1e-6

    @property
    def by_contour(self) -> bool:
        """Cut from sheet by its contour alone, all its openings and holes included."""
        return self.process in ("wire-cut", "etched")

    @property
    def bought(self) -> bool:
        return self.process in ("bought", "included")


def section(part: Part) -> tuple[Contour, tuple[Contour, ...]]:
    """Outline and openings of an extruded part, its through holes along the thickness included.

    Raises TypeError if the part is not an extrusion.
    """
    if not isinstance(part.body, Extrusion):
        raise TypeError(f"{part.part_no} is not an extrusion: it has no one section to cut")
    holes = tuple(
        circle(f.at[:2], f.diameter, f.name)
        for f in part.features
        if isinstance(f, Hole) and f.through and f.axis[:2] == (0.0, 0.0)
    )
    return part.body.outer, part.body.openings + holes


DETAILS = ("full", "envelope")


def envelope(part: Part) -> Part:
    """The part without holes, pockets and limits: a shape that contains the part. Its mass stays the part's.

    It is a reference shape, without cut file or drawing.
    """
    if isinstance(part.body, ModelFile):
        return part
    body = replace(part.body, openings=()) if isinstance(part.body, Extrusion) else part.body
    return replace(
        part,
        body=body,
        features=(),
        characteristics=(),
        geometric=(),
        datums=(),
        mass_override=part.mass,
        process=part.process if part.bought else "reference",
    )
