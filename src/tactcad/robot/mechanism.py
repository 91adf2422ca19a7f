"""The fixed and moving parts of a sensor, and its joints: a family's declaration for robots.

Everything is in the mount's frame, mm: its origin and axes are those of the robot's flange, +z toward the
object. A pad's frame has its origin in the middle of the pad's face, +z outwards. An element's frame is
parallel to its pad's, with the origin in the joints.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from tactcad.design.messages import InputError
from tactcad.design.tree import CommonTables
from tactcad.parts.language.description import Vector
from tactcad.scenes import make_scene
from tactcad.scenes.rig import ARRAY
from tactcad.scenes.scene import Placement, rotation

from .taxel_table import Taxel, require_positive

OUTWARD = 0.5  # rad or mm toward the object, if nothing stops an element
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]*")  # of XML 1.0's names those that ROS and MuJoCo take too


@dataclass(frozen=True)
class ElementJoint:
    """One freedom of an element, in its frame.

    kind       hinge: turns about an axis through the origin; slide: moves along it
    axis       positive where the pad sinks; of a tilt either way
    stiffness  N mm/rad, or N/mm
    reach      to the stop, rad or mm
    outward    how far it moves the other way
    """

    name: str
    kind: Literal["hinge", "slide"]
    axis: Vector
    stiffness: float
    reach: float
    outward: float = OUTWARD


@dataclass(frozen=True)
class Moving:
    """One element.

    taxel      its pad
    turn       axes of the pad's frame and the element's, as columns, [3, 3]
    joints_at  origin of the element's frame, in the pad's
    joints     one, or three of a cell (sink and two tilts) along its stiffness matrix's own axes
    parts      its moving parts, in place
    box        least and largest corner of its collision box besides the pad, in its frame
    ball       radius of the ball that replaces the pad in contact; 0: the flat pad
    rubs       whether an object may push the pad sideways by friction
    """

    taxel: Taxel
    turn: np.ndarray
    joints_at: np.ndarray
    joints: tuple[ElementJoint, ...]
    parts: tuple[Placement, ...]
    box: np.ndarray
    ball: float
    rubs: bool = False

    @property
    def name(self) -> str:
        return self.taxel.designator

    @property
    def origin(self) -> np.ndarray:
        """Origin of its frame."""
        return np.array([self.taxel.x_mm, self.taxel.y_mm, self.taxel.z_mm]) + self.turn @ self.joints_at


@dataclass(frozen=True)
class Mechanism:
    """A sensor: its fixed and moving parts.

    Raises InputError for a name that XML cannot hold, and for an element without stiffness or way.
    """

    design: CommonTables
    fixed: tuple[Placement, ...]
    moving: tuple[Moving, ...]

    def __post_init__(self) -> None:
        names = {"design.name": self.design.design.name} | {f"element {m.name}": m.name for m in self.moving}
        for where, name in (
            names | {f"joint {j.name}": j.name for m in self.moving for j in m.joints}
        ).items():
            if not NAME.fullmatch(name):
                legal = "a letter or _, then letters, digits, _ . -"
                raise InputError(where, "no name in XML, URDF and MJCF", value=name, legal=legal)
        for m in self.moving:
            own = {"stiffness": m.taxel.stiffness_N_per_mm, "stop gap": m.taxel.stop_gap_mm}
            figures = ("stiffness", "reach", "outward")
            of_joints = {f"{j.name} {f}": getattr(j, f) for j in m.joints for f in figures}
            require_positive(f"element {m.name}", own | of_joints)


def seen(p: Placement, origin: np.ndarray, turn: np.ndarray) -> Placement:
    """The placement in a frame with that origin, whose axes are the columns of `turn`."""
    x, y, z = (turn.T @ (np.array(p.origin) - origin)).tolist()
    return Placement(p.designator, p.part, (x, y, z), rotation((turn.T @ np.array(p.rotation)).tolist()))


def array_seen(design: CommonTables, origin: np.ndarray, turn: np.ndarray) -> dict[str, Placement]:
    """The array's placements by designator, in such a frame."""
    return {p.designator: seen(p, origin, turn) for p in make_scene(design, ARRAY).placements}


@dataclass(frozen=True)
class Inertia:
    """kg, m, kg m2 about the centre of mass."""

    mass: float
    centre: np.ndarray
    tensor: np.ndarray

    def at(self, point: np.ndarray) -> np.ndarray:
        """The tensor about a point."""
        r = self.centre - point
        return self.tensor + self.mass * (r @ r * np.eye(3) - np.outer(r, r))


def together(bodies: Sequence[Inertia]) -> Inertia:
    """Several solids joined in one frame."""
    mass = sum(b.mass for b in bodies)
    centre = np.sum([b.mass * b.centre for b in bodies], axis=0) / mass
    return Inertia(mass, centre, np.sum([b.at(centre) for b in bodies], axis=0))


@dataclass(frozen=True)
class Solid:
    """A body in its own frame: inertia, drawn shape (mm), collision boxes (middle, half sides, m)."""

    inertia: Inertia
    looks: tuple[Placement, ...]
    boxes: tuple[tuple[np.ndarray, np.ndarray], ...]


def mesh_name(p: Placement) -> str:
    """File of a part's mesh, below the robot's folder."""
    return f"meshes/{p.part.part_no}.stl"
