"""A sensor as a reviewer sees it: each element's figures, the array's mass and cut, and what checks say.

Closed forms only: no kernel. Parts and scenes are those of the record of geometry (`export.geometry`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from tactcad.assembly.virtual_build import LEAST_YIELD, sensor
from tactcad.checks.check_report import Report
from tactcad.checks.clearance import check_clearance
from tactcad.checks.goes_together import COUNT
from tactcad.checks.hinge_strength import check_strength
from tactcad.checks.rigidity import check_rigidity, check_rigs
from tactcad.checks.shop import DEFAULT, Shop, load_shop
from tactcad.checks.without_solids import run_on_part
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.export.geometry import Record, geometry
from tactcad.mechanics import signal
from tactcad.parts.description import NOT_MADE, Part
from tactcad.parts.finding import Finding
from tactcad.parts.hinge_section import design_gauge, design_readout, hinge_section
from tactcad.parts.layout import Layout
from tactcad.scenes import left_out, make_scene, scene_names
from tactcad.scenes.scene import Scene


@dataclass(frozen=True)
class ElementFigures:
    """One element; None where the models do not reach it, or the side does not tell."""

    stiffness: float | None  # N/mm
    rated_force: float | None  # N, in use
    signal_per_force: float | None  # V/N
    stop_gap: float | None  # mm


@dataclass(frozen=True)
class MadePart:
    """A part that is made: all that its sheet shows, and its shape, each a description or plain data."""

    sheet: Part | Record
    shape: tuple | Record


@dataclass(frozen=True)
class SensorState:
    """One state of a sensor.

    elements     by designator
    mass         of the array with its fasteners, g
    cut_length   of all wire-cut pieces of the array, mm
    made         every part that is made and has a sheet, by number
    scenes       by name: placements and bill of the record of geometry
    """

    elements: Mapping[str, ElementFigures]
    mass: float
    cut_length: float
    made: Mapping[str, MadePart]
    scenes: Mapping[str, Record]


# Of a line of a bill, what belongs to the scene and not to the part; of a part's record too.
OF_USE = ("qty", "spares", "designators")
SHAPE = ("contours", "holes", "pockets", "volume_mm3", "box_mm")


def recorded_state(record: Record, design: Design | None) -> SensorState:
    """What a record of geometry tells; the rated force follows with the design's rating."""
    parts = record["parts"]

    def figures(element: Mapping[str, Any]) -> ElementFigures:
        at_yield, rated = element.get("yield_force_n"), None
        if design is not None and at_yield is not None:
            rated = min(design.rating.force, at_yield / design.rating.yield_factor)
        gap = parts[element["part_no"]].get("limits", {}).get("stop gap", {}).get("nominal_mm")
        return ElementFigures(element.get("stiffness_n_per_mm"), rated, None, gap)

    scenes = record["scenes"]
    rows = scenes["array"]["bom"]
    lines = {number: line for scene in scenes.values() for number, line in scene["bom"].items()}
    return SensorState(
        {name: figures(element) for name, element in record.get("elements", {}).items()},
        sum(row["qty"] * (row["mass_g"] or 0.0) for row in rows.values()),
        sum(row["qty"] * (parts[n]["cut_length_mm"] or 0.0) for n, row in rows.items() if n in parts),
        {n: _made(part, lines.get(n, {})) for n, part in parts.items() if part["process"] not in NOT_MADE},
        scenes,
    )


def _made(part: Record, line: Record) -> MadePart:
    own = {name: value for name, value in part.items() if name not in OF_USE}
    listed = {name: value for name, value in line.items() if name not in OF_USE}
    return MadePart({"part": own, "listed": listed}, {name: part[name] for name in SHAPE if name in part})


@dataclass(frozen=True)
class Reviewed:
    """A design that keeps its rules, by the present code; `known` keeps findings of parts that designs
    share, `told` is its record of geometry where that was made already."""

    design: Design
    known: dict[str, tuple[Part, list[Finding]]] = field(default_factory=dict, repr=False)
    told: Record | None = None

    @cached_property
    def scenes(self) -> Sequence[Scene]:
        return [make_scene(self.design, name) for name in scene_names(self.design)]

    @cached_property
    def parts(self) -> dict[str, Part]:
        """By number."""
        return {part.part_no: part for scene in self.scenes for part in scene.parts}

    @cached_property
    def record(self) -> Record:
        """Of geometry."""
        return geometry(self.design, self.scenes) if self.told is None else self.told

    @cached_property
    def state(self) -> SensorState:
        told = recorded_state(self.record, self.design)
        made = {n: p for n, p in self.parts.items() if p.process not in NOT_MADE}
        return replace(
            told,
            elements={
                name: replace(figures, signal_per_force=volts)
                for (name, figures), volts in zip(told.elements.items(), self._signals())
            },
            made={number: MadePart(part, (part.body, part.features)) for number, part in made.items()},
        )

    def _signals(self) -> list[float | None]:
        """V/N of every element; None for all where one is out of the model's range."""
        layout = Layout(self.design)
        gauge, electronics = design_gauge(self.design), design_readout(self.design)
        try:
            read = signal.predict(hinge_section(layout, layout.elements), gauge, electronics, 0.0)
        except CheckFailure:
            return [None] * len(layout.elements)
        return [float(volts) for volts in read.per_force]

    @cached_property
    def yield_share(self) -> float:
        """Share of virtual arrays that meet every requirement, as `tactcad check` builds them."""
        return sensor(self.design, self.scenes).built(COUNT).share

    @cached_property
    def findings(self) -> list[Finding]:
        """Of every check that needs no kernel and no virtual builds."""
        report, design = Report(), self.design
        names = [scene.name for scene in self.scenes]
        report.run("strength", check_strength, design)
        report.run("clearance", check_clearance, design)
        report.run("rigidity", check_rigidity, design, names, [])
        check_rigs(report, design, self.scenes)
        shop = load_shop(DEFAULT)
        of_parts = [f for part in self.parts.values() for f in self._about(part, shop)]
        missing = [
            Finding("scene", "flag", f"scene {left.scene} left out", (), 0, 0, left.reason)
            for left in left_out(design)
        ]
        return [*report.findings, *of_parts, *missing]

    def _about(self, part: Part, shop: Shop) -> list[Finding]:
        if part.part_no not in self.known or self.known[part.part_no][0] != part:
            report = Report()
            run_on_part(report, part, shop)
            self.known[part.part_no] = (part, report.findings)
        return self.known[part.part_no][1]


def too_few(share: float) -> bool:
    """Whether `tactcad check` fails at that share of arrays."""
    return share < LEAST_YIELD
