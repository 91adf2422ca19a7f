"""A study's table as one offline page: what depends on what (shares of variance, main effects, pairs)."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tactcad.design.files import write_whole
from tactcad.design.messages import CheckFailure, InputError
from tactcad.export.manifest import read_sealed
from tactcad.report.figures import percent
from tactcad.report.plots import BLUE, GREY, drawn, panels
from tactcad.report.report import ReportSection, ReportTable, ValidationReport, to_html

from .run_sweep import PARQUET
from .store import SCHEMA, mark_of

if TYPE_CHECKING:
    from matplotlib.axis import Axis

PAGE = "plot.html"
MOST_ROWS = 200_000  # that the page is made of, of a longer table by chance
MOST_RESULTS = 6  # on the page: the first that vary
FAINT = BLUE + "26"  # 15 %
MOST_LETTERS = 16  # of a word below an axis
MOST_PAIRED, MOST_POINTS = 7, 1500  # columns and rows of the pairs' figure
LEAST_IN_BIN, MOST_BINS = 10, 24

Floats = NDArray[np.float64]


def write_page(out: str | Path) -> Path:
    """Write DIR/plot.html.

    Raises
    ------
    InputError
        The folder is no study's, or its table is not there, or not as the sweep wrote it.
    CheckFailure
        No field or no result varies among the designs that were measured.
    """
    folder = Path(out)
    mark_of(folder)
    manifest = read_sealed(folder, SCHEMA)
    vary, sha256 = list(manifest["study"]["vary"]), manifest["files"][0]["sha256"]
    columns, words = _columns(folder, sha256, vary)
    measured = manifest["designs"] - manifest["refused"]
    fields = [name for name in vary if name in columns]
    results = _results(columns, fields)
    if not fields or not results:
        lacking = f"no {'result' if fields else 'varied field'} differs among the designs that were measured"
        raise CheckFailure(f"{out}: nothing to plot: {lacking} ({measured} of {manifest['designs']})")
    shown = results[:MOST_RESULTS]
    sections = [_pairs_section(columns, fields, shown, words)]
    summary = [f"{measured} designs were measured: shares and main effects take more than {LEAST_IN_BIN}"]
    if measured > LEAST_IN_BIN:
        summary = _summary(columns, fields, shown)
        shares = _shares_section(columns, fields, shown, [name for name in vary if name not in columns])
        sections = [shares, _effects_section(columns, fields, shown, words), *sections]
    report = ValidationReport(
        title=f"Study {manifest['study']['name']}",
        subtitle=f"{manifest['designs']} designs of {manifest['study']['table']['design']}, "
        f"{manifest['refused']} refused",
        summary=tuple(summary),
        sections=tuple(sections),
        colophon=f"Made of {PARQUET}, SHA-256 {sha256}; results shown: "
        f"{len(shown)} of {len(results)} that vary.",
    )
    write_whole(folder / PAGE, to_html(report).encode())
    return folder / PAGE


def _columns(
    folder: Path, sha256: str, vary: Sequence[str]
) -> tuple[dict[str, Floats], dict[str, list[str]]]:
    """Varied columns of the measured designs, in the order of the table of that digest: numbers, or for
    fields with words or lists their index; and those words."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        with open(folder / PARQUET, "rb") as stream:
            if hashlib.file_digest(stream, "sha256").hexdigest() != sha256:
                legal = "the table as written, or the same sweep run again"
                raise InputError(str(folder / PARQUET), "altered since the sweep wrote it", legal=legal)
        file = pq.ParquetFile(folder / PARQUET)
    except (OSError, pa.ArrowInvalid) as error:
        what = f"cannot be read: {error}"
        raise InputError(str(folder / PARQUET), what, legal="a finished study") from None
    share = min(1.0, MOST_ROWS / max(1, file.metadata.num_rows))
    groups = (file.read_row_group(i) for i in range(file.num_row_groups))
    table = pa.concat_tables(group.take(_some(group.num_rows, share)) for group in groups)
    table = table.filter(table["valid"])
    numbers = [f.name for f in table.schema if pa.types.is_floating(f.type)]
    columns = {name: table[name].to_numpy() for name in numbers if table.num_rows}
    columns = {name: v for name, v in columns.items() if np.isfinite(v).all() and np.ptp(v) > 0}
    words = {}
    most = LEAST_IN_BIN if table.num_rows <= LEAST_IN_BIN else most_bins(table.num_rows)
    for name in (n for n in vary if n not in numbers):
        found, which = np.unique(table[name].to_numpy(zero_copy_only=False).astype(str), return_inverse=True)
        if 1 < len(found) <= most:
            words[name], columns[name] = found.tolist(), which.astype(float)
    return columns, words


def _some(count: int, share: float) -> NDArray[np.int64]:
    """A random share of the rows: every n-th of a Sobol sequence would leave out parts of the ranges."""
    rows = np.random.default_rng(count).permutation(count)
    return np.sort(rows[: max(1, round(share * count))])


def _results(columns: dict[str, Floats], fields: Sequence[str]) -> list[str]:
    """Results that differ from each other, stiffnesses first; promised errors are none."""
    names = [n for n in columns if n not in fields and not n.endswith(".expected_error")]
    first: dict[bytes, str] = {}
    for name in names:
        first.setdefault(columns[name].tobytes(), name)
    return sorted(first.values(), key=lambda name: not name.endswith(".stiffness"))


def most_bins(designs: int) -> int:
    """Into which a field is divided."""
    return max(2, min(MOST_BINS, designs // LEAST_IN_BIN))


def binned(field: Floats, result: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Middles of the field's bins, and in each the result's count, mean and variance.

    Bins hold as many designs each; a field of few values has a bin for each.
    """
    most = most_bins(len(field))
    values = np.unique(field)
    if len(values) <= most:
        index = np.searchsorted(values, field)
    else:
        index = np.argsort(np.argsort(field, kind="stable"), kind="stable") * most // len(field)
    count = np.bincount(index).astype(float)
    mean = np.bincount(index, result) / count
    variance = np.bincount(index, (result - mean[index]) ** 2) / count
    return np.bincount(index, field) / count, count, mean, variance


def first_order_share(field: Floats, result: Floats) -> float:
    """First-order Sobol index Var(E[y|x])/Var(y), estimated from the designs as they are.

    By the variance of the result's means over the field's bins, less what chance gives them: epsilon squared
    of the analysis of variance (Kelley, 1935). Fields that vary together share what they explain.
    """
    _, count, mean, variance = binned(field, result)
    total = float(((result - result.mean()) ** 2).sum())
    between = float((count * (mean - result.mean()) ** 2).sum())
    within = float((count * variance).sum())
    free = len(result) - len(count)
    by_chance = (len(count) - 1) * within / free if free > 0 else 0.0
    return float(np.clip((between - by_chance) / total, 0.0, 1.0))


def _shares(columns: dict[str, Floats], fields: Sequence[str], result: str) -> list[float]:
    return [first_order_share(columns[field], columns[result]) for field in fields]


def _summary(columns: dict[str, Floats], fields: Sequence[str], results: Sequence[str]) -> list[str]:
    lines = []
    for result in results:
        shares = _shares(columns, fields, result)
        most = int(np.argmax(shares))
        lines.append(f"{result}: most by {fields[most]}, {percent(shares[most])} of its variance")
    return lines


def _shares_section(
    columns: dict[str, Floats], fields: Sequence[str], results: Sequence[str], absent: Sequence[str]
) -> ReportSection:
    rows = []
    for result in results:
        shares = _shares(columns, fields, result)
        rows.append((result, *(percent(s) for s in shares), percent(max(0.0, 1.0 - sum(shares)))))
    table = ReportTable(
        "First-order shares of variance",
        (("result", ""), *((field, "") for field in fields), ("together", "")),
        tuple(rows),
        "What is left to fields together, and to chance.",
    )
    findings = ["A share says by how much the result's variance would fall if that field alone were known."]
    if absent:
        why = "it took one value, or too many words or lists for so few designs"
        findings.append(f"Not shown, as {why}: {', '.join(absent)}.")
    return ReportSection("shares", "Sobol shares", "Which field decides?", tuple(findings), (table,))


def _effects_section(
    columns: dict[str, Floats], fields: Sequence[str], results: Sequence[str], words: dict[str, list[str]]
) -> ReportSection:
    size = (2.6 * len(fields) + 1.2, 2.1 * len(results) + 0.4)
    with panels(len(results), len(fields), size, squeeze=False, sharey="row", sharex="col") as (figure, axes):
        for row, result in zip(axes, results):
            for ax, field in zip(row, fields):
                middle, _, mean, variance = binned(columns[field], columns[result])
                ax.tick_params(labelsize=8)
                deviation = np.sqrt(variance)
                if field in words:
                    ax.errorbar(middle, mean, deviation, fmt="o", color=BLUE, ecolor=FAINT, elinewidth=6)
                    continue
                ax.fill_between(middle, mean - deviation, mean + deviation, color=FAINT, lw=0)
                ax.plot(middle, mean, color=BLUE)
            row[0].set_ylabel(_short(result), fontsize=9)
        for ax, field in zip(axes[-1], fields):
            ax.set_xlabel(_short(field), fontsize=9)
            _name_words(ax.xaxis, words.get(field), 30)
        picture = drawn(figure, "effects", "Line: mean. Band: one standard deviation to either side.")
    finding = "A field that moves the mean acts by itself; where the band is wide, the other fields act."
    return ReportSection("effects", "Main effects", "What does each field do?", (finding,), (), (picture,))


def _pairs_section(
    columns: dict[str, Floats], fields: Sequence[str], results: Sequence[str], words: dict[str, list[str]]
) -> ReportSection:
    names = [*fields, *results][: max(MOST_PAIRED, len(fields) + 1)]
    count = len(columns[names[0]])
    rows = _some(count, min(1.0, MOST_POINTS / count))
    n = len(names)
    with panels(n, n, (1.75 * n + 1, 1.75 * n), squeeze=False) as (figure, axes):
        for i, y in enumerate(names):
            for j, x in enumerate(names):
                ax = axes[i, j]
                if i == j:
                    ax.hist(columns[x], bins=24, color=GREY)
                    ax.set_yticks([])
                else:
                    ax.plot(columns[x][rows], columns[y][rows], ".", color=BLUE, ms=1.6, rasterized=True)
                ax.tick_params(labelsize=7, labelbottom=i == n - 1, labelleft=j == 0)
                ax.grid(False)
            axes[i, 0].set_ylabel(_short(y), fontsize=8)
            axes[-1, i].set_xlabel(_short(y), fontsize=8)
            _name_words(axes[-1, i].xaxis, words.get(y), 30)
            if i:  # the first row's scale is of how often
                _name_words(axes[i, 0].yaxis, words.get(y), 0)
        text = f"{len(rows)} designs; on the diagonal, how often each value occurs."
        picture = drawn(figure, "pairs", text)
    finding = "Fields were taken as the upper left shows; results that go together lie on one line."
    return ReportSection("pairs", "Pairs", "Which go together?", (finding,), (), (picture,))


def _name_words(axis: Axis, words: list[str] | None, rotation: float) -> None:
    """Words instead of their places, if the axis is of words."""
    if words:
        short = [w if len(w) <= MOST_LETTERS else w[:MOST_LETTERS] + "..." for w in words]
        axis.set_ticks(range(len(words)), short, rotation=rotation, fontsize=7)


def _short(name: str) -> str:
    """A column's name on two lines."""
    head, _, last = name.rpartition(".")
    return f"{head}\n{last}" if head else name
