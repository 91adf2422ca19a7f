"""Plots can be read: labels stand free, and the front that is drawn is the front."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from bench_plots import Panel, Point, error_against_time, place_labels

from tactcad.report.plots import panels

CLUSTER = [
    Point("short", "closed form", 3.8e-8, 1.1),
    Point("beam", "closed form", 5.6e-8, 0.97),
    Point("section", "closed form", 1.5e-7, 1.2),
    Point("plane", "closed form", 1.2e-7, 0.15),
    Point("fem-plane", "plane elements", 0.14, 0.12),
    Point("fem-solid", "solid elements", 1.6, 1e-3),
    Point("mesh 2", "solid elements", 2.0, 1.2e-3),
]


@pytest.mark.by_day(2, "a plot each")
@pytest.mark.parametrize("seed", range(6))
def test_labels_stand_free_of_each_other_and_of_markers(seed):
    """By the renderer's own extents; the rungs' times as measured, and shuffled by up to half as much
    again."""
    shift = (
        np.exp(np.random.default_rng(seed).uniform(-0.4, 0.4, len(CLUSTER)))
        if seed
        else np.ones(len(CLUSTER))
    )
    points = [Point(p.label, p.series, p.seconds * f, p.worst) for p, f in zip(CLUSTER, shift)]
    with panels(1, 2, (12.4, 5.0), width_ratios=(1.7, 1.0)) as (figure, (ax, _)):
        error_against_time(ax, Panel(points, "t", "x", "y"))
        place_labels(figure, ax, [(p.label, p.seconds, p.worst) for p in points])
        figure.canvas.draw()
        boxes = [text.get_window_extent() for text in ax.texts]
        assert [text.get_text() for text in ax.texts] == [p.label for p in points]
        assert not [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]
        frame = ax.get_window_extent()
        for box in boxes:
            assert frame.x0 <= box.x0 and box.x1 <= frame.x1
            for p in points:
                x, y = ax.transData.transform((p.seconds, p.worst))
                assert not (box.x0 < x < box.x1 and box.y0 < y < box.y1)


def test_what_is_dominated_is_hollow_and_the_front_is_joined():
    with panels() as (figure, ax):
        error_against_time(ax, Panel(CLUSTER, "t", "x", "y"))
        joined, *rest = ax.lines
        markers = [line for line in rest if line.get_marker() not in ("None", "", None)]
        filled = {
            (line.get_xdata()[0], line.get_ydata()[0])
            for line in markers
            if line.get_markerfacecolor() != "#ffffff"
        }
        assert filled == set(zip(joined.get_xdata(), joined.get_ydata()))
        expected = {"short", "beam", "plane", "fem-plane", "fem-solid"}
        assert filled == {(p.seconds, p.worst) for p in CLUSTER if p.label in expected}
