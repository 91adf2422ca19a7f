"""Every reader of a user's file, fed with files changed by chance: a result, or one line that names the file.

Each reader is taken as far as a command takes what it read, printed text and JSON included, so that nothing
it lets through breaks what follows. Numpy's warnings count as faults. Seeds come from hypothesis, the same
ones every time.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import signal
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pytest
from command_line import ROOT, one_by_one
from hostile_bytes import NUMBERS, TEXTS, hostile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tactcad.checks.shop import load_shop
from tactcad.design.messages import CheckFailure, InputError
from tactcad.export import golden_file as golden
from tactcad.export import manifest, sides
from tactcad.export.cache import Cache
from tactcad.export.difference_page import page
from tactcad.export.dxf import dxf_bytes
from tactcad.export.geometry import geometry
from tactcad.export.inspection import inspection_bytes
from tactcad.export.manifest import sealed
from tactcad.lab import as_made, batch, calibration, calibration_file, grasp, pads, readings
from tactcad.lab.inspection_sheet import read_sheet
from tactcad.lab.load_cell import LoadCell
from tactcad.paper import published
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load
from tactcad.scenes import bom, make_scene, scene_names
from tactcad.scenes.rig import pose_of

DATA, EXAMPLES = ROOT / "src" / "tactcad", ROOT / "hardware" / "examples"
FEW, MANY = 15, 10_000
LONGEST = 60  # s; what takes longer hangs


@dataclass(frozen=True)
class Reader:
    """A good file, its name, and what a command does with a file of that kind. `named`: messages name the
    file."""

    name: str
    good: bytes
    use: Callable[[Path], object]
    named: bool = True


CELL = LoadCell.parse("57.04")


def calibrate(path: Path) -> None:
    rows = calibration.calibrate(readings.calibration(path), CELL)
    calibration_file.to_text(rows, CELL, 0.95), calibration_file.to_json(rows, CELL, 0.95)
    try:
        calibration_file.to_csv(rows, CELL)
    except CheckFailure as refusal:  # of one element, after the file was read
        assert str(refusal).startswith("element ")


def stiffness(known: Path, grasps: Path) -> None:
    sensitivity = calibration_file.read(str(known))
    found = [
        grasp.evaluate(g, sensitivity, coupling=pads.coupling("macro-array", g, 1.0))
        for g in readings.grasps(grasps)
    ]
    grasp.to_text(found, 0.95), grasp.to_json(found, 0.95)


def difference(old: sides.Side, source: str) -> None:
    new = sides.read_side(source)
    for a, b in ((old, new), (new, old)):
        changes = sides.compare_sides(a, b)
        [str(c) for c in changes], json.dumps([vars(c) for c in changes])
        page(a, b, changes)


DATA_KEPT = b"data\n" * 20


def cached(path: Path, cache: Cache) -> None:
    """Whatever an entry became, it is what was put there or nothing."""
    shutil.copy(path, cache._path("key"))
    assert cache.get("key") in (None, DATA_KEPT)


def entry_of(cache: Cache) -> bytes:
    cache.put("key", DATA_KEPT)
    assert cache.get("key") == DATA_KEPT
    return cache._path("key").read_bytes()


class Export:
    """An export without solids: manifest, one cut file, one bill, none of them made by the pipeline."""

    def __init__(self, design) -> None:
        scene = make_scene(design, "array")
        part = next(p for p in scene.parts if p.process == "wire-cut")
        record = geometry(design)["parts"][part.part_no]
        named = {name: record[name] for name in sides.IN_EXPORTS if name != "contours"}
        rows = bom.bom_rows(scene, None, {})
        self.files = {
            "part.dxf": ("dxf", part.part_no, dxf_bytes(part)),
            "bom.json": ("bom", "", bom.json_bytes(rows, design.name, "A", "array")),
        }
        listed = [
            manifest.FileRecord(path, kind, number, "A", manifest.sha256_of(data))
            for path, (kind, number, data) in self.files.items()
        ]
        parts = [manifest.PartRecord(**named, part_no=part.part_no, section_area_mm2=None)]
        self.manifest = manifest.manifest_bytes(
            manifest.Manifest(design.name, "A", tuple(listed), tuple(parts))
        )

    def with_file(self, name: str, path: Path, old: sides.Side) -> None:
        """Compare the export in which that file is another one, its digest set right."""
        place = path.parent / "export"
        place.mkdir(exist_ok=True)
        changed = path.read_bytes()
        for file, (_, _, data) in self.files.items():
            (place / file).write_bytes(changed if file == name else data)
        listed = changed
        if name in self.files:
            before = hashlib.sha256(self.files[name][2]).hexdigest()
            listed = self.manifest.replace(before.encode(), hashlib.sha256(changed).hexdigest().encode())
        with suppress(ValueError, AttributeError, RecursionError):  # sealed anew, so that all of it is read
            record = json.loads(listed)
            record.pop("seal", None)
            listed = sealed(record)
        (place / "manifest.json").write_bytes(listed)
        difference(old, str(place))


@pytest.fixture(scope="module")
def readers(tmp_path_factory) -> dict[str, Reader]:
    place = tmp_path_factory.mktemp("good")
    (place / "A.toml").write_text(one_by_one(4.0, "A"), encoding="utf-8")
    design = load(place / "A.toml")
    layout, old = Layout(design), sides.read_side(str(place / "A.toml"))
    rows = calibration.calibrate(readings.calibration(EXAMPLES / "calibration.csv"), CELL)
    known = place / "calibration.csv"
    known.write_text(calibration_file.to_csv(rows, CELL))
    one_grasp = place / "grasp.csv"  # its first sample: what is tried is the calibration
    one_grasp.write_bytes(b"".join((EXAMPLES / "grasp.csv").read_bytes().splitlines(True)[:93]))
    export = Export(design)
    cache = Cache(place / "cache", say=lambda text: None)
    lines = (EXAMPLES / "calibration.csv").read_bytes().split(b"\n")
    found = [
        Reader(
            "design.toml", (ROOT / "hardware" / "macro-array.toml").read_bytes(), every_scene, named=False
        ),
        Reader("shop.toml", (DATA / "checks" / "data" / "shop.toml").read_bytes(), load_shop),
        Reader("table1.csv", (DATA / "paper" / "data" / "table1.csv").read_bytes(), published.load),
        Reader(
            "table2.csv",
            (DATA / "paper" / "data" / "table2.csv").read_bytes(),
            lambda path: published.load(None, path),
        ),
        Reader(
            "batch.csv",
            BATCH,
            lambda path: batch.estimate_file(path, path.parent / "out" / "out.csv", "solid"),
        ),
        Reader("readings.csv", b"\n".join(lines[:60]) + b"\n", calibrate),
        Reader("grasp.csv", (EXAMPLES / "grasp.csv").read_bytes(), lambda path: stiffness(known, path)),
        Reader("calibration.csv", known.read_bytes(), lambda path: stiffness(path, one_grasp)),
        Reader(
            "calibration.json",
            calibration_file.to_json(rows, CELL, 0.95).encode(),
            lambda path: stiffness(path, one_grasp),
        ),
        Reader(
            "sheet.csv",
            inspection_bytes(layout),
            lambda path: as_made.report(
                design, "solid", as_made.as_made(layout, read_sheet(path, layout), "solid")
            ),
        ),
        Reader(
            "golden.json",
            golden.golden_bytes(golden.golden_record(design)),
            lambda path: difference(old, str(path)),
        ),
        Reader("manifest.json", export.manifest, lambda path: export.with_file("", path, old)),
        Reader("part.dxf", export.files["part.dxf"][2], lambda path: export.with_file("part.dxf", path, old)),
        Reader("bom.json", export.files["bom.json"][2], lambda path: export.with_file("bom.json", path, old)),
        Reader("entry", entry_of(cache), lambda path: cached(path, cache)),
    ]
    return {reader.name: reader for reader in found}


BATCH = (
    b"hinge_thickness,hinge_length,fillet_radius,load_arm,arm_height,body_height,body_length,poisson,youngs_modulus,width,"
    b"sides,friction,note\n"
    b"0.25,0.75,0.15,4,2.5,5,3,0.33,72000,3,two,0,x\n"
    b'0.3,0.9,0.15,6,2.5,5,3,0.33,69000,3,one,0.1,"a, b"\n'
)


def every_scene(path: Path) -> None:
    design = load(path)
    scene_names(design)
    geometry(design)


NAMES = (
    "design.toml shop.toml table1.csv table2.csv batch.csv readings.csv grasp.csv calibration.csv "
    "calibration.json sheet.csv "
    "golden.json manifest.json part.dxf bom.json entry"
).split()


def attempt(reader: Reader, data: bytes, place: Path) -> str:
    """What becomes of the file: "read", or "refused". Raises AssertionError for anything else."""
    work = place / "work"
    shutil.rmtree(work, ignore_errors=True)
    (work / "out").mkdir(parents=True)
    path = work / reader.name
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            reader.use(path)
            return "read"
        except (InputError, CheckFailure) as refusal:
            said = str(refusal)
            assert said.isprintable() and len(said) < 1000, said
            named = str(work) in said or "in the calibration" in said  # a grasp that another calibration fits
            assert not reader.named or named, said
            assert not list((work / "out").iterdir())
            return "refused"


def hangs(*_) -> None:
    raise AssertionError(f"no answer within {LONGEST} s")


def fuzz(reader: Reader, place: Path, examples: int) -> dict[str, int]:
    """How many files were read, and how many refused."""
    assert attempt(reader, reader.good, place) == "read"
    counts = {"read": 0, "refused": 0}

    @settings(
        max_examples=examples,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.integers(0, 2**48))
    def one(seed: int) -> None:
        signal.alarm(LONGEST)
        counts[attempt(reader, hostile(reader.good, reader.name.rpartition(".")[2], seed), place)] += 1

    before = signal.signal(signal.SIGALRM, hangs)
    try:
        one()
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
    return counts


@pytest.mark.by_day(8, "changed files by the dozen each")
@pytest.mark.parametrize("name", NAMES)
def test_a_file_changed_by_chance_is_read_or_refused(readers, tmp_path, record_property, name):
    counts = fuzz(readers[name], tmp_path, FEW)
    record_property(f"{name}, changed by chance", counts)
    assert counts["refused"] or name == "entry"


@pytest.mark.nightly
@pytest.mark.parametrize("name", NAMES)
def test_ten_thousand_files_changed_by_chance(readers, tmp_path, record_property, name):
    counts = fuzz(readers[name], tmp_path, MANY)
    record_property(f"{name}, changed by chance", counts)
    assert (counts["refused"] or name == "entry") and sum(counts.values()) >= MANY // 2


@settings(max_examples=30, derandomize=True, deadline=None, database=None)
@given(
    st.lists(
        st.tuples(
            st.sampled_from(["element", "deflection", "weights", "height", "cart", ""]),
            st.sampled_from([*NUMBERS, *TEXTS, "1e-6", "0.05", "2"]) | st.text(max_size=6),
        ),
        max_size=3,
    )
)
def test_poses_are_read_or_refused(macro, words):
    """What is taken as a pose, its scenes can be built from."""
    try:
        pose = pose_of([f"{key}={value}" for key, value in words], macro)
    except InputError as refusal:
        assert str(refusal).isprintable() and str(refusal).startswith("--pose: ")
        return
    for name in scene_names(macro):
        try:
            make_scene(macro, name, pose)
        except InputError as refusal:  # a pose that this scene has not
            assert str(refusal).isprintable()
