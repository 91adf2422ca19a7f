"""Tolerance stacks: for each requirement nominal, worst case, spread, and contributions; as a table, and as a
page with limits, spread and worst case as bars."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tactcad.design.family import family_of
from tactcad.mechanics.section import Array
from tactcad.parts.array.layout import Layout
from tactcad.scenes.requirement import Deviations, DimensionLimits, Requirement

from .mechanic import Assembled
from .variables import made

if TYPE_CHECKING:
    from .virtual_build import Builds

HEAD = ("requirement", "unit", "lower", "upper", "nominal", "worst_low", "worst_high", "sigma", "yield")
CONTRIBUTORS = 5  # columns of the table; a stack's further ones are small
SEED = 20261122  # published: the day on which stacks were first made
CORNERS, EFFECTS = 250, 125  # arrays on their corners, and of these for effects: to some percent of the whole
# Least share of arrays that meet all requirements; below it nothing is released.
LEAST_YIELD = 0.995
# A requirement counts as kept if it is missed by no more than rounding, in its unit.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Contributor:
    """A variable's share of a requirement's variance."""

    name: str
    share: float


@dataclass(frozen=True)
class StackLine:
    """One requirement of an array, at its instance that is nearest to a limit.

    nominal                 all parts at the middle of their limits
    worst_low, worst_high   every contributor at the limit that lowers, or raises, the value; behind contacts
                            the worst corner found
    sigma                   standard deviation with normal parts
    kept                    share of arrays that keep it, normal parts
    contributors            the largest first; shares sum to 1
    """

    requirement: Requirement
    nominal: float
    worst_low: float
    worst_high: float
    sigma: float
    kept: float
    contributors: tuple[Contributor, ...]

    @property
    def shortfall(self) -> float:
        """Excess of the worst case over the limits, in the requirement's unit; 0 if there is none."""
        r = self.requirement
        return max(0.0, r.lower - self.worst_low, self.worst_high - r.upper)


FEW = 40  # pieces of the variables that matter to a value, for it to be climbed


def stack(
    layout: Layout, variables: dict[str, DimensionLimits], wanted: Sequence[Requirement], count: int = 1000
) -> list[StackLine]:
    """The stack of every requirement, for the published seed.

    Parameters
    ----------
    layout
        The array.
    variables, wanted
        As `requirements` gives them.
    count
        Arrays drawn for spread and yield, and as many on their corners.
    """
    rng = np.random.default_rng(SEED)
    assemble = family_of(layout.design).stack.built
    built = assemble(layout, made(variables, count, "normal", rng))
    lines = {r.name: _summed(r, variables, built) for r in wanted if r.linear}
    behind = [r for r in wanted if not r.linear]
    lines |= {line.requirement.name: line for line in _behind_contacts(behind, variables, built, rng)}
    return [lines[r.name] for r in wanted]


def _summed(r: Requirement, variables: dict[str, DimensionLimits], built: Assembled) -> StackLine:
    """A sum of deviations: exact but for spread and yield, which are the drawn arrays'."""
    assert r.linear
    middle, terms = r.linear
    reach = {}
    for name, c in terms:
        v = variables[name]
        middle += c * float((v.upper + v.lower).sum()) / 2
        reach[name] = abs(c) * (v.upper - v.lower) / 2
    half = sum(float(v.sum()) for v in reach.values())
    value = r.value(built)
    ranked = _ranked({name: float((v**2).sum()) for name, v in reach.items()})
    return StackLine(r, middle, middle - half, middle + half, _spread(value), _share_kept(r, value), ranked)


def _behind_contacts(
    wanted: Sequence[Requirement],
    variables: dict[str, DimensionLimits],
    built: Assembled,
    rng: np.random.Generator,
) -> Iterator[StackLine]:
    """Values behind contacts, from arrays with every part on one of its limits.

    Shares are total effects (Jansen 1999): half the mean square of the value's change if one variable alone
    is drawn anew. The worst cases are the arrays with each part at the limit given by its correlation with
    the value, or the worst drawn array if that is worse.
    """
    if not wanted:
        return
    layout, assembled = built.layout, type(built)
    count = min(len(next(iter(built.made.values()))), CORNERS)
    middle = assembled(layout, made(variables, 1, "normal", rng, only=()))
    corners = assembled(layout, made(variables, count, "corners", rng, alike=False))
    anew = made(variables, count, "corners", rng, alike=False)
    instance = {r.name: int(np.argmin(r.margin(r.value(built)).min(axis=0))) for r in wanted}
    seen = {r.name: _at(r.value(corners), instance[r.name]) for r in wanted}
    some = assembled(layout, {name: v[:EFFECTS] for name, v in corners.made.items()})
    effect: dict[str, dict[str, float]] = {r.name: {} for r in wanted}
    for name, v in variables.items():
        if v.matters == "joint":
            continue
        changed = some.with_new(v, anew[name][:EFFECTS])
        for r in wanted:
            moved = _at(r.value(changed), instance[r.name]) - seen[r.name][:EFFECTS]
            effect[r.name][name] = float((moved**2).mean() / 2)
    worst = []
    for r in wanted:
        ways = {name: _way(corners.made[name], seen[r.name]) for name in variables}
        worst += [_corner(variables, ways, sign) for sign in (-1.0, 1.0)]
    # all of them at once: a program's own cost is larger than that of a few arrays
    extreme = assembled(layout, {name: np.vstack([made_[name] for made_ in worst]) for name in variables})
    for n, r in enumerate(wanted):
        value, at = seen[r.name], instance[r.name]
        ends = [*_at(r.value(extreme), at)[2 * n : 2 * n + 2]]
        ends += _climbed(r, at, corners, value, effect[r.name], variables)
        yield StackLine(
            r,
            float(_at(r.value(middle), at)[0]),
            float(min(*ends, value.min())),
            float(max(*ends, value.max())),
            _spread(_at(r.value(built), at)),
            _share_kept(r, r.value(built)),
            _ranked(effect[r.name]),
        )


def _climbed(
    r: Requirement,
    at: int,
    corners: Assembled,
    value: Array,
    effect: dict[str, float],
    variables: dict[str, DimensionLimits],
) -> list[float]:
    """Lowest and highest value by moving single pieces to their other limit, from the worst drawn arrays: if
    a value falls to both sides of its middle, no correlation shows the way. Only if few pieces matter."""
    names = [n for n, v in effect.items() if v > 0.0]
    flips = [(name, i) for name in names for i in range(variables[name].pieces)]
    if not 0 < len(flips) <= FEW:
        return []
    found = []
    for sign in (-1.0, 1.0):
        start = int(np.argmax(sign * value))
        one = {name: v[start : start + 1] for name, v in corners.made.items()}
        best = float(value[start])
        for _ in range(len(flips)):
            tried = {name: np.repeat(v, len(flips), axis=0) for name, v in one.items()}
            for row, (name, i) in enumerate(flips):
                v = variables[name]
                tried[name][row, i] = v.upper[i] + v.lower[i] - tried[name][row, i]
            reached = _at(r.value(type(corners)(corners.layout, tried)), at)
            row = int(np.argmax(sign * reached))
            if sign * (reached[row] - best) <= ROUNDING:
                break
            best, one = float(reached[row]), {name: v[row : row + 1] for name, v in tried.items()}
        found.append(best)
    return found


def _at(value: Array, instance: int) -> Array:
    return value[:, min(instance, value.shape[1] - 1)]


def _way(deviations: Array, value: Array) -> Array:
    """For each piece: 1 if a value rises with its deviation, -1 if it falls, 0 if chance would do as much."""
    d, v = deviations - deviations.mean(axis=0), value - value.mean()
    norm = np.sqrt((d**2).sum(axis=0) * (v**2).sum())
    correlation = np.divide(d.T @ v, norm, out=np.zeros(d.shape[1]), where=norm > 0)
    # three standard deviations of the correlation of independent numbers
    return np.where(np.abs(correlation) > 3.0 / np.sqrt(len(v)), np.sign(correlation), 0.0)


def _corner(variables: dict[str, DimensionLimits], ways: dict[str, Array], sign: float) -> Deviations:
    """One array with each piece at the limit of its direction, in the middle if it has none."""
    return {
        name: ((v.upper + v.lower) / 2 + sign * ways[name] * (v.upper - v.lower) / 2)[np.newaxis]
        for name, v in variables.items()
    }


def _spread(value: Array) -> float:
    """Standard deviation; 0 if the values differ by rounding only."""
    return float(value.std()) if np.ptp(value) > ROUNDING else 0.0


def _share_kept(r: Requirement, value: Array) -> float:
    return float((r.margin(value).min(axis=1) >= -ROUNDING).mean())


def _ranked(variance: dict[str, float]) -> tuple[Contributor, ...]:
    total = sum(variance.values())
    if total <= 0.0:
        return ()
    shares = sorted(variance.items(), key=lambda item: (-item[1], item[0]))
    return tuple(Contributor(name, v / total) for name, v in shares if v > 0.0)


def stack_bytes(lines: Sequence[StackLine]) -> bytes:
    """The table (RFC 4180, UTF-8): a row a requirement, its five largest contributors with their shares."""
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    pairs = [f"{what}_{n}" for n in range(1, CONTRIBUTORS + 1) for what in ("contributor", "share")]
    writer.writerow((*HEAD, *pairs))
    for line in lines:
        r = line.requirement
        limits = [f"{v:.6g}" if isfinite(v) else "" for v in (r.lower, r.upper)]
        figures = (line.nominal, line.worst_low, line.worst_high, line.sigma, line.kept)
        cells = [c for x in line.contributors[:CONTRIBUTORS] for c in (x.name, f"{x.share:.3f}")]
        row = [r.name, r.unit, *limits, *(f"{v + 0.0:.5g}" for v in figures), *cells]
        writer.writerow(row + [""] * (len(HEAD) + len(pairs) - len(row)))
    return text.getvalue().encode()


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
