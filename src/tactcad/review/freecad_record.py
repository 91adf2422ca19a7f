"""What FreeCAD's document is made from: parts, scenes, tables and findings, as plain data."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.lab.array_estimate import ElementEstimate, estimate
from tactcad.mechanics.ladder import DEFAULT_RUNG
from tactcad.parts.description import Part, Vector
from tactcad.parts.layout import Layout

from .finding_facts import FindingFact
from .scene_facts import PlacedFact, SceneFacts

Row = Sequence[str | float]

# Column of the spreadsheet and the estimate's field; a share is shown in per cent.
ESTIMATES = (
    ("element", "number"),
    ("arm, mm", "arm"),
    ("load arm, mm", "load_arm"),
    ("K, N/mm", "stiffness"),
    ("error of K at most, %", "expected_error"),
    ("K_r/K_m", "stiffness_ratio"),
    ("force, N", "force"),
    ("deflection, mm", "deflection"),
    ("gauge strain, microstrain", "gauge_strain"),
    ("stress, MPa", "stress"),
    ("rated force, N", "rated_force"),
    ("rated deflection, mm", "rated_deflection"),
)
SCALE = {"expected_error": 100.0, "gauge_strain": 1e6}


def freecad_record(
    design: Design, scenes: Sequence[SceneFacts], parts: Mapping[str, Part], findings: Sequence[FindingFact]
) -> dict[str, Any]:
    """The record; `file` of each part, its shape as BREP, is `part_file` of its place in `parts`."""
    identity = design.design
    return {
        "label": f"{identity.name} {identity.revision}",
        "about": [
            (name, getattr(identity, name) or "") for name in ("title", "name", "revision", "date", "author")
        ],
        "tables": {
            "Parameters": [("field", "value", "unit", "meaning", "origin"), *parameter_rows(design)],
            "Estimates": estimate_rows(design),
        },
        "parts": [
            {
                "part_no": p.part_no,
                "file": part_file(n),
                "colour": p.colour,
                "transparency": 0,
                "properties": _properties(p, identity.revision),
            }
            for n, p in enumerate(parts.values())
        ],
        "scenes": [_scene(scene, findings) for scene in scenes],
    }


def part_file(number: int) -> str:
    """Name of the file with the shape of the part that is at this place (from 0)."""
    return f"{number}.brep"


def parameter_rows(design: Design) -> list[Row]:
    """Every field of the design that has a value: path, value, unit, meaning and origin."""
    rows: list[Row] = []
    for section in dataclasses.fields(design):
        table = getattr(design, section.name)
        if section.name == "origin" or table is None:
            continue
        rows += _fields(section.name, table, design.origin)
        for number, hinge in getattr(table, "override", {}).items():
            rows += _fields(f"{section.name}.override.{number}", hinge, design.origin)
    return rows


def _fields(path: str, table: Any, origin: Mapping[str, str]) -> list[Row]:
    rows: list[Row] = []
    for f in dataclasses.fields(table):
        value = getattr(table, f.name)
        if "spec" in f.metadata and value is not None:
            name, spec = f"{path}.{f.name}", f.metadata["spec"]
            plain = value if isinstance(value, (int, float, str)) else _listed(value)
            rows.append((name, plain, spec.unit, spec.meaning, origin.get(name, "")))
    return rows


def _listed(value: Any) -> str:
    pairs = value.items() if isinstance(value, Mapping) else enumerate(value)
    named = isinstance(value, Mapping)
    return ", ".join(f"{k}: {v}" if named else str(v) for k, v in pairs)


def estimate_rows(design: Design) -> list[Row]:
    """A heading and a row for each element; one row that says why where the estimator does not reach."""
    try:
        rows = estimate(Layout(design), DEFAULT_RUNG)
    except CheckFailure as error:
        return [("not estimated",), (str(error),)]
    return [tuple(head for head, _ in ESTIMATES), *(_estimates(row) for row in rows)]


def _estimates(row: ElementEstimate) -> Row:
    values = ((name, getattr(row, name)) for _, name in ESTIMATES)
    return tuple(
        "" if v is None else v if name == "number" else float(f"{SCALE.get(name, 1.0) * v:.6g}")
        for name, v in values
    )


def _properties(part: Part, revision: str) -> list[tuple[str, str]]:
    """Name and text of what FreeCAD shows of a part."""
    bought = part.purchase.designation if part.purchase else ""
    return [
        ("PartNumber", part.part_no),
        ("Title", part.name),
        ("Revision", "" if part.purchase else revision),
        ("Process", part.process),
        ("Material", str(part.material)),
        ("Mass", f"{part.mass:.4g} g"),
        ("Order", bought),
    ]


def _scene(scene: SceneFacts, findings: Sequence[FindingFact]) -> dict[str, Any]:
    at = {p.designator: p for p in scene.placed}
    return {
        "name": scene.name,
        "placed": [dataclasses.asdict(p) for p in scene.placed],
        "findings": [
            {"label": f"{finding.severity}: {name}", "severity": finding.severity, "check": finding.check}
            | {"message": f"{finding.about}: {finding.message}", "at": _where(finding, at.get(name))}
            | {"way": at[name].way if name in at else (0.0, 0.0, 0.0)}
            for finding in findings
            if finding.scene in ("", scene.name)
            for name in _about(finding, at)
        ],
    }


def _about(finding: FindingFact, at: Mapping[str, PlacedFact]) -> list[str]:
    """Where a finding gets a mark: at the designators that it is about, else once at the scene's origin."""
    if finding.scene and finding.place:
        return [finding.check]
    here = [d for d in finding.designators if d in at]
    return here if finding.designators else [finding.about]


def _where(finding: FindingFact, placed: PlacedFact | None) -> Vector:
    """Place of the mark in the scene, mm."""
    x, y, z = (*finding.place, 0.0, 0.0, 0.0)[:3]
    if placed is None:
        return (x, y, z)
    at = [sum(r * v for r, v in zip(row, (x, y, z))) + o for row, o in zip(placed.rotation, placed.origin)]
    return (at[0], at[1], at[2])
