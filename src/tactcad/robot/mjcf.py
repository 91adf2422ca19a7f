"""The sensor as MuJoCo's MJCF: metres, kilograms, newtons, seconds, radians."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10, pi, sqrt
from xml.etree.ElementTree import Element

import numpy as np
from scipy.spatial.transform import Rotation

from .mechanism import ElementJoint, Mechanism, Moving, Solid, mesh_name
from .taxel_table import SCHEMA, VERSION
from .urdf import MM, add, colour, document, unit, way

# Steps in the shortest period: a free vibration by Runge and Kutta's fourth order loses (w dt)^6/72 of its
# energy a step, over 100 periods 0.03 %.
STEPS = 50
DAMPING = 0.01  # of the critical one; chosen: metal has less, bonded gauges and leads add, nobody measured it
# A contact or a stop comes to rest in so many steps; shorter than two MuJoCo does not take. Impedance: how
# much of the rest the contact bears. With m the arm's mass at the pad its softness is
# (1 - IMPEDANCE)/IMPEDANCE (SETTLING w dt)^2 of the arm's own, here 3e-5 at most.
SETTLING, IMPEDANCE = 4, 0.9999
# Of two geoms of one priority the larger friction holds, so the object's; the pad's own hardness still does.
RUBS = {"priority": 0, "condim": 3, "friction": (0.0, 0.0, 0.0), "solmix": 1e6}


def moment(joint: ElementJoint, arm: Solid) -> float:
    """Inertia moved by a joint: kg m2, or kg."""
    axis = np.array(joint.axis)
    return float(axis @ arm.inertia.at(np.zeros(3)) @ axis) if joint.kind == "hinge" else arm.inertia.mass


def timestep(mechanism: Mechanism, arms: Sequence[Solid]) -> float:
    """s, to two digits: a STEPS-th of the shortest period of all joints."""
    pairs = [(j, arm) for m, arm in zip(mechanism.moving, arms) for j in m.joints]
    step = min(2 * pi * sqrt(moment(j, arm) / (j.stiffness * unit(j))) for j, arm in pairs) / STEPS
    digit = 10.0 ** (floor(log10(step)) - 1)
    return float(f"{floor(step / digit) * digit:.1e}")


def text(mechanism: Mechanism, base: Solid, arms: Sequence[Solid], step: float) -> bytes:
    """The document."""
    root = Element("mujoco", model=mechanism.design.design.name)
    add(root, "compiler", angle="radian", autolimits="true", meshdir="meshes")
    precise = {"tolerance": 1e-12, "ccd_tolerance": 1e-10}  # lengths are of micrometres
    add(root, "option", timestep=step, integrator="RK4", cone="elliptic", **precise)
    custom = add(root, "custom")
    add(custom, "text", name="schema", data=f"{SCHEMA} {VERSION}")
    add(custom, "text", name="revision", data=mechanism.design.design.revision)
    default = add(root, "default")
    hard = {"solref": (SETTLING * step, 1.0), "solimp": (IMPEDANCE, IMPEDANCE, 1.0)}
    add(default, "joint", armature=0.0, **{f"{k}limit": v for k, v in hard.items()})
    add(add(default, "default", class_="visual"), "geom", type="mesh", contype=0, conaffinity=0, group=2)
    # elements meet what they touch, not each other; frictionless, as K is estimated
    hit = add(default, "default", class_="collision")
    add(hit, "geom", contype=1, conaffinity=0, group=3, condim=1, priority=1, **hard)
    asset = add(root, "asset")
    for file in dict.fromkeys(mesh_name(look) for body in (base, *arms) for look in body.looks):
        file = file.removeprefix("meshes/")
        add(asset, "mesh", name=file.removesuffix(".stl"), file=file, inertia="shell")
    stands = add(add(root, "worldbody"), "body", name="base")
    add(stands, "site", name="mount", size=MM)
    _solid(stands, base)
    sensors = add(root, "sensor")
    for m, arm in zip(mechanism.moving, arms):
        body = add(stands, "body", name=m.name, pos=m.origin * MM, quat=quaternion(m.turn))
        for j in m.joints:
            _joint(body, j, moment(j, arm))
            add(sensors, "jointpos", name=f"{j.name}_deflection", joint=j.name)
        _solid(body, arm)
        _pad(body, m)
        add(sensors, "touch", name=f"{m.name}_force", site=f"{m.name}_taxel")
    return document(root)


def quaternion(turn: object) -> np.ndarray:
    """Scalar first."""
    return Rotation.from_matrix(np.array(turn)).as_quat(canonical=True, scalar_first=True)


def _joint(body: Element, j: ElementJoint, moved: float) -> None:
    K = j.stiffness * unit(j)
    spring = {"stiffness": K, "damping": 2 * DAMPING * sqrt(K * moved)}
    ends = (-way(j, j.outward), way(j, j.reach))
    add(body, "joint", name=j.name, type=j.kind, axis=j.axis, range=ends, **spring)


def _solid(body: Element, solid: Solid) -> None:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = solid.inertia.tensor
    full = (xx, yy, zz, xy, xz, yz)
    add(body, "inertial", pos=solid.inertia.centre, mass=solid.inertia.mass, fullinertia=full)
    for look in solid.looks:
        mesh = mesh_name(look).removeprefix("meshes/").removesuffix(".stl")
        place = {"pos": np.array(look.origin) * MM, "quat": quaternion(look.rotation)}
        add(body, "geom", class_="visual", mesh=mesh, rgba=colour(look.part.colour), **place)
    for middle, half in solid.boxes:
        add(body, "geom", class_="collision", type="box", pos=middle, size=half)


def _pad(body: Element, m: Moving) -> None:
    """The pad's contact body, and the site at its face; the site's box includes every contact point of the
    ball."""
    face, length, width = -m.joints_at, m.taxel.length_mm / 2, m.taxel.width_mm / 2
    deep = m.ball or min(length, width)
    shape, size = ("sphere", (deep,)) if m.ball else ("box", (length, width, deep))
    geom = {"type": shape, "size": np.array(size) * MM, "pos": (face - [0, 0, deep]) * MM}
    rubs = RUBS if m.rubs else {}
    add(body, "geom", name=f"{m.name}_pad", class_="collision", **geom, **rubs)
    box = np.array([max(length, deep), max(width, deep), deep]) * MM
    add(body, "site", name=f"{m.name}_taxel", type="box", pos=face * MM, size=box, group=4)
