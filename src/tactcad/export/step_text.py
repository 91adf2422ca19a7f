"""STEP text (ISO 10303-21) in canonical form: equal content gives equal bytes, in any process.

The kernel numbers instances by a counter of the whole process and orders styles by memory address. Here every
entity is numbered anew in the order in which a walk from the top meets it.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable
from dataclasses import dataclass

from tactcad import __version__

_ENTITY = re.compile(r"#(\d+)\s*=\s*((?:'(?:[^']|'')*'|[^';])*);")
_REFERENCE = re.compile(r"'(?:[^']|'')*'|#(\d+)")
# Text that the kernel gives every instance, without information: 37 bytes of each.
_PLACEMENT = re.compile(r"^PRODUCT_DEFINITION_SHAPE\('Placement','Placement of an item',")
_INSTANCE = re.compile(r"^NEXT_ASSEMBLY_USAGE_OCCURRENCE\('[^']*','((?:[^']|'')*)'")
# A tolerance's value, whose measure the kernel does not write.
_MEASURE = re.compile(r"^MEASURE_WITH_UNIT\(([-+.\dE]+),")
# With every round tolerance zone the kernel writes the angle of a runout zone, which does not exist.
_RUNOUT, _ANGLE = re.compile("RUNOUT_ZONE_(DEFINITION|ORIENTATION)\\("), "PLANE_ANGLE_MEASURE_WITH_UNIT("
_STYLES = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"

AP214 = "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }"
AP242 = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }"


@dataclass(frozen=True)
class Header:
    """Entries of the file's header. date is YYYY-MM-DD; the time of day is fixed at midnight."""

    name: str
    description: str
    revision: str
    date: str
    author: str
    organisation: str


def canonical(text: str, header: Header, schema: str = AP214) -> str:
    """The kernel's STEP text with the given header, its entities renumbered in canonical order."""
    bodies = {
        int(n): re.sub(r"\s*\n\s*", "", body) for n, body in _ENTITY.findall(text[text.index("DATA;") :])
    }
    bodies = {n: _plain(body) for n, body in bodies.items() if not _RUNOUT.match(body)}
    references = {
        n: [int(m.group(1)) for m in _REFERENCE.finditer(body) if m.group(1)] for n, body in bodies.items()
    }
    used = {r for refs in references.values() for r in refs}
    roots = [n for n in bodies if n not in used and not bodies[n].startswith(_ANGLE)]
    styles = {n for n in roots if bodies[n].startswith(_STYLES)}
    digests = _digests(bodies, references, styles) if len(styles) > 1 else {}
    numbers: dict[int, int] = {}
    order: list[int] = []

    def take(root: int) -> None:
        stack = [root]
        while stack:
            n = stack.pop()
            if n in numbers:
                continue
            numbers[n] = len(order) + 1
            order.append(n)
            stack.extend(reversed(references[n]))

    # products in the kernel's order, which is the writing order; then styles, which have none, by content,
    # and those of equal solids by the solids' places
    for root in sorted(set(roots) - styles):
        take(root)
    for root in sorted(styles, key=lambda n: (digests.get(n, ""), _leads_to(n, references, numbers))):
        take(root)
    new = lambda m: f"#{numbers[int(m[1])]}" if m[1] else m[0]  # noqa: E731
    lines = [f"#{numbers[n]}={_REFERENCE.sub(new, bodies[n])};" for n in order]
    return "\n".join([_header(header, schema), "DATA;", *lines, "ENDSEC;", "END-ISO-10303-21;", ""])


def _leads_to(root: int, references: dict[int, list[int]], numbers: dict[int, int]) -> list[int]:
    """Numbers of the entities that have one already and that this one comes to first."""
    found, stack = list[int](), [root]
    while stack:
        for n in references[stack.pop()]:
            (found if n in numbers else stack).append(numbers.get(n, n))
    return sorted(found)


def _plain(body: str) -> str:
    """The body with the designator as an instance's id, without empty words, and with a length called so."""
    body = _INSTANCE.sub(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE('\1','\1'", body)
    body = _MEASURE.sub(r"MEASURE_WITH_UNIT(LENGTH_MEASURE(\1),", body)
    return _PLACEMENT.sub("PRODUCT_DEFINITION_SHAPE('','',", body)


def _digests(
    bodies: dict[int, str], references: dict[int, list[int]], starts: Iterable[int]
) -> dict[int, str]:
    """Digest of the whole content of these entities and of all that they refer to, independent of numbering
    (STEP data has no cycles)."""
    digests: dict[int, str] = {}
    for start in starts:
        stack = [start]
        while stack:
            n = stack[-1]
            waiting = [r for r in references[n] if r not in digests]
            if n in digests or not waiting:
                stack.pop()
                digests.setdefault(n, _digest(bodies[n], digests))
            else:
                stack.extend(waiting)
    return digests


def _digest(body: str, digests: dict[int, str]) -> str:
    whole = _REFERENCE.sub(lambda m: digests[int(m.group(1))] if m.group(1) else m.group(0), body)
    return hashlib.sha1(whole.encode("latin-1"), usedforsecurity=False).hexdigest()


def _header(h: Header, schema: str) -> str:
    return "\n".join(
        (
            "ISO-10303-21;",
            "HEADER;",
            f"FILE_DESCRIPTION(({_text(h.description)}),'2;1');",
            f"FILE_NAME({_text(h.name)},'{h.date}T00:00:00',({_text(h.author)}),({_text(h.organisation)}),"
            f"'Open CASCADE Technology','tactcad {__version__}',{_text('revision ' + h.revision)});",
            f"FILE_SCHEMA(('{schema}'));",
            "ENDSEC;",
        )
    )


def _text(value: str) -> str:
    """A STEP string: quotes doubled, other than ASCII as \\X2\\ or \\X4\\ code units."""
    out = []
    for ch in value:
        if ch in "'\\":
            out.append(ch * 2)
        elif " " <= ch <= "~":
            out.append(ch)
        elif ord(ch) <= 0xFFFF:
            out.append(f"\\X2\\{ord(ch):04X}\\X0\\")
        else:
            out.append(f"\\X4\\{ord(ch):08X}\\X0\\")
    return "'" + "".join(out) + "'"
