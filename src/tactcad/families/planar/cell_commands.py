"""`tactcad calibrate` and `tactcad stiffness` of planar designs, and the map that stiffness draws."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from tactcad.design.files import refuse_overwriting, write_whole
from tactcad.design.messages import InputError
from tactcad.lab import grasp, pads
from tactcad.lab.combine import Interval
from tactcad.lab.regression import require_level
from tactcad.report.report import plain

from .cell_calibration import calibrate as calibrate_cells
from .cell_grasp import CellFields, CellForces, as_rows, by_neighbours, fields, forces, places, with_rest
from .cell_layout import PlanarLayout
from .cell_matrices import Matrices, read_matrices, to_csv, to_json, to_text
from .cell_tables import PlanarDesign

LEAST = 3  # loads above zero from which on all cells together give K_obj
SHOWN_RATIO = 20.0  # range of a map's colours; values beyond take the end's colour


def _refuse(args: argparse.Namespace, *options: str) -> None:
    for option in options:
        if (given := getattr(args, option.replace("-", "_"), None)) not in (None, False):
            raise InputError(f"--{option}", "does not take designs of this family", value=given, legal="none")


def calibrate(args: argparse.Namespace, design: PlanarDesign) -> int:
    """Matrices of the cells from loads in three directions."""
    _refuse(args, "load-cell", "run-scatter", "drop-outliers", "map")
    cells = calibrate_cells(PlanarLayout(design), args.file, args.level)
    if args.out:
        write_whole(args.out, to_csv(cells).encode())
    sys.stdout.write(to_json(cells, args.level) if args.json else to_text(cells, args.level))
    return 0


@dataclass(frozen=True)
class CellGrasp:
    """One sample: forces on the cells, K_obj around each, and of all (None of fewer than LEAST loads)."""

    read: CellFields
    forces: CellForces
    around: list[Interval | None]
    whole: grasp.Grasp | None


def stiffness(args: argparse.Namespace, design: PlanarDesign) -> int:
    """Forces in three directions on every cell, K_obj by neighbours and of the whole, slip, and a map."""
    _refuse(args, "map")
    require_level(args.level)
    if args.picture:
        refuse_overwriting(args.picture, args.file, args.calibration)
    layout, known = PlanarLayout(design), read_matrices(args.calibration)
    layers = pads.layers(design, args.thickness, args.nu) if args.thickness else []
    samples = [_evaluated(args, layout, s, known, layers) for s in fields(layout, args.file)]
    if args.picture:
        write_whole(args.picture, picture(layout, samples[0]).encode())
    if args.json:
        document = {"schema": "tactcad-planar-stiffness-1", "level": args.level}
        document |= {"units": "N, N/mm, MPa, degrees", "samples": [as_json(layout, s) for s in samples]}
        print(json.dumps(plain(document), indent=1, allow_nan=False))
    else:
        print("\n\n".join(as_text(layout, s, args.level) for s in samples))
    return 0


def _evaluated(
    args: argparse.Namespace, layout: PlanarLayout, read: CellFields, known: Matrices, layers: list
) -> CellGrasp:
    found = forces(layout, read, known, args.level)
    around = by_neighbours(layout, read, found, known, args.level)
    whole = None
    if len(read.load) >= LEAST and len(read.element) > 1:
        signals, springs = as_rows(read, found, known)
        coupling, n = pads.coupling(args.design, signals, args.coupling or 0.0), len(layout.elements)
        whole = grasp.evaluate(
            signals, springs, reference=args.reference, level=args.level, coupling=coupling, elements=n
        )
        if layers:
            whole = grasp.on_layers(whole, with_rest(signals), springs, layers, args.level)
        whole = _with_limits(whole, float(known.stiffness_limit.max()))
    return CellGrasp(read, found, around, whole)


def _with_limits(whole: grasp.Grasp, limit: float) -> grasp.Grasp:
    """Intervals for every K within the limit, relative, that all cells share: K_obj goes with it."""

    def wide(i: Interval) -> Interval:
        return replace(i, low=i.low / (1.0 + limit), high=i.high * (1.0 + limit))

    layer = whole.layer
    if layer and layer.modulus:
        layer = replace(layer, modulus=wide(layer.modulus))
    return replace(whole, combined=wide(whole.combined), layer=layer)


def as_json(layout: PlanarLayout, s: CellGrasp) -> dict:
    """A sample's document."""
    f, layer = s.forces, s.whole.layer if s.whole else None

    def states(i: int) -> list[dict]:
        """Of the cell read as the i-th."""
        columns = (f.force[i], f.half_width[i], f.slips[i].tolist(), f.stopped[i].tolist())
        names = ("run", "load", "force", "half_width", "slips", "stopped")
        return [dict(zip(names, row)) for row in zip(s.read.run.tolist(), s.read.load.tolist(), *columns)]

    return {
        "sample": s.read.sample,
        "combined": s.whole.combined if s.whole else None,
        "modulus_MPa": layer.modulus if layer else None,
        "angle": layer.angle if layer else None,
        "touching": layer.touching if layer else None,
        "notes": s.whole.notes if s.whole else (),
        "cells": [
            {"element": e.number, "row": e.row, "column": e.column, "kind": e.kind.name}
            | {"object": s.around[i], "states": states(i)}
            for i, e in enumerate(places(layout, s.read))
        ],
    }


def _interval(i: Interval | None) -> str:
    if i is None:
        return "-"
    return "none fits" if i.empty else f"{i.estimate:.3g} ({i.low:.3g} to {i.high:.3g})"


def as_text(layout: PlanarLayout, s: CellGrasp, level: float) -> str:
    """A line a cell at the largest load, as people read it."""
    f, top = s.forces, int(np.argmax(s.read.load))
    lines = [
        f"sample {s.read.sample}: {len(s.read.element)} cells at {len(s.read.load)} loads; at "
        f"{s.read.load[top]:g} N, with {100 * level:.10g} % intervals",
        "cell  kind             Fx N               Fy N               Fz N  K_obj N/mm with its neighbours",
    ]
    for i, e in enumerate(places(layout, s.read)):
        three = "".join(f"{v:9.4f} +-{w:7.4f}" for v, w in zip(f.force[i, top], f.half_width[i, top]))
        marks = " slips" * bool(f.slips[i, top]) + " on its stop" * bool(f.stopped[i, top])
        lines.append(f"{e.number:4d}  {e.kind.name:9s}{three}  {_interval(s.around[i])}{marks}")
    slips = f"above {layout.design.rating.slip:g} of that (rating.slip)"
    lines += ["", f"Fz is down on the pad; a pad slips where its tangential force is {slips}"]
    if s.whole:
        lines.append(f"K_obj of all cells: {_interval(s.whole.combined)} N/mm")
        if (layer := s.whole.layer) and layer.modulus:
            (ax, *_), (ay, *_) = layer.angle
            lines.append(
                f"layer: E {_interval(layer.modulus)} MPa, its face inclined {ax:.2g}, {ay:.2g} degrees; "
                f"{len(layer.touching)} pads touch"
            )
        lines += [f"note: {n}" for n in s.whole.notes]
    else:
        lines.append(f"K_obj of all cells wants {LEAST} loads above zero, and two cells or more")
    return "\n".join(lines)


def picture(layout: PlanarLayout, s: CellGrasp) -> str:
    """The plane of cells: normal forces at the largest load, tangential ones beyond their intervals as
    arrows, slip as rings; and K_obj around each cell, as SVG."""
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Rectangle

    from tactcad.report.plots import RED, panels, svg

    cells, top, pitch = places(layout, s.read), int(np.argmax(s.read.load)), layout.design.planar.pitch
    x, y = (np.array([getattr(e, a) for e in cells]) for a in "xy")
    force = s.forces.force[:, top]
    kinds = np.array([e.kind.name for e in cells])
    of_kind = np.array([force[kinds == kind, 2].mean() for kind in kinds])
    known = np.array([i.estimate if i and not i.empty else np.nan for i in s.around])
    known = np.where((known > 0.0) & (known < inf), known, np.nan)
    with panels(1, 2, (11.2, 4.8)) as (figure, axes):
        over = f"Fz over the mean of its kind, at {s.read.load[top]:g} N"
        shown_as = ((force[:, 2] / of_kind, over), (known, "K_obj with the neighbours, N/mm"))
        for ax, (values, title) in zip(axes, shown_as):
            tiles = [Rectangle((u - pitch / 2, v - pitch / 2), pitch, pitch) for u, v in zip(x, y)]
            shown = PatchCollection(tiles, cmap="viridis", edgecolor="white")
            shown.set_array(np.ma.masked_invalid(values))
            middle = float(np.nanmedian(values)) if np.isfinite(values).any() else 0.0
            if ax is axes[1] and middle > 0.0:
                ends = np.clip(values, middle / SHOWN_RATIO, middle * SHOWN_RATIO)
                shown.set_clim(float(np.nanmin(ends)), float(np.nanmax(ends)))
            ax.add_collection(shown)
            figure.colorbar(shown, ax=ax)
            ax.set(xlabel="x, mm", ylabel="y, mm", aspect="equal", title=title)
            ax.autoscale_view()
            ax.grid(False)
        sideways, told = force[:, :2], s.forces.half_width[:, top, :2]
        sure = np.hypot(*sideways.T) > np.hypot(*told.T)
        if sure.any():
            longest = float(np.hypot(*sideways[sure].T).max())
            arrows = (x[sure], y[sure], *sideways[sure].T)
            axes[0].quiver(*arrows, color="white", angles="xy", scale=2.0 * longest / pitch, scale_units="xy")
        slips = s.forces.slips[:, top]
        axes[0].plot(x[slips], y[slips], "o", mfc="none", mec=RED, ms=14)
        return svg(figure, "cells")
