"""The weight that moves with the array in the grasping set-up, from the parts, against the design's (the
paper's 3.235 N)."""

from __future__ import annotations

from tactcad.design.present import present
from tactcad.design.tree import Design
from tactcad.parts.finding import Finding
from tactcad.scenes.moving_axis import moving_weight
from tactcad.scenes.scene import Scene

# Relative difference allowed between the parts' weight and the design's: the ballast is turned to weight
# anyway.
AGREES = 0.005


def check_moving_weight(design: Design, scene: Scene) -> list[Finding]:
    """A finding where what moves is heavier than asked for (no ballast can mend that), or lighter."""
    weight, wanted = moving_weight(scene), present(design.grasping).moving_weight
    if abs(weight - wanted) <= AGREES * wanted:
        return []
    message = f"what moves weighs {weight:.4g} N by its parts, grasping.moving_weight asks for {wanted:.4g} N"
    return [Finding("moving-weight", "fail", scene.name, (), weight, wanted, message)]
