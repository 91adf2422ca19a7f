"""The part of a calibration that the evaluation of grasps needs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tactcad.design.messages import InputError


@dataclass(frozen=True)
class Sensitivity:
    """A calibration; arrays, [element]."""

    element: np.ndarray  # numbers
    stiffness: np.ndarray  # K, N/mm
    stiffness_se: np.ndarray  # standard error
    signal_per_deflection: np.ndarray  # K_v, V/mm
    signal_per_deflection_se: np.ndarray
    correlation: np.ndarray  # of K and K_v
    dof: np.ndarray  # degrees of freedom of both standard errors
    load_cell: np.ndarray  # stiffness of the load cell that was in series, N/mm
    load_cell_half_width: np.ndarray  # of its limits, N/mm
    path: str = "calibration"

    def at_load_cell_limit(self, sign: float) -> Sensitivity:
        """The calibration that the same readings give with the load cell at its lower (sign -1) or upper (1)
        limit.

        Raises
        ------
        InputError
            At that limit the load cell is no stiffer than element and cell in series were measured to be.
        """
        cell = self.load_cell + sign * self.load_cell_half_width
        old = 1 / (1 + self.stiffness / self.load_cell)  # 1 - k/K_c, as k = K K_c/(K + K_c)
        k, v = self.stiffness * old, self.signal_per_deflection * old
        soft = cell <= k
        if soft.any():
            raise InputError(
                self.path,
                "the softest load cell within its limits is no stiffer than cell and element together",
                value=float(cell[soft][0]),
                legal=f"above {float(k[soft].max()):.4g} N/mm",
            )
        new = 1 - k / cell
        return replace(
            self,
            stiffness=k / new,
            stiffness_se=self.stiffness_se * (old / new) ** 2,
            signal_per_deflection=v / new,
            signal_per_deflection_se=self.signal_per_deflection_se * old / new,
        )
