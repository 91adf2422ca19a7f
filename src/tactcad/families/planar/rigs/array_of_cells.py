"""The array of cells: the sensor itself."""

from __future__ import annotations

from tactcad.scenes.rig import ARRAY, Rig, none

from ..cell_array import nothing_bends, scene

RIG = Rig(
    name=ARRAY,
    tables=(),
    make=scene,
    poses=none,
    under_sensor=none,
    rules=(),
    deflections=nothing_bends,
    requirements=lambda *_: [],
    checks=(),
)
