"""No command writes over what it reads: under another name, through a link, by a hard link, or with a folder
round it."""

from __future__ import annotations

import os
import shutil

import pytest
from command_line import ROOT, contents, environment, refused, tactcad_runs

BATCH = (
    "hinge_thickness,hinge_length,fillet_radius,load_arm,arm_height,body_height,body_length,poisson,youngs_modulus,width\n"
    "0.25,0.75,0.15,4,2.5,5,3,0.33,72000,3\n"
)
# command line with IN for the file that is read and OUT for what is written
FILES = {
    "calibrate": "calibrate IN --out OUT",
    "estimate": "estimate --batch IN --out OUT",
    "diff": "diff A.toml IN --html OUT",
    "check, design": "check IN --report OUT/..",
    "check, shop": "check A.toml --shop IN --report OUT/..",
    "release, design": "release IN --sample --out OUT/..",
    "release, shop": "release A.toml --sample --shop IN --out OUT/..",
    "review": "review IN --out OUT",
}
FOLDERS = {
    "export": "export IN --out OUT",
    "validate, design": "validate --design IN --out OUT",
    "validate, table 1": "validate --table1 IN --out OUT",
    "validate, table 2": "validate --table2 IN --out OUT",
}


@pytest.fixture
def inputs(bench, tmp_path):
    """A good file of every kind, by the word in `commands` that reads it."""
    bench.write_designs(tmp_path)
    (tmp_path / "hardware").mkdir()
    shutil.copy(tmp_path / "A.toml", tmp_path / "hardware" / "A.toml")
    data = ROOT / "src" / "tactcad"
    sources = {
        "calibrate": ROOT / "hardware" / "examples" / "calibration.csv",
        "shop": data / "checks" / "data" / "shop.toml",
        "table 1": data / "paper" / "data" / "table1.csv",
        "table 2": data / "paper" / "data" / "table2.csv",
    }
    (tmp_path / "batch.csv").write_text(BATCH)
    return sources, tmp_path


def good(name: str, inputs) -> bytes:
    sources, work = inputs
    for word, path in sources.items():
        if word in name:
            return path.read_bytes()
    return (work / ("batch.csv" if name == "estimate" else "B.toml")).read_bytes()


@pytest.mark.slow  # thirty commands
def test_files(inputs):
    """The output is the input: the very name, a link to it, a hard link, and the input a link to the
    output."""
    _, work = inputs
    commands, kept = [], {}
    name_of = (work / "A.toml").read_text().split('name = "', 1)[1].split('"', 1)[0]
    for n, (name, line) in enumerate(FILES.items()):
        for way in ("same", "link", "hard", "back"):
            folder = work / f"{n}-{way}"
            folder.mkdir()
            ending = ".csv" if name in ("calibrate", "estimate") else ".toml"
            if name.startswith("golden"):
                out = work / "exports" / "golden" / f"{name_of}.json"
                if way != "hard":
                    continue
                out.parent.mkdir(parents=True)
            elif name.startswith("check"):
                out = folder / "junit.xml"
            elif name.startswith("release"):
                out = folder / f"{name_of}-{'B' if 'design' in name else 'A'}-SAMPLE.zip"
            else:
                out = folder / f"file{ending}"
            source = out if way == "same" and out.suffix == ending else folder / f"input{ending}"
            first, second = (out, source) if way == "back" else (source, out)
            first.write_bytes(good(name, inputs))
            if first != second:
                os.link(first, second) if way in ("hard", "same") else second.symlink_to(first)
            shown = f"{out.parent}" if line.endswith("/..") else str(out)
            words = [str(source) if w == "IN" else shown if w.startswith("OUT") else w for w in line.split()]
            commands.append(words)
            kept[len(commands) - 1] = (source, source.read_bytes())
    before = contents(work)
    for n, done in enumerate(tactcad_runs(commands, work, environment(work))):
        said = refused(done)
        assert "which is read" in said, said
        source, data = kept[n]
        assert source.read_bytes() == data
    assert {k: v for k, v in contents(work).items() if not k.startswith(("home/", "tmp/"))} == before


def test_folders(inputs):
    """The input lies in the folder that would be replaced: itself, or a link to it, or a folder further
    in."""
    _, work = inputs
    commands = []
    for n, (name, line) in enumerate(FOLDERS.items()):
        ending = ".csv" if "table" in name else ".toml"
        for way in ("file", "link", "deep", "linked folder"):
            out = work / f"{n}-{way.replace(' ', '-')}"
            source = out / "deeper" / f"in{ending}" if way == "deep" else out / f"in{ending}"
            source.parent.mkdir(parents=True)
            if way == "link":
                (work / f"{n}{ending}").write_bytes(good(name, inputs))
                source.symlink_to(work / f"{n}{ending}")
            else:
                source.write_bytes(good(name, inputs))
            shown = out
            if way == "linked folder":
                shown = work / f"{n}-to"
                shown.symlink_to(out)
            commands.append([{"IN": str(source), "OUT": str(shown)}.get(w, w) for w in line.split()])
    before = contents(work)
    for done in tactcad_runs(commands, work, environment(work)):
        assert "which is read" in refused(done)
    assert {k: v for k, v in contents(work).items() if not k.startswith(("home/", "tmp/"))} == before


def test_a_page_of_differences_inside_the_export_that_it_tells_of(exported):
    """It would replace the export's file, or be one too many in it."""
    folder, env = exported / "exports" / "out", environment(exported)
    (exported / "by-link").symlink_to(folder)
    before = contents(folder)
    outs = ["exports/out/manifest.json", "exports/out/changes.html", "by-link/dxf/changes.html"]
    commands = [["diff", "exports/out", "B.toml", "--html", out] for out in outs]
    for done in tactcad_runs(commands, exported, env):
        assert "which is read" in refused(done)
    assert contents(folder) == before


def test_an_output_that_is_a_link_is_refused_and_what_it_leads_to_stays(inputs):
    """Before any work: nothing is in the cache."""
    _, work = inputs
    (work / "precious").write_text("ten years")
    (work / "readings.csv").write_bytes(good("calibrate", inputs))
    for link, to in {"a.FCStd": "precious", "nowhere": "not there", "b.FCMacro": "precious"}.items():
        (work / link).symlink_to(to)
    before = {p.name for p in work.iterdir()} | {"home", "tmp"}
    commands = """review A.toml --out a.FCStd, review A.toml --out nowhere, review A.toml --freecad a.FCStd,
        review A.toml --freecad b.FCStd, diff A.toml B.toml --markdown a.FCStd,
        calibrate readings.csv --out nowhere, estimate --batch batch.csv --out a.FCStd"""
    for done in tactcad_runs([line.split() for line in commands.split(",")], work, environment(work)):
        assert ": is a link; nothing was changed; legal: " in refused(done)
    assert {p.name for p in work.iterdir()} == before
    assert (work / "precious").read_text() == "ten years"


def test_outputs_beside_inputs_are_written(inputs):
    """Or the tests above would show nothing."""
    _, work = inputs
    (work / "readings.csv").write_bytes(good("calibrate", inputs))
    commands = [
        ["calibrate", "readings.csv", "--out", "table.csv"],
        ["estimate", "--batch", "batch.csv", "--out", "stiffness.csv"],
        ["diff", "A.toml", "B.toml", "--html", "changes.html"],
        ["check", "no.toml", "no-2.toml", "--report", "."],
    ]
    status = [done.returncode for done in tactcad_runs(commands, work, environment(work))]
    assert status == [0, 0, 0, 1]
    assert all(
        (work / name).stat().st_size for name in ("table.csv", "stiffness.csv", "changes.html", "junit.xml")
    )
