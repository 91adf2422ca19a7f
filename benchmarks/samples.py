"""Designs on which the ladder's constants are fitted and its errors measured, and their results by elements.

Four kinds: the promised box and beyond it, the box's edges, the whole range of the groups, and its
corners. The tables lie in data/; a seed draws the same designs again.
"""

from __future__ import annotations

import csv
import io
import math
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tactcad.design.files import write_whole
from tactcad.design.messages import InputError
from tactcad.fem.face_strain import face_strain, readings, solid_readings
from tactcad.fem.fem_ladder import converged_plane, converged_solid
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import validity
from tactcad.mechanics.register import ladder_data
from tactcad.mechanics.section import HingeSection

DATA = Path(__file__).parent / "data"
Columns = dict[str, NDArray[np.float64]]
Row = dict[str, float]

# The box over which the closed forms promise their error (mm; Poisson's ratio).
BOX = {
    "hinge_thickness": (0.15, 0.4),
    "hinge_length": (0.3, 1.5),
    "fillet_radius": (0.1, 0.3),
    "load_arm": (3.0, 7.0),
    "arm_height": (1.5, 3.0),
    "body_height": (3.0, 8.0),
    "body_length": (2.0, 6.0),
    "poisson": (0.2, 0.4),
    "width": (1.5, 8.0),
}
# Beyond the box, for small versions and short or deeply rounded slots; drawn by logarithm.
WIDE = {
    "hinge_thickness": (0.05, 0.4),
    "hinge_length": (0.1, 2.0),
    "fillet_radius": (0.03, 0.6),
    "load_arm": (2.0, 9.0),
    "arm_height": (1.2, 4.0),
    "body_height": (2.0, 10.0),
    "body_length": (1.0, 8.0),
    "poisson": (0.15, 0.45),
    "width": (1.0, 10.0),
}
LEAST_HEIGHT = 1.25  # height of arm and body over t + n r: below it there is no block behind the root
FILLET_RATIO = (0.15, 6.0)  # r/t
FULL_ROUND_SHARE = 0.1  # of the samples have r = l/2, so that lc = 0 is inside the fit
WIDE_SHARE = 0.4
EDGE_SHARE = 0.65  # of the parameters of a design on the box's edges lie at an end of their range
EDGE_PART = 3  # for so many designs inside the box one more lies on its edges
SEEDS = {"fitted": 20261121, "held out": 31415}
FILES = {
    "fitted": "ladder-samples.csv",
    "held out": "ladder-heldout.csv",
    "range": "ladder-range.csv",
    "corners": "ladder-corners.csv",
    "corners held out": "ladder-corners-heldout.csv",
    "narrow held out": "ladder-narrow-heldout.csv",
}
CLIMBED, CLIMBS = "climbed", "hinge-climbs.csv"  # hinge_climbs.py: designs at which rung solid errs most
GRIDS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0)  # gauge grid lengths sampled, in slot lengths

# The whole range: every length is a multiple of this thickness, and K/(E b) does not depend on size.
THICKNESS = 0.25  # mm
LONGEST_BODY = 141.0  # thicknesses: of the fit's samples; a longer one is a beam and only costs elements
RANGE_SEED = 1618
SOLID_PART, REFINED_PART = 8, 16  # two designs in so many are solved by solid elements, and by refined ones
REFINED_EDGES, REFINED_LENGTH = 12, 5.0  # designs on the box's edges that are refined; hinge thicknesses
# Largest number of elements in the plane, on its coarsest mesh, for which meshes 3 and 4 are still
# affordable. Above it the hinge is long and thin, and mesh 2 is more accurate.
MOST_CELLS = {2: 1000, 3: 80, 4: 45}
SECONDS = {
    "fem-plane": "seconds_plane",
    "fem-solid, mesh 2": "seconds_mesh_2",
    "fem-solid, mesh 3": "seconds_mesh_3",
}

# b/l under which a leaf, much longer than wide, curls over all of its width, and r/t from which fillets do.
# From the second b/l on it no longer does, whatever its fillets.
NARROW, LESS_NARROW, DEEP = 0.7, 1.5, 2.0
THICK = 6.0  # b/t under which the hinge is a bar, no leaf


# --- tables of designs ---


def as_written(rows: list[Row]) -> Columns:
    """Columns rounded to the digits that `write` keeps, so that the solved design is the one in the file."""
    return {k: np.array([float(f"{row[k]:.8g}") for row in rows]) for k in rows[0]}


def joined(tables: Sequence[Columns]) -> Columns:
    """The rows of several tables as one; a result that one of them lacks is NaN there."""
    names = list(dict.fromkeys(name for table in tables for name in table))
    return {
        name: np.concatenate([t.get(name, np.full(len(t["two_sided"]), math.nan)) for t in tables])
        for name in names
    }


def taken(columns: Columns, which: NDArray) -> Columns:
    """Those rows, by mask or index."""
    return {name: values[which] for name, values in columns.items()}


def section(columns: Columns) -> HingeSection:
    """The designs as one section of unit Young's modulus (stiffness is proportional to it)."""
    names = set(BOX) | {"two_sided"}
    return HingeSection.of(youngs_modulus=1.0, **{k: v for k, v in columns.items() if k in names})


def write(columns: Columns, path: Path) -> None:
    """Write columns as CSV, one line a design, eight digits."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in zip(*columns.values()):
        writer.writerow("" if math.isnan(v) else f"{v:.8g}" for v in row)
    write_whole(path, text.getvalue().encode())


def load(path: Path) -> Columns:
    """The columns that `write` wrote. Raises InputError if the file is something else."""
    try:
        rows = list(csv.DictReader(path.read_text("utf-8").splitlines()))
        return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}
    except (OSError, IndexError, TypeError, ValueError) as error:
        raise InputError(str(path), f"not the samples of an earlier fit: {error}") from None


def shipped_table(kind: str) -> Columns:
    """A committed sample, by its name in FILES."""
    return load(DATA / FILES[kind])


def shipped() -> dict[str, Columns]:
    """All committed samples: those "held out" are kept out of the fit, and those "climbed" to."""
    return {kind: shipped_table(kind) for kind in FILES} | {CLIMBED: load(DATA / CLIMBS)}


def solved(columns: Columns, results: Callable[[int, HingeSection], Row], what: str = "") -> Columns:
    """The designs with `results` of each (its number, its scalars) in further columns, NaN if it has none.

    Progress goes to standard error under the name `what`.
    """
    s, count, rows = section(columns), len(columns["two_sided"]), []
    for i in range(count):
        rows.append(results(i, s.rows(i)))
        if what and (i + 1) % 20 == 0:
            print(f"{what}: {i + 1} of {count} designs", file=sys.stderr, flush=True)
    names = list(dict.fromkeys(name for row in rows for name in row))
    return columns | {name: np.array([row.get(name, math.nan) for row in rows]) for name in names}


# --- drawing ---


def drawn(
    count: int, seed: int, make: Callable[[np.random.Generator, bool], Row], possible: Callable[[Row], bool]
) -> Columns:
    """`count` designs (mm) that `make` gives and `possible` accepts; every second one is two-sided."""
    rng, rows = np.random.default_rng(seed), list[Row]()
    while len(rows) < count:
        two_sided = bool(len(rows) % 2)
        row = make(rng, two_sided) | {"two_sided": float(two_sided)}
        if possible(row):
            rows.append(row)
    return as_written(rows)


def _possible(row: Row) -> bool:
    depth = row["hinge_thickness"] + (1.0 + row["two_sided"]) * row["fillet_radius"]
    reach = row["load_arm"] - row["hinge_length"] / 2.0
    return (
        2.0 * row["fillet_radius"] <= row["hinge_length"]
        and min(row["arm_height"], row["body_height"]) >= LEAST_HEIGHT * depth
        and FILLET_RATIO[0] <= row["fillet_radius"] / row["hinge_thickness"] <= FILLET_RATIO[1]
        and reach >= row["arm_height"] / 2.0
        and row["body_length"] >= 0.2 * row["body_height"]
    )


def draw(count: int, seed: int) -> Columns:
    """Designs inside the promised box and beyond it."""

    def make(rng: np.random.Generator, two_sided: bool) -> Row:
        if rng.random() < WIDE_SHARE:
            row = {k: math.exp(rng.uniform(math.log(a), math.log(b))) for k, (a, b) in WIDE.items()}
        else:
            row = {k: rng.uniform(*v) for k, v in BOX.items()}
        if rng.random() < FULL_ROUND_SHARE:
            row["hinge_length"] = 2.0 * row["fillet_radius"]
        return row

    return drawn(count, seed, make, _possible)


def draw_box(count: int, seed: int) -> Columns:
    """Designs inside the promised box only, uniformly drawn."""
    return drawn(count, seed, lambda rng, _: {k: rng.uniform(*v) for k, v in BOX.items()}, _possible)


def draw_edges(count: int, seed: int) -> Columns:
    """Designs on the promised box's edges and corners: each parameter at an end of its range, or inside."""

    def make(rng: np.random.Generator, two_sided: bool) -> Row:
        row = {
            k: v[rng.integers(2)] if rng.random() < EDGE_SHARE else rng.uniform(*v) for k, v in BOX.items()
        }
        row["fillet_radius"] = min(row["fillet_radius"], row["hinge_length"] / 2.0)
        return row

    return drawn(count, seed, make, _possible)


def designs(kind: str, count: int) -> tuple[Columns, Columns]:
    """`count` designs inside the promised box ("fitted": beyond it too), and a third as many on its edges."""
    inside = draw if kind == "fitted" else draw_box
    return inside(count, SEEDS[kind]), draw_edges(count // EDGE_PART, SEEDS[kind] + 1)


def draw_range(count: int, seed: int = RANGE_SEED, end_share: float | None = None) -> Columns:
    """Designs over the whole range of rung solid, every group drawn uniformly in its logarithm, or, with the
    chance `end_share`, at an end of its range."""
    ranges = ladder_data()["range"]["groups"]

    def group(rng: np.random.Generator, ends: list[float]) -> float:
        if end_share is not None and rng.random() < end_share:
            return float(rng.choice(ends))
        return math.exp(rng.uniform(math.log(ends[0]), math.log(ends[1])))

    def make(rng: np.random.Generator, two_sided: bool) -> Row:
        g = {name: group(rng, ends) for name, ends in ranges.items()}
        t, full_round = THICKNESS, rng.random() < FULL_ROUND_SHARE
        length, height, body = g["l/t"] * t, g["h/t"] * t, g["Hb/t"] * t
        return {
            "hinge_thickness": t,
            "hinge_length": length,
            "fillet_radius": length / 2.0 if full_round else g["r/t"] * t,
            "load_arm": g["(L - l/2)/h"] * height + length / 2.0,
            "arm_height": height,
            "body_height": body,
            "body_length": g["Lb/Hb"] * body,
            "poisson": g["poisson"],
            "width": g["b/t"] * t,
        }

    def possible(row: Row) -> bool:
        too_long = row["body_length"] > LONGEST_BODY * THICKNESS
        return not too_long and not validity.broken_rules(section(as_written([row])), "solid")

    return drawn(count, seed, make, possible)


def draw_refined(count: int = REFINED_EDGES, seed: int = RANGE_SEED + 1) -> Columns:
    """`count` designs on the promised box's edges whose hinges are short enough to be refined to mesh 4."""
    edges = draw_edges(6 * count, seed)
    s = section(edges)
    return taken(edges, np.flatnonzero(s.hinge_length < REFINED_LENGTH * s.hinge_thickness)[:count])


# --- corners: the range is a polytope in the logarithms of its groups; each parameter is drawn in turn from
# the interval that those before it leave, and is as often at an end of that interval as inside ---

# Shares of the parameters at the low and at the high end of their intervals. For the slot's length the shares
# are smaller: the longest need the most elements, the shortest the finest. Widths are mostly the smallest,
# at which the sheet is neither in plane stress nor in plane strain.
ENDS, SLOT_ENDS, WIDTH_ENDS = (0.25, 0.25), (0.1, 0.1), (0.5, 0.1)
# Shortest body, in hinge thicknesses: that of the fit before these designs entered it (2.75 since).
LEAST_BODY = 2.76
INWARD = 1e-6  # relative: a written corner is still inside
FEW = 150  # quadratic elements, layers that grow by 1.8 from half a thickness: some seconds a design


def _narrow_and_deep(s: HingeSection, low: float, high: float) -> np.ndarray:
    deep = s.two_sided & (s.fillet_radius >= DEEP * s.hinge_thickness)
    return (s.width >= low * s.hinge_length) & (s.width < high * s.hinge_length) & deep


def _narrow(s: HingeSection) -> np.ndarray:
    return s.width < NARROW * s.hinge_length


@dataclass(frozen=True)
class Draw:
    """How many designs are drawn, how many of the first are solved as solids at any cost, the seed, and which
    are kept (all by default)."""

    count: int
    solids: int
    seed: int
    kept: Callable[[HingeSection], np.ndarray] = lambda s: np.full(s.shape, True)

    def designs(self, most: int | None = None) -> Columns:
        corners = draw_corners(self.count, self.seed)
        return taken(corners, np.flatnonzero(self.kept(section(corners)))[:most])


# Few designs in the corners are narrow: those on which errors are measured have draws of their own.
DRAWS = {
    "corners": (Draw(240, 60, 271828), Draw(100, 0, 141421), Draw(66, 0, 577215)),
    "corners held out": (Draw(38, 0, 161803),),
    "narrow held out": (
        Draw(40, 40, 662607, _narrow),
        Draw(32, 32, 693147, lambda s: _narrow_and_deep(s, 0.0, NARROW)),
        Draw(600, 600, 173205, lambda s: _narrow(s) & (s.width < THICK * s.hinge_thickness)),
        Draw(500, 500, 141592, lambda s: _narrow_and_deep(s, NARROW, LESS_NARROW)),
    ),
}


def draw_corners(count: int, seed: int) -> Columns:
    """Up to `count` designs in corners, on edges and inside of solid's range; those that another rule refuses
    are dropped."""

    def finite(row: Row) -> bool:
        return all(map(math.isfinite, row.values()))

    corners = drawn(count, seed, _corner, finite)
    return taken(corners, validity.reasons(section(corners), "solid") == "")


def _corner(rng: np.random.Generator, two_sided: bool) -> Row:
    """One design; it holds NaN if the first parameters leave no interval for the rest."""
    sampled = ladder_data()["range"]
    g, low_block = sampled["groups"], sampled["least_height"]

    def pick(*bounds: tuple[float, float], ends: tuple[float, float] = ENDS) -> float:
        low = max(b[0] for b in bounds) * (1.0 + INWARD)
        high = min(b[1] for b in bounds) * (1.0 - INWARD)
        at, inside = rng.random(2)
        if not low <= high:
            return math.nan
        if at < sum(ends):
            return low if at < ends[0] else high
        return low * (high / low) ** inside

    def times(name: str, size: float, less: float = 0.0) -> tuple[float, float]:
        return g[name][0] * size - less, g[name][1] * size - less

    # in hinge thicknesses
    length = pick(times("l/t", 1.0), ends=SLOT_ENDS)
    radius = pick(times("r/t", 1.0), (0.0, length / 2.0))
    block = (low_block * (1.0 + (1 + two_sided) * radius), math.inf)
    arm_height = pick(times("h/t", 1.0), block)
    body_height = pick(times("Hb/t", 1.0), block)
    reach = pick(times("(L - l/2)/h", arm_height), times("L/Hb", body_height, length / 2.0))
    body_length = pick(times("Lb/Hb", body_height), (LEAST_BODY, LONGEST_BODY))
    poisson = pick(times("poisson", 1.0))
    sizes = {"b/t": 1.0, "b/l": length, "b/h": arm_height, "b/Hb": body_height}
    width = pick(*(times(name, size) for name, size in sizes.items()), ends=WIDTH_ENDS)
    return {
        "hinge_thickness": THICKNESS,
        "hinge_length": length * THICKNESS,
        "fillet_radius": radius * THICKNESS,
        "load_arm": (reach + length / 2.0) * THICKNESS,
        "arm_height": arm_height * THICKNESS,
        "body_height": body_height * THICKNESS,
        "body_length": body_length * THICKNESS,
        "poisson": poisson,
        "width": width * THICKNESS,
    }


def draw_all(kind: str) -> Columns:
    """The designs of a sample of DRAWS."""
    return joined([draw.designs() for draw in DRAWS[kind]])


# --- results of one design (scalars), of unit modulus ---


def plane_results(s: HingeSection) -> Row:
    """Plane-stress stiffness of unit width, and face strains over nominal."""
    shape, nu, L, t = reference_shape(s), float(s.poisson), float(s.load_arm), float(s.hinge_thickness)
    plane = converged_plane(shape, 1.0, nu, 1.0)
    nominal = 6.0 * L / (t * t)
    slot, flat = face_strain(plane.plane, "slot"), face_strain(plane.plane, "flat")
    result = {
        "plane_stiffness": plane.stiffness,
        "slot_peak": slot.peak / nominal,
        "flat_peak": flat.peak / nominal,
        "flat_centre": flat.centre / nominal,
    }
    for grid in GRIDS:
        fits = not bool(s.two_sided) or grid <= 1.0
        mean = float(flat.mean(grid * float(s.hinge_length))) / nominal if fits else math.nan
        result[f"grid_{grid:g}"] = mean
    return result


def solid_results(s: HingeSection) -> Row:
    """K3D/K2D of rung fem-solid, and mid-width over plane strain, per newton."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    solid = converged_solid(shape, 1.0, nu, b)
    grid = 0.5 * float(s.hinge_length)
    over_plane = solid_readings(solid.plane, solid.solids, grid) / readings(solid.plane, grid)
    return {
        "width_factor": solid.stiffness / converged_plane(shape, 1.0, nu, b).stiffness,
        "mid_grid_ratio": float(over_plane.gauge),
        "mid_peak_ratio": over_plane.fillet_strain,
    }


def range_results(s: HingeSection, meshes: tuple[int, ...]) -> Row:
    """Stiffness by plane elements (unit width) and by fem-solid on these meshes, with processor seconds."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    names = ("plane_stiffness", "solid_mesh_2", "solid_mesh_3", "solid_mesh_4", *SECONDS.values())
    result = dict.fromkeys(names, math.nan)
    start = time.process_time()
    result["plane_stiffness"] = converged_plane(shape, 1.0, nu, 1.0).stiffness
    result["seconds_plane"] = time.process_time() - start
    cells = len(plane_mesh(shape, 1).cells)
    for mesh in (m for m in meshes if cells <= MOST_CELLS[m]):
        start = time.process_time()
        result[f"solid_mesh_{mesh}"] = converged_solid(shape, 1.0, nu, b, mesh=mesh).stiffness
        if mesh < 4:
            result[f"seconds_mesh_{mesh}"] = time.process_time() - start
    return result


def meshes_of(i: int) -> tuple[int, ...]:
    """fem-solid's meshes for the i-th design of the range; designs of both notch forms in turn."""
    pair = i // 2
    return () if pair % (SOLID_PART // 2) else (2,) if pair % (REFINED_PART // 2) else (2, 3, 4)


def with_width_factor(columns: Columns) -> Columns:
    """The range's columns with K3D/K2D by the finest solid mesh on which each design was solved."""
    stiffness = np.full(len(columns["width"]), math.nan)
    for name in ("solid_mesh_2", "solid_mesh_3", "solid_mesh_4"):
        stiffness = np.where(np.isfinite(columns[name]), columns[name], stiffness)
    return columns | {"width_factor": stiffness / (columns["plane_stiffness"] * columns["width"])}


def corner_results(s: HingeSection, as_solid: bool) -> Row:
    """Stiffness by plane elements (unit width), and K3D/K2D if it is wanted or costs few elements; short
    hinges by finer solid elements."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    plane = converged_plane(shape, 1.0, nu, 1.0).stiffness
    if not (as_solid or few_elements(s)):
        return {"plane_stiffness": plane, "width_factor": math.nan}
    mesh = 3 if float(s.hinge_length) < float(s.hinge_thickness) else 2
    solid = converged_solid(shape, 1.0, nu, b, mesh=mesh).stiffness
    return {"plane_stiffness": plane, "width_factor": solid / (plane * b)}


def few_elements(s: HingeSection) -> bool:
    """Whether a design is cheap by solid elements: narrow, and neither long nor deep."""
    across = math.log1p(0.8 * float(s.width / s.hinge_thickness)) / math.log(1.8)
    return len(plane_mesh(reference_shape(s), 1).cells) * max(1, round(across)) <= FEW
