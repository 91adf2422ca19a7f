"""Arrays set in the fixture, against rigid bodies written for this test: full rotations instead of slopes,
every element let down until pad and pin touch, the stop plate from all triples of ledges."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from tactcad.parts.array.clamp import OVER_EDGE, SQUARE, lean
from tactcad.parts.rigs.setting_fixture import SettingLayout
from tactcad.parts.rules import load
from tactcad.stacks.mechanic import PAD, Assembled
from tactcad.stacks.variables import STEPS, made, own_holes, pair_holes
from tactcad.stacks.virtual_build import sensor

COUNT = 20_000


@pytest.fixture(scope="module")
def macro():
    return sensor(load("macro-array"), [])


class ByHand:
    """The array on the fixture: x along the arms, z over the floor, mm."""

    def __init__(self, layout, m) -> None:
        d = layout.design
        n, self.layout, self.m = len(m[PAD]), layout, m
        self.side = np.array([1.0 if p.row == 1 else -1.0 for p in layout.elements])
        self.y = np.array([p.y for p in layout.elements])
        pins = {1.0: 0, -1.0: len(layout.dowel_x)}
        xd, t = min(layout.dowel_x), d.clamp.end_plate_thickness
        inner, head_mid = layout.stack / 2, -layout.stack / 2 - t / 2
        height = d.holes.height - d.clamp.end_plate_bottom  # of a dowel hole over the lower edge
        step = d.clamp.end_plate_bottom + d.element.pad_height
        bores, sizes = m["end plate, head: dowel hole diameter"], m["dowel pin: diameter"]
        slack = (bores - sizes).min(axis=1) / 2
        self.turn, self.corner = np.empty((n, len(self.y))), np.empty((n, len(self.y)))
        half = SettingLayout(d).half
        steps = m["setting fixture: steps over the floor"]
        rise = m["setting fixture: steps' lean"] / half  # of a straight step, rad
        leans_by = m["element: pad's lean"] / (layout.design.element.pad_length / 2)
        for i, (side, y) in enumerate(zip(self.side, self.y)):
            k = pins[side]
            back = (
                step
                + steps[:, 1]
                + rise[:, 1] * side * xd
                + height
                + m[f"end plate, tapped: {OVER_EDGE}"][:, k]
            )
            front = (
                step
                + steps[:, 0]
                + rise[:, 0] * side * xd
                + height
                + m[f"end plate, head: {OVER_EDGE}"][:, k]
            )
            leans = (
                m["end plate, tapped: dowel holes' squareness along z"][:, k] / (SQUARE / 2) * lean(layout)
            )
            free = back + leans * (inner - head_mid) / (layout.stack + t)
            end = np.clip(free, front - slack, front + slack)
            pin = back + (end - back) * (inner - y) / (inner - head_mid)
            hole = d.holes.dowel_hole + m["element: dowel hole diameter"][:, i]
            size = float(d.clamp.dowel) + m["dowel pin: diameter"][:, k]
            centre = pin - (hole - size) / 2  # the hole hangs on its pin
            deep = d.holes.height + d.element.pad_height + m[PAD][:, i]
            low, high = np.full(n, -0.02), np.full(n, 0.02)
            for _ in range(30):  # the lower corner of the pad comes down to the floor
                mid = (low + high) / 2
                ends = [(x, -deep - leans_by[:, i] * (x - sum(self._corners) / 2)) for x in self._corners]
                over = [self._z(centre, x - xd, z, mid) for x, z in ends]
                lowest = np.min(over, axis=0) - m["setting fixture: floor's flatness"][:, i]
                high, low = np.where(lowest < 0, mid, high), np.where(lowest < 0, low, mid)
            self.turn[:, i] = (low + high) / 2
            self.corner[:, i] = centre
        self.deep = d.holes.height + d.element.pad_height + m[PAD]
        self.xd = xd

    @property
    def _corners(self):
        return self.layout.pad_inner, self.layout.pad_outer

    @staticmethod
    def _z(centre, along, over, turn):
        return centre + along * np.sin(turn) + over * np.cos(turn)

    def pads(self):
        middle = sum(self._corners) / 2 - self.xd
        return self._z(self.corner, middle, -self.deep, self.turn)

    def ledges(self, x):
        """Over the nominal ledge."""
        own = self.layout.ledge + self.layout.design.element.pad_height
        over = own + self.m["element: ledge over the pad face"] - self.deep
        return self._z(self.corner, x - self.xd, over, self.turn) - own

    def gaps(self, drawn):
        """The plate is pressed down in the middle: of all planes on three ledges the one over all ledges that
        is lowest there; if it rocks over two, the one nowhere far over a ledge."""
        layout = self.layout
        seat = layout.hold_down_x
        land = layout.pad_inner + layout.design.stop.land_length / 2
        points = np.column_stack([np.ones(len(self.y)), self.side * seat, self.y])
        ledges = self.ledges(seat)
        n = range(len(self.y))
        # three ledges, or two with the middle between them and as far over two others
        own = np.eye(len(n))
        rows = [own[list(three)] for three in combinations(n, 3)]
        for a, b in combinations(n, 2):
            if abs(points[a, 1] * points[b, 2] - points[a, 2] * points[b, 1]) < 1e-9:
                for p, q in combinations([k for k in n if k not in (a, b)], 2):
                    rows.append(np.array([own[a], own[b], own[p] - own[q]]))
        best, found = np.full(len(ledges), np.inf), np.zeros((len(ledges), 3))
        for touched in rows:
            if abs(np.linalg.det(touched @ points)) < 1e-6:
                continue
            planes = ledges @ touched.T @ np.linalg.inv(touched @ points).T
            over = planes @ points.T - ledges
            cost = np.where(over.min(axis=1) > -1e-9, planes[:, 0] + 1e-3 * over.max(axis=1), np.inf)
            found = np.where((cost < best)[:, None], planes, found)
            best = np.minimum(cost, best)
        lands = np.column_stack([np.ones(len(self.y)), self.side * land, self.y])
        flat = self.m["stop plate: flatness"]
        return drawn + self.m["element: stop gap"] + found @ lands.T - self.ledges(land) + flat


def test_pads_turns_and_ledges_are_those_of_rigid_bodies(macro):
    parts = made(macro.variables, COUNT // 10, "uniform", np.random.default_rng(3))
    a, hand = Assembled(macro.layout, parts), ByHand(macro.layout, parts)
    assert a.turn == pytest.approx(hand.turn, abs=2e-6)
    assert a.pads == pytest.approx(hand.pads(), abs=2e-5)
    for x in (macro.layout.hold_down_x, macro.layout.pad_inner + 0.5):
        assert a.ledges(x) == pytest.approx(hand.ledges(x), abs=2e-5)
    assert np.abs(a.turn).max() < 4e-3  # 3 um of steps, 10 of edge and pad, play and lean, over 17.5 mm


@pytest.mark.slow  # thousands of arrays as rigid bodies, twice
def test_yields_are_those_of_rigid_bodies(macro):
    """Limits moved to where half, 90 and 99 % of arrays keep them: within a point, from other parts; the
    spread of the pads and of the gaps within 5 %."""
    a = Assembled(macro.layout, made(macro.variables, COUNT, "normal", np.random.default_rng(7)))
    hand = ByHand(macro.layout, made(macro.variables, COUNT, "normal", np.random.default_rng(8)))
    drawn = a.gaps - a.made["element: stop gap"] - a.lifts
    for ours, theirs in (
        (np.ptp(a.pads, axis=1), np.ptp(hand.pads(), axis=1)),
        (np.abs(a.turn).max(axis=1), np.abs(hand.turn).max(axis=1)),
        ((a.gaps - drawn).max(axis=1), (hand.gaps(drawn[:1]) - drawn[:1]).max(axis=1)),
    ):
        for share in (0.5, 0.9, 0.99):
            limit = np.quantile(ours, share)
            assert np.mean(theirs <= limit) == pytest.approx(share, abs=0.01)
            assert np.quantile(theirs, share) == pytest.approx(limit, rel=0.05)


def test_a_floor_that_is_not_flat_carries_its_pad_lower(macro):
    """2 um under one pad: it goes down by its inner edge, 19.5 mm from its dowel, its middle 18.5. A pad that
    leans by 2 um at its edges stands on the outer one, 17.5 mm from its dowel."""
    zero = {n: np.zeros((2, v.pieces)) for n, v in macro.variables.items()}
    zero[STEPS] = np.full((2, 2), 0.006)
    zero["setting fixture: floor's flatness"][0, 3] = -0.002
    zero["element: pad's lean"][1, 3] = 0.002
    a = Assembled(macro.layout, zero)
    down, up = np.zeros(10), np.zeros(10)
    down[3], up[3] = -0.002 * 18.5 / 19.5, 0.002 * 18.5 / 17.5
    assert a.pads == pytest.approx(np.array([down, up]), abs=1e-9)


def test_an_unset_plate_is_no_level_one(macro):
    """A step 20 um low turns every element of both rows at that end, by itself over the lever."""
    zero = {n: np.zeros((1, v.pieces)) for n, v in macro.variables.items()}
    zero[STEPS] = np.array([[0.006 - 0.02, 0.006 - 0.02]])
    a = Assembled(macro.layout, zero)
    lever = min(macro.layout.dowel_x) - macro.layout.pad_outer
    assert a.turn == pytest.approx(-0.02 / lever, rel=1e-9)


def test_a_flat_carrier_turns_the_stack_as_far_as_its_plates_lean(macro):
    """Upper edges over the holes, by the holes' heights over step and lower edge: each plate is turned until
    its edge lies along the carrier, elements between them in proportion, by whole rotations."""
    m = made(macro.variables, 2000, "uniform", np.random.default_rng(11))
    a, layout = Assembled(macro.layout, m), macro.layout
    xd, half = min(layout.dowel_x), SettingLayout(layout.design).half
    at = (layout.stack + layout.design.clamp.end_plate_thickness) / 2
    pins, lean_to = [0, len(layout.dowel_x)], {}
    for which, step in (("tapped", 1), ("head", 0)):
        over = m["setting fixture: steps over the floor"][:, [step]]
        over = over + m["setting fixture: steps' lean"][:, [step]] / half * np.array([xd, -xd])
        edge = over + m[f"end plate, {which}: {OVER_EDGE}"][:, pins]
        edge = edge - (m[pair_holes("z")] + m[own_holes(which, "z")])[:, pins]
        lean_to[which] = np.arctan2(edge[:, 0] - edge[:, 1], 2 * xd)
    flat = (lean_to["tapped"] + lean_to["head"]) / 2
    for i, place in enumerate(layout.elements):
        share = (place.y + at) / (2 * at)
        turned = flat - (share * lean_to["tapped"] + (1 - share) * lean_to["head"])
        x = (layout.pad_inner + layout.pad_outer) / 2 * (1.0 if place.row == 1 else -1.0)
        z = x * np.sin(turned) + a.pads[:, i] * np.cos(turned)
        assert a.carried[:, i] == pytest.approx(z, abs=1e-7)
    assert 1e-4 < np.abs(a.twist).max() < 1e-3  # rad: it moves no pad by more than a micrometre
    assert np.abs(a.carried - a.pads).max() < 1e-3
