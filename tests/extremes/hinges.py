"""Named extreme hinges, and for each which rungs must answer and by which rule the others must refuse."""

from __future__ import annotations

from dataclasses import dataclass, field

from tactcad.mechanics.ladder import CLOSED_FORMS
from tactcad.mechanics.section import REFERENCE, HingeSection

LENGTHS = (
    "hinge_thickness",
    "hinge_length",
    "fillet_radius",
    "load_arm",
    "arm_height",
    "body_height",
    "body_length",
    "width",
)
FITTED = ("plane", "solid")


@dataclass(frozen=True)
class Case:
    """A change of the reference hinge; `refused`: rung -> how the broken rule's name starts."""

    name: str
    change: dict[str, float]
    refused: dict[str, str] = field(default_factory=dict)

    def section(self, two_sided: bool) -> HingeSection:
        return REFERENCE.with_(two_sided=two_sided, **self.change)


def by_all(rule: str) -> dict[str, str]:
    return dict.fromkeys(CLOSED_FORMS, rule)


def by_fitted(rule: str) -> dict[str, str]:
    return dict.fromkeys(FITTED, rule)


def scaled(factor: float) -> dict[str, float]:
    return {name: float(getattr(REFERENCE, name)) * factor for name in LENGTHS}


CASES = (
    Case(
        "hinge 0.02 mm",
        dict(hinge_thickness=0.02, fillet_radius=0.1, hinge_length=0.5, arm_height=1.4, body_height=3.0),
    ),
    Case(
        "hinge 0.02 mm with the fillets of a thick one",
        dict(hinge_thickness=0.02),
        by_fitted("r/t is outside"),
    ),
    Case(
        "hinge 2 mm",
        dict(
            hinge_thickness=2.0,
            hinge_length=6.0,
            fillet_radius=1.0,
            load_arm=40.0,
            arm_height=12.0,
            body_height=24.0,
            body_length=24.0,
            width=20.0,
        ),
    ),
    Case("hinge 2 mm in a 2 mm arm", dict(hinge_thickness=2.0), by_all("fillets higher than the arm")),
    Case(
        "slot of zero length",
        dict(hinge_length=0.0, fillet_radius=0.0),
        by_all("a length, width or modulus is not positive"),
    ),
    Case("slot of a nanometre", dict(hinge_length=1e-6, fillet_radius=2.5e-7), by_fitted("r/t is outside")),
    Case("sharp slot", dict(fillet_radius=0.0), by_fitted("r/t is outside")),
    Case("slot longer than the arm", dict(hinge_length=9.0), by_fitted("l/t is outside")),
    Case("slot twice the arm, load at its wall", dict(hinge_length=12.0), by_all("load inside the slot")),
    Case("slot more than twice the arm", dict(hinge_length=13.0), by_all("load inside the slot")),
    Case("full round", dict(hinge_length=0.5, fillet_radius=0.25)),
    Case(
        "fillets a nanometre too long",
        dict(hinge_length=0.5, fillet_radius=0.25 + 1e-6),
        by_all("fillets longer than the slot"),
    ),
    Case(
        "arm 0.5 mm",
        dict(
            load_arm=0.5,
            hinge_length=0.2,
            fillet_radius=0.05,
            hinge_thickness=0.05,
            arm_height=0.4,
            body_height=0.8,
            body_length=0.8,
        ),
    ),
    Case(
        "arm 0.5 mm under the usual arm height",
        dict(load_arm=0.5),
        by_fitted("load arm too short for the fit"),
    ),
    Case(
        "arm 100 mm",
        dict(
            load_arm=100.0,
            hinge_length=15.0,
            fillet_radius=3.0,
            hinge_thickness=5.0,
            arm_height=40.0,
            body_height=80.0,
            body_length=80.0,
            width=60.0,
        ),
    ),
    Case("arm 100 mm at the usual heights", dict(load_arm=100.0), by_fitted("(L - l/2)/h is outside")),
    Case("jaw size, 1:25, hinge 10 um", scaled(1 / 25)),
    Case("lengths given in metres", scaled(1e-3)),
    Case("lengths given in micrometres", scaled(1e3)),
    Case("modulus given in GPa", dict(youngs_modulus=69.0)),
    Case("modulus given in Pa", dict(youngs_modulus=69e9)),
    Case(
        "thickness alone in micrometres", dict(hinge_thickness=250.0), by_all("fillets higher than the arm")
    ),
    Case("thickness alone in metres", dict(hinge_thickness=2.5e-4), by_fitted("r/t is outside")),
    Case("no Poisson effect", dict(poisson=0.0), by_fitted("poisson is outside the fit's")),
    Case("nearly incompressible", dict(poisson=0.4999999), by_fitted("poisson is outside the fit's")),
    Case("incompressible", dict(poisson=0.5), by_all("poisson is outside 0 to 0.5")),
    Case("foil", dict(width=0.01), {"solid": "sheet too thin for its fillets for the fit"}),
    Case("plate", dict(width=1e4), {"solid": "b/t is outside"}),
)
