"""Land patterns, computed by IPC-7351B (density level B) from makers' or JEDEC's dimensions of the packages.

    Z = Lmin + 2 toe + rms(L, F, P),  G = Smax - 2 heel - rms(S, F, P),  X = Wmin + 2 side + rms(W, F, P)

with F = 0.1 mm (board) and P = 0.1 mm (placing). Pads are numbered anticlockwise from the upper left, seen on
the component side; y points down, as in KiCad.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import sqrt

from tactcad.parts.array.board_plate import PITCH

Span = tuple[float, float]
BOARD_TOLERANCE = PLACING = 0.1  # mm, IPC-7351B
TOE, HEEL, SIDE = 0.35, 0.35, 0.03  # mm, gull wings of more than 0.625 mm pitch, level B
FINE_SIDE = -0.02  # mm, of finer pitch
# mm, of terminals below a body, level B; chosen: side 0.01, heel 0.03 less, for 0.2 between pads at corners
NO_LEAD_TOE, NO_LEAD_HEEL, NO_LEAD_SIDE = 0.3, -0.03, -0.05
FLUSH = "QFN-16-FLUSH"
FLUSH_TOE = 0.1  # mm; chosen, for chips 4 mm apart: level C asks for 0.2; solder below the terminal holds
CHIP_TOE, CHIP_HEEL, CHIP_SIDE = 0.35, -0.05, 0.0  # mm, chips from 1608 on, level B
LEAST_GAP = 0.2  # mm between pads
COURTYARD = 0.25  # mm around pads and body, level B
PIN_PAD, PIN_DRILL = 1.7, 1.0  # mm; square pins of 0.64 have a diagonal of 0.9
RADIAL_PAD, RADIAL_DRILL, RADIAL_PITCH = 1.5, 0.8, 3.81  # mm; leads of 0.64


@dataclass(frozen=True)
class Pad:
    """mm from the footprint's middle; `drill` 0 of a surface pad; `round` of a round or oval one."""

    number: str
    x: float
    y: float
    w: float
    h: float
    drill: float = 0.0
    round: bool = False


@dataclass(frozen=True)
class Footprint:
    """A package's land pattern. `body` mm; `library` KiCad's own of the same package, "" for none; `height`
    mm above the board."""

    name: str
    pads: tuple[Pad, ...]
    body: tuple[float, float]
    height: float
    library: str
    source: str

    @cached_property
    def half(self) -> tuple[float, float]:
        """Half sides of the courtyard, mm."""
        return (
            max(self.body[0] / 2, *(abs(p.x) + p.w / 2 for p in self.pads)) + COURTYARD,
            max(self.body[1] / 2, *(abs(p.y) + p.h / 2 for p in self.pads)) + COURTYARD,
        )

    @property
    def through(self) -> bool:
        return any(p.drill for p in self.pads)


def _rms(*spans: float) -> float:
    return sqrt(sum(s**2 for s in (*spans, BOARD_TOLERANCE, PLACING)))


def _land(
    length: Span, terminal: Span, width: Span, toe: float, heel: float, side: float
) -> tuple[float, float, float]:
    """Middle of a pad from the footprint's, its length, its width, mm."""
    spread, each = length[1] - length[0], terminal[1] - terminal[0]
    outer = length[0] + 2 * toe + _rms(spread)
    inside = sqrt(spread**2 + 2 * each**2)  # of the gap between two terminals
    widest = length[1] - 2 * terminal[0] - (spread + 2 * each - inside) / 2
    inner = widest - 2 * heel - _rms(inside)
    return (outer + inner) / 4, (outer - inner) / 2, width[0] + 2 * side + _rms(width[1] - width[0])


def gull_wings(
    name: str,
    count: int,
    pitch: float,
    length: Span,
    terminal: Span,
    width: Span,
    body: tuple[float, float],
    height: float,
    library: str,
    source: str,
    slug: tuple[float, float] = (0.0, 0.0),
) -> Footprint:
    """Two rows of leads; `slug` mm of a pad below the body, the last one."""
    at, long, wide = _land(length, terminal, width, TOE, HEEL, SIDE if pitch > 0.625 else FINE_SIDE)
    n, wide = count // 2, min(wide, pitch - LEAST_GAP)
    pads = [Pad(str(i + 1), -at, (i - (n - 1) / 2) * pitch, long, wide) for i in range(n)]
    pads += [Pad(str(n + i + 1), at, ((n - 1) / 2 - i) * pitch, long, wide) for i in range(n)]
    if slug[0]:
        pads.append(Pad(str(count + 1), 0.0, 0.0, *slug))
    return Footprint(name, _rounded(pads), body, height, library, source)


def chip(
    name: str, length: Span, terminal: Span, width: Span, height: float, library: str, source: str
) -> Footprint:
    """Two ends."""
    at, long, wide = _land(length, terminal, width, CHIP_TOE, CHIP_HEEL, CHIP_SIDE)
    pads = [Pad("1", -at, 0.0, long, wide), Pad("2", at, 0.0, long, wide)]
    return Footprint(name, _rounded(pads), (length[1], width[1]), height, library, source)


def no_leads(
    name: str, side: int, pitch: float, length: Span, terminal: Span, width: Span, slug: float, height: float,
    library: str, source: str, toe: float = NO_LEAD_TOE,
) -> Footprint:  # fmt: skip
    """Terminals on four sides, so many a side; the last pad is a square below the body, `slug` mm."""
    at, long, wide = _land(length, terminal, width, toe, NO_LEAD_HEEL, NO_LEAD_SIDE)
    wide = min(wide, pitch - LEAST_GAP)
    steps = [(i - (side - 1) / 2) * pitch for i in range(side)]
    pads = [(-at, y, long, wide) for y in steps] + [(x, at, wide, long) for x in steps]
    pads += [(at, -y, long, wide) for y in steps] + [(-x, -at, wide, long) for x in steps]
    numbered = [Pad(str(i), *pad) for i, pad in enumerate([*pads, (0.0, 0.0, slug, slug)], start=1)]
    return Footprint(name, _rounded(numbered), (length[1], length[1]), height, library, source)


def _sot_23() -> Footprint:
    at, long, wide = _land((2.1, 2.64), (0.4, 0.6), (0.3, 0.5), TOE, HEEL, SIDE)
    pads = [Pad("1", -at, -0.95, long, wide), Pad("2", -at, 0.95, long, wide), Pad("3", at, 0.0, long, wide)]
    library = "Package_TO_SOT_SMD:SOT-23"
    return Footprint("SOT-23", _rounded(pads), (1.4, 3.04), 1.12, library, "JEDEC TO-236 AB")


def _rounded(pads: list[Pad]) -> tuple[Pad, ...]:
    return tuple(Pad(p.number, round(p.x, 3), round(p.y, 3), round(p.w, 3), round(p.h, 3)) for p in pads)


@lru_cache
def pin_header(pins: int) -> Footprint:
    """In a row along x, pin 1 to the left."""
    pads = tuple(
        Pad(str(i + 1), (i - (pins - 1) / 2) * PITCH, 0.0, PIN_PAD, PIN_PAD, PIN_DRILL, True)
        for i in range(pins)
    )
    library = f"Connector_PinHeader_2.54mm:PinHeader_1x{pins:02d}_P2.54mm_Vertical"
    return Footprint(
        f"pin-header-{pins}", pads, (pins * PITCH, PITCH), 8.5, library, "pins 0.64 mm square, 2.54 mm"
    )


QFN_16 = (4, 0.5, (2.9, 3.1), (0.3, 0.5), (0.18, 0.30), 1.45, 0.9)
FOOTPRINTS = {
    f.name: f
    for f in (
        gull_wings(
            "TSSOP-28", 28, 0.65, (6.2, 6.6), (0.45, 0.75), (0.19, 0.30), (4.4, 9.7), 1.2,
            "Package_SO:TSSOP-28_4.4x9.7mm_P0.65mm", "JEDEC MO-153 AE",
        ),
        gull_wings(
            "TSSOP-16", 16, 0.65, (6.2, 6.6), (0.45, 0.75), (0.19, 0.30), (4.4, 5.0), 1.2,
            "Package_SO:TSSOP-16_4.4x5mm_P0.65mm", "JEDEC MO-153 AB",
        ),
        gull_wings(
            "SOIC-16", 16, 1.27, (5.8, 6.2), (0.4, 1.27), (0.31, 0.51), (3.9, 9.9), 1.75,
            "Package_SO:SOIC-16_3.9x9.9mm_P1.27mm", "JEDEC MS-012 AC",
        ),
        gull_wings(
            "SOIC-8", 8, 1.27, (5.8, 6.2), (0.4, 1.27), (0.31, 0.51), (3.9, 4.9), 1.75,
            "Package_SO:SOIC-8_3.9x4.9mm_P1.27mm", "JEDEC MS-012 AA",
        ),
        gull_wings(
            "MSOP-10-EP", 10, 0.5, (4.75, 5.05), (0.4, 0.7), (0.17, 0.27), (3.0, 3.0), 1.1,
            "Package_SO:MSOP-10-1EP_3x3mm_P0.5mm_EP1.68x1.88mm", "JEDEC MO-187 BA-T", slug=(1.68, 1.88),
        ),
        no_leads(
            "LFCSP-32", 8, 0.5, (4.9, 5.1), (0.3, 0.5), (0.18, 0.30), 3.6, 0.8,
            "Package_CSP:LFCSP-32-1EP_5x5mm_P0.5mm_EP3.6x3.6mm", "JEDEC MO-220 VHHD",
        ),
        no_leads(
            "QFN-16", *QFN_16,
            "Package_DFN_QFN:QFN-16-1EP_3x3mm_P0.5mm_EP1.45x1.45mm", "JEDEC MO-220 VEED",
        ),
        no_leads(FLUSH, *QFN_16, "", "JEDEC MO-220 VEED", toe=FLUSH_TOE),
        chip(
            "0603", (1.45, 1.75), (0.2, 0.5), (0.65, 0.95), 0.95,
            "Capacitor_SMD:C_0603_1608Metric", "EIA 0603",
        ),
        chip(
            "0805", (1.8, 2.2), (0.3, 0.7), (1.1, 1.4), 1.3,
            "Resistor_SMD:R_0805_2012Metric", "EIA 0805, IEC 60115-8",
        ),
        chip(
            "1206", (3.0, 3.4), (0.25, 0.75), (1.4, 1.8), 1.8,
            "Capacitor_SMD:C_1206_3216Metric", "EIA 1206",
        ),
        chip(
            "SOD-123", (3.55, 3.85), (0.25, 0.65), (0.4, 0.7), 1.35,
            "Diode_SMD:D_SOD-123", "JEDEC DO-219 AB",
        ),
        _sot_23(),
        Footprint(
            "radial",
            tuple(
                Pad(n, x, 0.0, RADIAL_PAD, RADIAL_PAD, RADIAL_DRILL, True)
                for n, x in (("1", -RADIAL_PITCH / 2), ("2", RADIAL_PITCH / 2))
            ),
            (7.62, 2.67), 8.28, "", "Vishay Foil Resistors S series: leads 0.64 mm, 3.81 mm apart",
        ),
    )
}  # fmt: skip


def footprint(name: str) -> Footprint:
    """The footprint of a name; pin headers by `pin-header-` and their pins. Raises KeyError for one that is
    not known."""
    return pin_header(int(name.rpartition("-")[2])) if name.startswith("pin-header-") else FOOTPRINTS[name]
