"""A calibration as the evaluation of grasps takes it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tactcad.design.messages import InputError


@dataclass(frozen=True)
class Sensitivity:
    """A calibration by element: K (N/mm), K_v (V/mm), standard errors, their correlation, degrees of freedom;
    the load cell that stood in series, N/mm, and the half-width of its limits.
    """

    element: np.ndarray
    stiffness: np.ndarray
    stiffness_se: np.ndarray
    signal_per_deflection: np.ndarray
    signal_per_deflection_se: np.ndarray
    correlation: np.ndarray
    dof: np.ndarray
    load_cell: np.ndarray
    load_cell_half_width: np.ndarray
    path: str = "calibration"

    def at_load_cell_limit(self, sign: float) -> Sensitivity:
        """What the same readings give with the load cell at its lower (sign -1) or upper (1) limit.

        Raises InputError where the softest cell would have given way as much as cell and element together.
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
