"""For every check one deliberately bad part, from the tests of that check: what is wrong with it, and what is
found.

docs/checks.md is written from this (tests/checks_table.py), and tests/checks/test_checks_table.py holds
it complete.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from variants import variant

from tactcad.parts.language.finding import Finding

# the bad parts stand where they are tested
sys.path += [str(Path(__file__).parent / folder) for folder in ("checks", "rigs")]


@dataclass(frozen=True)
class Bad:
    """`run` is the name under which `tactcad check` times the check; `what` the bad part; `find` what is said
    of it."""

    run: str
    what: str
    find: Callable[[], list[Finding]]
    test: str


def strength(**changes) -> list[Finding]:
    from tactcad.checks.facing_rows.overload_stop import check_strength

    return check_strength(variant({path.replace("__", "."): value for path, value in changes.items()}))


def origin() -> list[Finding]:
    from variants import HARDWARE

    from tactcad.checks.run import _stale
    from tactcad.design.load import parse

    text = (HARDWARE / "soft-tissue.toml").read_text("utf-8")
    return _stale(parse(text.replace("hinge_thickness = 0.15", "hinge_thickness = 0.16"), "soft-tissue"))


def fatigue() -> list[Finding]:
    from tactcad.checks.facing_rows.overload_stop import check_fatigue

    return [*check_fatigue(variant())]


def clearance(**changes) -> list[Finding]:
    from tactcad.checks.facing_rows.overload_stop import check_clearance

    return check_clearance(variant({path.replace("__", "."): value for path, value in changes.items()}))


def tool() -> list[Finding]:
    import test_tools as t

    return t.found(t.scene(bridge=30.0))


BAD_STEPS = {
    "insertion": "a pin 16 mm long under a roof 10 mm over its hole's plate",
    "order": "a screw before the part that it goes into",
    "fingers": "a pin to be pulled that stands out 8 mm, a roof 13 mm over it",
    "freedom": "a plate on a rail of 2 mm, said to be level",
}


def bad_step(check: str) -> list[Finding]:
    import test_steps as t

    return t.found(t.BAD[check])


def calibration() -> list[Finding]:
    from tactcad.scenes.rigs.calibration import check_travel

    return check_travel(variant({"calibration.travel": 0.2}), None)


def rigidity() -> list[Finding]:
    from tactcad.checks.described.goes_together import check_rigidity

    return check_rigidity(variant({"holder.lid_thickness": 2.0}), ["grasping"], [])


def circuit(**changes) -> list[Finding]:
    from tactcad.checks.facing_rows.circuit import check_circuit

    return list(check_circuit(variant({path.replace("__", "."): v for path, v in changes.items()})))


def signals(**changes) -> list[Finding]:
    from tactcad.checks.facing_rows.circuit import check_signals

    return list(check_signals(variant({path.replace("__", "."): v for path, v in changes.items()})))


def gauges(**changes) -> list[Finding]:
    from tactcad.checks.facing_rows.circuit import check_gauges

    return list(check_gauges(variant({path.replace("__", "."): v for path, v in changes.items()})))


def overstrained() -> list[Finding]:
    from dataclasses import replace

    from tactcad.design.sensing import FOILS

    kept = dict(FOILS)
    FOILS["constantan on polyimide"] = replace(kept["constantan on polyimide"], strain=0.003)
    try:
        return gauges()
    finally:
        FOILS.update(kept)


def cut_off() -> list[Finding]:
    from test_circuit_checks import moved

    from tactcad.checks.facing_rows.circuit import check_inputs

    return list(check_inputs(moved("A1-U2", "enable", "ENABLE1")))


def missoldered() -> list[Finding]:
    from test_circuit_checks import moved

    from tactcad.checks.facing_rows.circuit import check_bridges

    return list(check_bridges(moved("W31", "2", "E2_RED")))


def planar(design: str = "planar-array", old: str = "", new: str = "") -> list[Finding]:
    from variants import HARDWARE

    from tactcad.design.load import parse
    from tactcad.families.planar.checks import CHECKS

    text = (HARDWARE / f"{design}.toml").read_text("utf-8")
    changed = parse(text.replace(old, new), design)
    return [f for check in CHECKS for f in check.run(changed, None)]


def assembly() -> list[Finding]:
    from tactcad.checks.described.goes_together import check_assembly

    return check_assembly(variant({"tolerance.tip": 0.2}))


def brep(shape: Callable, part=None) -> list[Finding]:
    from test_brep_and_mesh import BLOCK

    from tactcad.checks.on_solids.soundness import check_brep

    made = shape()  # of build123d, or the kernel's own
    return check_brep(part or BLOCK, getattr(made, "wrapped", made))


def two_boxes():
    from build123d import Box, Compound, Pos

    return Compound([Box(1, 1, 1).solid(), Pos(5, 0, 0) * Box(1, 1, 1).solid()])


def five_faces():
    from build123d import Box, Shell, Solid
    from test_brep_and_mesh import _solid_of

    return Solid(_solid_of(Shell(Box(10, 8, 5).faces()[:5]).wrapped))


def bow_tie():
    from test_brep_and_mesh import bow_tie

    return bow_tie()


def stepped(step: float, thickness: float) -> list[Finding]:
    from test_brep_and_mesh import BLOCK

    from tactcad.contour import chain
    from tactcad.parts.language.description import Extrusion
    from tactcad.solids.build import build

    contour = chain([(0, 0), (10, 0), (10, 4), (10 + step, 4), (10 + step, 8), (0, 8)])
    part = replace(BLOCK, body=Extrusion(contour, thickness))
    return brep(lambda: build(part), part)


def bent_tube() -> list[Finding]:
    from test_brep_and_mesh import bent_tube

    part, solid = bent_tube()
    return brep(lambda: solid, part)


def too_thick() -> list[Finding]:
    from test_brep_and_mesh import BLOCK

    from tactcad.parts.language.description import Extrusion
    from tactcad.solids.build import build

    return brep(
        lambda: build(BLOCK), replace(BLOCK, body=Extrusion(BLOCK.body.outer, 5.00001, BLOCK.body.openings))
    )


def step_file(spoil: str) -> list[Finding]:
    import test_brep_and_mesh as t

    from tactcad.checks.on_solids import soundness
    from tactcad.solids.build import build

    kept = soundness.write_step
    soundness.write_step = lambda shape: getattr(t, spoil)(kept(shape))
    try:
        return soundness.check_step(t.BLOCK, build(t.BLOCK))
    finally:
        soundness.write_step = kept


def thread() -> list[Finding]:
    import test_interference as t

    return t.findings_of(*t.THREADS["beyond the full thread"][:3], kind="thread")


def triangles(spoil: Callable) -> list[Finding]:
    import trimesh
    from test_brep_and_mesh import BLOCK, soup

    from tactcad.checks.on_solids.soundness import check_triangles
    from tactcad.solids.build import build

    vertices, faces = soup(build(BLOCK))
    return check_triangles("BLOCK", trimesh.Trimesh(vertices, spoil(faces), process=False))


def scaled() -> list[Finding]:
    from test_brep_and_mesh import BLOCK, soup

    from tactcad.checks.on_solids import soundness
    from tactcad.solids.build import build

    kept = soundness.triangles
    soundness.triangles = lambda s, a, b: (soup(s)[0] * 1.02, soup(s)[1])
    try:
        return soundness.check_mesh(BLOCK, build(BLOCK))
    finally:
        soundness.triangles = kept


def wirecut(case: str) -> list[Finding]:
    import test_wirecut as t

    from tactcad.checks.described.wirecut import check_wirecut

    bad = t.CASES[case][0] if case in t.CASES else t.part(t.block(web=0.25, kind="slot"))
    return check_wirecut(bad, t.SHOP)


def machining(rule: str) -> list[Finding]:
    import test_machining as t

    from tactcad.checks.described.machining import check_machining

    return check_machining(t.CASES[rule][0][0], t.USUAL)


def interference(case: str) -> list[Finding]:
    import test_interference as t

    return t.findings_of(*t.CASES[case][1])


def motion() -> list[Finding]:
    import test_motion as t

    return t.found(t.scene(t.FOIL, (0, 0, 13.3), (0, 0, 0), (0, 0, 20)))


def moving_weight() -> list[Finding]:
    from tactcad.scenes import make_scene
    from tactcad.scenes.rigs.grasping import check_moving_weight

    light = variant({"grasping.moving_weight": 2.0})
    return check_moving_weight(light, make_scene(light, "grasping"))


def unbuildable() -> list[Finding]:
    from test_brep_and_mesh import BLOCK

    from tactcad.checks import run
    from tactcad.solids.build import SolidError

    def refuse(part):
        raise SolidError(f"{part.part_no}: the kernel calls the solid invalid")

    kept = run.build
    run.build = refuse
    try:
        return run._built(BLOCK, {})
    finally:
        run.build = kept


def left_out() -> list[Finding]:
    from tactcad.checks.run import _left_out

    return _left_out(variant({"grasping.moving_weight": 2.74}))


def golden() -> list[Finding]:
    from tactcad.export.golden_file import golden_record, judge

    return judge(
        golden_record(variant()), golden_record(variant({"sheet.thickness": 2.9, "array.spacer": 1.1}))
    )


BREP, CLEARANCE = "tests/checks/test_brep_and_mesh.py", "tests/checks/test_clearance.py"
CIRCUIT = "tests/checks/test_circuit_checks.py"
PLANAR = "tests/families/planar/test_planar_designs.py"
MACHINING = {
    "mill-corner": "a pocket with sharp corners",
    "mill-groove": "a groove of 0.9 mm",
    "mill-floor": "a floor of 0.7 mm",
    "drill-diameter": "a hole of 0.4 mm",
    "drill-depth": "a hole 10.1 diameters deep",
    "drill-floor": "0.7 mm under a blind hole",
    "counterbore": "0.7 mm left under a screw's head",
    "thread-depth": "a thread 3.03 diameters deep",
    "tap-reach": "an M2 thread below a bore of 2.4 mm, 4 mm deep",
    "thread-run-out": "0.9 mm between full thread and drilled depth",
    "hole-wall": "a hole 0.7 mm from the side",
    "hole-web": "two holes 0.7 mm apart",
    "turn-slender": "a shaft 12.2 diameters long",
    "turn-wall": "a ring of 0.25 mm",
}
WIRECUT = {
    "closed chain": "an arc that ends 2 nm off its circle",
    "simple contour": "a bow tie",
    "openings inside": "an opening over the edge",
    "inside corner": "a radius of 0.149 mm",
    "slot width": "a throat of 0.299 mm",
    "wall": "a fin of 0.799 mm",
    "hinge": "a hinge of 0.25 mm",
    "start hole": "a round opening of 0.499 mm",
}
BAD: dict[str, Bad] = {
    "overload": Bad(
        "strength",
        "a gap of 0.2 mm over the 4 mm arm",
        lambda: strength(stop__gaps={"4": 0.2}),
        "tests/checks/test_strength_check.py",
    ),
    "origin": Bad("origins", "soft-tissue with another hinge", origin, "tests/design/test_origins.py"),
    "fatigue": Bad(
        "fatigue",
        "the shipped arms, rated above what they endure",
        fatigue,
        "tests/checks/test_strength_check.py",
    ),
    "rated-force": Bad(
        "strength", "the shipped arms of 6 mm and more", strength, "tests/checks/test_strength_check.py"
    ),
    "stop-below-rated": Bad(
        "strength",
        "a gap of 0.03 mm over the 8 mm arm",
        lambda: strength(stop__gaps={"8": 0.03}),
        "tests/checks/test_strength_check.py",
    ),
    "strength": Bad(
        "strength",
        "a hinge 3 mm long and 0.02 mm thin",
        lambda: strength(
            element__hinge_length=3.0, element__hinge_thickness=0.02, stop__gaps=dict.fromkeys("45678", 0.1)
        ),
        "tests/checks/test_strength_check.py",
    ),
    "slot-clearance": Bad(
        "clearance",
        "a slot of 0.25 mm under a stop gap of 0.6",
        lambda: clearance(
            array__row_arms=[[4]],
            element__hinge_length=0.25,
            element__fillet_radius=0.1,
            stop__gaps={"4": 0.6},
            element__body_height=3.6,
            gauge__grid_length=0.2,
        ),
        CLEARANCE,
    ),
    "stop-clearance": Bad(
        "clearance",
        "a land 0.13 mm high, arms within 0.2",
        lambda: clearance(
            array__row_arms=[[4]], stop__gaps={"4": 0.1}, element__body_height=2.83, tolerance__arm_height=0.2
        ),
        CLEARANCE,
    ),
    "opposite-clearance": Bad(
        "clearance",
        "rows 2.2 mm apart",
        lambda: clearance(array__row_pitch=2.2, array__row_arms=[[4], [4]]),
        CLEARANCE,
    ),
    "assembly": Bad(
        "assembly", "arms' tips within 0.2 mm of their place", assembly, "tests/stacks/test_virtual_build.py"
    ),
    "one-bridge": Bad("circuit", "a lead of E3 soldered to E2's pin", missoldered, CIRCUIT),
    "floating-input": Bad("circuit", "a multiplexer that ENABLE1 switches off", cut_off, CIRCUIT),
    "channels": Bad("circuit", "one input for ten elements", lambda: circuit(readout__inputs=1), CIRCUIT),
    "bridge-balance": Bad(
        "circuit", "resistors within 2 %", lambda: circuit(readout__completion_tolerance=0.02), CIRCUIT
    ),
    "common-mode": Bad(
        "circuit",
        "the negative supply 0.4 V below ground",
        lambda: circuit(readout__supply_negative=-0.4),
        CIRCUIT,
    ),
    "gauge-power": Bad("circuit", "bridges fed with 7 V", lambda: circuit(readout__excitation=7.0), CIRCUIT),
    "settling": Bad("circuit", "10 us for a reading", lambda: circuit(readout__on_time=1e-5), CIRCUIT),
    "converter-reference": Bad(
        "circuit",
        "a gauge of 80 ohm that a converter reads",
        lambda: circuit(readout__converter="AD7124-8", gauge__resistance=80.0),
        CIRCUIT,
    ),
    "converter-time": Bad(
        "circuit",
        "five elements in 0.2 s",
        lambda: circuit(readout__converter="AD7124-8", readout__period=0.2),
        CIRCUIT,
    ),
    "lead-room": Bad("circuit", "a recess 0.2 mm deep", lambda: circuit(element__recess_depth=0.2), CIRCUIT),
    "strain-relief": Bad("circuit", "leads not bonded", lambda: circuit(wiring__bonded=0.0), CIRCUIT),
    "signal-range": Bad("signals", "a converter of 0.9 V", lambda: signals(readout__adc_range=0.9), CIRCUIT),
    "force-resolution": Bad(
        "signals", "2 mN wished for", lambda: signals(readout__force_resolution=2.0), CIRCUIT
    ),
    "gauge-fatigue": Bad("gauge limits", "the shipped array", gauges, CIRCUIT),
    "gauge-strain": Bad("gauge limits", "a foil that bears 3000 e-6", overstrained, CIRCUIT),
    "unread-figures": Bad("gauge limits", "parts from memory", gauges, CIRCUIT),
    "deflection": Bad("rigidity", "a holder's lid of 2 mm", rigidity, "tests/checks/test_rigidity.py"),
    "calibration": Bad(
        "calibration travel", "0.2 mm of travel", calibration, "tests/rigs/test_rig_scenes.py"
    ),
    "planar-board": Bad(
        "planar board",
        "chips 3.9 mm apart",
        lambda: planar("jaw-array", "pitch = 4.0", "pitch = 3.9"),
        "tests/circuit/test_cell_board.py",
    ),
    "planar-rated-force": Bad(
        "planar strength", "1 N asked for", lambda: planar(old="force = 0.8", new="force = 1.0"), PLANAR
    ),
    "planar-fatigue": Bad("planar strength", "planar-array itself", planar, PLANAR),
    "planar-linear": Bad("planar strength", "the same", planar, PLANAR),
    "build": Bad("build", "a part that the kernel calls invalid", unbuildable, BREP),
    "one-solid": Bad("brep", "two boxes", lambda: brep(two_boxes), BREP),
    "brep-valid": Bad("brep", "a prism over a bow tie", lambda: brep(bow_tie), BREP),
    "shell-closed": Bad("brep", "a box without one face", lambda: brep(five_faces), BREP),
    "tiny-edge": Bad("brep", "a step of 0.5 um", lambda: stepped(5e-4, 5.0), BREP),
    "tiny-face": Bad("brep", "a ledge of 0.9 um2", lambda: stepped(9e-4, 0.001), BREP),
    "self-intersection": Bad("brep", "a bar swept through itself", bent_tube, BREP),
    "volume": Bad("brep", "a block 10 nm thicker than its solid", too_thick, BREP),
    "step-file": Bad("step", "a STEP file cut in half", lambda: step_file("cut_off"), BREP),
    "step-volume": Bad("step", "one with every point 1 % further out", lambda: step_file("stretched"), BREP),
    "step-area": Bad("step", "the same", lambda: step_file("stretched"), BREP),
    "step-box": Bad("step", "the same", lambda: step_file("stretched"), BREP),
    "mesh-watertight": Bad("mesh", "a triangle missing", lambda: triangles(lambda f: f[1:]), BREP),
    "mesh-winding": Bad("mesh", "every triangle turned", lambda: triangles(lambda f: f[:, ::-1]), BREP),
    "mesh-volume": Bad("mesh", "a mesh 2 % too large", scaled, BREP),
    "mesh-area": Bad("mesh", "the same", scaled, BREP),
    **{
        name: Bad("wire-cut", what, lambda name=name: wirecut(name), "tests/checks/test_wirecut.py")
        for name, what in WIRECUT.items()
    },
    **{
        name: Bad("machining", what, lambda name=name: machining(name), "tests/rigs/test_machining.py")
        for name, what in MACHINING.items()
    },
    "overlap": Bad(
        "interference",
        "cubes 1 um into each other",
        lambda: interference("overlap of a thousandth"),
        "tests/checks/test_interference.py",
    ),
    "undeclared-touch": Bad(
        "interference",
        "cubes face to face",
        lambda: interference("faces touch, not declared"),
        "tests/checks/test_interference.py",
    ),
    "contact": Bad(
        "interference",
        "cubes 0.1 mm apart that should touch",
        lambda: interference("declared, but apart"),
        "tests/checks/test_interference.py",
    ),
    "thread": Bad(
        "interference", "a screw 0.1 mm beyond its full thread", thread, "tests/checks/test_interference.py"
    ),
    "tool-room": Bad("tools", "a bridge 30 mm over the screw", tool, "tests/checks/test_tools.py"),
    **{
        name: Bad("steps", what, lambda name=name: bad_step(name), "tests/checks/test_steps.py")
        for name, what in BAD_STEPS.items()
    },
    "motion": Bad("motion", "a foil of 10 um in the way", motion, "tests/rigs/test_motion.py"),
    "moving-weight": Bad("moving weight", "2 N asked for", moving_weight, "tests/rigs/test_rig_statics.py"),
    "scene": Bad(
        "scenes left out",
        "2.74 N asked for, ballast of no thickness",
        left_out,
        "tests/checks/test_found_designs.py",
    ),
    "golden": Bad("golden", "a sheet of 2.9 mm, same revision", golden, "tests/export/test_golden.py"),
}
