"""What came out of a synthesis, in a few words: for the command, the page and the design file's heading."""

from __future__ import annotations

from typing import Any


def percent(share: float) -> str:
    return f"{100 * share:.3g} %"


def answer(r: dict[str, Any]) -> str:
    """What came out, in two sentences."""
    low, high = r["object_range"]
    if not r["met"]:
        return f"Impossible as asked: the best there is {_why_not(r)}."
    e, base = r["elements"], r["base"]
    than = f"; {base['name']} as it is: {percent(base['half_width'])}" if base["half_width"] else ""
    if base["cannot"]:
        than = f"; {base['name']} as it is cannot take the force: {base['cannot']}"
    return (
        f"{len(e)} elements feel {low:.3g} to {high:.3g} N/mm within {percent(r['wanted_half_width'])} "
        f"(half the 95 % interval; as drawn {percent(r['half_width'])}{than}). "
        f"{percent(r['yield'])} of arrays made within "
        f"their tolerances keep that ({percent(r['yield_interval'][0])} to "
        f"{percent(r['yield_interval'][1])})."
    )


def _why_not(r: dict[str, Any]) -> str:
    why = [f"misses {name} by {_excess(v)}" for name, v in r["beyond"].items()]
    if r["out_of_range"]:
        why.append(f"has elements that the estimator does not reach ({'; '.join(r['out_of_range'])})")
    if why:
        return "; ".join(why)
    if r["half_width"] is None:
        return f"keeps all limits, but is refused ({', '.join(sorted(r['refused']))})"
    kept, wanted = percent(r["yield"]), percent(r["yield_wanted"])
    return f"keeps it as drawn, but of the arrays made only {kept} do, not {wanted}"


def _excess(v: float) -> str:
    return percent(v) if v < 10 else "more than ten times"


def no_other_change(r: dict[str, Any]) -> str:
    """What of changes of single fields was found not to do, and what was not tried."""
    left = [what for what in r["left_out"] if what.startswith("least change")]
    if not left and r["changes"]:
        return "no other single field changed up to eight times makes it possible"
    if not left:
        return "no single field changed up to eight times makes it possible"
    return f"not tried for time: {len(left)} fields that might make it possible if changed alone"
