"""`formulas.py PAGES` sets every block of formulas (```math, LaTeX) as MathML, which browsers show as it is.

It runs in the site's own environment; GitHub shows the same blocks without it.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from latex2mathml.converter import convert

BLOCK = re.compile(r"^```math\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def with_formulas(text: str) -> str:
    """A page with its formulas as MathML, each in a box that scrolls where it is too wide."""
    return BLOCK.sub(lambda found: f'<div class="formula">{_mathml(found[1])}</div>', text)


def _mathml(latex: str) -> str:
    return convert(latex.strip(), display="block")


if __name__ == "__main__":
    for page in Path(sys.argv[1]).rglob("*.md"):
        page.write_text(with_formulas(page.read_text("utf-8")), "utf-8")
