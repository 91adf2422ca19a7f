"""Plots of a run, from its JSON: error against time, both logarithmic, what is worth choosing on a line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

from tactcad.paper import plots as drawing
from tactcad.paper.plots import GREY, MARKERS, SERIES, log_ticks, panels, place_labels, svg
from tactcad.paper.report import Figure

from .exponent import fit
from .front import efficient

FRONT = "#c8d3dc"
COLOUR = {
    "closed form": drawing.BLUE,
    "plane elements": drawing.GREEN,
    "solid elements": drawing.RED,
    "two meshes": drawing.SKY,
    "solid, corrected": drawing.ORANGE,
    "CalculiX, plane": drawing.PURPLE,
    "CalculiX, solid": drawing.PURPLE,
    "CHOLMOD": GREY,
    "triangles": drawing.BLACK,
    "kernel": drawing.RED,
}
TIMES = {
    1e-8: "10 ns",
    1e-7: "100 ns",
    1e-6: "1 µs",
    1e-5: "10 µs",
    1e-4: "100 µs",
    1e-3: "1 ms",
    1e-2: "10 ms",
    1e-1: "100 ms",
    1.0: "1 s",
    10.0: "10 s",
    100.0: "100 s",
}
SHARES = {
    1e-7: "0.1 ppm",
    1e-6: "1 ppm",
    1e-5: "0.001 %",
    1e-4: "0.01 %",
    1e-3: "0.1 %",
    1e-2: "1 %",
    1e-1: "10 %",
    1.0: "100 %",
    10.0: "1000 %",
}


@dataclass(frozen=True)
class Point:
    """Seconds, worst and mean relative error."""

    label: str
    series: str
    seconds: float
    worst: float
    mean: float | None = None


def figures(result: dict) -> dict[str, list[Figure]]:
    """Every plot that the run's benchmarks allow, by benchmark."""
    found: dict[str, list[Figure]] = {}
    for name, make in (
        ("rungs", _rungs),
        ("meshes", _meshes),
        ("tessellation", _tessellation),
        ("interference", _interference),
        ("scaling", _scaling),
    ):
        rows = _rows(result, name)
        if rows:
            found[name] = [make(rows)]
    if _rows(result, "rungs") and _rows(result, "meshes") and _rows(result, "tessellation"):
        found["rungs"].insert(0, choose(result))
    return found


def _rows(result: dict, name: str, key: str | None = None) -> list[dict]:
    return result["benchmarks"].get(name, {}).get("tables", {}).get(key or name, {}).get("rows", [])


def choose(result: dict) -> Figure:
    """What to take for stiffness and for triangles."""
    rungs = _rung_points(_rows(result, "rungs"), "solid")
    meshes = [
        Point(f"mesh {r['density']}", "solid elements", r["seconds"], r["worst"], r["mean"])
        for r in _rows(result, "meshes")
        if r["code"] == "tactcad" and r["elements"] == "solid"
    ]
    with panels(1, 2, (12.4, 5.0), width_ratios=(1.7, 1.0)) as (figure, (left, right)):
        triangles = _triangle_points(_rows(result, "tessellation"))
        _error_against_time(
            left,
            rungs + meshes,
            "Stiffness of an element, in three dimensions",
            "time per element",
            "error against converged solid elements",
        )
        _error_against_time(
            right, triangles, "Triangles of the array's parts", "time for all parts", "volume error"
        )
        key = (
            "filled and joined: worth choosing\nhollow: something else is quicker and more accurate\nmarker: "
            "worst error; line: down to the mean"
        )
        left.text(
            0.36, 0.97, key, transform=left.transAxes, va="top", fontsize=9, color=GREY, linespacing=1.5
        )
        _labelled(figure, (left, right), (rungs + meshes, triangles))
        return Figure(
            "bench-choose",
            svg(figure, "bench-choose"),
            "Error against time: markers at the worst, lines down to the mean; what is worth choosing is "
            "joined, what is dominated is hollow",
        )


def _rung_points(rows: list[dict], against: str) -> list[Point]:
    kind = {"fem-plane": "plane elements", "fem-solid": "solid elements"}
    return [
        Point(
            r["rung"],
            kind.get(r["rung"], "closed form"),
            r["seconds"],
            r[f"{against} worst"],
            r[f"{against} mean"],
        )
        for r in rows
        if r.get(f"{against} worst")
    ]


def _rungs(rows: list[dict]) -> Figure:
    with panels(1, 2, (12.4, 5.0)) as (figure, axes):
        for ax, against, title in zip(axes, ("solid", "plane"), ("In three dimensions", "In plane stress")):
            kind = "solid" if against == "solid" else "plane-stress"
            _error_against_time(
                ax,
                _rung_points(rows, against),
                title,
                "time per element",
                f"error against converged {kind} elements",
            )
        _labelled(figure, axes, [_rung_points(rows, against) for against in ("solid", "plane")])
        return Figure(
            "bench-rungs",
            svg(figure, "bench-rungs"),
            "Every rung over the envelope: markers at the worst error, lines down to the mean",
        )


def _meshes(rows: list[dict]) -> Figure:
    def series(row: dict) -> str:
        if row["code"] == "CalculiX":
            return f"CalculiX, {row['elements']}"
        if row["code"] != "tactcad":
            return row["code"]
        return {"plane": "plane elements", "plane, two meshes": "two meshes", "solid": "solid elements"}.get(
            row["elements"], row["elements"]
        )

    points = [
        [
            Point(str(r["density"]), series(r), r["seconds"], r["worst"], r["mean"])
            for r in rows
            if r["against"] == against
        ]
        for against in ("plane", "solid")
    ]
    with panels(1, 2, (12.4, 5.0)) as (figure, axes):
        for ax, some, title in zip(axes, points, ("Plane stress", "Three dimensions")):
            _error_against_time(
                ax,
                some,
                f"{title}: numbers are densities",
                "time",
                "error against converged elements",
                legend=True,
            )
        _labelled(figure, axes, points)
        return Figure(
            "bench-meshes",
            svg(figure, "bench-meshes"),
            "Every mesh density, with CalculiX as whole processes where it is installed",
        )


def _triangle_points(rows: list[dict]) -> list[Point]:
    return [
        Point(
            f"{r['angular']:g} rad, {r['triangles'] / 1000:.0f}k",
            "triangles",
            r["seconds"],
            r["worst"],
            r["volume error"],
        )
        for r in rows
        if r["linear"] == rows[0]["linear"]
    ]


def _tessellation(rows: list[dict]) -> Figure:
    with panels(1, 1, (7.6, 4.8)) as (figure, ax):
        points = _triangle_points(rows)
        _error_against_time(
            ax,
            points,
            "Angular tolerance, triangles",
            "time for all parts of the array",
            "volume error: worst part, and all",
        )
        _labelled(figure, [ax], [points])
        return Figure(
            "bench-tessellation",
            svg(figure, "bench-tessellation"),
            "Volume error against time of meshing the array's parts",
        )


def _interference(rows: list[dict]) -> Figure:
    known = [r for r in rows if r["pairs"] == rows[0]["pairs"]]
    none = 0.5 / known[0]["count"]  # where a logarithmic axis shows "none wrong"
    points = [
        Point(
            r["by"].replace("meshes, ", ""),
            "kernel" if r["by"] == "kernel" else "triangles",
            r["seconds"],
            max(r["wrong"] / r["count"], none),
        )
        for r in known
    ]
    with panels(1, 1, (7.6, 4.8)) as (figure, ax):
        _error_against_time(
            ax,
            points,
            f"Verdicts on {known[0]['count']} known pairs",
            "time a pair",
            "share of wrong verdicts",
        )
        if any(not r["wrong"] for r in known):
            ax.axhline(none, color=GREY, linewidth=0.8, linestyle=":")
            ax.annotate(
                "none wrong",
                (0.01, none),
                xycoords=("axes fraction", "data"),
                xytext=(0, 4),
                textcoords="offset points",
                color=GREY,
                fontsize=10,
            )
        _labelled(figure, [ax], [points])
        return Figure(
            "bench-interference",
            svg(figure, "bench-interference"),
            "Wrong verdicts against time: meshes at each tolerance, and the kernel",
        )


def _scaling(rows: list[dict]) -> Figure:
    names = list(dict.fromkeys(r["what"] for r in rows))
    estimates = [n for n in names if n.startswith(("estimate", "plane"))]
    with panels(1, 2, (12.4, 6.2)) as (figure, axes):
        for ax, chosen, title in zip(
            axes, (estimates, [n for n in names if n not in estimates]), ("Estimates", "Geometry")
        ):
            for i, name in enumerate(chosen):
                group = [r for r in rows if r["what"] == name]
                sizes, seconds = [r["elements"] for r in group], [r["seconds"] for r in group]
                label = f"{name}: n^{fit(sizes, seconds).value:.2f}" if len(group) > 1 else name
                ax.plot(
                    sizes,
                    seconds,
                    color=SERIES[i % len(SERIES)],
                    marker=MARKERS[i % len(MARKERS)],
                    markersize=5,
                    linestyle="--" if i >= len(SERIES) else "-",
                    linewidth=1.4,
                    label=label,
                )
            _scale(ax, "y", TIMES)
            ax.set_xscale("log")
            log_ticks(ax.xaxis, [10**k for k in range(6)])
            ax.set_xlim(*_decades([r["elements"] for r in rows if r["what"] in chosen]))
            ax.set_ylim(*_decades([r["seconds"] for r in rows if r["what"] in chosen]))
            ax.set_xlabel("elements")
            ax.set_ylabel("time")
            ax.set_title(title)
            ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize=9)
        return Figure(
            "bench-scaling",
            svg(figure, "bench-scaling"),
            "Cost against the number of elements, with fitted exponents",
        )


def _error_against_time(
    ax, points: Sequence[Point], title: str, across: str, up: str, legend: bool = False
) -> None:
    """Markers at the worst error, a line down to the mean; the efficient front joined, what it dominates
    hollow."""
    front = efficient([(p.seconds, p.worst) for p in points])
    ax.plot(
        [points[i].seconds for i in front],
        [points[i].worst for i in front],
        color=FRONT,
        linewidth=5,
        solid_capstyle="round",
        zorder=1,
    )
    order = list(dict.fromkeys(p.series for p in points))
    for i, p in enumerate(points):
        colour, marker = COLOUR[p.series], MARKERS[order.index(p.series) % len(MARKERS)]
        if p.mean:
            ax.plot([p.seconds] * 2, [p.mean, p.worst], color=colour, linewidth=1.0, zorder=2)
        first = next(q for q in points if q.series == p.series) is p
        ax.plot(
            p.seconds,
            p.worst,
            marker,
            markersize=8,
            color=colour,
            markerfacecolor=colour if i in front else "#ffffff",
            markeredgewidth=1.5,
            linestyle="none",
            zorder=3,
            label=p.series if first else None,
        )
    _scale(ax, "x", TIMES)
    _scale(ax, "y", SHARES)
    ax.set_xlim(*_decades([p.seconds for p in points]))
    ax.set_ylim(*_decades([v for p in points for v in (p.worst, p.mean) if v]))
    ax.set_xlabel(across)
    ax.set_ylabel(up)
    ax.set_title(title)
    if legend:
        ax.legend(loc="best", fontsize=9)


def _labelled(figure, axes: Sequence, points: Sequence[Sequence[Point]]) -> None:
    for ax, some in zip(axes, points):
        place_labels(figure, ax, [(p.label, p.seconds, p.worst) for p in some])


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """Whole powers of ten around the values, with room for markers."""
    return 10 ** (floor(log10(min(values))) - 0.1), 10 ** (ceil(log10(max(values))) + 0.1)


def _scale(ax, axis: str, names: dict[float, str]) -> None:
    """A logarithmic axis with a name at every power of ten."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    getattr(ax, f"set_{axis}scale")("log")
    one = getattr(ax, f"{axis}axis")
    one.set_major_locator(FixedLocator(list(names)))
    one.set_major_formatter(FuncFormatter(lambda v, _: names[min(names, key=lambda n: abs(n / v - 1.0))]))
    one.set_minor_locator(NullLocator())
