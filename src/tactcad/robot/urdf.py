"""The sensor as URDF: metres, kilograms, radians. It has no springs; the table of taxels has K."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np
from scipy.spatial.transform import Rotation

from .mechanism import ElementJoint, Mechanism, Solid, mesh_name

MM = 1e-3  # m
SPEED = 10.0  # rad/s or m/s, which URDF asks for; chosen beyond what any arm reaches
LEAST = 2e-14  # kg m2: MuJoCo refuses inertias under 1e-14
LIGHT = 4e-4  # of an element's mass and inertia; chosen: two such links stay within 0.1 %


def unit(joint: ElementJoint) -> float:
    """SI units in one of the joint's stiffness: N mm/rad, or N/mm."""
    return MM if joint.kind == "hinge" else 1 / MM


def way(joint: ElementJoint, value: float) -> float:
    """rad as they are, mm in m."""
    return value if joint.kind == "hinge" else value * MM


def text(mechanism: Mechanism, base: Solid, arms: Sequence[Solid]) -> bytes:
    """The document: `mount` carries `base`, and that every element; `E1_taxel` is the frame of E1's pad."""
    root = Element("robot", name=mechanism.design.design.name)
    add(root, "link", name="mount")
    _link(root, "base", base)
    _joint(root, "base_fixed", "fixed", "mount", "base", np.zeros(3))
    for m, arm in zip(mechanism.moving, arms):
        parent, at, turn = "base", m.origin * MM, m.turn
        for j in m.joints:
            child = m.name if j is m.joints[-1] else f"{j.name}_link"
            kind = "revolute" if j.kind == "hinge" else "prismatic"
            joint = _joint(root, j.name, kind, parent, child, at, turn)
            add(joint, "axis", xyz=j.axis)
            low, high = -way(j, j.outward), way(j, j.reach)
            effort = j.stiffness * unit(j) * high
            add(joint, "limit", lower=low, upper=high, effort=effort, velocity=SPEED)
            if child != m.name:
                _between(add(root, "link", name=child), arm)
            parent, at, turn = child, np.zeros(3), np.eye(3)
        link = _link(root, m.name, arm)
        length, width = m.taxel.length_mm, m.taxel.width_mm
        deep = m.ball or min(length, width) / 2
        _, geometry = _shape(link, "collision", (-m.joints_at - [0, 0, deep]) * MM, np.zeros(3))
        if m.ball:
            add(geometry, "sphere", radius=m.ball * MM)
        else:
            add(geometry, "box", size=np.array([length, width, 2 * deep]) * MM)
        add(root, "link", name=f"{m.name}_taxel")
        _joint(root, f"{m.name}_taxel_fixed", "fixed", m.name, f"{m.name}_taxel", -m.joints_at * MM)
    return document(root)


def _joint(
    root: Element, name: str, kind: str, parent: str, child: str, at: np.ndarray, turn: object = np.eye(3)
) -> Element:
    joint = add(root, "joint", name=name, type=kind)
    add(joint, "origin", xyz=at, rpy=rpy(turn))
    add(joint, "parent", link=parent)
    add(joint, "child", link=child)
    return joint


def _between(link: Element, arm: Solid) -> None:
    """A link between two joints of one element: simulators take no moving link without inertia."""
    inertial, each = add(link, "inertial"), max(LIGHT * np.trace(arm.inertia.tensor) / 3, LEAST)
    add(inertial, "mass", value=LIGHT * arm.inertia.mass)
    add(inertial, "inertia", ixx=each, ixy=0.0, ixz=0.0, iyy=each, iyz=0.0, izz=each)


def rpy(turn: object) -> np.ndarray:
    """Roll, pitch and yaw about fixed axes, rad."""
    return Rotation.from_matrix(np.array(turn)).as_euler("xyz")


def _link(root: Element, name: str, solid: Solid) -> Element:
    link, level = add(root, "link", name=name), np.zeros(3)
    inertial = add(link, "inertial")
    add(inertial, "origin", xyz=solid.inertia.centre, rpy=level)
    add(inertial, "mass", value=solid.inertia.mass)
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = solid.inertia.tensor
    add(inertial, "inertia", ixx=xx, ixy=xy, ixz=xz, iyy=yy, iyz=yz, izz=zz)
    for look in solid.looks:
        shape = _shape(link, "visual", np.array(look.origin) * MM, rpy(look.rotation))
        add(shape[1], "mesh", filename=mesh_name(look))
        material = add(shape[0], "material", name=look.part.colour)
        add(material, "color", rgba=colour(look.part.colour))
    for middle, half in solid.boxes:
        add(_shape(link, "collision", middle, level)[1], "box", size=2 * half)
    return link


def _shape(link: Element, kind: str, at: np.ndarray, turn: Iterable[float]) -> tuple[Element, Element]:
    """A visual or collision, and its geometry."""
    shape = add(link, kind)
    add(shape, "origin", xyz=at, rpy=turn)
    return shape, add(shape, "geometry")


def add(parent: Element, tag: str, **values: object) -> Element:
    """A child with attributes: text, numbers, or rows of numbers, to the last digit; `class_` is "class"."""
    return SubElement(parent, tag, {k.rstrip("_"): _attribute(v) for k, v in values.items()})


def _attribute(value: object) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, int):
        return repr(value)
    return " ".join(repr(v + 0.0) for v in np.atleast_1d(np.asarray(value, float)).tolist())


def document(root: Element) -> bytes:
    """A line an element."""
    indent(root)
    return tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"


def colour(text: str) -> tuple[float, ...]:
    """Red, green, blue and opacity of "#rrggbb"."""
    return (*(round(int(text[i : i + 2], 16) / 255, 4) for i in (1, 3, 5)), 1.0)
