"""The findings of a design's checks, and as files for machines: JSON and JUnit XML."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any
from xml.etree import ElementTree

from tactcad.design.messages import CheckFailure
from tactcad.parts.array.stiffness_table import Deflection
from tactcad.parts.language.description import Vector
from tactcad.parts.language.finding import Finding


@dataclass(frozen=True)
class Case:
    """One check of one thing: a part, a scene or the design; its time (s) and findings."""

    check: str
    subject: str
    seconds: float
    findings: tuple[Finding, ...]


@dataclass
class Report:
    """Every check that ran on a design, in order; and the deflections of the parts taken as rigid."""

    design: str = ""
    revision: str = ""
    cases: list[Case] = field(default_factory=list)
    deflections: list[Deflection] = field(default_factory=list)
    size: Vector | None = None  # mm, of the array; None of a design that is refused

    @property
    def findings(self) -> list[Finding]:
        return [f for case in self.cases for f in case.findings]

    @property
    def failures(self) -> list[Finding]:
        return [f for f in self.findings if f.severity == "fail"]

    @property
    def runs(self) -> dict[str, int]:
        """How many times each check ran."""
        return {name: len(cases) for name, cases in self._by_check().items()}

    @property
    def seconds(self) -> dict[str, float]:
        """How long each check took in all."""
        return {name: sum(c.seconds for c in cases) for name, cases in self._by_check().items()}

    def _by_check(self) -> dict[str, list[Case]]:
        grouped: dict[str, list[Case]] = {}
        for case in self.cases:
            grouped.setdefault(case.check, []).append(case)
        return grouped

    def run(self, name: str, check: Callable[..., Iterable[Finding]], *args: Any) -> None:
        """Run one check on its first argument (something with a part number or a name) and keep its findings.

        If a design is out of the estimator's range, checks that depend on it are flagged as not done.
        """
        subject = getattr(args[0], "part_no", None) or args[0].name
        start = time.perf_counter()
        try:
            findings = list(check(*args))  # a generator does its work here
        except CheckFailure as error:
            findings = [Finding(name, "flag", subject, (), 0, 0, f"not checked: {error}")]
        seconds = time.perf_counter() - start
        self.cases.append(Case(name, subject, seconds, tuple(findings)))


def as_record(report: Report) -> dict[str, Any]:
    """The report as plain data for JSON."""
    return {
        "design": report.design,
        "revision": report.revision,
        "passed": not report.failures,
        "size_mm": report.size,
        "findings": [f.as_record() for f in report.findings],
        "deflections": [asdict(line) for line in report.deflections],
        "runs": report.runs,
        "seconds": {name: round(s, 4) for name, s in report.seconds.items()},
    }


def json_bytes(reports: Sequence[Report]) -> bytes:
    """All designs' reports as one JSON text."""
    record = {"passed": not any(r.failures for r in reports), "designs": [as_record(r) for r in reports]}
    return (json.dumps(record, indent=1) + "\n").encode()


def junit_bytes(reports: Sequence[Report]) -> bytes:
    """All designs' reports as JUnit XML: a suite a design, a case for every check on every part or scene.

    A failing finding is a failure; flags are in the case's output.
    """
    root = ElementTree.Element("testsuites", name="tactcad check")
    for report in reports:
        failed = [c for c in report.cases if any(f.severity == "fail" for f in c.findings)]
        suite = ElementTree.SubElement(
            root,
            "testsuite",
            name=report.design,
            tests=str(len(report.cases)),
            failures=str(len(failed)),
            errors="0",
            time=f"{sum(c.seconds for c in report.cases):.3f}",
        )
        for case in report.cases:
            _case(suite, report.design, case)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"


def _case(suite: ElementTree.Element, design: str, case: Case) -> None:
    element = ElementTree.SubElement(
        suite, "testcase", classname=f"{design}.{case.check}", name=case.subject, time=f"{case.seconds:.4f}"
    )
    failures = [f for f in case.findings if f.severity == "fail"]
    if failures:
        message = failures[0].message if len(failures) == 1 else f"{len(failures)} findings"
        failure = ElementTree.SubElement(element, "failure", type=failures[0].check, message=message)
        failure.text = "\n".join(str(f) for f in failures)
    flags = [str(f) for f in case.findings if f.severity == "flag"]
    if flags:
        ElementTree.SubElement(element, "system-out").text = "\n".join(flags)


def failure_table(reports: Sequence[Report]) -> list[str]:
    """Every failure as a line of a table: design, part, check, message; empty if nothing failed."""
    rows = [(r.design, f.about, f.check, f.message + _at(f)) for r in reports for f in r.failures]
    if not rows:
        return []
    head = ("design", "part", "check", "what is wrong")
    widths = [max(len(row[i]) for row in (head, *rows)) for i in range(3)]
    line = lambda row: "  ".join([*(cell.ljust(w) for cell, w in zip(row, widths)), row[3]])  # noqa: E731
    return [line(head), line(tuple("-" * w for w in (*widths, len(head[3])))), *map(line, rows)]


def _at(finding: Finding) -> str:
    return f" (at {', '.join(f'{v:.3f}' for v in finding.place)})" if finding.place else ""
