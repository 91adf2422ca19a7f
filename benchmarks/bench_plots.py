"""Plots of a run, from its JSON: error against time, both logarithmic, the efficient choices joined by a
line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log10
from typing import TYPE_CHECKING

from tables import efficient, exponent

from tactcad.report import plots as drawing
from tactcad.report.plots import GREY, MARKERS, SERIES, drawn, log_ticks, note, panels
from tactcad.report.report import Picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as MplFigure

SIZE, SMALL = (12.4, 5.0), (7.6, 4.8)  # inches, of two panels and of one
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
# names of powers of ten
TIMES = {1e-8: "10 ns", 1e-7: "100 ns", 1e-6: "1 µs", 1e-5: "10 µs", 1e-4: "100 µs", 1e-3: "1 ms"}
TIMES |= {1e-2: "10 ms", 0.1: "100 ms", 1.0: "1 s", 10.0: "10 s", 100.0: "100 s"}
SHARES = {1e-7: "0.1 ppm", 1e-6: "1 ppm", 1e-5: "0.001 %", 1e-4: "0.01 %", 1e-3: "0.1 %", 1e-2: "1 %"}
SHARES |= {0.1: "10 %", 1.0: "100 %", 10.0: "1000 %"}


@dataclass(frozen=True)
class Point:
    """Seconds, worst and mean relative error."""

    label: str
    series: str
    seconds: float
    worst: float
    mean: float | None = None


@dataclass(frozen=True)
class Panel:
    """Error against time: the points, a title, labels of the axes; a legend; the error at which "none" is
    plotted.
    """

    points: list[Point]
    title: str
    across: str
    up: str
    legend: bool = False
    key: str = ""
    none: float | None = None


def figures(result: dict) -> dict[str, list[Picture]]:
    """Every plot that the run's benchmarks allow, by benchmark."""
    makers = {
        "rungs": _rungs,
        "meshes": _meshes,
        "tessellation": _tessellation,
        "interference": _interference,
        "scaling": _scaling,
    }
    rows = {name: _rows(result, name) for name in makers}
    shown = {name: [make(rows[name])] for name, make in makers.items() if rows[name]}
    if rows["rungs"] and rows["meshes"] and rows["tessellation"]:
        shown["rungs"].insert(0, choose(result))
    return shown


def _rows(result: dict, name: str) -> list[dict]:
    return result["benchmarks"].get(name, {}).get("tables", {}).get(name, {}).get("rows", [])


def choose(result: dict) -> Picture:
    """What to take for stiffness and for triangles."""
    meshes = [
        Point(f"mesh {r['density']}", "solid elements", r["seconds"], r["worst"], r["mean"])
        for r in _rows(result, "meshes")
        if r["code"] == "tactcad" and r["elements"] == "solid"
    ]
    key = (
        "filled and joined: worth choosing\nhollow: something else is quicker and more accurate\nmarker: "
        "worst error; line: down to the mean"
    )
    shown = (
        Panel(
            _rung_points(_rows(result, "rungs"), "solid") + meshes,
            "Stiffness of an element, in three dimensions",
            "time per element",
            "error against converged solid elements",
            key=key,
        ),
        Panel(
            _triangle_points(_rows(result, "tessellation")),
            "Triangles of the array's parts",
            "time for all parts",
            "volume error",
        ),
    )
    with panels(1, 2, SIZE, width_ratios=(1.7, 1.0)) as (figure, axes):
        return _drawn(
            figure,
            dict(zip(axes, shown)),
            "bench-choose",
            "Error against time: markers at the worst, lines down to the mean; what is worth choosing is "
            "joined, what is dominated is hollow",
        )


def _rung_points(rows: list[dict], against: str) -> list[Point]:
    kind = {"fem-plane": "plane elements", "fem-solid": "solid elements"}
    return [
        Point(r["rung"], kind.get(r["rung"], "closed form"), r["seconds"], worst, r[f"{against} mean"])
        for r in rows
        if (worst := r.get(f"{against} worst"))
    ]


def _rungs(rows: list[dict]) -> Picture:
    shown = [
        Panel(
            _rung_points(rows, against), title, "time per element", f"error against converged {kind} elements"
        )
        for against, title, kind in (
            ("solid", "In three dimensions", "solid"),
            ("plane", "In plane stress", "plane-stress"),
        )
    ]
    with panels(1, 2, SIZE) as (figure, axes):
        return _drawn(
            figure,
            dict(zip(axes, shown)),
            "bench-rungs",
            "Every rung over the envelope: markers at the worst error, lines down to the mean",
        )


def _meshes(rows: list[dict]) -> Picture:
    names = {"plane": "plane elements", "plane, two meshes": "two meshes", "solid": "solid elements"}

    def series(row: dict) -> str:
        if row["code"] == "tactcad":
            return names.get(row["elements"], row["elements"])
        return f"CalculiX, {row['elements']}" if row["code"] == "CalculiX" else row["code"]

    def panel(against: str, title: str) -> Panel:
        points = [
            Point(str(r["density"]), series(r), r["seconds"], r["worst"], r["mean"])
            for r in rows
            if r["against"] == against
        ]
        title = f"{title}: numbers are densities"
        return Panel(points, title, "time", "error against converged elements", legend=True)

    with panels(1, 2, SIZE) as (figure, (left, right)):
        return _drawn(
            figure,
            {left: panel("plane", "Plane stress"), right: panel("solid", "Three dimensions")},
            "bench-meshes",
            "Every mesh density, with CalculiX as whole processes where it is installed",
        )


def _triangle_points(rows: list[dict]) -> list[Point]:
    def label(r: dict) -> str:
        return f"{r['angular']:g} rad, {r['triangles'] / 1000:.0f}k"

    same = [r for r in rows if r["linear"] == rows[0]["linear"]]
    return [Point(label(r), "triangles", r["seconds"], r["worst"], r["volume error"]) for r in same]


def _tessellation(rows: list[dict]) -> Picture:
    across, up = "time for all parts of the array", "volume error: worst part, and all"
    with panels(1, 1, SMALL) as (figure, ax):
        return _drawn(
            figure,
            {ax: Panel(_triangle_points(rows), "Angular tolerance, triangles", across, up)},
            "bench-tessellation",
            "Volume error against time of meshing the array's parts",
        )


def _interference(rows: list[dict]) -> Picture:
    known = [r for r in rows if r["pairs"] == rows[0]["pairs"]]
    count = known[0]["count"]
    none = 0.5 / count  # where a logarithmic axis shows "none wrong"
    points = [
        Point(
            r["by"].replace("meshes, ", ""),
            "kernel" if r["by"] == "kernel" else "triangles",
            r["seconds"],
            max(r["wrong"] / r["count"], none),
        )
        for r in known
    ]
    panel = Panel(
        points,
        f"Verdicts on {count} known pairs",
        "time a pair",
        "share of wrong verdicts",
        none=None if all(r["wrong"] for r in known) else none,
    )
    with panels(1, 1, SMALL) as (figure, ax):
        return _drawn(
            figure,
            {ax: panel},
            "bench-interference",
            "Wrong verdicts against time: meshes at each tolerance, and the kernel",
        )


def _scaling(rows: list[dict]) -> Picture:
    names = list(dict.fromkeys(r["what"] for r in rows))
    estimates = [n for n in names if n.startswith(("estimate", "plane"))]
    with panels(1, 2, (12.4, 6.2)) as (figure, axes):
        for ax, chosen, title in zip(
            axes, (estimates, [n for n in names if n not in estimates]), ("Estimates", "Geometry")
        ):
            for i, name in enumerate(chosen):
                group = [r for r in rows if r["what"] == name]
                sizes, seconds = [r["elements"] for r in group], [r["seconds"] for r in group]
                label = f"{name}: n^{exponent(sizes, seconds).value:.2f}" if len(group) > 1 else name
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
            ax.set(xlabel="elements", ylabel="time", title=title)
            ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize=9)
        return drawn(figure, "bench-scaling", "Cost against the number of elements, with fitted exponents")


def _drawn(figure: MplFigure, shown: dict[Axes, Panel], name: str, caption: str) -> Picture:
    for ax, panel in shown.items():
        error_against_time(ax, panel)
    for ax, panel in shown.items():
        place_labels(figure, ax, [(p.label, p.seconds, p.worst) for p in panel.points])
    return drawn(figure, name, caption)


def error_against_time(ax: Axes, panel: Panel) -> None:
    """Markers at the worst error, a line down to the mean; the efficient front joined, dominated points
    hollow."""
    points = panel.points
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
    ax.set(xlabel=panel.across, ylabel=panel.up, title=panel.title)
    if panel.legend:
        ax.legend(loc="best", fontsize=9)
    if panel.key:
        ax.text(
            0.36, 0.97, panel.key, transform=ax.transAxes, va="top", fontsize=9, color=GREY, linespacing=1.5
        )
    if panel.none is not None:
        ax.axhline(panel.none, color=GREY, linewidth=0.8, linestyle=":")
        ax.annotate(
            "none wrong",
            (0.01, panel.none),
            (0, 4),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            color=GREY,
            fontsize=10,
        )


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """Whole powers of ten around the values, with room for markers."""
    return 10 ** (floor(log10(min(values))) - 0.1), 10 ** (ceil(log10(max(values))) + 0.1)


def _scale(ax: Axes, axis: str, names: dict[float, str]) -> None:
    """A logarithmic axis with a name at every power of ten."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    getattr(ax, f"set_{axis}scale")("log")
    one = getattr(ax, f"{axis}axis")
    one.set_major_locator(FixedLocator(list(names)))
    one.set_major_formatter(FuncFormatter(lambda v, _: names[min(names, key=lambda n: abs(n / v - 1.0))]))
    one.set_minor_locator(NullLocator())


def place_labels(
    figure: MplFigure, ax: Axes, labels: list[tuple[str, float, float]], size: float = 10.0
) -> None:
    """Write labels next to their points, each on the side where it covers least.

    To be called when the axes have their limits, since it depends on where the points are on the page.

    Parameters
    ----------
    figure, ax
        To write on.
    labels
        Text, and x and y in data units.
    size
        Of the letters, points.
    """
    figure.canvas.draw()  # the layout is known only then
    scale = 72.0 / figure.dpi
    points = [tuple(v * scale for v in ax.transData.transform((x, y))) for _, x, y in labels]
    frame = ax.get_window_extent()
    low, high = (frame.x0 * scale, frame.y0 * scale), (frame.x1 * scale, frame.y1 * scale)
    taken = [(x - 5, y - 5, x + 5, y + 5) for x, y in points]
    for (text, *place), (x, y) in zip(labels, points):
        width, height = 0.62 * size * len(text), 1.1 * size

        def box(place: tuple[float, float, str, str]) -> tuple[float, float, float, float]:
            dx, dy, ha, va = place
            left = x + dx - {"left": 0.0, "right": width, "center": width / 2}[ha]  # noqa: B023
            foot = y + dy - {"bottom": 0.0, "top": height, "center": height / 2}[va]  # noqa: B023
            return (left, foot, left + width, foot + height)  # noqa: B023

        def covered(place: tuple[float, float, str, str]) -> float:
            mine = box(place)  # noqa: B023
            outside = sum(max(0.0, low[i] - mine[i]) + max(0.0, mine[i + 2] - high[i]) for i in (0, 1))
            return sum(_common(mine, other) for other in taken) + 100.0 * outside

        best = min(_PLACES, key=covered)
        taken.append(box(best))
        dx, dy, ha, va = best
        note(ax, text, (place[0], place[1]), (dx, dy), ha=ha, va=va, fontsize=size, zorder=4)


# dx, dy in points and the text's corner there, in the order of preference
_PLACES = (
    (9, 0, "left", "center"),
    (-9, 0, "right", "center"),
    (0, 9, "center", "bottom"),
    (0, -9, "center", "top"),
    (7, 7, "left", "bottom"),
    (7, -7, "left", "top"),
    (-7, 7, "right", "bottom"),
    (-7, -7, "right", "top"),
    (14, 14, "left", "bottom"),
    (14, -14, "left", "top"),
    (-14, 14, "right", "bottom"),
    (-14, -14, "right", "top"),
    (0, 20, "center", "bottom"),
    (0, -20, "center", "top"),
)


def _common(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> float:
    """Common area of two boxes (left, foot, right, top)."""
    return max(0.0, min(a[2], b[2]) - max(a[0], b[0])) * max(0.0, min(a[3], b[3]) - max(a[1], b[1]))
