"""The parameter tree: one frozen dataclass a table of the design file.

Lengths in mm, forces in N, stresses in MPa, density in kg/m3. Frame: x from the middle line between the rows
along the arms, y along the row, z = 0 on the elements' flat (gauge) face, + away from the object. A default
of None is derived from other fields: here (each of the rigs' sizes is the published set-up's as long as the
array is no longer than the published one) and in parts/array/layout.py.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import ceil
from typing import Any

from .fields import Day, Number, NumberRows, Numbers, OneOf, TextLine, TextLines, Whole, given
from .materials import (
    ALLOYS,
    LOT_SPREAD,
    MAGNETIC,
    OTHER_SHEET,
    PLATE_ALLOYS,
    Difference,
    differences,
    sheet_tolerance,
)
from .sensing import Readout, StrainGauge, Wiring

FOLLOWS = "follows the array (design/tree.py): the published set-up's up to the published array's length"


@dataclass(frozen=True)
class Calibration:
    """[calibration]: the set-up that measures each element's stiffness."""

    load_cell_stiffness: float = given(Number("N/mm", 0.01, 1e6, "force sensor's own stiffness"), 57.04)
    load_cell_accuracy: float = given(Number("", 0, 0.5, "half-width of that stiffness, relative"), 0.02)
    load_cell_range: float = given(Number("N", 0.001, 1e5, "force sensor's range"), 5.0)
    load_cell_resolution: float = given(Number("N", 0, 100, "force sensor's resolution"), 0.001)
    step: float = given(Number("mm", 1e-5, 1, "micrometer step"), 0.025)
    travel: float = given(Number("mm", 1e-4, 10, "whole displacement"), 0.150)
    micrometer_resolution: float = given(Number("mm", 0, 0.1, "micrometer's resolution"), 0.0005)
    friction: float = given(Number("", 0, 1, "friction between tip and pad"), 0.2)
    load_point: float = given(Number("mm", 0, 1, "uncertainty of the load point along the arm"), 0.02)
    stage_travel: float = given(
        Number("mm", 0.5, 100, "horizontal micro-stages reach at least this far each way"), 12.5
    )
    axis_travel: float = given(
        Number("mm", 0.5, 100, "vertical micrometer axis reaches this far each way"), 12.5
    )
    retract: float = given(Number("mm", 0.1, 50, "tip is lifted this far before the stages move"), 1.0)
    roller: str = given(
        OneOf(("2", "2.5", "3"), "diameter in mm of the roller that touches the pad, ISO 8734"), "2"
    )


@dataclass(frozen=True)
class Sample:
    """[sample]: the rubber sample."""

    thickness: float = given(Number("mm", 0.1, 100, "sample thickness"), 6.0)
    poisson: float = given(Number("", 0, 0.4999, "Poisson's ratio"), 0.49)
    stiffness: float = given(Number("N/mm", 1e-6, 1e6, "stiffness under one pad"), 3.85)
    side: float = given(Number("mm", 4, 300, "side of the square sample"), None, FOLLOWS)
    step: float = given(Number("mm", 1e-4, 5, "step of the force sensor into the sample"), 0.050)
    travel: float = given(Number("mm", 1e-3, 10, "whole way of the force sensor into the sample"), 0.300)


@dataclass(frozen=True)
class Grasping:
    """[grasping]: array on a vertical axis over the sample, loaded by weights."""

    moving_weight: float = given(Number("N", 0.001, 1e4, "carrier, bar and array"), None, FOLLOWS)
    weight: float = given(Number("N", 1e-4, 1e3, "one added weight"), 0.980665)
    weights: int = given(Whole(0, 1000, "how many weights are added"), 10)
    lift: float = given(Number("mm", 1, 200, "the array is lifted this far to change the sample"), 20.0)
    weight_diameter: float = given(Number("mm", 10, 120, "disc weights"), 50.0)
    rail_length: float = given(Number("mm", 40, 600, "vertical guide rail, a multiple of 20"), 100.0)


@dataclass(frozen=True)
class Cart:
    """[cart]: plate on four ball bearings that roll along the arms."""

    bearing: str = given(
        OneOf(("623-2Z", "624-2Z", "683-2Z"), "wheels: deep groove ball bearings, ISO 15"), "623-2Z"
    )
    length: float = given(Number("mm", 10, 400, "plate along the arms"), None, FOLLOWS)
    width: float = given(Number("mm", 10, 400, "plate across the arms"), None, FOLLOWS)
    thickness: float = given(Number("mm", 2, 40, "plate"), 10.0)
    wheel_base: float = given(Number("mm", 5, 400, "distance of the axles along the arms"), None, FOLLOWS)
    clearance: float = given(Number("mm", 0.1, 20, "plate over the base plate"), 2.0)
    shim: float = given(Number("mm", 0.05, 5, "shim each side of a wheel's inner ring: its side play"), 0.5)
    roll: float = given(Number("mm", 0.1, 50, "the cart may roll this far each way"), 5.0)


@dataclass(frozen=True)
class Holder:
    """[holder]: vacuum holder of the sample, on the cart."""

    vacuum_diameter: float = given(
        Number("mm", 4, 250, "holes and plenum lie inside this circle"), None, FOLLOWS
    )
    hole_diameter: float = given(Number("mm", 0.2, 5, "suction holes"), 1.0)
    rings: int = given(Whole(1, 12, "hexagonal rings of holes around the middle one"), None, FOLLOWS)
    lid_thickness: float = given(Number("mm", 1, 30, "lid under the sample"), None, FOLLOWS)
    plenum_depth: float = given(Number("mm", 4, 40, "plenum: room for the port in its wall"), 8.0)
    floor: float = given(Number("mm", 1, 30, "material under the plenum"), 4.0)
    margin: float = given(Number("mm", 2, 60, "lid beyond the sample, for its screws"), 8.0)
    vacuum: float = given(Number("kPa", 1, 100, "below the air's pressure"), 40.0)
    pull: float = given(Number("N", 0, 1000, "force that may pull the sample off: tack of the pads"), 0.6)


@dataclass(frozen=True)
class Bonding:
    """[bonding]: the fixture in which gauges are bonded, their adhesive and their terminals."""

    signal_share: float = given(
        Number("", 1e-4, 0.5, "largest loss of a gauge's signal by its place along the hinge, as a share"),
        0.03,
    )
    sight: float = given(
        Number("mm", 0.001, 0.5, "the gauge's middle set between the tongue's edges by eye, plus and minus"),
        0.03,
    )
    pressure: float = given(Number("MPa", 0.001, 2, "of the clamp on the gauge while it cures"), 0.1)
    glue_thickness: float = given(
        Number("mm", 0.0005, 0.2, "cured adhesive under the gauge, part of gauge.grid_height"), 0.01
    )
    glue_modulus: float = given(Number("MPa", 1, 2e4, "Young's modulus of the cured adhesive"), 2000.0)
    cure: float = given(Number("min", 0.5, 2880, "the clamp stays on"), 10.0)
    terminal_length: float = given(Number("mm", 0.5, 20, "solder terminals along the element"), 3.0)
    terminal_width: float | None = given(
        Number("mm", 0.5, 20, "solder terminals across the element"), None, "the sheet's thickness, at most 2"
    )


# The published set-up, mm and N; the cart is chosen around its sample.
SIDE, LENGTH, WIDTH, WHEEL_BASE, VACUUM, RINGS = 32.0, 70.0, 50.0, 50.0, 26.0, 3
BESIDE_THREADS = 54.0  # mm, width of a cart whose wheels clear the stages' threads
MOVING, STACK = 3.235, 21.0  # paper: what moves with the array, N; its stack of sheets and spacers
PER_STACK = 0.05  # N for a mm of stack more; chosen: twice what aluminium weighs, trimmed by the ballast
# mm2 of sheet in both rows' bodies and spacers, as published; kg/m3, 7075; m/s2
SECTION, ALUMINIUM, GRAVITY = 290.0, 2810.0, 9.80665
RUBBER = 6.0  # of the sample beyond the pads; chosen: what the published array has beyond the ends of a row
# Lid, and the widest circle of holes over which it bends by less than 2 um (plate theory, rigs/stiffness.py).
LID, STIFF = 6.0, 44.0
LARGEST_SIDE = 80.0  # of a sample whose cart clears the post; chosen: 1 mm less than fits
# Circle of holes: the largest O-ring of the table lies around 66, a lid ten hole diameters thick bears less.
LARGEST_VACUUM = 64.0


def followed(values: dict[str, Any]) -> dict[str, Any]:
    """The tables of a design with omitted values filled in."""
    array, sheet, element = values["array"], values["sheet"], values["element"]
    sample, grasping = values.get("sample"), values.get("grasping")
    done = dict(values)
    done["design"] = _filled(done["design"], title=_title(array))
    done["tolerance"] = _filled(done["tolerance"], **_as_bought(done["material"], sheet))
    if sample is not None:
        sample = done["sample"] = _filled(sample, side=_side(array, sheet, element))
        more = max(sample.side - SIDE, 0.0)
        vacuum = min(VACUUM + more, LARGEST_VACUUM)
        wheels = {
            "length": LENGTH + more,
            "width": max(WIDTH + more, BESIDE_THREADS),
            "wheel_base": WHEEL_BASE + more,
        }
        # as stiff under its own pressure as one of LID over a plenum of STIFF: diameter^4 over thickness^3
        lid = max(LID, float(ceil(LID * (vacuum / STIFF) ** (4 / 3))))
        holes = {"vacuum_diameter": vacuum, "rings": round(RINGS * vacuum / VACUUM), "lid_thickness": lid}
        for name, sizes in (("cart", wheels), ("holder", holes)):
            if values.get(name) is not None:
                done[name] = _filled(values[name], **sizes)
    if grasping is not None:
        done["grasping"] = _filled(grasping, moving_weight=_moving(array, sheet, done["material"].density))
    return done


def _filled(table: Any, **left_out: float | str) -> Any:
    return replace(table, **{name: v for name, v in left_out.items() if getattr(table, name) is None})


def _as_bought(material: SheetMaterial, sheet: Sheet) -> dict[str, float]:
    """The sheet's tolerances: Young's modulus and thickness."""
    row = ALLOYS.get(material.alloy)
    return {
        "youngs_modulus": row.spread["youngs_modulus"] if row else LOT_SPREAD,
        "sheet_thickness": sheet_tolerance(sheet.thickness, material.density),
    }


def _title(array: Array) -> str:
    """Rows by elements a row, such as 2 x 5, or 5 + 4 if they differ."""
    counts = [len(row) for row in array.row_arms]
    size = f"{len(counts)} x {counts[0]}" if len({*counts}) == 1 else " + ".join(map(str, counts))
    return f"Tactile array {size}"


def _side(array: Array, sheet: Sheet, element: Element) -> float:
    """Side of the sample: rubber beyond every pad, in whole 2 mm."""
    along = (max(map(len, array.row_arms)) - 1) / 2 * array.pitch + sheet.thickness / 2
    across = (array.row_pitch + element.pad_length) / 2
    return min(max(SIDE, 2.0 * ceil(max(along, across) + RUBBER)), LARGEST_SIDE)


def _moving(array: Array, sheet: Sheet, density: float) -> float:
    """Weight that moves with the array, N: the published weight, more for a longer stack or a denser sheet
    (kg/m3), in whole 0.1 N."""
    spacer = array.spacer if array.spacer is not None else array.pitch - sheet.thickness
    count = max(map(len, array.row_arms))
    stack = count * sheet.thickness + (count + 1) * spacer
    denser = SECTION * stack * max(density - ALUMINIUM, 0.0) * 1e-9 * GRAVITY
    more = PER_STACK * max(stack - STACK, 0.0) + denser
    return ceil(10 * (MOVING + more) - 1e-9) / 10 if more > 1e-9 else MOVING


# Without control characters, line ends, characters that turn the direction of text, and those that XML (SVG)
# cannot hold.
_LINE = r"(?!\s*$)[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufeff\ufff9-\uffff]{1,80}"

IN_EXPORTS = ("golden", "releases", "check", "bench")  # folders next to those of the designs


def _line(meaning: str) -> TextLine:
    return TextLine(_LINE, "one line of 1 to 80 printable characters, among them a letter or digit", meaning)


@dataclass(frozen=True)
class Issue:
    """[design.unchanged.LETTER]: parts whose sheets and files are still those of that revision."""

    date: str = given(Day("date of issue of that revision"))
    parts: tuple[str, ...] = given(
        TextLines(
            TextLine(r"[A-Za-z0-9][A-Za-z0-9._+-]{0,79}", "a part number without the design's name", ""),
            "parts that keep that letter and date; all others have the design's",
        )
    )


@dataclass(frozen=True)
class Identity:
    """[design]: who made which revision of what."""

    name: str = given(
        TextLine(
            rf"(?!(?:con|prn|aux|nul|com[0-9]|lpt[0-9]|{'|'.join(IN_EXPORTS)})$)"
            r"[a-z0-9](?:[a-z0-9-]{0,38}[a-z0-9])?",
            "1 to 40 of a-z, 0-9 and '-', not first or last '-', no device of Windows (con, aux, com1, ...), "
            f"not what else lies in exports/ ({', '.join(IN_EXPORTS)})",
            "short name: folder, part numbers and file names start with it",
        )
    )
    revision: str = given(TextLine(r"[A-Z]{1,2}", "one or two capital letters", "revision index"))
    date: str = given(Day("date of issue; the only date in any output"))
    title: str = given(_line("title on drawings"), None, "tactile array, and its elements by row")
    author: str | None = given(_line("creator, for the title block"), None, "not stated")
    organisation: str | None = given(
        _line("legal owner, for the title block; a release needs one"), None, "not stated"
    )
    contact: str | None = given(
        _line("contact for shops: name, mail or telephone; a release needs one"), None, "not stated"
    )
    unchanged: dict[str, Issue] = field(default_factory=dict)

    def of_part(self, part_no: str) -> Identity:
        """Its sheet's and files': with the letter and date of the revision since which it has not changed."""
        own = part_no.removeprefix(f"{self.name}-")
        letter = next((letter for letter, issue in self.unchanged.items() if own in issue.parts), None)
        if letter is None:
            return replace(self, unchanged={})
        return replace(self, unchanged={}, revision=letter, date=self.unchanged[letter].date)

    @property
    def board_no(self) -> str:
        """What is printed on the circuit boards, which have one letter."""
        return f"{self.name}-board"

    @property
    def of_board(self) -> Identity:
        return self.of_part(self.board_no)


def _property(spec: Number | OneOf, optional: bool = False) -> Any:
    left_out = "the table's value" + ("; unknown of a label of its own" if optional else "")
    return given(spec, None, left_out)


@dataclass(frozen=True)
class SheetMaterial:
    """[material]: the sheet that the elements are cut from.

    For a name in the table (data/materials.csv), values that are left out are the table's; a label of its own
    needs all properties but the last three.
    """

    alloy: str = given(
        TextLine(
            r"[A-Za-z0-9](?:[A-Za-z0-9 .,+/()_-]{0,28}[A-Za-z0-9)+])?",
            f"{', '.join(ALLOYS)}, or a label of its own (1 to 30 letters, digits, blanks and .,+/()_-)",
            "material and temper of the sheet: a name of the table, or a label of its own",
        )
    )
    youngs_modulus: float = _property(Number("MPa", 1e3, 1e6, "Young's modulus"))
    poisson: float = _property(Number("", 0.0, 0.49, "Poisson's ratio"))
    density: float = _property(Number("kg/m3", 500, 25000, "density"))
    yield_strength: float = _property(Number("MPa", 1, 5000, "0.2 % proof stress"))
    fatigue_strength: float = _property(Number("MPa", 1, 5000, "fatigue strength, R = -1, 5e8 cycles"))
    tensile_strength: float | None = _property(
        Number("MPa", 1, 5000, "tensile strength; if unknown, Goodman's line ends at yield"), optional=True
    )
    conductivity: float | None = _property(Number("W/(m K)", 0.1, 500, "thermal conductivity"), optional=True)
    magnetic: str | None = _property(
        OneOf(MAGNETIC, "whether a magnet attracts it; noted on drawings"), optional=True
    )


@dataclass(frozen=True)
class Sheet:
    """[sheet]"""

    thickness: float = given(Number("mm", 0.1, 20, "sheet thickness = width of every element"))


@dataclass(frozen=True)
class Array:
    """[array]: the elements and their places."""

    row_arms: tuple[tuple[float, ...], ...] = given(
        NumberRows(
            Numbers(Number("mm", 0.1, 100, "arm length"), 1, 500, "arm lengths of a row"),
            "arm lengths, hinge centre to the arm's tip, row by row; elements are numbered in this order",
        )
    )
    pitch: float = given(Number("mm", 0.2, 50, "distance of neighbouring pads along a row"))
    row_pitch: float = given(Number("mm", 0.1, 50, "distance of facing pads' centres across the rows"))
    spacer: float | None = given(Number("mm", 0.05, 30, "spacer thickness"), None, "pitch - sheet thickness")


@dataclass(frozen=True)
class Hinge:
    """[element.override.N]: one element's own values; None keeps [element]'s value."""

    hinge_thickness: float | None = given(Number("mm", 0.005, 5, "hinge thickness t"), None)
    hinge_length: float | None = given(Number("mm", 0.01, 50, "slot length l"), None)
    fillet_radius: float | None = given(Number("mm", 0.005, 25, "slot fillet radius r"), None)
    arm_height: float | None = given(Number("mm", 0.05, 50, "arm height h"), None)


@dataclass(frozen=True)
class Element:
    """[element]: the side view that the wire cuts."""

    hinge_thickness: float = given(Number("mm", 0.005, 5, "hinge thickness t"))
    hinge_length: float = given(
        Number("mm", 0.01, 50, "slot length l, corner fillets included, along the arm")
    )
    fillet_radius: float = given(Number("mm", 0.005, 25, "radius r of the slot's corner fillets"))
    arm_height: float = given(Number("mm", 0.05, 50, "arm height h over the flat face"))
    body_height: float = given(Number("mm", 0.05, 50, "thickness Hb of the body in front of the clamp"))
    pad_length: float = given(Number("mm", 0.05, 50, "contact pad's length along the arm"))
    pad_height: float = given(Number("mm", 0.01, 50, "height of the pad over the flat face"))
    sides: str = given(
        OneOf(
            ("one", "two"),
            "slot from the back only (flat gauge face), or from both faces (the gauge lies in a slot, whole)",
        ),
        "one",
    )
    pad_root_radius: float = given(Number("mm", 0.005, 10, "fillet between pad and flat face"), 0.3)
    corner_radius: float = given(
        Number("mm", 0.005, 5, "radius of the remaining inside corners, for the wire"), 0.3
    )
    seat_length: float = given(
        Number("mm", 0.1, 20, "ledge of the element with the longest arm, slot to clamp edge"), 1.96
    )
    rear_length: float = given(Number("mm", 1, 200, "clamped rear body, clamp edge to rear end"), 18.1)
    rear_height: float = given(Number("mm", 0.2, 100, "height of the rear body over the flat face"), 8.0)
    recess_offset: float = given(
        Number("mm", 0, 100, "wire recess of the flat face starts this far behind the clamp edge"), 1.6
    )
    recess_depth: float = given(Number("mm", 0.01, 20, "depth of the wire recess"), 0.8)
    override: dict[int, Hinge] = field(default_factory=dict)


@dataclass(frozen=True)
class Holes:
    """[holes]: through every element, spacer and end plate; in line for all arm lengths."""

    height: float = given(Number("mm", 0.1, 100, "hole centres over the flat face"), 4.7)
    screw_offsets: tuple[float, ...] = given(
        Numbers(Number("mm", 0.1, 200, "x"), 1, 8, "clamping screws behind the clamp edge"), (3.7, 14.5)
    )
    dowel_offsets: tuple[float, ...] = given(
        Numbers(Number("mm", 0.1, 200, "x"), 1, 4, "dowels behind the clamp edge"), (9.1,)
    )
    dowel_hole: float = given(
        Number("mm", 0.2, 20, "dowel hole in elements and spacers, slide fit, lower limit"), 3.012
    )
    dowel_hole_upper: float = given(Number("mm", 0.001, 0.1, "its upper deviation; lower is 0"), 0.006)
    web: float = given(Number("mm", 0.1, 20, "least material around a hole"), 1.5)


@dataclass(frozen=True)
class Clamp:
    """[clamp]: spacers, end plates, stop plate, carrier and their fasteners."""

    screw: str = given(OneOf(("M2", "M2.5", "M3", "M4", "M5"), "clamping screws, ISO 4762 A2-70"), "M3")
    dowel: str = given(OneOf(("2", "2.5", "3", "4", "5"), "dowel diameter in mm, ISO 8734"), "3")
    plate_alloy: str = given(OneOf(PLATE_ALLOYS, "end plates and carrier"), "6061-T6")
    end_plate_thickness: float = given(Number("mm", 2, 40, "end plate along the row"), 8.0)
    end_plate_bottom: float = given(
        Number("mm", 0, 50, "end plates start this far over the flat face: clear of the object"), 0.5
    )
    end_plate_height: float | None = given(
        Number("mm", 4, 100, "end plate along z"),
        None,
        "so that a standard set screw reaches from the carrier to the stop plate",
    )
    end_plate_margin: float = given(Number("mm", 0, 20, "end plate beyond the elements' rear end"), 0.5)
    spacer_bottom: float = given(Number("mm", 0, 50, "spacers start this far over the flat face"), 0.9)
    spacer_drop: float = given(Number("mm", 0, 20, "spacers end this far below the rear body's top"), 0.1)
    stop_plate_thickness: float = given(Number("mm", 0.5, 20, "stop plate"), 4.0)
    stop_plate_gap: float = given(Number("mm", 0.05, 5, "stop plate to rear bodies and end plates"), 0.4)
    hold_down_pitch: float | None = given(
        Number("mm", 5, 200, "largest distance of the set screws that hold the stop plate down"),
        None,
        "the stop plate between them gives way by a tenth of stop.tolerance under rating.overload_force",
    )
    carrier_thickness: float = given(Number("mm", 2, 40, "carrier plate"), 6.0)
    carrier_margin: float = given(Number("mm", 0, 20, "carrier beyond the end plates"), 2.0)
    carrier_screw_offset: float = given(Number("mm", 0.5, 200, "carrier screws behind the clamp edge"), 10.6)
    mount_thread: str = given(OneOf(("M3", "M4", "M5"), "carrier's threads for the axis"), "M4")
    mount_pitch_y: float = given(Number("mm", 5, 200, "distance of these threads along the row"), 32.0)


@dataclass(frozen=True)
class Tolerance:
    """[tolerance]: plus and minus, taken as two standard deviations; on drawings, in bands and budget.

    docs/mechanics.md gives the origin of defaults that no drawing states.
    """

    hinge_thickness: float = given(Number("mm", 1e-4, 0.1, "hinge thickness"), 0.005)
    hinge_length: float = given(Number("mm", 1e-4, 0.5, "slot length"), 0.02)
    fillet_radius: float = given(Number("mm", 1e-4, 0.5, "radius of the slot's fillets"), 0.02)
    load_arm: float = given(Number("mm", 1e-4, 1, "pad edges, and element in its clamp"), 0.05)
    sheet_thickness: float = given(
        Number("mm", 1e-4, 1, "sheet thickness"),
        None,
        f"of aluminium as EN 485-4 has it, sheets up to 1 m wide; of others {OTHER_SHEET:g}",
    )
    arm_height: float = given(Number("mm", 1e-4, 0.5, "arm height"), 0.02)
    tip: float = given(Number("mm", 1e-4, 0.5, "arm's tip from the dowel hole's centre"), 0.02)
    ledge: float = given(Number("mm", 1e-4, 0.1, "ledge over the pad's face"), 0.005)
    pad_height: float = given(Number("mm", 1e-4, 0.5, "pad height over the dowel hole"), 0.01)
    tilt: float = given(Number("degree", 0, 5, "array against object"), 0.1)
    youngs_modulus: float = given(
        Number("", 0, 0.2, "Young's modulus of the lot, relative"),
        None,
        f"the spread of the material's row; {LOT_SPREAD:g} of a label of its own",
    )
    recast_layer: float = given(
        Number("mm", 0, 0.05, "layer without strength on every cut face, at most"), 0.001
    )
    clamp_compliance: float = given(
        Number("rad/(N mm)", 0, 1e-3, "turn of the clamp under the moment at its edge, at most"), 1e-5
    )
    zero_drift: float | None = given(
        Number("", 0, 0.01, "drift of a bridge's zero, dR/R, during a grasp, by its leads' warmth"),
        None,
        "0.5 K between the copper of the longest lead and its neighbour, over the gauge's resistance",
    )
    creep: float = given(
        Number("", 0, 0.1, "share of a gauge's signal that creeps under a held load, each decade of time"),
        0.001,
    )


@dataclass(frozen=True)
class Stop:
    """[stop]: the overload stop: a land at each tip under the stop plate."""

    land_length: float = given(Number("mm", 0.05, 20, "stop land along the arm, from the tip"), 1.0)
    tolerance: float = given(Number("mm", 0.001, 0.1, "tolerance of the gap, plus and minus"), 0.010)
    gaps: dict[float, float] | None = field(
        default=None,
        metadata={
            "spec": Number("mm", 0.001, 5, 'gap by arm length, a table: "4" = 0.13'),
            "derived": "from the estimator: the widest that keeps every hinge within its rated deflection, "
            "by 0.005 mm",
        },
    )


ASKED_FORCE = Number("N", 1e-6, 1e4, "force asked of each element at its pad")


@dataclass(frozen=True)
class Rating:
    """[rating]: loads that the design is rated for."""

    force: float = given(ASKED_FORCE, 2.0)
    yield_factor: float = given(Number("", 1, 10, "safety against yield of the rated force, in use"), 1.5)
    deflection_factor: float = given(
        Number(
            "",
            1,
            10,
            "safety against yield of the rated deflection, which neither overload nor calibration passes",
        ),
        1.2,
    )
    overload_force: float = given(
        Number("N", 1e-6, 1e5, "whole moving weight on one element: the stop must carry it"), 13.04
    )
    friction: float = given(Number("", 0, 0.9, "friction between pad and object"), 0.0)


NO_TABLES = ("origin", "added")  # fields of a design that hold no values of its own


@dataclass(frozen=True)
class CommonTables:
    """Tables that the design file of every family has (family.py); a family's own class adds its own."""

    design: Identity
    material: SheetMaterial
    origin: dict[str, str] = field(default_factory=dict, kw_only=True)
    added: tuple[Any, ...] = field(default=(), kw_only=True)  # by Python, scenes.scene.AddedPart

    @classmethod
    def completed(cls, tables: dict[str, Any]) -> dict[str, Any]:
        """The tables as read, with what they leave out and others decide: a title, at least."""
        own = tables["design"]
        return tables | {"design": replace(own, title=own.title or f"Tactile array {own.name}")}

    @property
    def name(self) -> str:
        return self.design.name

    @property
    def differences(self) -> tuple[Difference, ...]:
        """Differences between the material and the table's row of its name; see `materials.differences`."""
        return differences(self.material.alloy, vars(self.material), self.origin)

    @property
    def stiffness_factor(self) -> float | None:
        """Ratio of stiffness with the table's Young's modulus to that with the design's: the ratio of the
        moduli, since the elements are linear; None if the design has the table's."""
        return next((d.table / d.value for d in self.differences if d.name == "youngs_modulus"), None)

    @property
    def plate_alloy(self) -> str:
        """Alloy of milled plates, by its row of the table; a family's own class may leave it to a field."""
        return Clamp.plate_alloy


@dataclass(frozen=True)
class Design(CommonTables):
    """A whole design file of facing rows."""

    sheet: Sheet
    array: Array
    element: Element
    holes: Holes = Holes()
    clamp: Clamp = Clamp()
    gauge: StrainGauge = StrainGauge()
    stop: Stop = Stop()
    rating: Rating = Rating()
    readout: Readout = Readout()
    wiring: Wiring = Wiring()
    tolerance: Tolerance = Tolerance()
    cart: Cart | None = None
    holder: Holder | None = None
    calibration: Calibration | None = None
    sample: Sample | None = None
    grasping: Grasping | None = None
    bonding: Bonding | None = None

    @classmethod
    def completed(cls, tables: dict[str, Any]) -> dict[str, Any]:
        return followed(tables)

    @property
    def plate_alloy(self) -> str:
        return self.clamp.plate_alloy
