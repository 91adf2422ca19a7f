"""The recipes of CONTRIBUTING.md, carried out on a copy of the sources: how many files each takes, and what
the commands then do."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from variants import TINY_TEXT

HERE = Path(__file__).parent
SOURCE = HERE.parents[1] / "src"


class Tree:
    """A copy of the sources; `changed` counts what a recipe writes or edits in it."""

    def __init__(self, folder: Path) -> None:
        self.src, self.folder, self.changed = folder / "src", folder, set()
        shutil.copytree(SOURCE, self.src, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))

    def write(self, path: str, text: str) -> None:
        self.changed.add(path)
        (self.src / "tactcad" / path).write_text(text, "utf-8")

    def edit(self, path: str, *changes: tuple[str, str]) -> None:
        text = (self.src / "tactcad" / path).read_text("utf-8")
        for old, new in changes:
            assert text.count(old) == 1, (path, old)
            text = text.replace(old, new)
        self.write(path, text)

    def run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        own = {"PYTHONPATH": str(self.src), "TACTCAD_CACHE": str(self.folder / "cache")}
        return subprocess.run(
            [sys.executable, "-m", "tactcad", *arguments],
            cwd=self.folder,
            env=os.environ | own,
            capture_output=True,
            text=True,
            check=False,
        )


@pytest.fixture
def tree(tmp_path):
    return Tree(tmp_path)


def sensor(tree: Tree, more: str) -> str:
    """A design of one element, and `more` text; its path."""
    (tree.folder / "tiny.toml").write_text(TINY_TEXT + more, "utf-8")
    return "tiny.toml"


SHEAR = '''
@dataclass(frozen=True)
class Shear:
    """[shear]: the set-up that pushes pads along their arms."""

    thickness: float = given(Number("mm", 0.1, 10, "bar"), 1.5)
    travel: float = given(Number("mm", 0.001, 1, "way of the bar"), 0.1)
    force: float = given(Number("N", 0.01, 100, "at the end of that way"), 1.0)


@dataclass(frozen=True)
class Design:
    """A whole design file."""
'''


@pytest.mark.slow  # exports and checks a design by the kernel
def test_a_scene_takes_three_files(tree):
    tree.edit(
        "design/tree.py",
        ('\n@dataclass(frozen=True)\nclass Design:\n    """A whole design file."""\n', SHEAR),
        (
            "    bonding: Bonding | None = None\n",
            "    bonding: Bonding | None = None\n    shear: Shear | None = None\n",
        ),
    )
    tree.write("parts/rigs/shear_bar.py", (HERE / "shear_bar.py").read_text("utf-8"))
    tree.write("scenes/rigs/shear_calibration.py", (HERE / "shear_calibration.py").read_text("utf-8"))
    assert len(tree.changed) == 3

    done = tree.run("check", sensor(tree, "\n[shear]\n"), "--json")
    assert done.returncode == 0, done.stderr + done.stdout
    report = json.loads(done.stdout)
    assert any(line["scene"] == "shear-calibration" for line in report["deflections"])  # rigidity
    assert report["runs"]["shear travel"] == 1  # its own check
    assert report["runs"]["configurations"] == 1  # its pose

    done = tree.run("export", "tiny.toml", "--guide", "--drawings", "--out", "out")
    assert done.returncode == 0, done.stderr
    manifest = json.loads((tree.folder / "out" / "manifest.json").read_text("utf-8"))
    assert "tiny-shear-bar" in str(manifest["parts"])
    paths = [file["path"] for file in manifest["files"]]
    assert "bom-shear-calibration.csv" in paths
    for kind in ("step", "pictures", "drawings", "guide"):
        assert any(path.startswith(f"{kind}/") and "shear-calibration" in path for path in paths), (
            kind,
            paths,
        )
    assert "shear bar enters between the rows" in (tree.folder / "out" / "stack.csv").read_text("utf-8")

    left = tree.run("check", sensor(tree, "\n[shear]\nthickness = 5.0\n"))
    assert "rule bar_enters_the_gap" in left.stdout + left.stderr
    for change, said in (
        ("thickness = 1.0", "shear.thickness = 1; legal: at least 1.371 mm"),
        ("thickness = 1.9\ntravel = 1.0", "travel too long"),
    ):
        refused = tree.run("check", sensor(tree, f"\n[shear]\n{change}\n"))
        assert refused.returncode == 1 and said in refused.stdout + refused.stderr


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("A = 1\n", "no RIG is declared in tactcad.scenes.rigs.lacking"),
        ("from ..rig import Rig\nRIG = Rig(name='lacking', tables=())\n", "missing 7 required"),
        (
            "import dataclasses as d\nfrom .array import RIG as A\nRIG = d.replace(A, tables=('bond',))\n",
            "rig array: a design has no table bond",
        ),
        ("from .bonding import RIG\n", "two rigs have one name"),
    ],
)
def test_an_incomplete_rig_is_refused_at_import(tree, text, said):
    tree.write("scenes/rigs/lacking.py", text)
    done = subprocess.run(
        [sys.executable, "-c", "from tactcad.scenes.rig import all_rigs; all_rigs()"],
        env=os.environ | {"PYTHONPATH": str(tree.src)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode and said in done.stderr.splitlines()[-1]
