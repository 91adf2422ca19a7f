"""The table of docs/checks.md: each check, its bad part, and what is then said.

    python tests/checks_table.py            writes it

Messages are what the checks say of the bad parts in bad_parts.py.
"""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCUMENT = ROOT / "docs" / "checks.md"
BEGIN, END = "<!-- checks: written by tests/checks_table.py -->\n", "<!-- end of checks -->\n"
HEAD = "| group | check | its bad part | what it says |\n|---|---|---|---|\n"


def rows() -> list[str]:
    """A line a check, in the order of BAD; the first of those that are timed together has their name."""
    from bad_parts import BAD

    lines, before = [], ""
    for name, bad in BAD.items():
        finding = next(f for f in bad.find() if f.check == name)
        flagged = " (flag)" if finding.severity == "flag" else ""
        said = finding.message.replace("|", "\\|")
        lines.append(
            f"| {bad.run if bad.run != before else ''} | `{name}`{flagged} | {bad.what} | {said} |\n"
        )
        before = bad.run
    return lines


def renewed(text: str) -> str:
    before, rest = text.split(BEGIN)
    return before + BEGIN + HEAD + "".join(rows()) + END + rest.split(END)[1]


if __name__ == "__main__":
    DOCUMENT.write_text(renewed(DOCUMENT.read_text(encoding="utf-8")), encoding="utf-8")
