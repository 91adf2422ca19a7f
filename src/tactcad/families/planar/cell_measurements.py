"""Measurements on every cell of a cut foil."""

from __future__ import annotations

from tactcad.parts.array.measurements import MICROSCOPE, Measurement

from .cell_layout import CellPlace, PlanarLayout


def measured(layout: PlanarLayout) -> list[tuple[CellPlace, str, tuple[Measurement, ...]]]:
    t = layout.design.planar.thickness
    cut, foil = layout.process.tolerance(t), layout.design.foil_tolerance

    def of(e: CellPlace) -> tuple[Measurement, ...]:
        w, s = e.kind.table.beam_width, e.kind.beam_length
        edges, middle = "island's to frame's edge (mean of four)", "middle of each beam (mean of four)"
        return (
            Measurement("beam width", w, w - cut, w + cut, True, "", middle, MICROSCOPE),
            Measurement("beam length", s, s - cut, s + cut, False, "", edges, MICROSCOPE),
            Measurement(
                "thickness",
                t,
                t - foil,
                t + foil,
                True,
                "",
                "on the border, near the cell",
                "micrometer, 0.0005 or better",
            ),
        )

    return [(e, f"{layout.design.name}-foil", of(e)) for e in layout.elements]
