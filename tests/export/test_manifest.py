"""A folder is what its manifest says, or it is seen."""

from __future__ import annotations

import json
import subprocess
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest

from tactcad.design.messages import InputError
from tactcad.export.manifest import (
    FileRecord,
    Manifest,
    PartRecord,
    check_manifest,
    manifest_bytes,
    read_manifest,
    sha256_of,
)

CONTENT = {"step/X-a4_B.step": b"ISO-10303-21;", "bom.csv": b"item\r\n"}
PART = PartRecord(
    "X-a4",
    "block",
    "wire-cut",
    2,
    600.0,
    580.0,
    1.686,
    (10.0, 5.0, 1.5),
    ((0.0, 0.0, 0.0), (20.0, 10.0, 3.0)),
    60.0,
)
MANIFEST = Manifest(
    "macro",
    "B",
    (
        FileRecord("step/X-a4_B.step", "step-part", "X-a4", "B", sha256_of(CONTENT["step/X-a4_B.step"])),
        FileRecord("bom.csv", "bom", "", "B", sha256_of(CONTENT["bom.csv"])),
    ),
    (PART, replace(PART, part_no="PIN", cut_length_mm=None)),
    {"values": {"a.b": 0.1}},
)


@pytest.fixture
def folder(tmp_path) -> Path:
    for name, data in CONTENT.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(data)
    write(tmp_path, MANIFEST)
    return tmp_path


def write(folder: Path, manifest: Manifest) -> None:
    (folder / "manifest.json").write_bytes(manifest_bytes(manifest))


def test_what_is_written_is_read_back(folder):
    assert read_manifest(folder) == MANIFEST
    assert check_manifest(folder) == []


def test_the_names_that_others_rely_on(folder):
    record = json.loads((folder / "manifest.json").read_text())
    assert {"schema", "design", "revision", "files", "parts"} <= set(record)
    assert set(record["files"][0]) == {"path", "kind", "part_no", "revision", "sha256"}
    assert set(record["parts"][0]) >= {
        "part_no",
        "name",
        "process",
        "qty",
        "volume_mm3",
        "area_mm2",
        "mass_g",
        "centre_mm",
        "box_mm",
        "cut_length_mm",
    }


def test_digests_are_those_of_sha256sum(folder):
    name = "step/X-a4_B.step"
    run = subprocess.run(["sha256sum", name], cwd=folder, capture_output=True, text=True, check=True)
    assert MANIFEST.files[0].sha256 == run.stdout.split()[0]


def one_byte(folder: Path) -> None:
    (folder / "bom.csv").write_bytes(b"itEm\r\n")


def gone(folder: Path) -> None:
    (folder / "bom.csv").unlink()


def stray(folder: Path) -> None:
    (folder / "step" / "old.step").write_bytes(b"")


def stray_hidden(folder: Path) -> None:
    (folder / ".old").write_bytes(b"")


def no_manifest(folder: Path) -> None:
    (folder / "manifest.json").unlink()


def cut_manifest(folder: Path) -> None:
    (folder / "manifest.json").write_bytes(manifest_bytes(MANIFEST)[:-30])


def other_schema(folder: Path) -> None:
    record = json.loads((folder / "manifest.json").read_text())
    (folder / "manifest.json").write_text(json.dumps({**record, "schema": "other"}))


def no_object(folder: Path) -> None:
    (folder / "manifest.json").write_text("[]")


def edited(folder: Path) -> None:
    text = (folder / "manifest.json").read_text()
    (folder / "manifest.json").write_text(text.replace('"a.b": 0.1', '"a.b": 0.25'))


def unsealed(folder: Path) -> None:
    record = json.loads((folder / "manifest.json").read_text())
    del record["seal"]
    (folder / "manifest.json").write_text(json.dumps(record, indent=1) + "\n")


OF_FILES = [one_byte, gone, stray, stray_hidden]


@pytest.mark.parametrize(
    "damage", [*OF_FILES, no_manifest, cut_manifest, other_schema, no_object, edited, unsealed]
)
def test_damage_is_seen(folder, damage):
    damage(folder)
    assert check_manifest(folder)
    with pytest.raises(InputError, match="manifest.json") if damage not in OF_FILES else nullcontext():
        read_manifest(folder)


@pytest.mark.parametrize(
    "changes",
    [
        {"files": (*MANIFEST.files, MANIFEST.files[0])},
        {"files": (replace(MANIFEST.files[0], kind="obj"), MANIFEST.files[1])},
        {"files": (replace(MANIFEST.files[0], part_no="nobody"), MANIFEST.files[1])},
        {"files": (*MANIFEST.files, FileRecord("../secret", "bom", "", "B", "0"))},
        {"files": (*MANIFEST.files, FileRecord("/etc/passwd", "bom", "", "B", "0"))},
        {"parts": (*MANIFEST.parts, PART)},
        {"parts": (MANIFEST.parts[1], replace(PART, volume_mm3=0.0))},
        {"parts": (MANIFEST.parts[1], replace(PART, centre_mm=(21.0, 5.0, 1.5)))},
    ],
)
def test_a_manifest_that_cannot_be_true_is_seen(folder, changes):
    write(folder, replace(MANIFEST, **changes))
    assert check_manifest(folder)


def test_no_infinite_numbers():
    with pytest.raises(ValueError, match="not JSON compliant"):
        manifest_bytes(replace(MANIFEST, parts=(replace(PART, mass_g=float("inf")),)))


def test_an_empty_folder_is_no_fault_and_an_unreadable_one_is_named(folder, monkeypatch):
    (folder / "notes").mkdir()
    assert check_manifest(folder) == []

    def refused(*_: object, onerror, **__: object):
        onerror(PermissionError(13, "Permission denied", str(folder / "notes")))

    monkeypatch.setattr("os.walk", refused)
    assert check_manifest(folder) == [f"{folder / 'notes'}: Permission denied"]
