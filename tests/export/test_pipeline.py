"""Whole exports: equal bytes anywhere, nothing rebuilt without need, everything rebuilt with need, whole when
killed."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from math import atan2, cos, hypot, pi, sin, sqrt, tau
from pathlib import Path

import pytest
from variants import BARE_TEXT, HARDWARE, variant

import tactcad
from tactcad.design.messages import CheckFailure, InputError
from tactcad.export import inputs as export_inputs
from tactcad.export import pipeline
from tactcad.export.formats import ExportOptions
from tactcad.export.manifest import check_manifest, read_manifest
from tactcad.export.pipeline import export
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.description import Extrusion, Part

pytestmark = pytest.mark.cad

CHILD = """
import json, sys
from tactcad.cli.main import main
status = main(sys.argv[1:])
loaded = {m.split(".")[0] for m in sys.modules}
rooms = {m.split(".")[1] for m in sys.modules if m.startswith("tactcad.")}
print(json.dumps({"status": status, "loaded": sorted(loaded), "rooms": sorted(rooms)}))
"""
HEAVY = {"OCP", "build123d", "cadquery", "numpy", "scipy", "ezdxf", "matplotlib", "skfem"}
REVISION = tomllib.loads((HARDWARE / "macro-array.toml").read_text())["design"]["revision"]
TWO_ARMS = {"array.row_arms": [[4.0, 6.0]]}
TWO_ARMS_TEXT = BARE_TEXT.replace("[[4, 7, 6, 8, 6], [8, 5, 4, 5, 7]]", "[[4, 6]]")


def run(*arguments: str, cwd: Path, source: Path | None = None, **environment: str) -> tuple[dict, str]:
    """`tactcad ARGUMENTS` in a fresh process: what it loaded (and its status), and what it said."""
    environment = {
        **{k: v for k, v in os.environ.items() if k in ("PATH", "LD_LIBRARY_PATH")},
        "PYTHONPATH": str(source or Path(tactcad.__file__).parents[1]),
        **environment,
    }
    done = subprocess.run(
        [sys.executable, "-c", CHILD, *arguments],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    said = json.loads(done.stdout.splitlines()[-1])
    assert said["status"] == 0 and "Traceback" not in done.stderr, done.stderr
    return said, done.stderr


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


class Notes:
    """Progress that keeps what it is told."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.steps: list[str] = []

    def line(self, text: str) -> None:
        self.lines.append(text)

    def step(self, done: int, total: int, text: str) -> None:
        self.steps.append(text)


ARRAY = ExportOptions(("array",))


def exported(design, out: Path, others: str = "refuse"):
    notes = Notes()
    return export(design, ARRAY, out, notes, others), notes


# --- the shipped array and one of its rigs, in a fresh process ---

# every scene of every design, with guides and drawings: tests/faults/test_surroundings.py, nightly
TWO_SCENES = ("--scene", "array", "--scene", "sample-stiffness")


def export_in_a_home_of_its_own(home: Path, seed: str, zone: str, language: str, *scenes: str) -> Path:
    """The design exported by a process that shares nothing with another but the code."""
    (home / "designs").mkdir()
    shutil.copy(HARDWARE / "macro-array.toml", home / "designs" / "paper.toml")
    said, _ = run(
        "export",
        "designs/paper.toml",
        *scenes,
        "--out",
        f"out-{seed}",
        cwd=home,
        HOME=str(home),
        TZ=zone,
        LANG=language,
        PYTHONHASHSEED=seed,
        TACTCAD_CACHE=str(home / "cache"),
    )
    # whatever of the code a cold export runs, the manifest's inputs watch (the command line's own room
    # apart)
    assert "solids" in said["rooms"]
    # profiling counts, shutdown puts away: neither shapes a file
    assert set(said["rooms"]) - {"cli", "profiling", "shutdown"} <= set(pipeline.ROOMS)
    return home


def assert_names_no_machine(home: Path, out: str) -> None:
    for name, data in contents(home / out).items():
        for trace in (str(home), str(home.parent), "/root", "/home", os.uname().nodename):
            assert trace.encode() not in data, f"{trace} in {name}"


@pytest.fixture(scope="module")
def shipped(tmp_path_factory) -> Path:
    """Where that export, out-1, and its cache lie."""
    home = tmp_path_factory.mktemp("home 1")
    return export_in_a_home_of_its_own(home, "1", "Pacific/Auckland", "C", *TWO_SCENES)


@pytest.mark.slow  # an export with a cold cache in another process
def test_two_processes_write_equal_bytes_in_every_file_of_the_array(shipped, tmp_path):
    """But for those that speak of all scenes together, which test_surroundings.py compares."""
    other = export_in_a_home_of_its_own(tmp_path, "4242", "America/St_Johns", "C.UTF-8", *TWO_SCENES[:2])
    first, second = contents(shipped / "out-1"), contents(other / "out-4242")
    assert len(second) > 40 and set(second) < set(first)
    of_all_scenes = {"manifest.json", "inspection.csv", "inspection-parts.csv", "stack.csv", "stack.html"}
    assert {name for name in second if first[name] != second[name]} <= of_all_scenes
    assert_names_no_machine(other, "out-4242")


@pytest.mark.slow  # a cold export of the shipped array and a rig in a fresh process
def test_the_export_is_what_the_contract_says(shipped):
    folder = shipped / "out-1"
    assert check_manifest(folder) == []
    record = json.loads((folder / "manifest.json").read_text())
    kinds = {f["kind"] for f in record["files"]}
    assert kinds == {
        "step-part",
        "step-pmi",
        "step-assembly",
        "dxf",
        "bom",
        "picture",
        "inspection",
        "report",
        "netlist",
        "wiring",
        "board",
        "gerber",
    }
    parts = {p["part_no"] for p in record["parts"]}
    assert {f["part_no"] for f in record["files"] if f["kind"] == "step-part"} == parts
    cut = {p["part_no"] for p in record["parts"] if p["cut_length_mm"] is not None}
    assert {f["part_no"] for f in record["files"] if f["kind"] == "dxf"} == cut
    assert {
        p["part_no"] for p in record["parts"] if p["process"] == "wire-cut"
    } < cut  # and plates, test_blanks.py
    solids = {
        p.name: sum(r["qty"] for r in json.loads(p.read_text())["rows"] if r["has_solid"])
        for p in folder.glob("bom*.json")
    }
    assemblies = [f["path"] for f in record["files"] if f["kind"] == "step-assembly"]
    instances = [(folder / path).read_text().count("=NEXT_ASSEMBLY_USAGE_OCCURRENCE(") for path in assemblies]
    assert sorted(solids.values()) == sorted(instances)
    assert solids["bom.json"] == 40
    rows = [row for bill in folder.glob("bom*.json") for row in json.loads(bill.read_text())["rows"]]
    for p in record["parts"]:  # scenes are built one after the other from the same parts
        assert p["qty"] == max(r["qty"] for r in rows if r["part_no"] == p["part_no"])


# --- what a cut file says, measured in it ---


def dxf_segments(path: Path) -> list[tuple]:
    import ezdxf

    found = []
    for e in ezdxf.readfile(path).modelspace():
        kind = e.dxftype()
        assert kind in ("LINE", "ARC", "CIRCLE")
        if kind == "LINE":
            found.append(("line", tuple(e.dxf.start)[:2], tuple(e.dxf.end)[:2]))
        elif kind == "ARC":
            found.append(("arc", tuple(e.dxf.center)[:2], e.dxf.radius, e.dxf.start_angle, e.dxf.end_angle))
        else:
            found.append(("circle", tuple(e.dxf.center)[:2], e.dxf.radius))
    return found


def heights_at(segments: list[tuple], x: float) -> list[float]:
    """y of every crossing of the vertical line at x."""
    found = []
    for kind, *s in segments:
        if kind == "line":
            (x0, y0), (x1, y1) = s
            if min(x0, x1) < x < max(x0, x1):
                found.append(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
        else:
            (cx, cy), r, first, last = *s[:2], *(s[2:] or (0.0, 360.0))
            if abs(x - cx) < r:
                for sign in (1, -1):
                    y = sign * sqrt(r * r - (x - cx) ** 2)
                    turn = (atan2(y, x - cx) - first * pi / 180) % tau
                    if turn <= ((last - first) % 360 or 360) * pi / 180:
                        found.append(cy + y)
    return sorted(found)


def area_of(segments: list[tuple]) -> float:
    """Green's theorem on fine chords: outline less circles (within 1e-7 of the exact one)."""
    chains, holes = [], 0.0
    for kind, *s in segments:
        if kind == "circle":
            holes += pi * s[1] ** 2
        elif kind == "line":
            chains.append(list(s))
        else:
            (cx, cy), r, first, last = s
            sweep, n = ((last - first) % 360) * pi / 180, 400
            arc = [first * pi / 180 + sweep * k / n for k in range(n + 1)]
            # points a little outside, so that the chords' polygon has the arc's own area
            out = r * sqrt((sweep / n) / sin(sweep / n))
            points = [(cx + out * cos(a), cy + out * sin(a)) for a in arc]
            ends = [(cx + r * cos(a), cy + r * sin(a)) for a in (arc[0], arc[-1])]
            chains.append([ends[0], *points[1:-1], ends[1]])
    outline = chains.pop(0)
    while chains:
        gaps = [
            (min(hypot(c[i][0] - outline[-1][0], c[i][1] - outline[-1][1]) for i in (0, -1)), n)
            for n, c in enumerate(chains)
        ]
        gap, n = min(gaps)
        assert gap < 1e-6, "open chain"
        nxt = chains.pop(n)
        if hypot(nxt[0][0] - outline[-1][0], nxt[0][1] - outline[-1][1]) > 1e-6:
            nxt.reverse()
        outline += nxt[1:]
    assert hypot(outline[0][0] - outline[-1][0], outline[0][1] - outline[-1][1]) < 1e-6, "open chain"
    twice = sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(outline, outline[1:]))
    return abs(twice) / 2 - holes


def test_hinge_and_area_measured_in_the_cut_files(one):
    folder, design = one[0] / "out", variant(TWO_ARMS)
    volumes = {p.part_no: p.volume_mm3 for p in read_manifest(folder).parts}
    for place in Layout(design).elements:
        number = f"macro-array-element-a{place.arm:g}mm"
        (file,) = (folder / "dxf").glob(f"{number}_*.dxf")
        segments = dxf_segments(file)
        face, floor = heights_at(segments, place.hinge_x)[:2]
        assert floor - face == pytest.approx(design.element.hinge_thickness, abs=1e-6)
        tip = heights_at(segments, place.hinge_x - place.arm + design.stop.land_length / 2)
        assert tip[0] == pytest.approx(-design.element.pad_height, abs=1e-6)
        assert area_of(segments) == pytest.approx(volumes[number] / design.sheet.thickness, rel=2e-6)


# --- what is rebuilt, and why: two elements, in this process ---


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    """An export of two elements, to be copied: where it lies with its cache, what it did and said."""
    base = tmp_path_factory.mktemp("one")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TACTCAD_CACHE", str(base / "cache"))
        done, notes = exported(variant(TWO_ARMS), base / "out")
    return base, done, notes


@pytest.fixture
def mine(one, tmp_path, monkeypatch):
    """A copy of that export and cache, free to be damaged."""
    shutil.copytree(one[0], tmp_path / "copy", symlinks=True)
    monkeypatch.setenv("TACTCAD_CACHE", str(tmp_path / "copy" / "cache"))
    return tmp_path / "copy" / "out"


def test_the_first_export_makes_everything_and_says_why(one):
    base, done, notes = one
    assert_names_no_machine(base, "out")
    assert done.reasons == ("there is no earlier export",)
    assert len(done.made) == done.files - 5  # bills, tables of elements and manifest are written every time
    assert any("no earlier export" in line for line in notes.lines)


def test_a_changed_arm_rebuilds_only_what_depends_on_it(mine):
    before = contents(mine)
    done, notes = exported(variant({"array.row_arms": [[4.5, 6.0]]}), mine)
    assert done.reasons == ("design.array.row_arms[0][0] changed 4.0 -> 4.5",)
    assert any("4.0 -> 4.5" in line for line in notes.lines)
    assert done.built == ("macro-array-element-a4.5mm",)
    assert set(done.made) == {
        f"step/macro-array-element-a4.5mm_{REVISION}.step",
        f"step/macro-array-element-a4.5mm_{REVISION}-ap242.step",
        f"dxf/macro-array-element-a4.5mm_{REVISION}.dxf",
        "pictures/macro-array-element-a4.5mm.svg",
        f"step/macro-array-array_{REVISION}.step",
        "pictures/macro-array-array-above.svg",
        "pictures/macro-array-array-below.svg",
        "pictures/macro-array-array-open.svg",
        "stack.csv",
        "stack.html",
        "inspection-parts.csv",
    }
    after = contents(mine)
    assert not [name for name in after if "-a4mm" in name], "the old element is gone"
    same = set(before) & set(after) - set(done.made)
    same -= {"bom.csv", "bom.json", "inspection.csv", "strength.csv", "manifest.json"}
    assert len(same) > 20 and all(before[name] == after[name] for name in same)


def again(out: Path, folder: Path, **more) -> tuple[dict, str]:
    """That export once more, from a file, in a fresh process."""
    (folder / "two.toml").write_text(TWO_ARMS_TEXT)
    more |= {"cwd": folder, "TACTCAD_CACHE": os.environ["TACTCAD_CACHE"]}
    return run("export", "two.toml", "--scene", "array", "--out", str(out), **more)


def test_a_second_export_does_nothing_and_loads_nothing(mine, tmp_path):
    before = {p: p.lstat().st_mtime_ns for p in mine.parent.rglob("*")}
    said, log = again(mine, tmp_path)
    assert HEAVY & set(said["loaded"]) == set()
    assert "nothing was rebuilt" in log and log.count("\n") == 1
    assert {p: p.lstat().st_mtime_ns for p in before} == before


@pytest.mark.slow  # a whole export in a fresh process
def test_whatever_is_made_anew_is_the_same(mine, tmp_path):
    """A comment in a copy of the source: a fresh process makes every file again, none from the cache, and
    with equal bytes."""
    out, source = mine, tmp_path / "src"
    shutil.copytree(Path(tactcad.__file__).parent, source / "tactcad")
    _, log = again(out, tmp_path, source=source)
    assert "nothing was rebuilt" in log, "the same code elsewhere is the same code"
    before = contents(out)
    with (source / "tactcad" / "contour" / "contour.py").open("a") as file:
        file.write("# touched\n")
    said, log = again(out, tmp_path, source=source)
    assert "source of tactcad.contour changed" in log
    assert " 0 taken from the cache" in log
    assert "OCP" in said["loaded"]
    after = contents(out)
    assert {n for n in before if before[n] != after[n]} == {"manifest.json"}, "a comment changes no geometry"
    assert set(before) == set(after)
    first, second = (json.loads(files["manifest.json"]) for files in (before, after))
    for record in (first, second):  # which differ in the source's digest alone
        del record["seal"], record["inputs"]["sources"]["contour"]
    assert first == second


def test_a_change_that_no_solid_depends_on_makes_the_stack_anew(mine):
    done, _ = exported(variant({**TWO_ARMS, "rating.force": 1.5}), mine)
    assert done.reasons == ("design.rating.force changed 2.0 -> 1.5",)
    assert (done.made, done.built) == (("stack.csv", "stack.html", "inspection-parts.csv"), ())


@pytest.mark.slow  # a whole export
def test_another_author_writes_headers_anew_and_builds_no_solid(mine):
    done, _ = exported(variant({**TWO_ARMS, "design.author": "J\u00f6rg"}), mine)
    assert done.built == ()
    assert {n for n in done.made if n.startswith("step/")} == {
        n for n in contents(mine) if n.startswith("step/")
    }
    assert all(
        b"J\\X2\\00F6\\X0\\rg" in data for name, data in contents(mine).items() if name.startswith("step/")
    )


@pytest.mark.slow  # a whole export
def test_another_revision_is_in_every_name_and_file(mine):
    done, _ = exported(variant({**TWO_ARMS, "design.revision": "B"}), mine)
    names = [n for n in contents(mine) if n.startswith(("step/", "dxf/"))]
    assert names and all("_B." in name.replace("-ap242", "") for name in names)
    assert all(r.revision == "B" for r in read_manifest(mine).files)
    assert done.built == ()


@pytest.mark.slow  # a whole export
def test_a_library_of_another_version_rebuilds(mine, monkeypatch):
    version = export_inputs.metadata.version
    monkeypatch.setattr(
        export_inputs.metadata, "version", lambda name: "9.9.9" if name == "ezdxf" else version(name)
    )
    done, _ = exported(variant(TWO_ARMS), mine)
    assert (
        len(done.reasons) == 1
        and done.reasons[0].startswith("ezdxf ")
        and done.reasons[0].endswith("-> 9.9.9")
    )
    assert len(done.made) == done.files - 5


@pytest.mark.parametrize("room", pipeline.ROOMS)
def test_a_touched_source_file_of_any_room_is_a_reason(room, mine, monkeypatch):
    """Only the reason is asked for: what is made then is tried below."""
    digest = export_inputs.source_digest
    monkeypatch.setattr(export_inputs, "source_digest", lambda r: "touched" if r == room else digest(r))
    design = variant(TWO_ARMS)
    now = export_inputs.inputs_of({"design": design, "options": ARRAY}, pipeline.ROOMS, pipeline.LIBRARIES)
    why = pipeline._reasons(pipeline.looked_at(mine, pipeline.manifests.SCHEMA), now)
    assert why == [f"source of tactcad{'.' if room else ''}{room} changed"]


# --- damage ---


@pytest.mark.parametrize("damage", ["changed", "cut", "removed", "added", "manifest", "manifest emptied"])
def test_a_damaged_export_is_noticed_and_made_whole(damage, mine):
    good = contents(mine)
    target = mine / "dxf" / f"macro-array-element-a4mm_{REVISION}.dxf"
    if damage == "changed":
        target.write_bytes(target.read_bytes().replace(b"0.25", b"0.26", 1))
    elif damage == "cut":
        target.write_bytes(target.read_bytes()[:100])
    elif damage == "removed":
        target.unlink()
    elif damage == "added":
        (mine / "dxf" / "notes.txt").write_text("mine")
    else:
        (mine / "manifest.json").write_text("{}" if damage == "manifest" else "")
    if damage == "removed":
        done, _ = exported(variant(TWO_ARMS), mine)
    else:
        with pytest.raises(InputError, match="not as tactcad wrote it"):
            exported(variant(TWO_ARMS), mine)
        done, _ = exported(variant(TWO_ARMS), mine, "discard")
    assert done.reasons and done.made == ()
    assert contents(mine) == good


@pytest.mark.slow  # a cold export; by day test_a_library_of_another_version_rebuilds and test_cache.py
def test_a_damaged_cache_is_noticed_and_made_whole(mine):
    good = contents(mine)
    cache = Path(os.environ["TACTCAD_CACHE"])
    entries = [p for p in cache.rglob("*") if p.is_file() and len(p.name) == 64]  # the mark is none
    for n, path in enumerate(entries):
        data = bytearray(path.read_bytes())
        data[(n * 7919) % len(data)] ^= 0x20
        path.write_bytes(data)
    (mine / "bom.csv").unlink()
    done, notes = exported(variant(TWO_ARMS), mine)
    assert sum("damaged" in line for line in notes.lines) >= len(done.made) > 20
    assert contents(mine) == good


def test_a_file_that_does_not_read_back_leaves_the_earlier_export(mine, monkeypatch):
    good = contents(mine)
    from tactcad.export import dxf

    write = dxf.dxf_bytes
    monkeypatch.setattr(dxf, "dxf_bytes", lambda part: re.sub(rb"(?m)^0\.25(\r?)$", rb"0.26\1", write(part)))
    with pytest.raises(CheckFailure, match="DXF"):
        exported(variant({"array.row_arms": [[4.7, 6.0]]}), mine)
    assert contents(mine) == good and not list(mine.parent.glob(".out.*"))


def test_what_is_written_wrong_leaves_the_earlier_export(mine, monkeypatch):
    """A picture of nothing, a bill with a row less, and a manifest with another digest, in the order in which
    an export comes to them."""
    from tactcad.drawing.engine import picture
    from tactcad.export import manifest
    from tactcad.scenes import bom

    good = contents(mine)
    wrong = {
        (picture, "svg"): (lambda data: re.sub(rb' d="[^"]*"', b' d=""', data), "nothing is drawn"),
        (bom, "csv_bytes"): (
            lambda data: b"".join(data.splitlines(keepends=True)[:-1]),
            "bill of materials of array",
        ),
        (manifest, "manifest_bytes"): (
            lambda data: re.sub(rb'"sha256": "\w{64}', b'"sha256": "' + b"0" * 64, data, count=1),
            "the finished export does not hold",
        ),
    }
    for (module, name), (damage, said) in wrong.items():
        write = getattr(module, name)
        with monkeypatch.context() as patch, pytest.raises(CheckFailure, match=said):
            patch.setattr(module, name, lambda *a, write=write, damage=damage: damage(write(*a)))
            exported(variant({"array.row_arms": [[4.7, 6.0]]}), mine)
    assert contents(mine) == good and not list(mine.parent.glob(".out.*"))


def test_a_measured_part_must_agree_with_its_description(mine, monkeypatch):
    """Centre of mass and box from the kernel are compared with the closed forms."""
    made = variant({"array.row_arms": [[4.7, 6.0]]})
    centre, box = Part.centre.fget, Extrusion.box.fget
    with monkeypatch.context() as patch, pytest.raises(CheckFailure, match="centre of mass"):
        patch.setattr(Part, "centre", property(lambda self: (centre(self)[0] + 1e-5, *centre(self)[1:])))
        exported(made, mine)
    larger = property(lambda self: (box(self)[0], tuple(x + 1e-5 for x in box(self)[1])))
    monkeypatch.setattr(Extrusion, "box", larger)
    with pytest.raises(CheckFailure, match="bounding box is 1e-05 mm from the description's"):
        exported(made, mine)


def test_a_broken_rule_leaves_the_earlier_export(mine):
    good = contents(mine)
    with pytest.raises(InputError, match="fillets_fit_slot"):
        exported(variant({**TWO_ARMS, "element.fillet_radius": 0.5}), mine)
    assert contents(mine) == good
