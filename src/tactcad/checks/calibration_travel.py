"""Whether a hinge passes its rated deflection at the end of the calibration's travel, which no stop
limits.
"""

from __future__ import annotations

from tactcad.design.present import present
from tactcad.design.tree import Design
from tactcad.parts.element import element_number
from tactcad.parts.finding import Finding, Severity
from tactcad.parts.rigs.calibration_loads import calibration_loads


def check_calibration(design: Design) -> list[Finding]:
    """Fail where the travel makes a hinge yield, flag where it passes the rated deflection; each with the
    travel that does not.

    An element whose strength the estimator cannot compute is flagged by the strength check.
    """
    findings = []
    travel = present(design.calibration).travel
    for load in calibration_loads(design):
        if load.refused or load.deflection <= load.rated_deflection:
            continue
        severity: Severity = "fail" if travel > load.travel_at_yield else "flag"
        who = f"{load.place.designator} ({element_number(design, load.place)})"
        message = (
            f"{travel:g} mm of travel bend it by {load.deflection:.4g} mm, it is rated "
            f"for {load.rated_deflection:.4g}: calibrate it to {load.travel_at_rated:.4g} mm of travel"
        )
        findings.append(
            Finding(
                "calibration",
                severity,
                who,
                (load.place.hinge_x, load.place.hinge.t / 2),
                load.deflection,
                load.rated_deflection,
                message,
            )
        )
    return findings
