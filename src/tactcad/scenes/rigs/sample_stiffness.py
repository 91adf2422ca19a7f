"""Sample stiffness: the force gauge's flat tip presses the sample on the cart."""

from __future__ import annotations

from tactcad.design.fields import present
from tactcad.design.tree import Design
from tactcad.parts.rigs.cart import cart_layout
from tactcad.parts.rigs.stand import StandLayout
from tactcad.parts.rigs.stiffness import sample_lines
from tactcad.parts.rules.grasping_rules import SAMPLE_FITS

from ..builder import Builder, telling
from ..rig import Rig, none
from ..rig_requirements import wheels
from ..scene import REST, STILL, Motion, Move, Need, Pose, Scene
from ..shared_rigs import (
    AXIS_LIFT,
    JAM_SPANNER,
    RAISED,
    cart_on_base,
    place_cart,
    place_force_axis,
    place_sample,
    place_stand,
    raised,
)

said = telling(__file__)


def sample_stiffness(design: Design, pose: Pose = REST) -> Scene:
    """Scene `sample-stiffness`: tip on the middle of the sample, pose.deflection mm into it or pose.height
    over it."""
    rig, cart = StandLayout(design), cart_layout(design)
    assert cart is not None, "RIG has its tables"
    b = Builder()
    s, gauge = present(design.sample), present(design.calibration)
    dents = ((-pose.cart, 0.0),) if pose.deflection else ()
    lid = place_cart(b, cart, pose.cart)
    post = place_stand(b, rig, stages=False)
    contact, tip = place_force_axis(
        b, rig, post, cart.sample_top, pose.height - pose.deflection, roller=False
    )
    b.step(
        "Tip",
        (0, -130, AXIS_LIFT - 40),
        said("Tip"),
        order=[*tip, Move(("JN1",), STILL, (STILL,), JAM_SPANNER)],
        tools=(JAM_SPANNER,),
        sets=("TI1 to FG1: all, by JN1",),
    )
    cart_on_base(b, [raised(b)])
    sample = place_sample(b, cart, pose.cart, lid, dents, pose.deflection, RAISED)
    b.step(
        "Press",
        (0, 0, 0),
        said("Press", step=s.step * 1e3, travel=s.travel * 1e3, give=1e3 / gauge.load_cell_stiffness),
        order=[raised(b, down=True), raised(b), raised(b, down=True)],
        needs=(Need((sample, contact), "the tip presses the sample"),),
    )
    if pose.height == 0:
        b.meet(contact, sample)
    c = present(design.cart)
    lifted = (0.0, 0.0, gauge.retract)
    motions = (
        Motion("tip down to the sample", (("axis", lifted, (0.0, 0.0, 0.0)),)),
        Motion(
            "cart rolls under the lifted tip",
            (("axis", lifted, lifted), ("cart", (-c.roll, 0.0, 0.0), (c.roll, 0.0, 0.0))),
        ),
    )
    return b.scene("sample-stiffness", motions, cover=b.groups["axis"])


def _poses(design: Design) -> tuple[Pose, ...]:
    """The tip half and all the way into the sample; lifted, the cart half the way out."""
    travel, roll = present(design.sample).travel, present(design.cart).roll
    return (Pose(deflection=travel / 2), Pose(deflection=travel), Pose(cart=roll / 2, height=1.0))


RIG = Rig(
    name="sample-stiffness",
    tables=("calibration", "sample", "cart", "holder"),
    make=sample_stiffness,
    poses=_poses,
    under_sensor=none,
    rules=SAMPLE_FITS,
    deflections=sample_lines,
    requirements=wheels,
    checks=(),
)
