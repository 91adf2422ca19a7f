"""Only what a scene needs: what TACTCAD_PROFILE counts, and that nothing is loaded or made that nobody asked
for."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from variants import HARDWARE, variant

import tactcad
from tactcad.profiling import HEAVY, making, profiled, text
from tactcad.scenes import make_scene, scene_names

DESIGN = HARDWARE / "double-sample.toml"  # two elements, and every rig
MESHES = {"trimesh", "manifold3d"}
KERNEL = {name for name, what in HEAVY.items() if what == "CAD kernel"}


def run(*arguments, cwd, script="-m", **more):
    """A fresh process: its exit status, standard output, and the profile on standard error."""
    environment = {k: v for k, v in os.environ.items() if k in ("PATH", "LD_LIBRARY_PATH", "HOME")}
    environment |= {"PYTHONPATH": str(Path(tactcad.__file__).parents[1]), "TACTCAD_CACHE": str(cwd / "cache")}
    environment |= more
    command = [sys.executable, "-m", "tactcad"] if script == "-m" else [sys.executable, "-c", script]
    done = subprocess.run(
        [*command, *arguments], cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )
    return done


def profile(*arguments, cwd, status=0):
    done = run(*arguments, "--json", cwd=cwd, TACTCAD_PROFILE="1")
    assert done.returncode == status, done.stderr
    record, _ = json.JSONDecoder().raw_decode(done.stderr[done.stderr.index("{\n") :])
    return record  # behind it stands why a command is refused


@pytest.mark.parametrize(
    "arguments,loaded",
    [
        (("estimate",), {"numpy"}),
        (("estimate", "--accuracy", "1%"), {"numpy"}),
        (("estimate", "--within", "1%", "--in", "100"), {"numpy"}),  # costs of the finite elements told, too
        (("size", "--stiffness", "10", "--load-arm", "5"), {"numpy"}),
        (("schema",), set()),
    ],
    ids=lambda a: " ".join(a) if isinstance(a, tuple) else "",
)
def test_estimates_load_numpy_alone_and_make_nothing(arguments, loaded, tmp_path):
    (tmp_path / "hardware").symlink_to(HARDWARE)
    record = profile(*arguments, cwd=tmp_path)
    assert set(record["loaded"]) == loaded
    assert set(record["made"]) <= {"scene"}  # the sensor's overall size is read off its placements
    assert record["peak_memory_mb"] < 100


def fresh(folder, name):
    """A working folder with no cache in it."""
    (folder / name).mkdir()
    return folder / name


NIGHTLY = [pytest.mark.nightly, pytest.mark.cad]


@pytest.mark.slow  # two builds in fresh processes
@pytest.mark.parametrize(
    "arguments",
    [
        ("build", "--count", "100"),
        pytest.param(("check", "--scene", "array"), marks=NIGHTLY),
        pytest.param(("export", "--scene", "array"), marks=NIGHTLY),
    ],
    ids=lambda a: a[0],
)
def test_choosing_by_a_budget_loads_and_makes_nothing_else(arguments, tmp_path):
    """What it costs is counted without kernel; scenes are described once more, for counting."""
    command, *rest = arguments
    chosen = rest[:-2] + ["--within", "10%"] if command == "build" else [*rest, "--within", "0.5%"]
    if command == "export":
        rest, chosen = ([*some, "--out", f"{len(some)}"] for some in (rest, chosen))
    plain, by = (
        profile(command, str(DESIGN), *some, cwd=fresh(tmp_path, f"{n}"))
        for n, some in enumerate((rest, chosen))
    )
    added = {"mesh"} if command == "export" else set()
    assert set(by["loaded"]) == set(plain["loaded"]) and set(by["made"]) - set(plain["made"]) <= added
    assert set(by["made"].get("solid", {})) == set(plain["made"].get("solid", {}))


def test_a_time_too_short_loads_no_kernel(tmp_path):
    for command in ("check", "export"):
        record = profile(command, str(DESIGN), "--in", "0.5", cwd=tmp_path, status=1)
        assert not set(record["loaded"]) & (KERNEL | MESHES) and set(record["made"]) <= {"scene"}


def test_finite_element_estimates_load_no_kernel_and_solve_each_distinct_element_once(tmp_path):
    record = profile("estimate", str(DESIGN), "--model", "fem-plane", cwd=tmp_path)
    assert not set(record["loaded"]) & (KERNEL | MESHES)
    assert set(record["made"]) == {"elements", "scene"}
    arms = {arm for row in variant(base="double-sample").array.row_arms for arm in row}
    # two densities of each, and of the one that is compared with its uncut contour
    assert [e["times"] for e in record["made"]["elements"].values()] == [len(arms) + 1] * 2


def test_cut_files_and_inspection_load_no_kernel(tmp_path):
    script = """
import sys
from tactcad.profiling import HEAVY
from tactcad.export.dxf import check_dxf, dxf_bytes
from tactcad.parts.rules import load
from tactcad.parts.array.layout import Layout
from tactcad.scenes import make_scene, scene_names
from tactcad.lab.inspection_sheet import read_sheet
import tactcad.lab.as_made, tactcad.export.strength_table, tactcad.scenes.bom
design = load(sys.argv[1])
for name in scene_names(design):
    for part in make_scene(design, name).parts:
        if part.process == "wire-cut":
            assert check_dxf(dxf_bytes(part), part) == []
heavy = {name for name, what in HEAVY.items() if what in ("CAD kernel", "meshes")}
found = {m.split(".")[0] for m in sys.modules} & heavy
sys.exit(f"loaded {found}" if found else 0)
"""
    done = run(str(DESIGN), cwd=tmp_path, script=script)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow  # two exports in fresh processes
@pytest.mark.cad
@pytest.mark.parametrize("scene", ["array", pytest.param("grasping", marks=pytest.mark.nightly)])
def test_export_builds_the_scenes_own_parts_each_once_and_solves_nothing(scene, tmp_path):
    done = run("export", str(DESIGN), "--scene", scene, "--out", "out", cwd=tmp_path, TACTCAD_PROFILE="1")
    assert done.returncode == 0, done.stderr
    made = parsed(done.stderr)
    parts = {part.part_no for part in make_scene(variant(base="double-sample"), scene).parts}
    assert set(made["solid"].values()) == {1}, "none twice"
    # bought screws are drawn in pictures by a simpler shape of their own
    solids = {name.removesuffix("-drawn") for name in made["solid"] if "-board-" not in name}
    assert solids == parts, "none outside the scene, but those of its boards"
    assert set(made["scene"]) == {scene} and "elements" not in made
    assert all(name.startswith("picture of") for name in made.get("mesh", {})), "meshes for pictures alone"
    again = run("export", str(DESIGN), "--scene", scene, "--out", "out", cwd=tmp_path, TACTCAD_PROFILE="1")
    assert parsed(again.stderr) == {} and "none of the heavy ones" in again.stderr


@pytest.mark.cad
@pytest.mark.nightly
def test_check_builds_and_meshes_every_part_once(tmp_path):
    done = run("check", str(DESIGN), cwd=tmp_path, TACTCAD_PROFILE="1")
    made = parsed(done.stderr)
    design = variant(base="double-sample")
    parts = {part.part_no for name in scene_names(design) for part in make_scene(design, name).parts}
    posed = {n: times for n, times in made["solid"].items() if not n.startswith("AID-")}  # boxes
    assert parts <= posed.keys()
    assert set(posed.values()) == {1} == set(made["mesh"].values())
    assert set(made["mesh"]) == parts, "a mesh where a check asks for one"
    assert "elements" not in made


def parsed(stderr: str) -> dict[str, dict[str, int]]:
    """How often each thing was made, by kind, from the profile's text."""
    lines = stderr[stderr.index("profile: ") :].splitlines()[2:]
    made, kind = {}, ""
    for line in lines:
        if line.startswith("    "):
            name, _, rest = line.strip().rpartition(" x ")
            name, times = name.rsplit(None, 1)
            made[kind][name.strip()] = int(times)
        else:
            kind = line.strip().split(":")[0]
            made[kind] = {}
    return made


def test_the_profile_is_printed_when_a_command_fails_too(tmp_path):
    done = run("estimate", str(DESIGN), "--accuracy", "0.0001%", cwd=tmp_path, TACTCAD_PROFILE="1")
    assert done.returncode == 1 and "profile: " in done.stderr and "no rung is known" in done.stderr


def test_nothing_is_put_down_where_nobody_asks():
    with making("solid", "a"):
        pass
    with profiled() as outer:
        with making("solid", "b"), profiled() as inner, making("mesh", "c"):
            pass
        with pytest.raises(ValueError, match="torn"), making("solid", "d"):
            raise ValueError("torn")
    assert [(m.kind, m.name) for m in inner.made] == [("mesh", "c")]
    assert [(m.kind, m.name) for m in outer.made] == [("solid", "b")]
    with profiled() as own:
        for _ in range(3):
            with making("solid", "e"):
                sum(range(1000))
    record = own.record()
    assert record["made"]["solid"]["e"]["times"] == 3 and record["peak_memory_mb"] > 10
    assert "e " in text(record) and "3 x" in text(record)
    assert set(record["loaded"]) <= set(HEAVY)
