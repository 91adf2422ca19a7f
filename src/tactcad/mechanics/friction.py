"""Effect of friction at a protruding pad on the stiffness at its contact."""

from __future__ import annotations

from .section import Array, HingeSection


def lever(s: HingeSection) -> Array:
    """H = pad_height + t/2, distance from the hinge's mid-plane to the contact, mm."""
    return s.pad_height + s.hinge_thickness / 2.0


def factor(s: HingeSection) -> Array:
    """L/(L - mu H): the contact slides by H d/L, and friction against it adds moment mu F H.

    Only meaningful where mu H < L; beyond that the arm locks itself (`validity` refuses it).
    """
    L = s.load_arm
    return L / (L - s.friction * lever(s))
