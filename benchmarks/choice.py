"""One table to choose from: rung, tessellation, detail level."""

from __future__ import annotations

from tactcad.mechanics.register import BY_NAME
from tactcad.paper.report import sig

TESSELLATION = {
    0.5: "a first look",
    0.35: "pictures of long arrays",
    0.2: "the mesh check",
    0.1: "printing",
    0.05: "volumes from meshes",
}
DETAIL = {"full": "review, manufacture", "envelope": "layout and collision: no holes, pockets, threads"}
UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))


def duration(seconds: float) -> str:
    """Two digits in the unit that suits."""
    scale, unit = next((pair for pair in UNITS if seconds >= pair[0]), UNITS[-1])
    return f"{sig(seconds / scale, 2)} {unit}"


def choice(result: dict) -> str:
    """Markdown: what there is to choose, how wrong it is at worst, what it costs, and when to take it."""
    lines = ["| choose | setting | worst error | time | file | when |", "|---|---|---|---|---|---|"]
    for row in _rows(result, "rungs"):
        error = f"{sig(100 * row['solid worst'], 2)} %"
        lines.append(
            f"| rung, per element | `{row['rung']}` | {error} | {duration(row['seconds'])} | | "
            f"{BY_NAME[row['rung']].when} |"
        )
    for row in _rows(result, "tessellation"):
        when = TESSELLATION.get(row["angular"])
        if when and row["linear"] == _rows(result, "tessellation")[0]["linear"]:
            error, size = f"{sig(100 * row['worst'], 2)} % of volume", f"{sig(row['stl_bytes'] / 1e3, 2)} kB"
            lines.append(
                f"| triangles, array's parts | {row['angular']:g} rad | {error} | {duration(row['seconds'])} "
                f"| {size} | {when} |"
            )
    for row in _rows(result, "detail"):
        if row["scene"] in ("array", "grasping"):
            size = f"{sig(row['bytes'] / 1e3, 2)} kB"
            lines.append(
                f"| scene {row['scene']} | {row['detail']} | | {duration(row['seconds'])} | {size} | "
                f"{DETAIL[row['detail']]} |"
            )
    return "\n".join(lines)


def _rows(result: dict, name: str) -> list[dict]:
    return result["benchmarks"][name]["tables"][name]["rows"]
