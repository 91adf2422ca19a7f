"""Benchmarks of what is touched: the object's rungs by number of pads, and fits of grasps on a layer."""

from __future__ import annotations

from functools import partial

import numpy as np
from measuring import (
    RunPlan,
    array_of,
    array_text,
    benchmark,
    cost,
    interleaved,
    measured,
    processor_seconds,
    tactcad,
)
from tables import goal, table

from tactcad.contact.elastic_body import Body
from tactcad.contact.press import PadsOnBody
from tactcad.design.family import family_of
from tactcad.lab.calibration_file import Sensitivity
from tactcad.lab.layer_fit import fit, layer
from tactcad.lab.pressed import press_array

TISSUE = Body(0.5, 0.49, 6.0)  # MPa, mm
OBJECT = f"E={TISSUE.modulus:g},nu={TISSUE.poisson:g},thickness={TISSUE.thickness:g}"
EACH = 0.3  # N a pad: within the depth that a linear body holds for
SIZES = {  # elements by rung: smoke, short, full
    "springs": ((2,), (10, 100), (10, 1000)),
    "layer": ((2,), (10, 100), (2, 10, 100, 1000)),
    "large": ((), (10,), (10,)),
}
ANGLES = (0.0, 2.0, 5.0)  # degrees, of the face
LOADS = np.linspace(0.0, 10 * EACH, 11)  # N
NOISE = 1e-4  # of the largest signal
READ_AGAIN = 10  # grasps of one inclination
CALIBRATED = 0.005  # standard error of K and K_v, relative: three runs that differ by 1 %
GOAL_FIT = 0.01  # s a grasp


@benchmark(
    "object",
    "What is touched: rungs and fits",
    "What does a grasp cost, by rung and number of pads, and what the fit of its readings?",
    kernel=False,
)
def grasps(plan: RunPlan) -> dict:
    rows = [_pressed(plan, rung, n) for rung, sizes in SIZES.items() for n in plan.of(*sizes)]
    fits = [_fitted(plan, angle) for angle in ANGLES]
    pressed = (
        "rung; elements; seconds: `tactcad grasp` [s]; peak_bytes: peak memory [MB]; "
        "again: a further load [ms]"
    )
    fitted = "angle: inclined, degrees; grasps; processor: processor time a grasp [ms]"
    note = (
        f"macro-array's rows repeated, {EACH:g} N a pad, layer of {TISSUE.thickness:g} mm, "
        f"E {TISSUE.modulus:g} MPa. The command is a process of its own; a further load follows "
        "in one process."
    )
    of = (
        f"One stream a row: macro-array, {len(LOADS)} loads, noise {NOISE:g}, thickness within 5 %, "
        "inclined in any direction."
    )
    slowest = max(fits, key=lambda row: row["processor"])
    largest = max((r for r in rows if r["rung"] == "layer"), key=lambda r: r["elements"])
    return {
        "tables": {"object": table(pressed, rows, note), "fits": table(fitted, fits, of, "Fits of grasps")},
        "findings": [
            f"{largest['elements']} pads on a layer: `tactcad grasp` takes {largest['seconds']:.2g} s and "
            f"{largest['peak_bytes'] / 1e6:.0f} MB.",
            goal(
                f"a grasp is fitted in {1e3 * fits[0]['processor']:.2g} ms on a level face, at most "
                f"{1e3 * slowest['processor']:.2g} on an inclined one (goal {1e3 * GOAL_FIT:g}).",
                slowest["processor"] < GOAL_FIT,
            ),
        ],
    }


def _pressed(plan: RunPlan, rung: str, elements: int) -> dict:
    plan.say(f"{rung}, {elements} elements")
    file, design, load = plan.folder / f"array-{elements}.toml", array_of(elements), EACH * elements
    file.write_text(array_text(elements), "utf-8")
    command = tactcad("grasp", file, "--object", OBJECT, "--load", f"{load:g}", "--rung", rung)
    repeats = plan.of(1, 1, 3) if elements <= 10 else 1
    runs = [measured(command) for _ in range(repeats)]
    again = interleaved({rung: partial(press_array, design, TISSUE, load, rung=rung)}, repeats)[rung]
    return {"rung": rung, "elements": elements, **cost(runs), "again": again.seconds}


def _fitted(plan: RunPlan, angle: float) -> dict:
    """A stream of simulated grasps, inclined in many directions."""
    plan.say(f"fits, {angle:g} degrees")
    rng, design = np.random.default_rng(plan.seed), array_of(10)
    of = family_of(design).must("pads", "grasp")
    (pads, per_sink), number = of.springs(design), of.places(design)[2]
    order, body, signals = np.argsort(number), PadsOnBody(pads, TISSUE), []
    K, K_v, ones = 1 / pads.compliance[order, 0, 0], per_sink[order], np.ones(10)
    errors = (CALIBRATED * K, K_v, CALIBRATED * K_v, 0.5 * ones, 20.0 * ones)
    known = Sensitivity(number[order], K, *errors, 1e6 * ones, 0.0 * ones)
    for _ in range(plan.of(1, 2, 25)):
        turn = rng.uniform(0.0, 2.0 * np.pi)
        way = (angle * np.cos(turn), angle * np.sin(turn))
        sinks = [body.press(load=load, angle=way).sink[order] for load in LOADS[1:]]
        signal = (np.array([0.0 * sinks[0], *sinks]) * K_v).T
        noise = rng.standard_normal((READ_AGAIN, *signal.shape))
        signals += [*(signal + NOISE * signal.max() * noise)]
    h, height = TISSUE.thickness, design.tolerance.pad_height
    at = layer(number, pads, height, TISSUE.poisson, h, 0.05 * h)
    stream = partial(fit, at, number[order], LOADS, np.array(signals), known)
    stream()
    seconds = min(processor_seconds(stream) for _ in range(plan.of(1, 1, 3)))
    return {"angle": f"{angle:g}", "grasps": len(signals), "processor": seconds / len(signals)}
