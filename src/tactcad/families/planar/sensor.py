"""Every cell's figures: stiffness, forces at yield and at its stop, its chip's field, the smallest force
resolved."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import Any, cast

import numpy as np

from tactcad.design.allowance import Allowance
from tactcad.design.materials import Alloy
from tactcad.design.messages import InputError
from tactcad.mechanics.strength import goodman
from tactcad.report.figures import aligned

from . import beam
from .beam import Array
from .cell import unit_loads, wrench
from .cell_layout import Kind, PlanarLayout
from .cell_tables import Chip, PlanarDesign
from .field import STEP, felt, field, sensitivity

NEIGHBOURS = 3  # pitches away at which a neighbour's field still counts: beyond, under 1 % of the nearest's


@dataclass(frozen=True)
class CellEstimate:
    """One cell; N, mm, N/mm, MPa, mT.

    stiffness, shear_stiffness  at the pad, along z and across
    expected_error              of the stiffness, against solid elements, relative
    fatigue_factor              Goodman's at the rated force, put on and off, by the von Mises stress
    rated_force                 the lesser of the force asked for and yield over its factor, with the rated
                                shear
    stop_force                  at which the island meets the base
    linear_force                up to which K stays within rating.linearity
    field                       at the chip, cell at rest
    condition, matrix_change    of the 3 x 3 matrix at rest; its largest change up to the rated force
    force_noise                 of fx, fy and fz, from one reading's noise
    """

    number: int
    kind: str
    arm: float
    stiffness: float
    shear_stiffness: float
    expected_error: float
    force: float
    sink: float
    stress: float
    yield_force: float
    rated_force: float
    fatigue_factor: float
    elastic: bool
    stop_force: float
    linear_force: float
    field: float
    signal: float
    condition: float
    matrix_change: float
    force_noise_x: float
    force_noise_z: float
    gauge_strain: None = None
    peak_strain: float = 0.0


def pad_compliance(kind: Kind, height: float) -> Array:
    """The pad's motion under a force on it, mm/N, 3 x 3."""
    load = unit_loads(height)
    return load.T @ kind.cell.compliance @ load


def chip_matrix(layout: PlanarLayout, kind: Kind) -> Array:
    """The field's change at the chip by a force on the pad, mT/N, 3 x 3, about the cell at rest."""
    _, slope = sensitivity(layout.magnet, layout.design.hall.gap, magnet_lever(layout))
    return slope @ kind.cell.compliance @ unit_loads(layout.pad_height)


def matrix_change(layout: PlanarLayout, kind: Kind) -> float:
    """Largest change of `chip_matrix` up to the rated force with its shear, over its largest entry."""
    rest, cell = chip_matrix(layout, kind), kind.cell
    moved = cell.compliance @ _sheared(layout) * rated_force(layout, kind)[1]
    moved[2:3] = cell.sunk(moved[2:3])
    stiffer = np.array([1.0, 1.0, 1.0 + 3.0 * cell.stiffening * moved[2] ** 2, 1.0, 1.0, 1.0])
    fields = felt(layout.magnet, layout.design.hall.gap, magnet_lever(layout), moved + 1j * STEP * np.eye(6))
    there = fields.imag.T / STEP / stiffer @ cell.compliance @ unit_loads(layout.pad_height)
    return float(np.abs(there - rest).max() / np.abs(rest).max())


def magnet_lever(layout: PlanarLayout) -> float:
    """From the island's mid-plane down to the magnet's lower face, mm."""
    return layout.design.planar.thickness / 2.0 + layout.design.magnet.height


def largest_field(layout: PlanarLayout, kind: Kind) -> float:
    """At the chip, at rest or at the rated force with its shear, mT."""
    motion = kind.cell.compliance @ _sheared(layout) * rated_force(layout, kind)[1]
    at_rated = felt(layout.magnet, layout.design.hall.gap, magnet_lever(layout), motion)
    return max(field_at_rest(layout), float(np.abs(at_rated).max()))


def field_at_rest(layout: PlanarLayout) -> float:
    return float(np.abs(sensitivity(layout.magnet, layout.design.hall.gap, magnet_lever(layout))[0]).max())


def force_noise(chip: Chip, matrix: Array) -> Array:
    """Of one reading's noise, N, of fx, fy and fz."""
    return np.sqrt(((np.linalg.inv(matrix) * reading_noise(chip)) ** 2).sum(axis=1))


def reading_noise(chip: Chip) -> Array:
    """Of one reading of the three fields, mT."""
    return 1e-3 * np.array([chip.noise_xy, chip.noise_xy, chip.noise_z])


def rated_stress(layout: PlanarLayout, kind: Kind) -> float:
    """Stress of 1 N down with the rated shear, its own error added, MPa."""
    return kind.cell.stress(_sheared(layout)) * (1.0 + stress_error(kind.bevel))


def _sheared(layout: PlanarLayout) -> Array:
    """Wrench of 1 N down with the rated shear."""
    return wrench(np.array([layout.design.rating.shear, 0.0, -1.0]), layout.pad_height)


def stress_error(bevel: float) -> float:
    """Stated error of the beams' stress: the largest that a climb found, of any mode; of beveled beams at
    least that of plain ones."""
    return _largest(beam.stress_errors(), beam.bevel_errors()["stress"] if bevel else {})


def stiffness_error(bevel: float) -> float:
    """Stated error of the beams' stiffness, likewise."""
    return _largest(beam.fit()["errors"], beam.bevel_errors()["stiffness"] if bevel else {})


def _largest(*reports: dict[str, dict[str, float]]) -> float:
    return max(mode["climbed"] for report in reports for mode in report.values())


def rated_force(layout: PlanarLayout, kind: Kind) -> tuple[float, float]:
    """Force at yield together with the rated shear, and rated force, N."""
    at_yield = layout.design.material.yield_strength / rated_stress(layout, kind)
    return at_yield, min(layout.design.rating.force, at_yield / layout.design.rating.yield_factor)


def closing_force(layout: PlanarLayout, kind: Kind) -> float:
    """At which the island meets the base, N: its stiffness grows with the sink (cell.stiffening)."""
    z, cell = kind.table.stop_gap, kind.cell
    return float(z / cell.compliance[2, 2] * (1.0 + cell.stiffening * z**2))


def lowest(layout: PlanarLayout, kind: Kind, force: float) -> float:
    """How deep the island's corner gets under a force with the rated shear towards it, mm."""
    c = kind.cell.compliance
    tilt = layout.design.rating.shear * force * layout.pad_height * float(c[4, 4])
    return float(kind.cell.sunk(force * c[2, 2:3])[0]) + tilt * kind.corner


def aside(layout: PlanarLayout, kind: Kind) -> float:
    """How far a post moves sideways at the cover's upper face by the rated shear, mm."""
    shear = np.array([layout.design.rating.shear * rated_force(layout, kind)[1], 0.0, 0.0])
    motion = kind.cell.compliance @ wrench(shear, layout.pad_height)
    return float(motion[0] + motion[4] * (layout.pad_height - layout.design.post.stand_out))


def neighbours_field(layout: PlanarLayout) -> float:
    """Largest field of the other cells' magnets at a chip, mT, all at rest: known, and subtracted."""
    p, gap = layout.design.planar, layout.design.hall.gap
    across, up = (min(NEIGHBOURS, n - 1) for n in (p.columns, p.rows))
    places = product(range(-across, across + 1), range(-up, up + 1))
    at = [(i * p.pitch, j * p.pitch, -gap) for i, j in places if (i, j) != (0, 0)]
    return float(np.abs(field(layout.magnet, np.array(at)).sum(axis=0)).max()) if at else 0.0


def rows(layout: PlanarLayout, _rung: str, force: float | None) -> list[CellEstimate]:
    design = layout.design
    by_kind: dict[str, CellEstimate] = {}
    for kind in layout.used:
        at_yield, rated = rated_force(layout, kind)
        pad, matrix = pad_compliance(kind, layout.pad_height), chip_matrix(layout, kind)
        load = design.rating.force if force is None else force
        stiffness = float(1.0 / pad[2, 2])
        per_axis = force_noise(layout.chip, matrix)
        linear = kind.cell.linear_range(design.rating.linearity)
        stress = load * rated_stress(layout, kind)
        by_kind[kind.name] = CellEstimate(
            number=0,
            kind=kind.name,
            arm=kind.beam_length,
            stiffness=stiffness,
            shear_stiffness=float(1.0 / pad[0, 0]),
            expected_error=stiffness_error(kind.bevel),
            force=load,
            sink=load / stiffness,
            stress=stress,
            yield_force=at_yield,
            rated_force=rated,
            fatigue_factor=float(goodman(cast(Alloy, design.material), rated * rated_stress(layout, kind))),
            elastic=load < at_yield,
            stop_force=closing_force(layout, kind),
            linear_force=stiffness * linear * (1.0 + design.rating.linearity),
            field=field_at_rest(layout),
            signal=float(abs(matrix[2, 2])),
            condition=float(np.linalg.cond(matrix)),
            matrix_change=matrix_change(layout, kind),
            force_noise_x=float(per_axis[0]),
            force_noise_z=float(per_axis[2]),
            peak_strain=stress / design.material.youngs_modulus,
        )
    return [replace(by_kind[e.kind.name], number=e.number) for e in layout.elements]


HEADINGS = (
    ("kind", "kind", "", 0.0),
    ("stiffness", "K", "N/mm", 1.0),
    ("shear_stiffness", "K across", "N/mm", 1.0),
    ("sink", "sink", "um", 1e3),
    ("stress", "stress", "MPa", 1.0),
    ("yield_force", "yields at", "N", 1.0),
    ("rated_force", "rated", "N", 1.0),
    ("fatigue_factor", "Goodman", "", 1.0),
    ("stop_force", "stop closes", "N", 1.0),
    ("linear_force", "linear to", "N", 1.0),
    ("signal", "signal", "mT/N", 1.0),
    ("matrix_change", "changes by", "%", 100.0),
    ("force_noise_x", "noise x, y", "mN", 1e3),
    ("force_noise_z", "noise z", "mN", 1e3),
)


def run(args: argparse.Namespace, asked: Allowance, design: PlanarDesign) -> int:
    """`tactcad estimate`: a line a kind, since cells of a kind are equal; --json has every cell."""
    from tactcad.scenes import overall_size, stated_size

    for option, given in (("--model", args.model), ("--inspection", args.inspection), ("--within", asked)):
        if given:
            raise InputError(option, "does not take designs of this family", value="planar")
    layout = PlanarLayout(design)
    found, size = rows(layout, "", args.force), overall_size(design)
    if args.json:
        document = {
            "design": design.name,
            "revision": design.design.revision,
            "family": "planar",
            "alloy": design.material.alloy,
            "size_mm": size,
            "units": {"length": "mm", "force": "N", "stiffness": "N/mm", "stress": "MPa", "field": "mT"},
            "neighbours_field_mT": neighbours_field(layout),
            "object_errors": object_errors(layout) if len(layout.used) == 2 else {},
            "elements": [asdict(row) for row in found],
        }
        print(json.dumps(document, indent=2))
        return 0
    print(
        f"{design.name} {design.design.revision}, {design.material.alloy}, {len(found)} cells, "
        f"{found[0].force:g} N on each pad as if no stop closed, {stated_size(size)} overall"
    )
    shown = list({row.kind: row for row in found}.values())
    columns = [
        (heading, unit, *(f"{v * scale:.4g}" if scale else v for v in (getattr(row, name) for row in shown)))
        for name, heading, unit, scale in HEADINGS
    ]
    print(*aligned([*zip(*columns)]), sep="\n")
    own = stress_error(layout.process.bevel)
    print(
        f"K against solid elements: within {100 * found[0].expected_error:.2g} %; stress includes its own "
        f"error of {100 * own:.2g} % and the rated shear; noise is of one reading of {layout.chip.name}"
    )
    unread = "unread" in layout.chip.source
    print(
        f"at a chip at rest {found[0].field:.3g} mT, of which neighbours make {neighbours_field(layout):.2g}"
        + ("; the chip's figures were not all read in its maker's sheet" if unread else "")
    )
    ratio = {row.kind: row.stiffness for row in shown}
    if len(ratio) == 2:
        print(f"K_r/K_m {max(ratio.values()) / min(ratio.values()):.3g}")
        told = ", ".join(f"{100 * e:.1f} % at {k:g} N/mm" for k, e in object_errors(layout).items())
        print(f"noise of one reading of a pair, one of its cells at its rated force: K_obj within {told}")
    return 0


def object_errors(layout: PlanarLayout) -> dict[float, float]:
    """By K_obj, N/mm: its relative standard deviation by the noise of one reading of a pair, one of whose
    cells is at its rated force."""
    from .cell_targets import KINDS, of_kind, variances

    at = np.array([0.5, 1.0, 5.0, 20.0])
    pair = [of_kind(layout, name) for name in KINDS]
    soft, stiff, _ = variances(pair[0], pair[1], 1, 0.0, at)
    found = zip(at.tolist(), np.sqrt(soft + stiff).tolist())
    return {k: error for k, error in found if np.isfinite(error)}


def golden(design: PlanarDesign) -> dict[str, dict]:
    layout, part = PlanarLayout(design), {"part_no": f"{design.name}-foil"}
    return {
        e.designator: part | {"stiffness_n_per_mm": row.stiffness, "yield_force_n": row.yield_force}
        for e, row in zip(layout.elements, rows(layout, "", None))
    }


STRENGTH = "kind stiffness rated_force fatigue_factor yield_force stop_force linear_force stress".split()


def strength(layout: PlanarLayout) -> bytes:
    """strength.csv: a row a cell; N, N/mm, MPa."""
    d = layout.design.design
    lines = [",".join(("design", "revision", "element", *STRENGTH))]
    for row, place in zip(rows(layout, "", None), layout.elements):
        values = [v if isinstance(v := getattr(row, n), str) else f"{v:.5g}" for n in STRENGTH]
        lines.append(",".join((d.name, d.revision, place.designator, *values)))
    return ("\r\n".join(lines) + "\r\n").encode()


def stop_stress(layout: PlanarLayout, kind: Kind, gap: Any) -> Any:
    """Stress of a cell that is pressed down on its stop, `gap` mm deep (or several), with the rated shear of
    the force that closes it, MPa: by bending, by the beams' stretch of 3 z^2/(5 s^2) if the island cannot
    turn, and by tipping."""
    cell = kind.cell
    down = wrench(np.array([0.0, 0.0, -1.0]), layout.pad_height) / cell.compliance[2, 2]
    tip = wrench(np.array([layout.design.rating.shear, 0.0, 0.0]), layout.pad_height)
    force = gap / cell.compliance[2, 2] * (1.0 + cell.stiffening * gap**2)
    stretch = layout.design.material.youngs_modulus * 0.6 * (gap / kind.beam_length) ** 2 * cell.held
    bent = cell.stress(down) * gap + cell.stress(tip) * force
    return bent * (1.0 + stress_error(kind.bevel)) + stretch
