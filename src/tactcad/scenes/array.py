"""The array: two facing rows of elements between end plates, with stop plate and carrier."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from tactcad.design.tree import Design
from tactcad.parts import plates
from tactcad.parts.consumables import array_supplies
from tactcad.parts.description import Part
from tactcad.parts.element import element
from tactcad.parts.fasteners import carrier_screw, clamping
from tactcad.parts.layout import ElementPlace, Layout
from tactcad.parts.library import dowels, screws

from .array_steps import array_steps
from .scene import UPRIGHT, Contact, Placement, Rotation, Scene

# Local contour plane (x, y) laid into the scene's (x, z) plane, thickness along y: row one's arms
# run along +x, row two is row one turned by half a turn about z.
ROW: dict[int, Rotation] = {1: ((1, 0, 0), (0, 0, -1), (0, 1, 0)), 2: ((-1, 0, 0), (0, 0, 1), (0, 1, 0))}
ALONG_Y: Rotation = ROW[2]  # local z runs along +y
AGAINST_Y: Rotation = ROW[1]  # local z runs along -y
DOWN: Rotation = ((1, 0, 0), (0, -1, 0), (0, 0, -1))  # local z runs along -z


def array(design: Design, instead: Mapping[int, Part] = MappingProxyType({}), stops: bool = True) -> Scene:
    """Scene `array` of a design; elements are E1, E2, ... by number.

    `instead` gives other parts by element number, such as one that a rig has pressed. Without `stops` the stop plate
    and its set screws are not in place yet, as in the calibration.
    """
    layout = Layout(design)
    build = _Builder(layout, instead)
    build.stack()
    build.plates()
    build.clamping()
    build.carrier()
    if stops:
        build.stop_plate()
    return Scene(
        "array",
        tuple(build.placements),
        tuple(build.contacts),
        array_supplies(layout),
        frozenset(build.cover),
        steps=array_steps(layout, tuple(p.designator for p in build.placements)),
    )


class _Builder:
    """Collects placements and contacts in assembly order."""

    def __init__(self, layout: Layout, instead: Mapping[int, Part]) -> None:
        self.layout, self.instead = layout, instead
        self.placements: list[Placement] = []
        self.contacts: list[Contact] = []
        self.on_ledge: list[str] = []
        self.cover: set[str] = {"ST1", "CA1", "EP1"}  # and every screw and pin

    def place(self, designator: str, part: Part, origin, rotation: Rotation) -> str:
        if part.bought:
            self.cover.add(designator)
        self.placements.append(
            Placement(designator, part, tuple(round(float(v), 9) for v in origin), rotation)
        )
        return designator

    def touch(self, first: str, second: str) -> None:
        self.contacts.append(Contact(first, second, "touch"))

    def _element(self, place: ElementPlace) -> Part:
        return self.instead.get(place.number) or element(self.layout, place)

    def stack(self) -> None:
        """Elements and blanks, a spacer before, between and after them, row by row."""
        layout = self.layout
        half_sheet, half_spacer = layout.design.sheet.thickness / 2, layout.spacer / 2
        spacer = plates.spacer(layout)
        blank = plates.blank(layout)
        standing: dict[tuple[int, int], tuple[str, Part]] = {}
        for place in layout.elements:
            standing[place.row, place.index] = (place.designator, self._element(place))
        for number, (row, i) in enumerate(layout.blanks(), start=1):
            standing[row, i] = (f"BL{number}", blank)
        self.ends: dict[int, tuple[str, str]] = {}
        spacers = 0
        for row in (1, 2):
            out = 1.0 if row == 1 else -1.0  # local thickness runs along -y in row one, +y in row two
            before = None
            for i in range(layout.positions + 1):
                spacers += 1
                y = -layout.stack / 2 + i * layout.design.array.pitch + half_spacer
                name = self.place(f"SP{spacers}", spacer, (0, y + out * half_spacer, 0), ROW[row])
                if before:
                    self.touch(before, name)
                else:
                    first = name
                if i < layout.positions:
                    designator, part = standing[row, i]
                    self.place(designator, part, (0, layout.position_y(i) + out * half_sheet, 0), ROW[row])
                    self.touch(name, designator)
                    self.on_ledge.append(designator)
                    before = designator
            self.ends[row] = (first, name)

    def plates(self) -> None:
        layout = self.layout
        outer = layout.stack / 2 + layout.design.clamp.end_plate_thickness
        z0 = layout.end_plate_z[0]
        self.place("EP1", plates.end_plate(layout, head=True), (0, -outer, z0), ALONG_Y)
        self.place("EP2", plates.end_plate(layout, head=False), (0, outer, z0), AGAINST_Y)
        for first, last in self.ends.values():
            self.touch("EP1", first)
            self.touch("EP2", last)
        self.place("CA1", plates.carrier(layout), (0, 0, layout.carrier_bottom), UPRIGHT)
        self.touch("EP1", "CA1")
        self.touch("EP2", "CA1")

    def clamping(self) -> None:
        """Screws (or tie rods) and dowels along y through both rows."""
        layout, d = self.layout, self.layout.design
        c = clamping(layout)
        z = d.holes.height
        face = layout.stack / 2
        outer = face + d.clamp.end_plate_thickness
        xs = [side * x for side in (1, -1) for x in layout.screw_x]
        for n, x in enumerate(xs, start=1):
            if c.rod:
                self._tie_rod(n, x, z, outer, c.screw)
                continue
            screw = screws.cap_screw(d.clamp.screw, c.screw)
            name = self.place(f"SC{n}", screw, (x, -(face + c.head_plate_web), z), ALONG_Y)
            self.touch(name, "EP1")
            self.contacts.append(Contact(name, "EP2", "thread"))
        pin = dowels.dowel(d.clamp.dowel, c.dowel)
        for n, x in enumerate((side * x for side in (1, -1) for x in layout.dowel_x), start=1):
            name = self.place(f"DW{n}", pin, (x, -c.dowel / 2, z), ALONG_Y)
            self.contacts.append(Contact(name, "EP2", "press"))

    def _tie_rod(self, n: int, x: float, z: float, outer: float, length: float) -> None:
        thread = self.layout.design.clamp.screw
        rod = self.place(f"TR{n}", screws.threaded_rod(thread, length), (x, -length / 2, z), ALONG_Y)
        for end, (side, plate) in enumerate(((-1, "EP1"), (1, "EP2"))):
            turned = AGAINST_Y if side < 0 else ALONG_Y  # local z runs outwards
            nut = self.place(f"NU{2 * n - 1 + end}", screws.nut(thread), (x, side * outer, z), turned)
            self.touch(plate, nut)
            self.contacts.append(Contact(rod, nut, "thread"))

    def carrier(self) -> None:
        """Carrier screws into the end plates."""
        layout, d = self.layout, self.layout.design
        thread, fixing = d.clamp.screw, carrier_screw(layout)
        first = len([p for p in self.placements if p.designator.startswith("SC")])
        corners = [(sx, sy) for sy in (-1, 1) for sx in (1, -1)]
        for n, (sx, sy) in enumerate(corners, start=first + 1):
            at = (
                sx * layout.carrier_screw_x,
                sy * layout.end_plate_y,
                layout.carrier_bottom + fixing.under_head,
            )
            name = self.place(f"SC{n}", screws.cap_screw(thread, fixing.length), at, DOWN)
            self.touch(name, "CA1")
            self.contacts.append(Contact(name, "EP1" if sy < 0 else "EP2", "thread"))

    def stop_plate(self) -> None:
        """The stop plate, and set screws in the carrier that press it on the ledges."""
        layout, thread = self.layout, self.layout.design.clamp.screw
        self.place("ST1", plates.stop_plate(layout), (0, 0, layout.ledge), UPRIGHT)
        for designator in self.on_ledge:
            self.touch(designator, "ST1")
        length = layout.hold_down.length
        spots = [(side * layout.hold_down_x, y) for side in (1, -1) for y in layout.hold_down_y]
        for n, (x, y) in enumerate(spots, start=1):
            name = self.place(
                f"SS{n}", screws.set_screw(thread, length), (x, y, layout.stop_plate_top + length), DOWN
            )
            self.touch(name, "ST1")
            self.contacts.append(Contact(name, "CA1", "thread"))
