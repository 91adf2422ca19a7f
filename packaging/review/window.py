"""The tree and the colours that a person sees: an assembly imported by FreeCAD's window program with the
settings that docs/freecad.md tells to choose, in a profile of its own, without a screen.
"""

from __future__ import annotations

import json
import re
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tactcad.design.messages import CheckFailure
from tactcad.review.freecad import environment, profile, program

INSIDE = Path(__file__).with_name("in_freecad_window.py")
SECONDS = 300

# Label in Edit > Preferences > Import-Export > STEP -> group and name in FreeCAD's settings, and the value to
# choose.
SETTINGS = {
    "Enable STEP Compound merge": ("hSTEP", "ReadShapeCompoundMode", False),
    "Use LinkGroup": ("", "UseLinkGroup", True),
    "Reduce number of objects using Link array": ("", "ReduceObjects", False),
    "Ignore instance names": ("", "UseBaseName", False),
}
UNCOLOURED = [0.8, 0.8, 0.8]  # what FreeCAD gives a shape without a colour


def settings() -> str:
    """A user's settings as FreeCAD keeps them, with the four above."""

    def flags(folder: str) -> list[str]:
        return [
            f'<FCBool Name="{n}" Value="{int(on)}"/>' for where, n, on in SETTINGS.values() if where == folder
        ]

    return profile(*flags(""), f'<FCParamGroup Name="hSTEP">{"".join(flags("hSTEP"))}</FCParamGroup>')


def command() -> str | None:
    """FreeCAD's window program, None if there is none."""
    try:
        return program()
    except CheckFailure:
        return None


def shown(program: str, paths: Sequence[Path]) -> dict[Path, dict]:
    """The trees of assemblies, opened by one start of FreeCAD; none if it ended without telling."""
    found = asked(program, INSIDE, paths, settings()) or {}
    return {path: found[str(path.resolve())] for path in paths if found}


def asked(program: str, script: Path, paths: Sequence[Path], user: str) -> dict | None:
    """Output of a script in FreeCAD's window program for files, under a user's settings; None if it ended
    without telling."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "user.cfg").write_text(user)
        files = "\n".join(str(path.resolve()) for path in paths)
        told = {"REVIEW_FILE": files, "REVIEW_OUT": str(folder / "out.json")}
        try:
            subprocess.run(
                [program, "-u", str(folder / "user.cfg"), str(script)],
                env=environment(folder) | told,
                capture_output=True,
                check=False,
                timeout=SECONDS,
            )
            return json.loads((folder / "out.json").read_text())
        except (OSError, ValueError, subprocess.TimeoutExpired):
            return None


def tree_faults(path: str, tree: dict | None, bill: list[dict]) -> list[str]:
    """Every placed part is in the tree once, under its reference designator, and shows its part, in
    colour."""
    if tree is None:
        return [f"{path}: FreeCAD's window program ended without a report"]
    if tree["groups"] != 1:
        return [f"{path}: {tree['groups']} assemblies in FreeCAD's tree instead of one"]
    meant = {d: row["part_no"] for row in bill if row["has_solid"] for d in row["designators"].split()}
    seen = {child["label"]: re.sub(r"\d{3}$", "", child["part"]) for child in tree["children"]}
    plain = {
        d: re.sub(r"\d{3}$", "", number) for d, number in meant.items()
    }  # FreeCAD numbers equal names: spacer001
    wrong = [f"{path}: {d} is not in FreeCAD's tree" for d in sorted(set(meant) - set(seen))]
    wrong += [
        f"{path}: FreeCAD's tree has {d}, the bill of materials has not"
        for d in sorted(set(seen) - set(meant))
    ]
    wrong += [
        f"{path}: {d} shows {seen[d]} instead of {meant[d]}"
        for d in sorted(set(seen) & set(meant))
        if seen[d] != plain[d]
    ]
    if len(tree["children"]) != len(seen):
        wrong.append(f"{path}: a designator stands twice in FreeCAD's tree")
    bare = sorted({child["part"] for child in tree["children"] if child["colour"] == UNCOLOURED})
    return wrong + [f"{path}: {part} has no colour in FreeCAD" for part in bare]
