"""The recipes of CONTRIBUTING.md, carried out on a copy of the sources: how many files each takes, and what
the commands then do."""

from __future__ import annotations

import dataclasses
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from exact_ladder import ORDER, true_compliance
from variants import TINY_TEXT

from tactcad.design.family import Late, all_families
from tactcad.export.inputs import flattened

HERE = Path(__file__).parent
SOURCE = HERE.parents[1] / "src"


class Tree:
    """A copy of the sources and of what Python compiled of them; `changed` counts what a recipe writes or
    edits in it."""

    def __init__(self, folder: Path) -> None:
        self.src, self.folder, self.changed = folder / "src", folder, set()
        shutil.copytree(SOURCE, self.src, ignore=shutil.ignore_patterns("*.egg-info"))

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


COVER = '''

def cover_plate(layout: Layout) -> Part:
    """Lid on the carrier."""
    x, y = layout.stop_plate_half, layout.stop_plate_width / 2
    body = Extrusion(rectangle(-x, -y, x, y), 1.0)
    return Part(f"{layout.design.name}-cover", "Cover plate", "milled", MAGNETIC_STAINLESS, body)
'''
PLACED = """
    from tactcad.parts.array.clamp import cover_plate

    top = layout.carrier_bottom + layout.design.clamp.carrier_thickness
    b.meet(b.place("CO", cover_plate(layout), (0, 0, top), UPRIGHT, "Cover"), "CA1")
"""
SHOWN = """
from tactcad.parts.rules import load
from tactcad.scenes import make_scene
from tactcad.scenes.bom import bom_rows

scene = make_scene(load("tiny.toml"), "array")
print(*(s.title for s in scene.steps if "CO1" in s.designators))
print(*(r.qty for r in bom_rows(scene, None, {}) if r.part_no == "tiny-cover"))
"""


def test_a_part_takes_two_files_its_step_included(tree):
    file = "parts/array/clamp.py"
    tree.write(file, (tree.src / "tactcad" / file).read_text("utf-8") + COVER)
    stops, hold = "        _stop_plate(b, layout, on_ledge)\n", "        step(\n            HOLD_DOWN,"
    step = '        step("Cover", (0, 0, 2.0 * width), "Bond the cover on the carrier."),\n'
    tree.edit("scenes/rigs/array.py", (stops, stops + PLACED.lstrip("\n")), (hold, step + hold))
    assert len(tree.changed) == 2
    sensor(tree, "")
    done = subprocess.run(
        [sys.executable, "-c", SHOWN],
        cwd=tree.folder,
        env=os.environ | {"PYTHONPATH": str(tree.src)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "Cover\n1\n", done.stderr


SHEAR = '''
@dataclass(frozen=True)
class Shear:
    """[shear]: the set-up that pushes pads along their arms."""

    thickness: float = given(Number("mm", 0.1, 10, "bar"), 1.5)
    travel: float = given(Number("mm", 0.001, 1, "way of the bar"), 0.1)
    force: float = given(Number("N", 0.01, 100, "at the end of that way"), 1.0)


@dataclass(frozen=True)
class Design(CommonTables):
    """A whole design file of facing rows."""
'''


@pytest.mark.slow  # exports and checks a design by the kernel
def test_a_scene_takes_three_files(tree):
    tree.edit(
        "design/tree.py",
        (
            "\n@dataclass(frozen=True)\nclass Design(CommonTables):\n"
            '    """A whole design file of facing rows."""\n',
            SHEAR,
        ),
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


ALL_RIGS = "from tactcad.scenes.rig import all_rigs; all_rigs(Design)"


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
        [sys.executable, "-c", f"from tactcad.design.tree import Design; {ALL_RIGS}"],
        env=os.environ | {"PYTHONPATH": str(tree.src)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode and said in done.stderr.splitlines()[-1]


@pytest.mark.slow  # exports and releases a design by the kernel
def test_a_format_takes_its_module_beside_its_test(tree):
    tree.write("export/part_formats/threemf.py", (HERE / "threemf.py").read_text("utf-8"))
    assert len(tree.changed) == 1

    done = tree.run("export", sensor(tree, ""), "--scene", "array", "--out", "out")
    assert done.returncode == 0, done.stderr
    files = json.loads((tree.folder / "out" / "manifest.json").read_text("utf-8"))["files"]
    written = {file["part_no"]: file["path"] for file in files if file["kind"] == "3mf"}
    assert written and all((tree.folder / "out" / path).is_file() for path in written.values())
    rows = json.loads((tree.folder / "out" / "bom.json").read_text("utf-8"))["rows"]
    made = {row["part_no"]: row["file"] for row in rows if row["make_buy"] == "make" and row["has_solid"]}
    assert made == written  # its rank is the highest
    done = tree.run("export", "tiny.toml", "--scene", "array", "--out", "again")
    assert ", 0 made, " in done.stderr

    done = tree.run("release", "tiny.toml", "--sample", "--draft", "--out", "zips")
    assert done.returncode == 0, done.stderr
    (whole,) = (path for path in (tree.folder / "zips").glob("*PRELIMINARY.zip"))
    with zipfile.ZipFile(whole) as archive:
        assert set(written.values()) <= set(archive.namelist())
        readme = archive.read("README.txt").decode()
    assert "every part made as a mesh, for printers" in " ".join(readme.split())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("A = 1\n", "no PartFormat is declared in tactcad.export.part_formats.lacking"),
        (
            "from ..formats import PartFormat\nF = PartFormat(kind='lacking', path='a/b')\n",
            "missing 6 required",
        ),
        (
            "from dataclasses import replace\nfrom .usual import STL\n"
            "F = replace(STL, kind='flat', path='flat.stl')\n",
            "format flat: 'flat.stl' has no folder, or no {part_no}",
        ),
        (
            "import dataclasses as d\nfrom .usual import STL as S\nF = d.replace(S, place=7)\n",
            "two formats are of one kind",
        ),
    ],
)
def test_an_incomplete_format_is_refused_at_import(tree, text, said):
    tree.write("export/part_formats/lacking.py", text)
    done = subprocess.run(
        [sys.executable, "-c", "import tactcad.export.pipeline"],
        env=os.environ | {"PYTHONPATH": str(tree.src)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode and said in done.stderr.splitlines()[-1]


RULE = """

@rule(after="override_names_element")
def rows_stand_together(layout: Layout) -> Iterator[Finding]:
    yield from at_most("array.row_pitch", "rows too far apart", layout.design.array.row_pitch, 8.0)
"""


def test_a_design_rule_takes_one_file(tree):
    """It is found, refuses a design by its field, and its witness is asked for by name."""
    file = "parts/rules/element_rules.py"
    tree.write(file, (tree.src / "tactcad" / file).read_text("utf-8") + RULE)
    assert len(tree.changed) == 1

    design = TINY_TEXT.replace("row_pitch = 4.0", "row_pitch = 9.0")
    assert design != TINY_TEXT
    (tree.folder / "wide.toml").write_text(design, "utf-8")
    done = tree.run("estimate", "wide.toml")
    assert done.returncode == 2
    assert "rule rows_stand_together" in done.stderr and "array.row_pitch" in done.stderr
    assert "at most 8 mm" in done.stderr

    tests = HERE.parent
    asked = subprocess.run(
        [sys.executable, "-c", "import test_rules; test_rules.test_every_rule_has_a_witness()"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, (tree.src, tests, tests / "parts")))},
        capture_output=True,
        text=True,
        check=False,
    )
    assert asked.returncode and "rule rows_stand_together has no witness: add " in asked.stderr


CHECK = """
from collections.abc import Iterator

from tactcad.parts.language.description import Part
from tactcad.parts.language.finding import Finding, at_most

from ..check import Check

HEAVIEST = 10.0  # g


def check_weight(part: Part) -> Iterator[Finding]:
    yield from at_most("heavy", part.part_no, part.mass, HEAVIEST, f"{part.mass:.0f} g", (0.0, 0.0, 0.0))


CHECKS = (Check("weight", "part", lambda part, _: check_weight(part), place=60),)
"""
BAD_PART = """

def heavy() -> list[Finding]:
    from tactcad.checks.described.weight import check_weight
    from tactcad.contour import rectangle
    from tactcad.parts.language.description import Extrusion, Part
    from tactcad.parts.language.stock import CARBON_STEEL

    body = Extrusion(rectangle(0.0, 0.0, 40.0, 20.0), 20.0)
    return [*check_weight(Part("b", "Block", "milled", CARBON_STEEL, body))]


BAD["heavy"] = Bad("weight", "a block of 126 g", heavy, "tests/bad_parts.py")
"""
ASKED = "import test_checks_table as t; t.test_every_check_in_the_code_has_its_bad_part()"
FOUND = """
from tactcad.checks.check import Job, described, run_each
from tactcad.checks.check_report import Report
from tactcad.parts.rules import load
from tactcad.scenes import make_scene

design, report = load("tiny.toml"), Report("tiny")
for part in make_scene(design, "array").parts:
    run_each(report, described(design), "part", part, Job(design, ["array"]))
for finding in report.failures:
    print(finding.check, finding.part, finding.value)
import bad_parts
print(*bad_parts.BAD["heavy"].find())
"""


def test_a_check_takes_two_files(tree):
    """It is found and run, and its bad part is asked for by name."""
    tests = tree.folder / "tests"
    shutil.copytree(HERE.parent, tests, ignore=shutil.ignore_patterns("__snapshots__"))
    (tree.folder / "hardware").symlink_to(HERE.parents[1] / "hardware")  # that bad parts vary
    tree.write("checks/described/weight.py", CHECK)

    def run(script: str) -> subprocess.CompletedProcess[str]:
        path = os.pathsep.join(map(str, (tree.src, tests, tests / "checks")))
        return subprocess.run(
            [sys.executable, "-c", script],
            cwd=tree.folder,
            env=os.environ | {"PYTHONPATH": path},
            capture_output=True,
            text=True,
            check=False,
        )

    asked = run(ASKED)
    assert asked.returncode and "check heavy has no bad part: add one to tests/bad_parts.py" in asked.stderr

    (tests / "bad_parts.py").write_text((tests / "bad_parts.py").read_text("utf-8") + BAD_PART, "utf-8")
    tree.changed.add("tests/bad_parts.py")
    assert len(tree.changed) == 2
    assert (done := run(ASKED)).returncode == 0, done.stderr

    sensor(tree, "")
    done = run(FOUND)
    assert done.returncode == 0, done.stderr
    *of_array, of_block = done.stdout.splitlines()
    assert of_array and all(line.startswith("heavy tiny-") for line in of_array)
    assert all(float(line.split()[-1]) > 10.0 for line in of_array)
    assert "126 g" in of_block  # 40 x 20 x 20 mm of 7850 kg/m3: 125.6 g


RUNG = """
from ..register import Rung
from . import plane

STIFF = Rung("stiff", 8, "the recipe's test", lambda s, data: plane.compliance_by(s, data) / 1.01)
"""


@pytest.mark.slow  # fits the whole ladder in a process
def test_a_rung_takes_one_file_and_data_by_one_command(tree):
    def stiffness(model):
        done = tree.run("estimate", "--model", model, "--json")
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)["elements"]

    known = {model: [row["stiffness"] for row in stiffness(model)] for model in ("plane", "solid")}
    tree.write("mechanics/rungs/stiff.py", RUNG)
    assert len(tree.changed) == 1
    for words in ("estimate --model stiff", "estimate --within 1%"):
        refused = tree.run(*words.split())
        assert refused.returncode == 2 and refused.stdout == "" and refused.stderr.count("\n") == 1
        assert refused.stderr.startswith(
            "tactcad: rung stiff of mechanics/rungs: its errors are not measured"
        )

    data = tree.src / "tactcad" / "mechanics" / "data"
    constants = json.loads((data / "ladder.json").read_text("utf-8"))
    fit = [sys.executable, HERE.parents[1] / "benchmarks" / "ladder_fit.py", data]
    subprocess.run(fit, env=os.environ | {"PYTHONPATH": str(tree.src)}, capture_output=True, check=True)
    measured = json.loads((data / "ladder.json").read_text("utf-8"))
    assert measured.pop("report") and constants.pop("report")
    before, now = flattened(constants), flattened(measured)
    assert set(before) == set(now)
    # another processor rounds otherwise, which moves where the search ends along what the sample hardly
    # determines (p0 against p1); what the constants say stays
    for model, values in known.items():
        assert [row["stiffness"] for row in stiffness(model)] == pytest.approx(values, rel=2e-5)

    for stiff, plane in zip(stiffness("stiff"), stiffness("plane"), strict=True):
        assert stiff["stiffness"] == pytest.approx(1.01 * plane["stiffness"], rel=1e-9)
    within = tree.run("estimate", "--within", "1%", "--json")
    assert within.returncode == 0, within.stderr


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("A = 1\n", "no Rung is declared in tactcad.mechanics.rungs.lacking"),
        ("from ..register import Rung\nRUNG = Rung('lacking', 9)\n", "missing 1 required"),
        ("from ..register import Rung\nRUNG = Rung('lacking', 9, 'never')\n", "a compliance or elements"),
        ("from .solid import RUNG\n", "two rungs have one name"),
        (
            "import dataclasses as d\nfrom . import solid as o\nRUNG = d.replace(o.RUNG, name='lacking')\n",
            "two rungs have one place",
        ),
    ],
)
def test_an_incomplete_rung_is_refused_at_import(tree, text, said):
    tree.write("mechanics/rungs/lacking.py", text)
    done = tree.run("estimate")
    assert done.returncode and said in done.stderr.splitlines()[-1]


def test_a_rung_without_its_exact_twin_is_asked_for():
    with pytest.raises(LookupError, match="rung stiff .* tests/exact_ladder.py"):
        true_compliance("stiff", [1.0] * len(ORDER), True)


@pytest.mark.slow  # checks and releases a design by the kernel
def test_a_second_family_takes_five_files(tree):
    """Four modules and a design file; the commands are those of the first family."""
    (tree.src / "tactcad" / "families" / "leaf").mkdir()
    for path in sorted((HERE / "leaf").glob("*.py")):
        tree.write(f"families/leaf/{path.name}", path.read_text("utf-8"))
    design = (HERE / "leaf" / "leaf.toml").read_text("utf-8")
    (tree.folder / "leaf.toml").write_text(design, "utf-8")
    assert len(tree.changed) + 1 == 5

    estimated = json.loads(tree.run("estimate", "leaf.toml", "--json").stdout)
    assert estimated["elements"][0]["stiffness"] == pytest.approx(72000 * 10 * 1.0**3 / (4 * 20.0**3))
    assert "[leaf]" in tree.run("schema").stdout
    for command in (
        ("build", "leaf.toml"),
        ("check", "leaf.toml"),
        ("review", "leaf.toml"),
        ("release", "leaf.toml"),
    ):
        done = tree.run(*command)
        assert done.returncode == 0, (command, done.stderr)
    script = (
        "import tactcad as tc; d = tc.load('leaf.toml').with_(length=25.0); e = d.estimate(); print(e)\n"
        "print(e[0].stiffness, *d.size)\n"
        "tc.load('leaf.toml').with_(length=4.0)"
    )
    own = {"PYTHONPATH": str(tree.src), "TACTCAD_CACHE": str(tree.folder / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=tree.folder, env=os.environ | own, capture_output=True, text=True
    )
    stiffness, *size = map(float, done.stdout.splitlines()[-1].split())
    assert stiffness == pytest.approx(72000 * 10 * 1.0**3 / (4 * 25.0**3))
    assert size == [35.0, 10.0, 9.0]  # 10 mm held on the block of 8 mm, the sheet of 1 mm on it
    assert "tactcad.design.messages.InputError: leaf.length: rule leaf_is_slender" in done.stderr
    made = tree.run("export", "leaf.toml", "--drawings", "--guide", "--out", "out")
    assert made.returncode == 0, made.stderr
    kinds = {
        f["kind"] for f in json.loads((tree.folder / "out" / "manifest.json").read_text("utf-8"))["files"]
    }
    assert {"step-part", "dxf", "drawing", "bom", "inspection", "picture"} <= kinds and "netlist" not in kinds

    (tree.folder / "loads.csv").write_text("0.01,0,0,2,0,0\n0,0.02,0,0,2,0\n0,0,0.05,0,0,2\n", "utf-8")
    calibrated = tree.run("calibrate", "loads.csv", "--design", "leaf.toml")
    assert calibrated.stdout == "leaf: 200 N/mm, 100 N/mm, 40 N/mm\n", calibrated.stderr

    (tree.folder / "longer.toml").write_text(design.replace("length = 20.0", "length = 25.0"), "utf-8")
    assert "stiffness_n_per_mm: 22.5 -> 11.52" in tree.run("diff", "leaf.toml", "longer.toml").stdout
    (tree.folder / "short.toml").write_text(design.replace("length = 20.0", "length = 4.0"), "utf-8")
    for said, command in (
        ("rule leaf_is_slender", ("check", "short.toml")),
        (
            "does not take designs of this family",
            ("grasp", "leaf.toml", "--object", "E=1,nu=0.4,thickness=5"),
        ),
        ("does not take designs of this family", ("estimate", "leaf.toml", "--model", "solid")),
        ("no such scene", ("check", "leaf.toml", "--scene", "calibration")),
    ):
        refused = tree.run(*command)
        assert refused.returncode == 2 and said in refused.stderr, command


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("A = 1\n", "no FAMILY is declared in tactcad.families.lacking"),
        (
            "from tactcad.design.family import Family\nFAMILY = Family(name='lacking', spec=dict)\n",
            "missing 13 required",
        ),
        ("from .facing_rows import FAMILY\n", "two families have one name"),
        (
            "from dataclasses import replace\n"
            "from . import facing_rows as f\nFAMILY = replace(f.FAMILY, spec=dict)\n",
            "spec must have the tables of all families",
        ),
    ],
)
def test_an_incomplete_family_is_refused_at_import(tree, text, said):
    tree.write("families/lacking.py", text)
    done = tree.run("schema")
    assert done.returncode and said in done.stderr.splitlines()[-1]


def test_every_function_that_a_family_names_is_there():
    def named(value):
        if isinstance(value, Late):
            yield value
        elif dataclasses.is_dataclass(value) and not isinstance(value, type):
            yield from named([getattr(value, f.name) for f in dataclasses.fields(value)])
        elif isinstance(value, list | tuple | dict):
            for each in value.values() if isinstance(value, dict) else value:
                yield from named(each)

    found = [late for family in all_families().values() for late in named(family)]
    assert len(found) > 20 and all(callable(late.found) for late in found)
