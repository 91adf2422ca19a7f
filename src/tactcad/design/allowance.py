"""Error and time allowed for an answer, and the method that they allow.

A command lists its methods as grades, in the order of their work; `pick` takes one. Only costs are computed
for that, so an impossible request is refused before any work.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from .messages import CheckFailure, InputError
from .text_values import as_number

LONGEST = 1e9  # s, thirty years


@dataclass(frozen=True)
class Grade:
    """A method: its name, the largest relative error it promises, and its expected seconds, None if it
    answers at once."""

    name: str
    error: float
    seconds: float | None


@dataclass(frozen=True)
class Allowance:
    """Largest error of an answer (relative, of 1) and its largest time (s); None if that is not limited."""

    within: float | None = None
    seconds: float | None = None

    def __bool__(self) -> bool:
        return self.within is not None or self.seconds is not None


@dataclass(frozen=True)
class Picked:
    """The grade taken and its neighbours: the next of less work, and of less error; None at the ends."""

    asked: Allowance
    what: str
    grade: Grade
    coarser: Grade | None
    finer: Grade | None

    def text(self) -> str:
        """The grade taken, its promise, and the cost of the next grades, in one line."""
        sides = (("a step less", self.coarser), ("a step more", self.finer))
        steps = "; ".join(f"{side}: {_whole(grade) if grade else 'none'}" for side, grade in sides)
        return f"budget: {self.grade.name}: {self.what} within {_promise(self.grade)}; {steps}"

    def record(self) -> dict:
        """The same as JSON holds it; errors relative, times in seconds."""
        neighbours = {"less": self.coarser, "more": self.finer}
        return {
            "within": self.asked.within,
            "in_s": self.asked.seconds,
            "of": self.what,
            "chosen": asdict(self.grade),
            **{side: asdict(grade) if grade else None for side, grade in neighbours.items()},
        }


def read_within(text: str, where: str) -> float:
    """A relative error from "1%", "1 %" or "0.01". Raises InputError if it is none."""
    plain = text.strip()
    try:
        value = as_number(plain.removesuffix("%")) / (100.0 if plain.endswith("%") else 1.0)
    except ValueError:
        value = float("nan")
    if not 0.0 < value < 1.0:
        legal = '"0.1%", "1%", 0.01: above 0, below 100 %'
        raise InputError(where, "not an accuracy", value=text, legal=legal)
    return value


def read_seconds(text: str, where: str) -> float:
    """Seconds from text. Raises InputError if they are none."""
    try:
        value = as_number(text)
    except ValueError:
        value = float("nan")
    if not 0.0 < value <= LONGEST:
        raise InputError(where, "no time", value=text, legal=f"seconds, above 0, at most {LONGEST:g}")
    return value


def pick(grades: Sequence[Grade], asked: Allowance, what: str) -> Picked:
    """The grade of least work that keeps the error asked for, or the one of least error in the time.

    Parameters
    ----------
    grades
        In the order of their work, one or more. One that promises no less than one before is no step.
    asked
        Error, time or both.
    what
        The quantity with that error, as "K".

    Raises
    ------
    CheckFailure
        If no grade keeps the request; the message names the best possible.
    """
    steps: list[Grade] = []
    for grade in grades:
        if not steps or grade.error < steps[-1].error:
            steps.append(grade)
    good = [g for g in steps if asked.within is None or g.error <= asked.within]
    if not good:
        raise CheckFailure(
            f"nothing keeps {what} within {percent(asked.within)}: the best is {_whole(steps[-1])}"
        )
    in_time = [g for g in steps if asked.seconds is None or (g.seconds or 0.0) <= asked.seconds]
    possible = [g for g in good if g in in_time]
    if not possible:
        raise CheckFailure(_too_short(asked, what, good[0], in_time))
    chosen = possible[-1] if asked.within is None else possible[0]
    at = steps.index(chosen)
    finer = steps[at + 1] if at + 1 < len(steps) else None
    return Picked(asked, what, chosen, steps[at - 1] if at else None, finer)


def percent(error: float | None) -> str:
    return f"{100.0 * (error or 0.0):.2g} %"


def seconds_text(seconds: float) -> str:
    """About how long: "0.12 s", "117 min", "2.1 h"."""
    unit, size = next(((u, n) for u, n in (("h", 3600.0), ("min", 60.0)) if seconds >= 2.0 * n), ("s", 1.0))
    shown = seconds / size
    return f"{shown:.0f} {unit}" if shown >= 10.0 else f"{shown:.2g} {unit}"


def _too_short(asked: Allowance, what: str, needed: Grade, in_time: Sequence[Grade]) -> str:
    """The message of a too short time: the time needed, and the best within the given one."""
    of = "" if asked.within is None else f" for {what} within {percent(asked.within)}"
    best = f"; in {asked.seconds:g} s at best {_whole(in_time[-1])}" if in_time else ""
    return (
        f"{asked.seconds:g} s are too short{of}: needs about {needed.seconds or 0.0:.4g} s "
        f"({_whole(needed)}){best}"
    )


def _whole(grade: Grade) -> str:
    return f"{grade.name}, {_promise(grade)}"


def _promise(grade: Grade) -> str:
    time = "" if grade.seconds is None else f" in about {seconds_text(grade.seconds)}"
    return percent(grade.error) + time
