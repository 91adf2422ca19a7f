"""The stack as a page: every requirement with limits, spread and worst case as bars, and who contributes."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from math import isfinite
from pathlib import Path

from .stack import StackLine
from .virtual_build import LEAST_YIELD, Builds

WIDTH, HEIGHT, EDGE = 300.0, 30.0, 10.0  # of a requirement's bar, px
SHOWN = 3  # contributors named with it


def stack_page(title: str, builds: Builds, lines: Sequence[StackLine]) -> bytes:
    """The page (HTML, UTF-8) of a design's stack and of the arrays built virtually."""
    style = Path(__file__).with_suffix(".css").read_text("utf-8")
    yields = ", ".join(f"{100 * share:.4g} % ({name})" for name, share in builds.kept.items())
    missed = "; ".join(
        f"{name}: " + ", ".join(f"{requirement} ({n})" for requirement, n in failed.items())
        for name, failed in builds.failures.items()
        if failed
    )
    rows = "\n".join(_row(line) for line in lines)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}: stack</title><style>{style}</style></head>
<body>
<h1>{escape(title)}: how limits add up</h1>
<p>Of {builds.count} arrays built virtually (seed {builds.seed}) all requirements are met by {escape(yields)}.
Parts are normal with limits at two standard deviations, uniform between their limits, or on corners, every
dimension at one of its limits. A release needs {100 * LEAST_YIELD:g} % with normal and with uniform
parts.{f" Missed, by arrays: {escape(missed)}." if missed else ""}</p>
<p><small>Bar: legal range in green; thin line from worst to worst case; thick line three standard deviations
each way; dot at the nominal value. Figures in the requirement's unit.</small></p>
<table><thead><tr><th>Requirement</th><th>Limits</th><th>Nominal</th><th></th><th>Worst case</th><th>Share of
variance</th></tr></thead>
<tbody>
{rows}
</tbody></table>
</body></html>
""".encode()


def _row(line: StackLine) -> str:
    r = line.requirement
    if isfinite(r.lower) and isfinite(r.upper):
        limits = f"{r.lower:.4g} to {r.upper:.4g}"
    else:
        limits = f"at least {r.lower:.4g}" if isfinite(r.lower) else f"at most {r.upper:.4g}"
    top = line.contributors[:SHOWN]
    bars = "".join(f'<i style="width:{100 * c.share:.1f}%"></i>' for c in top)
    named = "<br>".join(f"{escape(c.name)} {100 * c.share:.0f} %" for c in top)
    return (
        f"<tr{' class=missed' if line.kept < LEAST_YIELD else ''}><td>{escape(r.name)}</td>"
        f"<td class=n>{limits} {r.unit}</td><td class=n>{line.nominal:.4g}</td><td>{_bar(line)}</td>"
        f"<td class=n>{line.worst_low:.4g} to {line.worst_high:.4g}</td>"
        f"<td><div class=share>{bars}</div><small>{named}</small></td></tr>"
    )


def _bar(line: StackLine) -> str:
    r = line.requirement
    three = (line.nominal - 3 * line.sigma, line.nominal + 3 * line.sigma)
    ends = [v for v in (r.lower, r.upper, line.worst_low, line.worst_high, *three) if isfinite(v)]
    low, high = min(ends), max(ends)
    span = (high - low) or 1.0

    def x(v: float) -> float:
        v = min(max(v, low), high)
        return round(EDGE + (WIDTH - 2 * EDGE) * (v - low) / span, 1)

    y = HEIGHT / 2
    left = x(r.lower) if isfinite(r.lower) else 0.0
    right = x(r.upper) if isfinite(r.upper) else WIDTH
    return (
        f'<svg width="{WIDTH:g}" height="{HEIGHT:g}" role="img" aria-label="from {line.worst_low:.4g} to '
        f'{line.worst_high:.4g}">'
        f'<rect x="{left}" y="5" width="{max(right - left, 1.0):.1f}" height="{HEIGHT - 10:g}" '
        'fill="#dcebdc"/>'
        f'<line x1="{x(line.worst_low)}" x2="{x(line.worst_high)}" y1="{y}" y2="{y}" stroke="#1c2733"/>'
        f'<line x1="{x(three[0])}" x2="{x(three[1])}" y1="{y}" y2="{y}" stroke="#31618f" stroke-width="7"/>'
        f'<circle cx="{x(line.nominal)}" cy="{y}" r="4" fill="#fff" stroke="#1c2733"/></svg>'
    )
