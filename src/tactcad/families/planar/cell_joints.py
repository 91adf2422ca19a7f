"""Cells for robots: every island on a slide and two hinges."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from tactcad.parts.language.description import Extrusion, Part
from tactcad.robot.mechanism import ElementJoint, Mechanism, Moving, array_seen
from tactcad.robot.taxel_table import Taxel
from tactcad.scenes.scene import Placement

from .cell_layout import Kind, PlanarLayout, beside
from .cell_tables import PlanarDesign
from .field import sensitivity
from .sensor import magnet_lever


def cells(design: PlanarDesign) -> Mechanism:
    """The array from its board's lower face, on the robot's flange.

    A cell turns about its island's middle in the foil's mid-plane: there the compliance matrix of a cell is
    diagonal, since it is its own image in that plane and under quarter turns. So sink and two tilts are its
    own axes, each as stiff as 1/C_ii: every other freedom is free of force. At the pad, H above, a
    tangential force F tips the cell by F H C_tilt and moves the pad by F (C_xx + H^2 C_tilt). Left out are
    C_xx, of the island's shift in its plane, and its twist, which are rigid here; and the stiffening by the
    beams' stretch, so that a stop closes at its gap under less than the estimate's force.

    The island moves, with its half of every beam, foot plate, post and magnet. The pad touches by a ball
    about the island's middle: wherever a cell has tipped to, its force acts at the height H over it.
    A tilt ends where from rest island, foot plate or post would meet base or cover.
    """
    layout, t = PlanarLayout(design), design.planar.thickness
    H, house = layout.pad_height, design.housing
    flange = np.array([0.0, 0.0, layout.board_z - design.hall.board])
    placed = array_seen(design, flange, np.eye(3))
    islands, placed["F1"] = _parted(layout, placed["F1"])
    signal = float(abs(sensitivity(layout.magnet, design.hall.gap, magnet_lever(layout))[1][2, 2]))
    numbers, moving = {(e.row, e.column): e.number for e in layout.elements}, []
    over_cover = house.cover_thickness + layout.cover_z - t / 2.0
    for e in layout.elements:
        sink, tilt = 1.0 / np.diag(e.kind.cell.compliance)[[2, 3]]
        gap, name, d = e.kind.table.stop_gap, e.designator, design.post.pad
        tips = min(gap / e.kind.reach, house.lift / e.kind.reach, house.side_gap / over_cover)
        joints = (
            ElementJoint(f"{name}_sink", "slide", (0.0, 0.0, -1.0), float(sink), gap, house.lift),
            ElementJoint(f"{name}_tilt_x", "hinge", (1.0, 0.0, 0.0), float(tilt), tips, tips),
            ElementJoint(f"{name}_tilt_y", "hinge", (0.0, 1.0, 0.0), float(tilt), tips, tips),
        )
        taxel = Taxel(
            number=e.number,
            designator=name,
            kind=e.kind.name,
            **{"x_mm": e.x, "y_mm": e.y, "z_mm": float(layout.pad_z - flange[2])},
            **{"q_w": 1.0, "q_x": 0.0, "q_y": 0.0, "q_z": 0.0},
            **{"normal_x": 0.0, "normal_y": 0.0, "normal_z": 1.0},
            length_mm=d,
            width_mm=d,
            area_mm2=pi * d**2 / 4.0,
            stiffness_N_per_mm=float(sink),
            signal_V_per_mm=None,
            noise_V=None,
            signal_mT_per_mm=signal,
            noise_mT=1e-3 * layout.chip.noise_z,
            range_mm=gap,
            stop_gap_mm=gap,
            joints=tuple(j.name for j in joints),
            sink_mm_per_rad=(1e3, 0.0, 0.0),
            shear_x_N_per_rad=(0.0, 0.0, float(tilt / H)),
            shear_y_N_per_rad=(0.0, float(-tilt / H), 0.0),
            neighbours=tuple(numbers[at] for at in beside(e) if at in numbers),
        )
        island = replace(placed["F1"], designator=name, part=islands[e.kind.name])
        x, y, z = island.origin
        own = (placed.pop(f"{part}{e.number}") for part in ("FP", "P", "M"))
        # the post, up to half of its free length: above that the ball touches
        box = [(-d / 2, -d / 2, t / 2), (d / 2, d / 2, H - design.post.stand_out / 2)]
        moved, pad = (replace(island, origin=(x + e.x, y + e.y, z)), *own), np.array([0.0, 0.0, -H])
        moving.append(Moving(taxel, np.eye(3), pad, joints, moved, np.array(box), H, rubs=True))
    return Mechanism(design, tuple(placed.values()), tuple(moving))


def _parted(layout: PlanarLayout, foil: Placement) -> tuple[dict[str, Part], Placement]:
    """For each kind the moving part of the foil, about its island's middle, and the rest of the foil: cut at
    the beams' middles."""
    t = layout.design.planar.thickness
    part = replace(foil.part, characteristics=(), geometric=(), datums=())  # its pieces are not made
    spigots = [f for f in part.features if f.name == "spigot"]
    standing = tuple(f for f in part.features if f.name != "spigot")
    frame = tuple(e.kind.parted(layout.corner, (e.x, e.y))[1] for e in layout.elements)
    body = Extrusion(part.extrusion.outer, t, frame)
    rest = replace(part, part_no=f"{part.part_no}-frame", body=body, features=standing)

    def island(kind: Kind) -> Part:
        body = Extrusion(kind.parted(layout.corner, (0.0, 0.0))[0], t)
        hole = replace(spigots[0], at=(0.0, 0.0, 0.0))
        return replace(part, part_no=f"{part.part_no}-{kind.name}", body=body, features=(hole,))

    return {k.name: island(k) for k in layout.used}, replace(foil, part=rest)
