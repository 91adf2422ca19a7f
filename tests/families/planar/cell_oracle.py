"""Half-widths of an estimator that knows the nuisances' laws: noise, set-ups, tilted magnets, neighbours.

Bayes' rule of a linear model about the truth: every reading of a calibration and of a grasp, with its
derivatives by all that is not known. Field and sink without load are each run's own. How a cell bends is
known but for c of `cell_calibration`, what its magnet's tilt adds, whose law is known.
"""

from __future__ import annotations

import cell_labs
import numpy as np

from tactcad.families.planar.cell_layout import PlanarLayout

Z = 1.959964
RUNS, SHARES = 4, (0.0, 0.5, 1.0)  # of `cell_labs.calibration_csv`


class _Model:
    """Rows of readings over their standard deviations, by unknowns that get a column when first named."""

    def __init__(self) -> None:
        self.columns: dict[tuple, int] = {}
        self.rows: list[dict[int, float]] = []

    def reading(self, deviation: float, by: dict[tuple, float]) -> None:
        self.rows.append(
            {self.columns.setdefault(k, len(self.columns)): v / deviation for k, v in by.items()}
        )

    def half_widths(self, of: list[tuple]) -> np.ndarray:
        J = np.zeros((len(self.rows), len(self.columns)))
        for i, row in enumerate(self.rows):
            J[i, list(row)] = list(row.values())
        scale = np.linalg.norm(J, axis=0)
        root = np.linalg.inv(np.linalg.qr(J / scale, mode="r"))  # (J'J)^-1 is root root'
        at = [self.columns[k] for k in of]
        return Z * np.linalg.norm(root[at], axis=1) / scale[at]


def law_of_bows(layout: PlanarLayout, seed: int, arrays: int) -> np.ndarray:
    """Standard deviation of c over arrays as made, mT/N^2, [cell, field, axis]."""

    def bow(rng: np.random.Generator, spread: float) -> np.ndarray:
        return 0.5 * np.einsum("icdd->icd", cell_labs.made(layout, rng, spread).bent)

    rng = np.random.default_rng(seed)
    drawn = bow(rng, 0.0)
    return np.sqrt(np.mean([(bow(rng, 1.0) - drawn) ** 2 for _ in range(arrays)], axis=0))


def _calibrated(lab: cell_labs.Lab, errors: cell_labs.Errors, largest: float, bow: np.ndarray) -> _Model:
    """Matrices ("m", cell, field, axis), c ("c", ...) and stiffnesses ("k", cell), relative, by set-ups."""
    model = _Model()
    for i, K in enumerate(lab.stiffness):
        M = lab.straight[i, :, i]
        for a in range(3):
            for axis in range(3):
                model.reading(bow[i, a, axis], {("c", i, a, axis): 1.0})
        for axis in range(3):
            full = largest * (0.4 if axis < 2 else 1.0)
            for run in range(RUNS):
                off = [("d", i, axis, run, b) for b in range(3)]
                both = [("s", axis, run, b) for b in range(3)]
                for one, many in zip(off, both):
                    model.reading(errors.own, {one: 1.0} | ({many: -1.0} if errors.shared else {}))
                    if errors.shared and i == 0:
                        model.reading(errors.shared, {many: 1.0})
                for share in SHARES:
                    q = share * full
                    for a in range(3):
                        by = {("rest", i, axis, run, a): 1.0, ("m", i, a, axis): q}
                        by |= {("c", i, a, axis): q * (q - full)}
                        by |= {one: q * M[a, b] for b, one in enumerate(off)}
                        model.reading(errors.field[a], by)
                    if axis == 2:
                        by = {("dry", i, run): 1.0, ("k", i): -q / K, off[2]: q / K}
                        model.reading(errors.sink, by)
    return model


def _felt(
    model: _Model, lab: cell_labs.Lab, errors: cell_labs.Errors, largest: float, force: np.ndarray, by
) -> None:
    """Readings at every load and without; `by` the force's derivatives, (state, cell, axis) to a table."""
    for s, f in enumerate(force):
        for i in range(len(lab.stiffness)):
            for a in range(3):
                row = {("zero", i, a): 1.0}
                for j in range(len(lab.stiffness)):
                    for axis in range(3):
                        for name, slope in by(s, j, axis).items():
                            row[name] = row.get(name, 0.0) + lab.straight[i, a, j, axis] * slope
                for axis in range(3):
                    q, full = f[i, axis], largest * (0.4 if axis < 2 else 1.0)
                    row |= {("m", i, a, axis): q, ("c", i, a, axis): q * (q - full)}
                model.reading(errors.field[a], row)
    for i in range(len(lab.stiffness)):
        for a in range(3):
            model.reading(errors.field[a], {("zero", i, a): 1.0})


def of_forces(lab, errors, largest: float, bow: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Of the forces at the last load, N, [cell, 3]; forces [state, cell, 3]."""
    model = _calibrated(lab, errors, largest, bow)
    _felt(model, lab, errors, largest, force, lambda s, j, axis: {("f", s, j, axis): 1.0})
    n, last = len(lab.stiffness), len(force) - 1
    return model.half_widths([("f", last, i, axis) for i in range(n) for axis in range(3)]).reshape(n, 3)


def of_object(lab, errors, largest: float, bow: np.ndarray, force: np.ndarray, x: float) -> np.ndarray:
    """Of K_obj by every cell and its neighbours, N/mm: they share an approach at each load and K_obj, and
    each pad touches at an approach of its own."""
    cells, out = lab.layout.elements, []
    for own in cells:
        beside = {j for j, e in enumerate(cells) if abs(e.row - own.row) + abs(e.column - own.column) <= 1}
        model = _calibrated(lab, errors, largest, bow)

        def by(s: int, j: int, axis: int, beside=beside) -> dict[tuple, float]:
            if axis < 2 or j not in beside:
                return {("f", s, j, axis): 1.0}
            f, K = force[s, j, 2], lab.stiffness[j]  # f = way/(1/K + 1/x)
            return {("way", s): f, ("x",): f * K / (K + x), ("k", j): f * x / (K + x), ("touch", j): 1.0}

        _felt(model, lab, errors, largest, force, by)
        out.append(x * model.half_widths([("x",)])[0])  # relative, as K and the way are
    return np.array(out)
