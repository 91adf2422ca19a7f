"""Every other file that a command reads, and every other word: one line that says what is wrong, exit status
2, nothing written."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from pathlib import Path

import pytest
from command_line import ROOT, contents, environment, refused, tactcad_forked, tactcad_runs

EXAMPLES = ROOT / "hardware" / "examples"
BATCH = (
    "hinge_thickness,hinge_length,fillet_radius,load_arm,arm_height,body_height,body_length,poisson,youngs_modulus,width\n"
    "0.25,0.75,0.15,4,2.5,5,3,0.33,72000,3\n"
)
# kind of file -> the command that reads it, FILE where it stands
READERS = {
    "shop.toml": ["check", "A.toml", "--shop", "FILE", "--report", "report"],
    "calibration.json": ["stiffness", "good-grasp.csv", "--calibration", "FILE", "--thickness", "6"],
    "batch.csv": ["estimate", "--batch", "FILE", "--out", "out.csv"],
    "readings.csv": ["calibrate", "FILE", "--out", "out.csv"],
    "grasp.csv": ["stiffness", "FILE", "--calibration", "good-calibration.csv"],
    "calibration.csv": ["stiffness", "good-grasp.csv", "--calibration", "FILE", "--thickness", "6"],
    "sheet.csv": ["estimate", "A.toml", "--inspection", "FILE"],
    "table1.csv": ["validate", "--table1", "FILE", "--out", "report"],
    "table2.csv": ["validate", "--table2", "FILE", "--out", "report"],
    "golden.json": ["diff", "FILE", "A.toml", "--html", "out.html"],
    "design.toml": ["diff", "A.toml", "FILE", "--html", "out.html"],
}


@pytest.fixture(scope="module")
def good(bench, tmp_path_factory) -> dict[str, bytes]:
    """A good file of every kind."""
    folder = tmp_path_factory.mktemp("good")
    env = environment(folder)
    readings = EXAMPLES / "calibration.csv"
    as_csv = tactcad_forked("calibrate", readings, "--out", "calibration.csv", cwd=folder, env=env)
    as_json = tactcad_forked("calibrate", readings, "--json", cwd=folder, env=env)
    assert as_csv.returncode == as_json.returncode == 0
    data = ROOT / "src" / "tactcad"
    return {
        "batch.csv": BATCH.encode(),
        "readings.csv": readings.read_bytes(),
        "grasp.csv": (EXAMPLES / "grasp.csv").read_bytes(),
        "calibration.csv": (folder / "calibration.csv").read_bytes(),
        "calibration.json": as_json.stdout,
        "sheet.csv": next(file for path, file in bench.files["A"].items() if path.endswith("inspection.csv")),
        "shop.toml": (data / "checks" / "data" / "shop.toml").read_bytes(),
        "table1.csv": (data / "paper" / "data" / "table1.csv").read_bytes(),
        "table2.csv": (data / "paper" / "data" / "table2.csv").read_bytes(),
        "golden.json": (ROOT / "exports" / "golden" / "soft-tissue.json").read_bytes(),
        "design.toml": (ROOT / "hardware" / "macro-array.toml").read_bytes(),
    }


def spoilt(good: bytes, kind: str) -> dict[str, bytes]:
    """What the file can be instead."""
    text = good.decode()
    faults = {
        "empty": b"",
        "a line end": b"\n",
        "half of it": good[: len(good) // 2].rstrip(b"0123456789.\n"),
        "UTF-16": text.encode("utf-16"),
        "not UTF-8": good[:-1] + b"\xff\n",
        "NULs": good[:40] + b"\0" * 100 + good[40:],
        "a picture": b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 10,
        "deep": b"[" * 100_000,
        "another kind": b"<html><body>404</body></html>",
        "too large": None,  # 600 MB that take no room
    }
    if kind.endswith(".csv"):
        header, *rows = [line for line in text.splitlines() if not line.startswith("#")]
        faults |= {
            "no rows of that width": f"{header}\n{rows[0]},7,8,9\n".encode(),
            "column twice": f"{header},{header.split(',')[0]}\n{rows[0]},7\n".encode(),
            "no number": f"{header}\n{rows[0].replace('1', 'one').replace('2', '=cmd()')}\n".encode(),
            "infinite": ",".join(
                [header + "\n" + rows[0].split(",")[0], "1e999", *rows[0].split(",")[2:]]
            ).encode(),
            "open quote": f'{header}\n"{rows[0]}\n'.encode(),
            "field of 1 MB": f"{header}\n{'x' * 1_000_000}{rows[0]}\n".encode(),
        }
    if kind.endswith(".json"):
        record = json.loads(text)
        faults |= {
            "NaN": text.replace(": 1", ": NaN", 1).encode(),
            "beyond all numbers": text.replace(": 1", ": 1e999", 1).encode(),
            "thousands of digits": text.replace(": 1", ": " + "1" * 10_000, 1).encode(),
            "a list": json.dumps([record]).encode(),
            "another schema": json.dumps(record | {"schema": "other"}).encode(),
            **{
                f"{key} is {value!r}": json.dumps(record | {key: value}).encode()
                for key in set(record)
                - {"schema", "units", "level", "load_cell_stiffness_N_per_mm", "warnings"}
                for value in (None, "x", [1], {"x": [1]})
                if not (isinstance(value, str) and key in ("design", "revision", "date", "title"))
            },
        }
    if kind == "golden.json":
        part = next(iter(record["parts"]))
        for name, value in {
            "contours": [[[0, 0, 1, 1]]],
            "process": 3,
            "holes": [1],
            "volume_mm3": {"a": 1},
        }.items():
            changed = json.loads(text)
            changed["parts"][part][name] = value
            faults[f"a part's {name}"] = json.dumps(changed).encode()
    if kind.endswith(".toml"):
        faults |= {
            "60 kB key": b"a." * 30_000 + b"a = 1",
            "unknown field": b"x = 1\n" + good,
            "a long integer": b"x = " + b"9" * 10_000,
        }
    return faults


def not_files(work: Path, ending: str) -> list[str]:
    """Paths that lead to no file, with the ending that the command goes by."""
    (work / f"folder{ending}").mkdir()
    os.mkfifo(work / f"pipe{ending}")
    (work / f"loop{ending}").symlink_to(f"loop{ending}")
    (work / f"zero{ending}").symlink_to("/dev/zero")
    (work / f"null{ending}").symlink_to("/dev/null")
    return [f"{name}{ending}" for name in ("./pipe", "loop", "zero", "null", "nowhere", "x" * 300)]


@pytest.mark.by_day(3, "up to fifty commands each")
@pytest.mark.parametrize("kind", READERS)
def test_files_that_are_something_else(bench, good, tmp_path, kind):
    bench.write_designs(tmp_path)
    for name in ("grasp.csv", "calibration.csv"):
        (tmp_path / f"good-{name}").write_bytes(good[name])
    faults, ending = spoilt(good[kind], kind), Path(kind).suffix
    for n, data in enumerate(faults.values()):
        (tmp_path / f"{n}{ending}").write_bytes(data or b"")
        if data is None:
            os.truncate(tmp_path / f"{n}{ending}", 600_000_000)
    names = dict(zip(faults, (f"{n}{ending}" for n in range(len(faults))))) | {
        n: n for n in not_files(tmp_path, ending)
    }
    before = sorted(p.name for p in tmp_path.iterdir()) + ["home", "tmp"]
    commands = [[name if word == "FILE" else word for word in READERS[kind]] for name in names.values()]
    for (fault, name), done in zip(names.items(), tactcad_runs(commands, tmp_path, environment(tmp_path))):
        try:
            said = refused(done)
        except AssertionError as error:
            pytest.fail(f"{kind}, {fault}: {error}")
        assert (
            said.startswith((f"tactcad: {Path(name)}", f"tactcad: {name[:40]}")) or kind == "design.toml"
        ), (fault, said)
        assert len(said) < 700 and said.isprintable(), (fault, said)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(before)


@pytest.mark.slow  # every command
def test_the_good_files_are_read(good, tmp_path, bench):
    """Or the tests above would show nothing. (`validate` and `check` with their own files are tested
    elsewhere.)"""
    bench.write_designs(tmp_path)
    for name, data in good.items():
        (tmp_path / name).write_bytes(data)
        (tmp_path / f"good-{name}").write_bytes(data)
    kinds = [kind for kind in READERS if kind not in ("shop.toml", "table1.csv", "table2.csv")]
    commands = [[kind if word == "FILE" else word for word in READERS[kind]] for kind in kinds]
    for kind, done in zip(kinds, tactcad_runs(commands, tmp_path, environment(tmp_path))):
        assert done.returncode == 0, (kind, done.stderr)


@pytest.mark.slow  # forty commands on exports
def test_an_export_that_was_tampered_with(exported, tmp_path):
    """`diff` takes no export whose files are not its manifest's, nor a manifest that is none."""
    folder = exported / "exports" / "out"

    def damaged(name: str, change) -> str:
        copy = exported / name
        shutil.copytree(folder, copy)
        manifest = json.loads((copy / "manifest.json").read_text())
        seal = manifest.pop("seal")
        change(copy, manifest)
        if name != "hinge":  # sealed anew, so that what else is wrong is found
            text = json.dumps(manifest, indent=1, ensure_ascii=False) + "\n"
            seal = hashlib.sha256(text.encode()).hexdigest()
        sealed = json.dumps({**manifest, "seal": seal}, indent=1, ensure_ascii=False) + "\n"
        (copy / "manifest.json").write_text(sealed)
        return name

    def part(field: str, value: object):
        return lambda copy, m: m["parts"][0].__setitem__(field, value)

    def file(field: str, value: object):
        return lambda copy, m: m["files"][0].__setitem__(field, value)

    changes = {
        "hinge": lambda copy, m: m["inputs"]["values"].__setitem__("design.element.hinge_thickness", 0.3),
        "volume": part("volume_mm3", "heavy"),
        "centre": part("centre_mm", [1]),
        "box": part("box_mm", 7),
        "name": part("name", {}),
        "unknown": part("colour", "red"),
        "path": file("path", "../../A.toml"),
        "absolute": file("path", "/etc/hostname"),
        "no text": file("path", 7),
        "kind": file("kind", "poem"),
        "digest": file("sha256", "0"),
        "device": file("path", "device"),
        "files": lambda copy, m: m.__setitem__("files", {"a": 1}),
        "schema": lambda copy, m: m.__setitem__("schema", None),
        "inputs": lambda copy, m: m.clear(),
        "cut": lambda copy, m: (copy / "bom.csv").write_text("x"),
        "pipe": lambda copy, m: ((copy / "bom.csv").unlink(), os.mkfifo(copy / "bom.csv")),
        "added": lambda copy, m: (copy / "virus.exe").write_text("x"),
    }
    same = ["diff", "A.toml", damaged("as it was", lambda copy, m: None)]
    assert tactcad_forked(*same, cwd=exported, env=environment(exported)).returncode == 0
    names = [damaged(name, change) for name, change in changes.items()]
    (exported / "device" / "device").symlink_to("/dev/zero")
    for name, text in (
        ("deep", "[" * 100_000),
        ("list", "[]"),
        ("half", (folder / "manifest.json").read_text()[:999]),
    ):
        (exported / name).mkdir()
        (exported / name / "manifest.json").write_text(text)
        names.append(name)
    before = {p.name for p in exported.iterdir()}
    commands = [[*command, name] for name in names for command in (["diff", "A.toml"], ["review"])]
    for command, done in zip(commands, tactcad_runs(commands, exported, environment(exported))):
        said = refused(done)
        assert f"tactcad: {command[-1]}: not a sound export: " in said, (command, done.stderr)
        assert command[-1] != "hinge" or "hinge/manifest.json: altered since tactcad wrote it" in said
    assert {p.name for p in exported.iterdir()} == before


def test_a_report_folder_that_is_somebody_elses(tmp_path):
    """`validate --out` replaces an earlier report only; a file called report.json does not make one."""
    folders = {"deep": "[" * 100_000, "null": "null", "other": '{"schema": "x"}', "binary": "\0\1"}
    for name, text in folders.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "report.json").write_text(text)
    (tmp_path / "pipe").mkdir()
    os.mkfifo(tmp_path / "pipe" / "report.json")
    commands = [["validate", "--out", name] for name in (*folders, "pipe")]
    for done in tactcad_runs(commands, tmp_path, environment(tmp_path)):
        assert "report.json (added)" in refused(done)
    assert {name: (tmp_path / name / "report.json").read_text() for name in folders} == folders


NEAR = {
    "exprot": "did you mean export?",
    "estimate --model soild": "did you mean solid?",
    "estimate --model fem_plane": "did you mean fem-plane?",
    "estimate --modell solid": "did you mean --model?",
    "estimate macro-aray": "did you mean macro-array?",
    "export A.toml --scene aray": "did you mean array?",
    "export A.toml --pose elemnt=1": "did you mean element?",
    "size --stiffness 10 --load-arm 5 --alloy 7075-T7": "did you mean 7075-T6?",
    "export sides.toml": "did you mean two?",
    "export field.toml": "did you mean element.hinge_thickness?",
    "check A.toml --shop limit.toml": "did you mean spark_gap?",
}
FAR = {
    "zzz": "one of new, design, export, check",
    "estimate --model zzz": "one of short, beam",
    "estimate zzz": "or one of ",
    "export A.toml --scene zzz": "one of array",
    "schema extra": "one of design, material, sheet",
    "export --out": "expected one argument",
    "estimate --force x": "invalid float value: 'x'",
    "estimate --force nan": "from 1e-06 to 10000 N",
    "size --stiffness 1": "--load-arm",
    "check --": "--: nothing follows it",
    "export --out x --": "--: nothing follows it",
    "check --shop ''": "--shop: empty",
    "validate --table1 ''": "--table1: empty",
    "export --out ''": "--out: empty",
    "check A.toml ''": "DESIGN: empty",
}


def test_mistyped_words(bench, tmp_path):
    """Commands, options, rungs, designs, scenes, fields, choices: what is legal, and the one that was
    meant."""
    bench.write_designs(tmp_path)
    good = bench.texts["A"]
    (tmp_path / "sides.toml").write_text(good.replace('sides = "', 'sides = "twoo" # ', 1))
    (tmp_path / "field.toml").write_text(good.replace("hinge_thickness =", "hinge_thicknes =", 1))
    shop = (ROOT / "src" / "tactcad" / "checks" / "data" / "shop.toml").read_text()
    (tmp_path / "limit.toml").write_text(shop.replace("spark_gap =", "spark_gab =", 1))
    before = contents(tmp_path)
    cases = NEAR | FAR
    commands = [[word.strip("'") for word in line.split()] for line in cases]
    for (line, expected), done in zip(cases.items(), tactcad_runs(commands, tmp_path, environment(tmp_path))):
        said = refused(done)
        assert expected in said, (line, said)
        assert line in NEAR or "did you mean" not in said, (line, said)
    assert contents(tmp_path) == before
