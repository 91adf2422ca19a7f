"""Tables of a planar array's design file, and the rows of chips and processes that they name. No numpy."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from tactcad.design.fields import Number, OneOf, Whole, given
from tactcad.design.materials import PLATE_ALLOYS
from tactcad.design.text_values import data_rows
from tactcad.design.tree import ASKED_FORCE, CommonTables


@dataclass(frozen=True)
class Chip:
    """A three-axis Hall chip: body, mm; full scale, mT; noise of a reading, uT rms; its time, ms."""

    name: str
    maker: str
    length: float
    width: float
    height: float
    full_scale: float
    noise_xy: float
    noise_z: float
    reading_ms: float
    addresses: int
    setting: str
    source: str


PLACE_LENGTH = 25.0  # mm, up to which an etched place keeps its tolerance: row "etched" of the processes


@dataclass(frozen=True)
class FoilLimit:
    """Of a length in the foil: the larger of a share of the foil's thickness and a least value, mm."""

    share: float
    least: float

    def __call__(self, thickness: float) -> float:
        return max(self.share * thickness, self.least)


@dataclass(frozen=True)
class FoilProcess:
    """Limits of foil cutting, mm: data/processes.csv. The tolerance is plus and minus on a width, the bevel a
    share of the thickness by which either edge stands back at both faces. Thinner than `loose_from` a part
    hangs on tabs; `etch_factor` least and most, 0 if nothing is undercut."""

    name: str
    thinnest: float
    thickest: float
    slot: FoilLimit
    web: FoilLimit
    inside_radius: FoilLimit
    tolerance: FoilLimit
    bevel: float
    loose_from: float
    etch_factor: tuple[float, float]
    source: str

    def place(self, length: float) -> float:
        """Diameter of a hole's position tolerance, mm, on a sheet of that length: the least up to
        PLACE_LENGTH, beyond in proportion (chosen)."""
        return round(self.tolerance.least * max(1.0, length / PLACE_LENGTH), 3)


def _process(row: dict[str, str]) -> FoilProcess:
    pairs = ((row[f"{of}_share"], row[f"{of}_least"]) for of in ("slot", "web", "inside", "tolerance"))
    slot, web, inside, cut = (FoilLimit(float(share), float(least)) for share, least in pairs)
    low, high, bevel, loose = (float(row[name]) for name in ("thinnest", "thickest", "bevel", "loose_from"))
    factor = float(row["etch_factor_least"]), float(row["etch_factor_most"])
    return FoilProcess(row["name"], low, high, slot, web, inside, cut, bevel, loose, factor, row["source"])


def _chip(row: dict[str, str]) -> Chip:
    types: dict[str, type] = {"str": str, "int": int, "float": float}
    return Chip(**{key: types[Chip.__annotations__[key]](value) for key, value in row.items()})


CHIPS = {row["name"]: _chip(row) for row in data_rows(__file__, "chips")}
PROCESSES = {row["name"]: _process(row) for row in data_rows(__file__, "processes")}


@dataclass(frozen=True)
class Planar:
    """[planar]: the plane of cells, two kinds that alternate like a chessboard."""

    rows: int = given(Whole(1, 40, "rows of cells, along y"))
    columns: int = given(Whole(1, 40, "cells in a row, along x"))
    pitch: float = given(Number("mm", 1, 50, "distance of neighbouring cells, both ways"))
    thickness: float = given(Number("mm", 0.03, 0.5, "foil"))
    web: float = given(Number("mm", 0.1, 10, "foil between the openings of neighbouring cells"), 0.6)
    process: str = given(OneOf(tuple(PROCESSES), "how the foil is cut"), "etched")
    first: str = given(OneOf(("measuring", "reference"), "kind of cell no. 1, least x and y"), "reference")


@dataclass(frozen=True)
class CellKind:
    """[measuring] and [reference]: a kind of cell."""

    form: str = given(OneOf(("straight", "pinwheel"), "beams from the sides' middles, or beside the island"))
    island: float = given(Number("mm", 0.3, 40, "side of the square island"))
    beam_width: float = given(Number("mm", 0.03, 20, "width of each of its four beams"))
    fillet: float = given(Number("mm", 0.01, 5, "fillet at the beams' roots"))
    stop_gap: float = given(Number("mm", 0.01, 3, "travel of the island down to the base"))
    ear: float = given(Number("mm", 0.1, 20, "ear from which a pinwheel's beam runs, along the beam"), 0.8)
    slot: float = given(Number("mm", 0.05, 10, "slot between a pinwheel's island and beam"), 0.35)


@dataclass(frozen=True)
class Post:
    """[post]: a turned post with its foot plate on every island."""

    pad: float = given(Number("mm", 0.3, 40, "diameter of the pad that touches the object"))
    stand_out: float = given(Number("mm", 0.1, 20, "pad over the cover"), 1.0)
    foot: float = given(Number("mm", 0.05, 3, "foot plate, as large as the island, that keeps it rigid"), 0.4)
    spigot: float = given(Number("mm", 0.2, 10, "diameter in foot plate and foil"), 0.8)


@dataclass(frozen=True)
class DiscMagnet:
    """[magnet]: a disc under every island, magnetised along its axis."""

    diameter: float = given(Number("mm", 0.3, 20, "diameter"), 1.5)
    height: float = given(Number("mm", 0.2, 20, "height"), 1.0)
    remanence: float = given(Number("T", 0.1, 1.5, "remanence"), 1.2)
    tolerance: float = given(Number("", 0, 0.3, "spread of the remanence, relative, plus and minus"), 0.05)


@dataclass(frozen=True)
class Hall:
    """[hall]: a three-axis Hall chip below every magnet."""

    chip: str = given(OneOf(tuple(CHIPS), "chip, a row of its table"), "MLX90393")
    gap: float = given(Number("mm", 0.2, 20, "magnet at rest to chip"), 1.5)
    board: float = given(Number("mm", 0.2, 5, "board that carries the chips"), 1.0)
    buses: int = given(Whole(1, 400, "buses, or lines of a multiplexer, that the chips share"), 4)
    rate: float = given(Number("Hz", 0.01, 1000, "readings of every chip a second, at least"), 20.0)


@dataclass(frozen=True)
class Housing:
    """[housing]: base, spacers, cover, screws."""

    joint: str = given(
        OneOf(("screwed", "bonded"), "layers screwed together, or bonded in a jig, flush at their edges"),
        "screwed",
    )
    border: float = given(Number("mm", 0.5, 30, "foil beyond the outer cells' openings, along x"), 5.0)
    side: float | None = given(Number("mm", 0.5, 30, "the same along y"), None, "border")
    lift: float = given(Number("mm", 0.05, 3, "room over the foot plates below the cover"), 0.3)
    side_gap: float = given(Number("mm", 0.05, 3, "travel of a post sideways to the cover"), 0.3)
    cover_thickness: float = given(Number("mm", 0.5, 10, "cover; the screws end in its threads"), 3.0)
    well: float = given(Number("mm", 0.1, 5, "room around a magnet in the base"), 0.45)
    plate_alloy: str = given(OneOf(PLATE_ALLOYS, "base and cover"), "6061-T6")


@dataclass(frozen=True)
class PlanarRating:
    """[rating]"""

    force: float = given(ASKED_FORCE, 1.0)
    shear: float = given(Number("", 0, 2, "largest tangential force, a share of the normal one"), 0.3)
    yield_factor: float = given(Number("", 1, 10, "safety against yield of the rated force"), 1.5)
    linearity: float = given(Number("", 0.001, 0.5, "change of K that counts as linear, relative"), 0.05)
    slip: float = given(Number("", 0.01, 5, "ratio of tangential to normal force at which a pad slips"), 0.5)


@dataclass(frozen=True)
class PlanarTolerance:
    """[tolerance]: plus and minus, two standard deviations."""

    thickness: float | None = given(
        Number("mm", 1e-4, 0.1, "foil"), None, "5 % of the foil, as rolled precision strip is sold; chosen"
    )
    stop_gap: float = given(Number("mm", 0.001, 0.2, "travel of an island down to the base"), 0.01)
    magnet_place: float = given(
        Number("mm", 0.005, 1, "magnet's offset from its island's middle, each way"), 0.08
    )
    magnet_tilt: float = given(Number("degree", 0, 10, "magnet's axis"), 2.0)
    chip_place: float = given(Number("mm", 0.005, 1, "chip's offset from its place, each way"), 0.1)


@dataclass(frozen=True)
class Cradle:
    """[calibration]: the cradle that turns weights into loads along z, x and y."""

    squareness: float = given(Number("mm", 0.002, 0.05, "zone of the cradle's feet and seat"), 0.01)


@dataclass(frozen=True)
class PlanarDesign(CommonTables):
    """A whole design file of cells in a plane."""

    planar: Planar
    measuring: CellKind
    reference: CellKind
    post: Post
    housing: Housing
    magnet: DiscMagnet = DiscMagnet()
    hall: Hall = Hall()
    rating: PlanarRating = PlanarRating()
    tolerance: PlanarTolerance = PlanarTolerance()
    calibration: Cradle | None = None

    @classmethod
    def completed(cls, tables: dict[str, Any]) -> dict[str, Any]:
        own, p = tables["design"], tables["planar"]
        title = own.title or f"Planar tactile array, {p.rows} x {p.columns} cells"
        return tables | {"design": replace(own, title=title)}

    @property
    def plate_alloy(self) -> str:
        return self.housing.plate_alloy

    @property
    def foil_tolerance(self) -> float:
        """Tolerance of the foil's thickness, mm."""
        stated = self.tolerance.thickness
        return 0.05 * self.planar.thickness if stated is None else stated
