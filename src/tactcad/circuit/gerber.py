"""A board's files for who makes it: Gerber X2 layers (Ucamco's format, 2022.02), drills (XNC) and the table
of places for the machine that fits the components. mm; y points up, from the lower left corner.
"""

from __future__ import annotations

from collections.abc import Iterable

from tactcad.design.files import as_csv

from .copper import LAYERS, PLANES, TOP, VIA, VIA_DRILL, BoardCopper, Point
from .printed import INK, printed

MASK = 0.05  # mm that the mask's openings reach beyond the pads; chosen: board houses ask for 0.05 to 0.1
OUTLINE = 0.1  # mm, the drawn width of the board's edge
FUNCTIONS = {
    "F_Cu": "Copper,L1,Top",
    "In1_Cu": "Copper,L2,Inr",
    "In2_Cu": "Copper,L3,Inr",
    "B_Cu": "Copper,L4,Bot",
    "F_Mask": "Soldermask,Top",
    "B_Mask": "Soldermask,Bot",
    "F_Paste": "Paste,Top",
    "F_Silkscreen": "Legend,Top",
    "Edge_Cuts": "Profile,NP",
}
Flash = tuple[Point, float, float, bool]  # where, width, height, round
Line = tuple[Point, Point, float]


def gerber_files(board: BoardCopper, name: str, date: str) -> dict[str, bytes]:
    """Every layer and both drill files; `name` is printed on the board."""
    pads = [(at, *placed.size(pad), pad.round, pad) for placed, pad, at, _ in board.pads]
    vias = [(v.at, VIA, VIA, True) for v in board.vias]
    through: list[Flash] = [(at, w, h, r) for at, w, h, r, pad in pads if pad.drill]
    surface: list[Flash] = [(at, w, h, r) for at, w, h, r, pad in pads if not pad.drill]
    holes: list[Flash] = [((x, y), d, d, True) for x, y, d in board.holes]
    inner = through + vias
    made: dict[str, bytes] = {}
    for layer in LAYERS:
        lines = [(t.start, t.end, t.width) for t in board.tracks if t.layer == layer]
        region = board.outlines[layer] if layer in PLANES else ()
        flashes = inner + surface if layer == TOP else inner
        made[layer.replace(".", "_")] = _layer(board, layer.replace(".", "_"), date, flashes, lines, region)
    for layer, flashes in (("F_Mask", through + surface + holes), ("B_Mask", through + holes)):
        opened = [(at, w + 2 * MASK, h + 2 * MASK, r) for at, w, h, r in flashes]
        made[layer] = _layer(board, layer, date, opened)
    made["F_Paste"] = _layer(board, "F_Paste", date, surface)
    ink = [(a, b, INK) for a, b in printed(board, name)]
    made["F_Silkscreen"] = _layer(board, "F_Silkscreen", date, [], ink)
    corners = board.corners()
    edge = [(a, b, OUTLINE) for a, b in zip(corners, corners[1:] + corners[:1])]
    made["Edge_Cuts"] = _layer(board, "Edge_Cuts", date, [], edge)
    files = {f"{layer}.gbr": data for layer, data in made.items()}
    plated = [(VIA_DRILL, v.at, "ViaDrill") for v in board.vias]
    plated += [(pad.drill, at, "ComponentDrill") for _, pad, at, _ in board.pads if pad.drill]
    bare = [(d, (x, y), "MechanicalDrill") for x, y, d in board.holes]
    files["PTH.drl"] = _drills(board, date, plated, "Plated,1,4,PTH")
    files["NPTH.drl"] = _drills(board, date, bare, "NonPlated,1,4,NPTH")
    return files


def _layer(
    board: BoardCopper,
    layer: str,
    date: str,
    flashes: Iterable[Flash],
    lines: Iterable[Line] = (),
    region: Iterable[Point] = (),
) -> bytes:
    def at(p: Point) -> str:
        return f"X{round(p[0] * 1e6)}Y{round((board.height - p[1]) * 1e6)}"

    out: list[str] = []
    apertures: dict[str, int] = {}

    def aperture(shape: str) -> str:
        return f"D{apertures.setdefault(shape, 10 + len(apertures))}*"

    if ring := list(region):
        out += ["G36*", f"{at(ring[0])}D02*", *(f"{at(p)}D01*" for p in (*ring[1:], ring[0])), "G37*"]
    for (start, end), width in (((a, b), w) for a, b, w in lines):
        out += [aperture(f"C,{width:.6f}"), f"{at(start)}D02*", f"{at(end)}D01*"]
    for where, w, h, round_ in flashes:
        out += [aperture(f"C,{w:.6f}" if round_ else f"R,{w:.6f}X{h:.6f}"), f"{at(where)}D03*"]
    head = [
        "%TF.GenerationSoftware,tactcad,tactcad*%",
        f"%TF.CreationDate,{date}T00:00:00Z*%",
        "%TF.SameCoordinates,Original*%",
        f"%TF.FileFunction,{FUNCTIONS[layer]}*%",
        f"%TF.FilePolarity,{'Negative' if 'Mask' in layer else 'Positive'}*%",
        "%FSLAX46Y46*%",
        "%MOMM*%",
        "%LPD*%",
        "G01*",
        *(f"%ADD{number}{shape}*%" for shape, number in apertures.items()),
    ]
    return ("\n".join([*head, *out, "M02*"]) + "\n").encode()


def _drills(
    board: BoardCopper, date: str, drills: Iterable[tuple[float, Point, str]], function: str
) -> bytes:
    tools: dict[tuple[float, str], list[Point]] = {}
    for diameter, at, what in drills:
        tools.setdefault((diameter, what), []).append(at)
    lines = ["M48", f"; #@! TF.CreationDate,{date}T00:00:00Z", f"; #@! TF.FileFunction,{function}", "METRIC"]
    for i, (diameter, what) in enumerate(sorted(tools), start=1):
        plating = "NonPlated,NPTH" if what == "MechanicalDrill" else "Plated,PTH"
        lines += [f"; #@! TA.AperFunction,{plating},{what}", f"T{i}C{diameter:.3f}"]
    lines += ["%", "G90", "G05"]
    for i, tool in enumerate(sorted(tools), start=1):
        lines += [f"T{i}", *(f"X{x:.3f}Y{board.height - y:.3f}" for x, y in sorted(tools[tool]))]
    return ("\n".join([*lines, "M30"]) + "\n").encode()


def places_csv(board: BoardCopper) -> bytes:
    """For machine-fitted components: designator, value, package, middle, turn. Unfitted ones are left out."""
    rows = [("designator", "value", "part_no", "package", "x_mm", "y_mm", "rotation", "side")]
    for placed in board.placed:
        c, (x, y) = placed.component, placed.at
        if c.fitted and not placed.footprint.through:
            row = (c.designator, c.value, c.part_no, c.footprint, f"{x:.3f}", f"{board.height - y:.3f}")
            rows.append((*row, f"{placed.turn}", "top"))
    return as_csv(rows)
