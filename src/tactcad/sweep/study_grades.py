"""A study's rung and arrays as grades: what each choice promises of the worst design, and what the whole
study costs with it here, nothing of it being kept yet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tactcad.costs.grades import COUNTS, YIELD, counts, here, linear, published, seconds_each
from tactcad.design.allowance import Allowance, Grade, Picked, pick
from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure, InputError
from tactcad.mechanics.accuracy import CANDIDATES, MEASURED_FOR, Candidate, accuracy_data, zones
from tactcad.mechanics.ladder import RUNGS
from tactcad.mechanics.register import rungs
from tactcad.mechanics.section import HingeSection
from tactcad.mechanics.validity import reasons
from tactcad.scenes import scene_names
from tactcad.stacks.virtual_build import widest

from .designs_taken import designs_taken
from .measured import CLOSED_FORMS_A_TASK, Refused, sections
from .study import BUILDS, CHECKS, EXPORT, Study

OWN_MESH = tuple(c for c in CANDIDATES if c.mesh == rungs()[c.rung].meshes[0])  # a study names no other


def with_allowance(study: Study, asked: Allowance, workers: int) -> tuple[Study, Picked]:
    """The study with what the allowance picks: a rung instead of those that it names, a number of arrays.

    Parameters
    ----------
    study
        As read.
    asked
        P is the error of K, and of the yield's interval its half-width; if both are measured, of both.
    workers
        Processes that share the work.

    Raises
    ------
    InputError
        The study measures neither stiffness nor virtual builds, so there is nothing to pick.
    CheckFailure
        The allowance cannot be kept.
    """
    rungs, builds = study.measure.rungs, BUILDS in study.measure.what
    if not rungs and not builds:
        option = "--in" if asked.within is None else "--within"
        legal = "left out, or a study of a rung or of builds"
        raise InputError(
            option, "picks a rung or a number of arrays, and this study has neither", legal=legal
        )
    choices = [(study, "", 0.0)]
    each: dict[Candidate, float] = {}
    if rungs:
        errors, each = _promised(study)
        choices = [(_by_rung(study, c.rung), c.name, errors[c]) for c in OWN_MESH]
    if builds:
        choices = [
            (_by_arrays(one, n), f"{name}, {n} arrays".removeprefix(", "), max(error, widest(n)))
            for one, name, error in choices
            for n in COUNTS
        ]
    seconds = [_seconds(one, each, workers) for one, _, _ in choices]
    grades = [Grade(name, e, s) for (_, name, e), s in zip(choices, seconds)]
    if rungs and builds:  # no order of work among pairs but their time
        grades.sort(key=lambda grade: grade.seconds or 0.0)
    picked = pick(grades, asked, " and ".join(["K"] * bool(rungs) + [YIELD] * builds))
    return next(one for one, name, _ in choices if name == picked.grade.name), picked


def _by_rung(study: Study, rung: str) -> Study:
    what = [rung, *(w for w in study.measure.what if w not in RUNGS)]
    return replace(study, measure=replace(study.measure, what=tuple(what)))


def _by_arrays(study: Study, arrays: int) -> Study:
    return replace(study, measure=replace(study.measure, arrays=arrays))


def _promised(study: Study) -> tuple[dict[Candidate, float], dict[Candidate, float]]:
    """Largest error of each candidate over all designs where errors were measured, and seconds of an element,
    of the first designs' mean. Every design is looked at once."""
    present: set[int] = set()
    first: HingeSection | None = None
    for section in _all_sections(study):
        inside = np.flatnonzero(reasons(section, MEASURED_FOR).ravel() == "")
        present |= set(zones(section).ravel()[inside].tolist())
        first = section.rows(inside) if first is None and len(inside) else first
    if first is None:
        raise CheckFailure("the errors of the rungs were not measured for any design of this study")
    data = accuracy_data()["zones"]
    return {c: max(data[z]["promised"][c.name] for z in present) for c in OWN_MESH}, seconds_each(first)


def _all_sections(study: Study) -> Iterator[HingeSection]:
    """Every element measured, of many designs at a time; designs that cannot be read are left out."""
    for start in range(0, study.count, CLOSED_FORMS_A_TASK):
        stop = min(start + CLOSED_FORMS_A_TASK, study.count)
        found = sections(study, designs_taken(study, start, stop), Refused(stop - start))
        yield from (section for *_, section in found)


def _seconds(study: Study, each: dict[Candidate, float], workers: int) -> float:
    """Seconds of the whole study: its designs shared by the workers, and the work of one process alone."""
    costs, measure, count = published(), study.measure, study.count
    layout = family_of(study.design).layout(study.design)
    elements = {"element": float(len(layout.elements))}
    places = {p.number: p for p in layout.elements}
    kinds = {
        (p.arm, p.hinge, p.body_length) for n, p in places.items() if measure.rungs and n in study.elements
    }
    one = 0.0
    for rung in measure.rungs:
        closed = bool(rungs()[rung].compliance)
        own = next(c for c in OWN_MESH if c.rung == rung)
        one += len(study.elements) * costs["sweep"]["closed"] if closed else max(len(kinds), 1) * each[own]
    if BUILDS in measure.what:
        one += linear(costs["build"], elements) - costs["start"]["numpy"]
        one += measure.arrays * linear(costs["array"], elements)
    for what in {CHECKS, EXPORT} & set(measure.what):
        count_of, _ = counts(study.design, scene_names(study.design))
        one += linear(costs[what], count_of) - costs["start"]["kernel"]
    one += costs["sweep"]["design"] * measure.whole_designs
    kernel = costs["start"]["kernel"] * bool({CHECKS, EXPORT} & set(measure.what))
    alone = costs["sweep"]["start"] + kernel + count * costs["sweep"]["row"]
    return here(alone + count * one / min(workers, count))
