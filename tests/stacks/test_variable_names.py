"""Variables are asked for by names that mypy knows, declared where their limits are."""

from __future__ import annotations

import ast
from pathlib import Path

import tactcad
from tactcad.parts.array.layout import Layout
from tactcad.stacks.requirements import requirements

SOURCE = Path(tactcad.__file__).parent


def test_no_deviation_is_asked_for_by_a_text(macro, macro_scene):
    known, _ = requirements(Layout(macro), [macro_scene])
    asked = [
        f"{path.name}:{node.lineno}: {node.slice.value}"
        for path in (*SOURCE.glob("stacks/*.py"), SOURCE / "scenes" / "rig_requirements.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Subscript)
        and isinstance(node.slice, ast.Constant)
        and node.slice.value in known
    ]
    assert len(known) > 20 and asked == []
