"""Setting: the loose stack in the setting fixture, pads and end plates down, its screws tightened there."""

from __future__ import annotations

from dataclasses import replace

from tactcad.design.tree import Design
from tactcad.parts import rigs
from tactcad.parts.array.supplies import supplies
from tactcad.parts.bought.standard_parts import dowel
from tactcad.parts.rigs.setting_fixture import BASE, PIN_OUT, SettingLayout

from ..builder import Builder, telling
from ..moves import PRESS, TWEEZED
from ..rig import plain_rig
from ..scene import REST, STILL, UPRIGHT, Contact, Held, Move, Pose, Rotation, Scene
from .array import COPLANAR, STACKED, array, flatness_tools, narrow, setting_words, wedge

said = telling(__file__)

ALONG_X: Rotation = ((0, 0, 1), (1, 0, 0), (0, 1, 0))  # local x runs along y, y along z, z along x


def setting(design: Design, pose: Pose = REST) -> Scene:
    """Scene `setting`; it has no pose but rest."""
    rig = SettingLayout(design)
    layout, whole = rig.array, array(design)
    b = Builder()
    b.supplies += supplies("setting", {"rows": len(design.array.row_arms)})
    foot = round(rig.floor - BASE, 9)
    fixture = b.place("FX", rigs.setting_fixture(rig), (-rig.half, 0, foot), ALONG_X)
    pin = dowel(design.clamp.dowel, rig.pin_length)
    top = rig.floor + rig.step + PIN_OUT
    fences = {}
    for side, plate in ((1, "EP2"), (-1, "EP1")):
        at = (-side * rig.pin_x, side * rig.pin_y, top - rig.pin_length)
        fences[plate] = b.place("FP", pin, at, UPRIGHT)
        b.meet(fences[plate], fixture, "press")
    b.step(
        "Setting fixture",
        (0, 0, 0),
        f"Press the pins into the fixture from above, {rig.pin_length - PIN_OUT:g} mm deep. Set it on a "
        "flat bench and wipe floor and steps.",
        tools=(PRESS, f"a sleeve {PIN_OUT:g} mm long as stop"),
    )
    blanks = [p for p in whole.placements if p.designator.startswith("BL")]
    strip = ""
    if blanks:
        part = rigs.setting_strip(rig)
        turned = UPRIGHT if blanks[0].rotation[0][0] > 0 else ((-1, 0, 0), (0, -1, 0), (0, 0, 1))
        strip = b.place("FS", part, (0, sum(rig.blanks_y) / 2, rig.floor), turned, on=fixture)
        b.step(
            "Strip under the blanks",
            (0, 0, 20),
            "Lay the strip on the floor where the blanks' fronts will stand.",
            tools=(TWEEZED,) if narrow(layout) else (),
            by=TWEEZED if narrow(layout) else "",
        )
    stacked = {d for s in whole.steps if s.title in STACKED for d in s.designators}
    loose = replace(
        whole,
        name="loose stack",
        placements=tuple(p for p in whole.placements if p.designator in stacked),
        contacts=_among(whole, stacked),
        supplies=(),
        cover=frozenset(),
        steps=(),
    )
    b.subassembly(loose, UPRIGHT, (0, 0, 0))
    pins = tuple(c.first for c in loose.contacts if c.kind == "press")
    for name, fence in fences.items():
        b.meet(name, fence)
        b.meet(name, fixture)
    for place in layout.elements:
        b.meet(place.designator, fixture)
    for p in blanks:
        b.meet(p.designator, strip)
    b.step(
        "Loose stack in the fixture",
        (0, 0, 60),
        said("Loose stack in the fixture"),
        order=[Move(tuple(p.designator for p in loose.placements), (0.0, 0.0, 60.0), (STILL,))],
        held=(
            Held((("EP1", "EP2"),), (fixture,), ("z", "rx", "ry")),
            *([Held((("EP1", "EP2"),), tuple(fences.values()), ("rz",))] if rig.pins_square else []),
            Held(tuple((p.designator,) for p in layout.elements), (fixture, *pins), ("z", "ry")),
            *([Held(tuple((p.designator,) for p in blanks), (strip, *pins), ("z", "ry"))] if blanks else []),
        ),
        leaves=(
            f"elements: turn about their dowels, {wedge(layout)}",
            "EP1: along y, until the clamping is tight",
        ),
    )
    screws = [
        p
        for s in whole.steps
        if s.title == COPLANAR
        for p in whole.placements
        if p.designator in s.designators
    ]
    for p in screws:
        b.put(p)
    names = {p.designator for p in screws}
    b.contacts += [c for c in whole.contacts if {c.first, c.second} & names]
    b.step(
        COPLANAR,
        (0, -60, 0),
        setting_words(layout),
        tools=flatness_tools(layout),
        sets=("the stack: all, by friction",),
    )
    return b.scene("setting", cover=names)


def _among(scene: Scene, names: set[str]) -> tuple[Contact, ...]:
    return tuple(c for c in scene.contacts if {c.first, c.second} <= names)


RIG = plain_rig("setting", setting)  # its limits are the array's: stacks/variables.py
