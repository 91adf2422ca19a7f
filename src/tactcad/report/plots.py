"""Style of the reports' pictures, and their SVG text: equal bytes from equal numbers."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from tactcad.report.report import Picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure as Canvas

# Okabe and Ito's palette, distinct for colour-blind readers; shapes differ as well.
SERIES = ("#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7")
BLACK, ORANGE, SKY, GREEN, BLUE, RED, PURPLE = SERIES
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
GREY = "#6a737d"

STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "axes.titlesize": 12,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e3e7eb",
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "legend.fontsize": 10,
    "svg.fonttype": "path",
    "figure.constrained_layout.use": True,
}


@contextmanager
def panels(
    rows: int = 1, columns: int = 1, size: tuple[float, float] = (11.2, 4.6), **options: Any
) -> Iterator:
    """Figure and axes in the reports' style; closed afterwards."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # a matplotlibrc in the working folder is anybody's: it could have TeX run
        matplotlib.rcParams.update(STYLE)
        figure, axes = plt.subplots(rows, columns, figsize=size, **options)
        try:
            yield figure, axes
        finally:
            plt.close(figure)


def svg(figure: Canvas, name: str) -> str:
    """SVG text for a page: no date, ids made of the name and the content, no XML header."""
    import matplotlib

    out = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": name}):
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Title": name})
    text = out.getvalue()
    text = text[text.index("<svg") :]
    # Several pictures share one page: ids get the picture's name before them.
    text = re.sub(r'(\bid="|xlink:href="#|url\(#)', rf"\g<1>{name}-", text)
    return re.sub(r"[ \t]+\n", "\n", text)


def drawn(figure: Canvas, name: str, caption: str) -> Picture:
    """The picture for a report, under that name."""
    return Picture(name, svg(figure, name), caption)


def log_ticks(axis: Axis, ticks: Iterable[float]) -> None:
    """Plain numbers at these places of a logarithmic axis, no minor labels."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

    axis.set_major_locator(FixedLocator(list(ticks)))
    axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axis.set_minor_formatter(NullFormatter())


def log_axes(ax: Axes, x: Iterable[float] = (), y: Iterable[float] = ()) -> None:
    """Logarithmic if there are ticks, with plain numbers at them."""
    for name, axis, ticks in (("x", ax.xaxis, x), ("y", ax.yaxis, y)):
        if ticks:
            ax.set(**{f"{name}scale": "log"})
            log_ticks(axis, ticks)


def note(ax: Axes, text: str, at: tuple[float, float], shift: tuple[float, float], **style: Any) -> None:
    """A text `shift` points off its place."""
    ax.annotate(text, at, shift, textcoords="offset points", **style)


def series(ax: Axes, i: int, x: ArrayLike, y: ArrayLike, hollow: bool = False, **style: Any) -> None:
    """Points of the i-th series in its colour and shape."""
    face = {"mfc": "white", "mec": SERIES[i]} if hollow else {"color": SERIES[i], "mec": "white", "mew": 0.6}
    ax.plot(x, y, MARKERS[i], **({"ms": 7} | face | style))


def with_bars(ax: Axes, i: int, x: ArrayLike, y: ArrayLike, half: ArrayLike, **style: Any) -> None:
    """Points of the i-th series in its colour and shape, with bars up and down."""
    ax.errorbar(x, y, yerr=half, fmt=MARKERS[i], color=SERIES[i], **style)


def legend_below(figure: Canvas, handles: list[Any]) -> None:
    """One legend for all panels, in a line below them."""
    close = {"columnspacing": 1.2, "handletextpad": 0.3}
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), **close)
