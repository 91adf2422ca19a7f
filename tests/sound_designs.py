"""Designs constructed to keep every rule, by their own geometry: each dimension is chosen to leave room for the next.

The bounds are worked out here from the standards' tables and the layout as described, not from the rules' code.
"""

from __future__ import annotations

from math import ceil, cos, floor, pi, tan

from hypothesis import strategies as st
from variants import variant

from tactcad.design.tree import Design
from tactcad.parts.library.screws import METRIC, SET_SCREW_LENGTHS

CAP_LENGTHS = (2, 2.5, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30)
M6_UPPER = {"2": 0.008, "2.5": 0.008, "3": 0.008, "4": 0.012, "5": 0.012}  # ISO 286-2


@st.composite
def sound_designs(draw, row_lengths=(1, 2, 3, 5, 8, 13)) -> Design:
    """A design that keeps every rule: one or two rows, either notch form, any screw and dowel.

    Radii and walls are what a wire of 0.25 mm and the usual shop can cut, so that every check passes too.
    """

    def mm(low: float, high: float) -> float:
        """Between the bounds, in whole micrometres."""
        low, high = ceil(low * 1000 - 1e-6), floor(high * 1000 + 1e-6)
        return draw(st.integers(low, max(low, high))) / 1000

    def choice(*options):
        return draw(st.sampled_from(options))

    sides = choice("one", "two")
    notches = 1 if sides == "one" else 2
    screw, dowel, mount = choice(*METRIC), choice(*M6_UPPER), choice("M3", "M4", "M5")
    m, mounted = METRIC[screw], METRIC[mount]
    counterbore, nut_corner = m.head + 0.5, m.nut / cos(pi / 6)
    head = max(counterbore, nut_corner) / 2

    # rows, sheet, spacer: at least as long as the set screw between the end plates
    rows = [draw(st.sampled_from(row_lengths)) for _ in range(choice(1, 2))]
    sheet, spacer = mm(0.5, 6), mm(0.2, 3)
    if max(rows) * (sheet + spacer) + spacer < m.d + 0.6:
        rows[0] = ceil((m.d + 0.6) / (sheet + spacer))

    # hinge, arm, ledge
    t, r = mm(0.05, 0.5), mm(0.15, 0.5)
    l = round(2 * r + mm(0, 1), 3)
    h = mm(max(0.9, 1.25 * (t + notches * r) + 0.01), 4)
    corner = mm(0.15, 0.4)
    rise = mm(0.2929 * corner + 0.05, 1.2)  # ledge over arm
    body = h + rise if sides == "one" else h + 2 * rise
    bottom = 0.0 if sides == "one" else -rise
    ledge = h + rise

    # pad, gauge, land, and arms long enough for them
    pad, root = mm(0.9, 4), mm(0.15, 0.5)
    pad_height = mm(max(root, 0.1 - bottom), 4)
    grid = mm(0.05, l)
    carrier_arm = mm(0.2, 2)
    land = mm(0.1, 2)
    shortest = max(
        pad + root + l / 2, pad + root + carrier_arm, land + rise + corner * tan(pi / 8) + l / 2, pad / 2 + l + 0.5
    )
    arms = [[mm(shortest, shortest + 20) for _ in range(n)] for n in rows]
    row_pitch = mm(pad + 0.1, pad + 5)

    # stop plate's seat, set screws beside the rear bodies
    plate_gap = mm(corner, min(0.3 + (m.d - m.set_point) / 2, spacer + sheet / 2))
    seat = mm(max(corner + plate_gap + 0.5, m.d / 2 + 0.3, m.d + 0.6 - shortest), 6)

    # holes in the rear bodies
    dowel_upper = mm(0.001, 0.02)
    dowel_hole = mm(float(dowel) + M6_UPPER[dowel], float(dowel) + 0.05)
    widest = max(m.clearance, dowel_hole + dowel_upper)
    web = mm(0.8, 2)
    recess = mm(corner, 1.5)
    spacer_bottom = mm(recess, recess + 0.5)
    under = max(counterbore / 2 + 1, nut_corner / 2 + 0.1, float(dowel) / 2 + 1)
    height = mm(max(spacer_bottom + web + widest / 2, under), 7)
    plate_bottom = mm(0, height - under)
    drop = mm(0, 0.5)
    rear_height = mm(max(height + web + widest / 2 + drop, ledge + 2 * corner), 12)
    step = max(widest + web, 2 * max(head, float(dowel) / 2) + 0.1)
    offsets = [mm(max(web + widest / 2, head), 6)]
    for _ in range(2):
        offsets.append(mm(offsets[-1] + step, offsets[-1] + step + 3))
    screws, dowels = choice(((0, 2), (1,)), ((1,), (0,)), ((2, 0), (1,)), ((0,), (2, 1)))

    # carrier: its screws, the axis's threads and the set screws in a line of sight, well apart
    fixing = min(n for n in CAP_LENGTHS if n - 1.5 * m.d - 0.8 >= 2 - 1e-9)
    thickness = mm(max(fixing - 1.5 * m.d - 0.8 + m.head_height, 1.5 * mounted.d, 1.5 * m.d + 1), 12)
    carrier_offset = mm(counterbore + mounted.d + 1.5, counterbore + mounted.d + 5)
    rear_length = mm(
        max(offsets[-1] + max(web + widest / 2, head + 1), carrier_offset + counterbore / 2 + 1), 60
    )
    recess_offset = mm(0, min(8, rear_length - corner))

    # a set screw that reaches from the carrier to the stop plate, under a carrier over everything else
    cone = m.tap_drill / 2 / tan(pi * 59 / 180)
    blind = 1.5 * m.d + 1 + 2 * m.pitch + cone
    lowest = max(height + max(counterbore, float(dowel)) / 2 + 1 + blind, rear_height + 0.1)
    longest = SET_SCREW_LENGTHS[screw][-1]
    thickness = min(thickness, max(longest - 1, 1.5 * m.d + 1, 1.5 * mounted.d, fixing - 1.5 * m.d - 0.8 + m.head_height))
    # an overload of at most three times the nominal yield force of 505 MPa, and so that what passes the closed stop by its
    # lever 1 - L/a and the hinge's half length stays a tenth of it
    overload = min(
        505 * sheet * t**2 / (6 * L) * min(3, 0.1 * L / ((1 - L / a) * l / 2)) for row in arms for a in row for L in [a - pad / 2]
    )
    stop_plate = mm(max(2, lowest - ledge - (longest - thickness + 1)), 20)

    return variant(
        {
            "material.youngs_modulus": 71000.0,
            "sheet.thickness": sheet,
            "array.row_arms": arms,
            "array.pitch": round(sheet + spacer, 3),
            "array.spacer": spacer,
            "array.row_pitch": row_pitch,
            "element.sides": sides,
            "element.hinge_thickness": t,
            "element.hinge_length": l,
            "element.fillet_radius": r,
            "element.arm_height": h,
            "element.body_height": round(body, 3),
            "element.pad_length": pad,
            "element.pad_height": pad_height,
            "element.pad_root_radius": root,
            "element.corner_radius": corner,
            "element.seat_length": seat,
            "element.rear_length": rear_length,
            "element.rear_height": rear_height,
            "element.recess_offset": recess_offset,
            "element.recess_depth": recess,
            "holes.height": height,
            "holes.screw_offsets": [offsets[i] for i in screws],
            "holes.dowel_offsets": [offsets[i] for i in dowels],
            "holes.dowel_hole": dowel_hole,
            "holes.dowel_hole_upper": dowel_upper,
            "holes.web": web,
            "clamp.screw": screw,
            "clamp.dowel": dowel,
            "clamp.end_plate_thickness": mm(max(m.tap_drill + 2, 3), 12),
            "clamp.end_plate_bottom": plate_bottom,
            "clamp.end_plate_margin": mm(0, 2),
            "clamp.spacer_bottom": spacer_bottom,
            "clamp.spacer_drop": drop,
            "clamp.stop_plate_thickness": stop_plate,
            "clamp.stop_plate_gap": plate_gap,
            "clamp.hold_down_pitch": mm(15, 60),
            "clamp.carrier_thickness": thickness,
            "clamp.carrier_margin": mm(0, 4),
            "clamp.carrier_screw_offset": carrier_offset,
            "clamp.mount_thread": mount,
            "clamp.mount_pitch_y": mm(max(5, mounted.d + 0.5), 40),
            "gauge.grid_length": grid,
            "gauge.carrier_arm_side": carrier_arm,
            "gauge.carrier_body_side": mm(0.1, seat + l / 2 + recess_offset),
            "stop.land_length": land,
            "stop.tolerance": 0.001,
            "rating.overload_force": overload,
        }
    )
