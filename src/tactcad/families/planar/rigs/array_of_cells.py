"""The array of cells: the sensor itself."""

from __future__ import annotations

from tactcad.scenes.rig import ARRAY, Rig, none

from ..cell_array import scene

RIG = Rig(
    name=ARRAY,
    tables=(),
    make=scene,
    poses=none,
    under_sensor=none,
    rules=(),
    deflections=lambda _design: iter(()),
    requirements=lambda *_: [],
    checks=(),
)
