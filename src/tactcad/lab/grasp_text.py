"""Object stiffnesses as text for people and as JSON."""

from __future__ import annotations

import json
from math import isinf
from typing import Any

from tactcad.lab.combine import Interval
from tactcad.lab.grasp import Grasp
from tactcad.report.plain import plain

SCHEMA = "tactcad-stiffness-1"


def to_text(samples: list[Grasp], level: float, per_modulus: float | None = None) -> str:
    """For each sample K_obj of all elements, a table of its pairs, then limits and notes; `level` is that of
    the intervals, `per_modulus` K_obj for each MPa of the object's modulus."""
    lines = []
    for g in samples:
        c = g.combined
        lines += [
            *(f"warning: {warning}" for warning in g.warnings),
            f"sample {g.sample}: K_obj = {_number(c.estimate)} N/mm, {100 * level:.10g}% interval "
            f"{_interval(c)} ({c.verdict})",
            "",
        ]
        head = (
            "measuring",
            "reference",
            "R",
            f"{100 * level:.10g}% interval",
            "K_obj N/mm",
            f"{100 * level:.10g}% interval",
            "condition",
            "verdict",
        )
        body = [
            (
                str(p.measuring),
                str(p.reference),
                f"{p.ratio:.4f}",
                f"{p.ratio_low:.4f} to {p.ratio_high:.4f}",
                _number(p.object.estimate),
                _interval(p.object),
                f"{p.condition:.1f}",
                p.object.verdict,
            )
            for p in g.pairs
        ]
        width = [max(len(line[i]) for line in [head, *body]) for i in range(len(head))]
        lines += [
            "  ".join(cell.rjust(w) for cell, w in zip(line[:-1], width)) + "  " + line[-1]
            for line in [head, *body]
        ]
        lines += [
            "",
            f"slopes over {g.loads} loads; noise of one signal {g.noise * 1e3:.3g} mV ({g.dof} degrees "
            "of freedom); the combined value uses all elements at once, with the covariance of pairs "
            "that share the reference",
            f"K_obj of all elements by noise and calibration alone: {_interval(g.combined_by_noise)} N/mm",
            *(f"  {name}: {_interval(i)} N/mm" for name, i in g.combined_by_limits),
        ]
        if per_modulus:
            scaled = Interval(c.estimate / per_modulus, c.low / per_modulus, c.high / per_modulus, c.empty)
            lines.append(f"Young's modulus {_number(scaled.estimate)} MPa, interval {_interval(scaled)} MPa")
        lines += [*g.notes, ""]
    return "\n".join(lines)


def to_json(samples: list[Grasp], level: float, per_modulus: float | None = None) -> str:
    """All fields of every sample as JSON; an end that is not bounded is 'inf'."""
    records: list[Any] = [plain(g) for g in samples]
    for record, g in zip(records, samples):
        c = g.combined
        record["combined"]["verdict"] = c.verdict
        if per_modulus:
            values = {"estimate": c.estimate, "low": c.low, "high": c.high}
            record["modulus_MPa"] = plain({name: v / per_modulus for name, v in values.items()})
        for pair, p in zip(record["pairs"], g.pairs):
            pair["object"]["verdict"] = p.object.verdict
    data = {"schema": SCHEMA, "level": level, "units": "mm, N, V", "samples": records}
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def _number(value: float) -> str:
    return "infinite" if isinf(value) else f"{value:.4g}"


def _interval(i: Interval) -> str:
    return "none" if i.empty else f"{i.low:.4g} to {'no bound' if isinf(i.high) else f'{i.high:.4g}'}"
