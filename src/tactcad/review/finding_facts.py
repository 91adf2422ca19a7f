"""Findings of the checks with where they are: the scene, the parts that they are about, and the place."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from tactcad.design.tree import Design
from tactcad.export.inputs import digest, source_digest
from tactcad.export.shapes import Shapes
from tactcad.scenes.scene import Scene

# Checks of a whole scene give places in its frame; a motion's is an offset, no place; all others the part's.
IN_SCENE = ("interference", "tools", "configurations")
NO_PLACE = ("motion",)


@dataclass(frozen=True)
class FindingFact:
    """One finding.

    about        as the check names it
    scene        that it belongs to, "" where to all that hold the part
    designators  of the parts that it is about; of a part number all of its
    place        mm, in the scene's frame where there is a scene, else in the part's own; empty: all of it
    """

    check: str
    severity: str
    about: str
    message: str
    scene: str
    designators: tuple[str, ...]
    place: tuple[float, ...]


def finding_facts(
    design: Design, scenes: Sequence[Scene], shapes: Shapes, say: Callable[[int, int, str], None]
) -> list[FindingFact]:
    """Every finding of every check on these scenes, failures first; kept in the cache of the shapes."""
    names = [scene.name for scene in scenes]
    key = digest(("review findings", shapes.made_by, source_digest("checks"), design, names))

    def make() -> bytes:
        from tactcad.checks.run import run_checks  # loads the kernel

        report = run_checks(design, names, say=say)
        cases = [(case.check, case.subject, asdict(f)) for case in report.cases for f in case.findings]
        return json.dumps(cases, default=float).encode()

    cases = json.loads(shapes.cache.get_or_make(key, make))
    found = [_fact(check, subject, finding, scenes) for check, subject, finding in cases]
    return sorted(found, key=lambda f: f.severity != "fail")


def _fact(check: str, subject: str, finding: dict[str, Any], scenes: Sequence[Scene]) -> FindingFact:
    name = finding["part"].partition(" (")[0]
    placed = [(p.designator, p.part.part_no) for scene in scenes for p in scene.placements]
    who = [d for d, _ in placed if d == name] or [d for d, number in placed if number == name]
    in_scene = check in IN_SCENE and subject in {scene.name for scene in scenes}
    return FindingFact(
        finding["check"],
        finding["severity"],
        finding["part"],
        finding["message"],
        subject if in_scene else "",
        tuple(dict.fromkeys(who)),
        () if check in NO_PLACE else tuple(finding["place"]),
    )
