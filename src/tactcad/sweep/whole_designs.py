"""What is measured of one whole design at a time: elements, virtual builds, checks, files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tactcad.design.load import from_table
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import Design
from tactcad.mechanics.ladder import FINITE_ELEMENTS
from tactcad.parts.layout import Layout
from tactcad.parts.rules import refuse_broken

from .closed_forms import names_of
from .study import BUILDS, CHECKS, EXPORT, Study

# Columns beside those of the elements, by what is measured: numbers, then texts.
NUMBERS = {BUILDS: ("yield",), CHECKS: ("checks_failed", "checks_flagged"), EXPORT: ("files",)}
TEXTS = {BUILDS: ("most_missed",), CHECKS: ("first_failure",), EXPORT: ("manifest_sha256",)}


def numbers_of(study: Study) -> list[str]:
    """Columns of numbers that a study has, in the order of its table."""
    elements = [
        name for rung in study.measure.rungs for n in study.elements for name in names_of(study, rung, n)
    ]
    return elements + [
        name for what, names in NUMBERS.items() if what in study.measure.what for name in names
    ]


def texts_of(study: Study) -> list[str]:
    """Columns of text that a study has."""
    return [name for what, names in TEXTS.items() if what in study.measure.what for name in names]


def measured_whole(study: Study, table: dict[str, Any], folder: Path) -> tuple[dict[str, Any], str]:
    """What is asked of one design, by column, and why it was refused ("" where it was not).

    Parameters
    ----------
    study
        The study.
    table
        The design, as TOML would give it.
    folder
        Where an export goes.

    Raises
    ------
    InputError
        The export's folder is not ours to write, which says nothing about the design.
    """
    found: dict[str, Any] = {}
    try:
        design = from_table(table)
        refuse_broken(design)
        for rung in study.measure.rungs:
            if rung in FINITE_ELEMENTS:
                found |= _by_elements(study, design, rung)
        for what, measure in ((BUILDS, _builds), (CHECKS, _checks)):
            if what in study.measure.what:
                found |= measure(study, design)
    except (InputError, CheckFailure) as refusal:
        return found, str(refusal)
    try:
        if EXPORT in study.measure.what:
            found |= _export(design, folder)
    except CheckFailure as refusal:
        return found, str(refusal)
    return found, ""


def _by_elements(study: Study, design: Design, rung: str) -> dict[str, float]:
    from tactcad.lab.array_estimate import estimate

    layout = Layout(design)
    if max(study.elements) > len(layout.elements):
        raise CheckFailure(f"the design has no element {max(study.elements)}")
    wanted = {e.number: e for e in estimate(layout, rung, numbers=study.elements)}
    found: dict[str, float] = {}
    for number in study.elements:
        names = names_of(study, rung, number)
        values = [getattr(wanted[number], name.rpartition(".")[2]) for name in names]
        found |= dict(zip(names, (np.nan if v is None else v for v in values)))
    return found


def _builds(study: Study, design: Design) -> dict[str, Any]:
    from tactcad.assembly.virtual_build import sensor

    builds = sensor(design).built(study.measure.arrays)
    failures = builds.failures[builds.worse]
    worst = max(failures, key=lambda name: failures[name]) if failures else ""
    return {"yield": builds.share, "most_missed": worst}


def _checks(_: Study, design: Design) -> dict[str, Any]:
    from tactcad.checks.run import run_checks
    from tactcad.scenes import scene_names

    report = run_checks(design, scene_names(design))
    flags = [f for f in report.findings if f.severity == "flag"]
    failed = report.failures
    return {
        "checks_failed": len(failed),
        "checks_flagged": len(flags),
        "first_failure": str(failed[0]) if failed else "",
    }


def _export(design: Design, folder: Path) -> dict[str, Any]:
    from tactcad.export.contents import sha256_of
    from tactcad.export.pipeline import ExportOptions, export
    from tactcad.scenes import scene_names

    folder.parent.mkdir(parents=True, exist_ok=True)
    done = export(design, ExportOptions(tuple(scene_names(design))), folder, _Quiet())
    manifest = (folder / "manifest.json").read_bytes()
    return {"files": done.files, "manifest_sha256": sha256_of(manifest)}


class _Quiet:
    """No messages: a worker has no terminal."""

    def line(self, text: str) -> None:
        pass

    def step(self, done: int, total: int, text: str) -> None:
        pass
