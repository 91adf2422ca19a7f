"""`tactcad release` on a design of one element: what is in the zip, when there is none, and that every fault
in one is found."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from variants import TINY_TEXT

import tactcad
from tactcad.cli.main import main
from tactcad.drawing.engine.paper import SAMPLE as STATUS
from tactcad.drawing.engine.sheet_files import pdf_runs
from tactcad.parts.rules import load
from tactcad.release.archive import MODE, archive_bytes
from tactcad.release.readme import DRAFT, SAMPLE
from tactcad.release.release_contents import ReleaseContents, owned
from tactcad.release.verify import check_contents, read_back
from tactcad.scenes import make_scene, scene_names

pytestmark = [pytest.mark.cad, pytest.mark.slow]  # releases again and again

REVISION = re.search(r'revision = "(\w+)"', TINY_TEXT).group(1)
NAME = f"tiny-{REVISION}.zip"
OWNER, CONTACT = "Tiny lab", "workshop@tiny.example"
OWNED = ("--owner", OWNER, "--contact", CONTACT)
WAYS = (
    "wire-cutting",
    "milling-and-turning",
    "sheet",
    "purchase-mechanical",
    "purchase-electronic",
    "circuit-boards",
)
ALL = {NAME, *(f"tiny-{REVISION}-{way}.zip" for way in WAYS)}


OLDER = archive_bytes({"bom.csv": b"older"}, "2026-11-20")


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A folder with hardware/tiny.toml and its golden file."""
    folder = tmp_path_factory.mktemp("project")
    (folder / "hardware").mkdir()
    (folder / "hardware" / "tiny.toml").write_text(TINY_TEXT)
    assert main(["golden", str(folder / "hardware" / "tiny.toml")]) == 0
    return folder


@pytest.fixture(scope="module")
def home(project, tmp_path_factory):
    """Where a fresh process that shares nothing with this one but the code has released the design."""
    home = tmp_path_factory.mktemp("home")
    shutil.copytree(project, home / "project")
    environment = {k: v for k, v in os.environ.items() if k in ("PATH", "LD_LIBRARY_PATH")} | {
        "PYTHONPATH": str(Path(tactcad.__file__).parents[1]),
        "HOME": str(home),
        "TZ": "Pacific/Auckland",
        "PYTHONHASHSEED": "4242",
        "TACTCAD_CACHE": str(home / "cache"),
        "TMPDIR": str(home),
    }
    run = subprocess.run(
        [sys.executable, "-m", "tactcad", "release", "hardware/tiny.toml", *OWNED],
        cwd=home / "project",
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert {p.name for p in (home / "project" / "exports" / "releases").iterdir()} == ALL
    return home


@pytest.fixture(scope="module")
def released(home):
    return home / "project" / "exports" / "releases" / NAME


@pytest.fixture(scope="module")
def files(released):
    with zipfile.ZipFile(released) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.fixture(scope="module")
def contents(project):
    design = owned(load(project / "hardware" / "tiny.toml"), OWNER, CONTACT, False)
    scenes = [make_scene(design, name) for name in scene_names(design)]
    return ReleaseContents(design, scenes, (), (), False)


def test_nothing_in_it_names_the_machine(home, files):
    host = re.compile(rb"\b%b\b" % re.escape(os.uname().nodename.encode()))
    for name, data in files.items():
        for trace in (str(home), str(home.parent), "/home", "/root"):
            assert trace.encode() not in data, f"{trace} in {name}"
        # the sheets' streams are packed: a short host name stands in them by chance
        assert name.endswith(".pdf") or not host.search(data), name


def test_what_is_in_it(files):
    assert list(files)[0] == "README.txt" and list(files)[-1] == "MANIFEST.sha256"
    assert list(files)[1:-1] == sorted(list(files)[1:-1])
    sheets = {n for n in files if n.startswith("pdf/")}
    made = {
        n
        for n in files
        if n.startswith("step/tiny-") and "-ap242" not in n and "-fitted-board" not in n  # which is bought
    }  # one sheet a part made, one drawing a scene, and the circuit's
    assert {Path(n).stem for n in sheets} == {Path(n).stem for n in made} | {f"tiny-circuit_{REVISION}"}
    assert {"bom.csv", "inspection.csv", "strength.csv", f"dxf/tiny-element-a5mm_{REVISION}.dxf"} <= set(
        files
    )
    listed = dict(line.split("  ")[::-1] for line in files["MANIFEST.sha256"].decode().splitlines())
    assert listed == {n: hashlib.sha256(d).hexdigest() for n, d in files.items() if n != "MANIFEST.sha256"}


def test_the_bill_and_the_folders_agree(files):
    rows = list(csv.DictReader(io.StringIO(files["bom.csv"].decode(), newline="")))
    made = [row for row in rows if row["make_buy"] == "make"]
    assert {row["file"] for row in made} <= set(files) and len(made) == 7
    lines = files["README.txt"].decode().splitlines()
    head = next(line for line in lines if line.startswith("  part  "))
    of, size = head.index("material"), head.index("size, mm")
    for row in made:  # what to make, how many, of what: a material may take several lines
        (first,) = (i for i, line in enumerate(lines) if line.startswith(f"  {row['part_no']}  "))
        assert lines[first][:of].split()[1:] == [
            row["rev"],
            row["qty"],
            *([row["spares"]] if row["spares"] != "0" else []),
        ]
        last = next(i for i in range(first + 1, len(lines)) if not lines[i].startswith(" " * of))
        assert " ".join(line[of:size].strip() for line in lines[first:last]).strip() == row["material"], row


def test_the_readme_answers_a_shops_questions(files):
    text = files["README.txt"].decode("ascii")
    assert text.splitlines()[0] == f"tiny, revision {REVISION}: Macro tactile array 2 x 5"
    assert max(map(len, text.splitlines())) <= 110
    for said in (
        "hinge thickness: 0.25 mm, 0.245 to 0.255",
        "do not tumble",
        "ISO 22081",
        "7075-T6",
        "sha256sum -c",
    ):
        assert said in " ".join(text.split())
    for name in files:  # every file is accounted for
        assert (
            name.split("/")[0] + ("/" if "/" in name else "") in text
            or name == "README.txt"
            or name.startswith("bom")
        )
    assert "PRELIMINARY" not in text


# every fault in a zip is found


def _swap(files: dict[str, bytes], name: str, old: bytes, new: bytes) -> dict[str, bytes]:
    assert old in files[name], (name, old)
    return {**files, name: files[name].replace(old, new)}


def _marked(files: dict[str, bytes], name: str, mark: str) -> dict[str, bytes]:
    """A word on the first sheet of that drawing."""
    from pypdf import PdfReader, PdfWriter
    from reportlab.pdfgen.canvas import Canvas

    over = io.BytesIO()
    canvas = Canvas(over)
    canvas.drawString(100, 100, mark)
    canvas.save()
    writer = PdfWriter(clone_from=io.BytesIO(files[name]))
    writer.pages[0].merge_page(PdfReader(over).pages[0])
    out = io.BytesIO()
    writer.write(out)
    return {**files, name: out.getvalue()}


def _recut(files: dict[str, bytes]) -> dict[str, bytes]:
    """Another way of writing the same cut file, its digest renewed in the bill."""
    name = f"dxf/{ELEMENT}.dxf"
    new = files[name].replace(b"  0\nEOF", b"999\nremark\n  0\nEOF")
    old, now = (hashlib.sha256(d).hexdigest().encode() for d in (files[name], new))
    return {**_swap(files, "bom.csv", old, now), name: new}


ELEMENT = f"tiny-element-a5mm_{REVISION}"
R = REVISION.encode()
TAMPERED = {
    "cut file of another size": lambda f: _swap(f, f"dxf/{ELEMENT}.dxf", b"\n8.0\n", b"\n8.1\n"),
    "cut file in inches": lambda f: _swap(
        f, f"dxf/{ELEMENT}.dxf", b"$INSUNITS\n 70\n4\n", b"$INSUNITS\n 70\n1\n"
    ),
    "cut file of another part": lambda f: {**f, f"dxf/{ELEMENT}.dxf": f[f"dxf/tiny-blank_{REVISION}.dxf"]},
    "cut file missing": lambda f: {n: d for n, d in f.items() if n != f"dxf/{ELEMENT}.dxf"},
    "cut file of nothing": lambda f: {**f, f"dxf/other_{REVISION}.dxf": f[f"dxf/{ELEMENT}.dxf"]},
    "cut file of another revision": lambda f: {**f, "dxf/tiny-element-a5mm_ZZ.dxf": f[f"dxf/{ELEMENT}.dxf"]},
    "header of another revision": lambda f: _swap(
        f, f"step/{ELEMENT}.step", b"'revision " + R + b"'", b"'revision ZZ'"
    ),
    "assembly of another revision": lambda f: _swap(
        f, f"step/tiny-array_{REVISION}.step", b"'revision " + R + b"'", b"'revision ZZ'"
    ),
    "solid missing": lambda f: {n: d for n, d in f.items() if n != f"step/{ELEMENT}.step"},
    "assembly in a part's file": lambda f: {
        **f,
        f"step/{ELEMENT}.step": f[f"step/tiny-array_{REVISION}.step"],
    },
    "model with limits missing": lambda f: {n: d for n, d in f.items() if n != f"step/{ELEMENT}-ap242.step"},
    "model with limits of another revision": lambda f: _swap(
        f, f"step/{ELEMENT}-ap242.step", b"'revision " + R + b"'", b"'revision ZZ'"
    ),
    "instance missing": lambda f: _swap(
        f,
        f"step/tiny-array_{REVISION}.step",
        b"=NEXT_ASSEMBLY_USAGE_OCCURRENCE('E1'",
        b"=NEXT_ASSEMBLY_USAGE('E1'",
    ),
    "bill of another revision": lambda f: _swap(f, "bom.csv", b"tiny-stop-plate," + R, b"tiny-stop-plate,ZZ"),
    "bill with another quantity": lambda f: _swap(
        f, "bom.csv", b"tiny-stop-plate," + R + b",1", b"tiny-stop-plate," + R + b",2"
    ),
    "bill with another file": lambda f: _swap(
        f, "bom.csv", b"dxf/" + ELEMENT.encode(), b"dxf/" + ELEMENT.encode() + b"x"
    ),
    "bill missing": lambda f: {n: d for n, d in f.items() if n != "bom.csv"},
    "drawing missing": lambda f: {n: d for n, d in f.items() if n != f"pdf/{ELEMENT}.pdf"},
    "drawing of another part": lambda f: {**f, f"pdf/{ELEMENT}.pdf": f[f"pdf/tiny-blank_{REVISION}.pdf"]},
    "drawing cut off": lambda f: {**f, f"pdf/{ELEMENT}.pdf": f[f"pdf/{ELEMENT}.pdf"][:2000]},
    "drawing of a draft": lambda f: _marked(f, f"pdf/{ELEMENT}.pdf", "PRELIMINARY"),
    "drawing of a sample": lambda f: _marked(f, f"pdf/{ELEMENT}.pdf", STATUS),
    "drawing with a key characteristic twice": lambda f: _marked(f, f"pdf/{ELEMENT}.pdf", "K1"),
    "assembly drawing of a draft": lambda f: _marked(f, f"pdf/tiny-array_{REVISION}.pdf", "PRELIMINARY"),
    "assembly drawing missing": lambda f: {
        n: d for n, d in f.items() if n != f"pdf/tiny-array_{REVISION}.pdf"
    },
    "cut file changed with everything that names it but the drawing": lambda f: _recut(f),
    "inspection sheet of another revision": lambda f: _swap(f, "inspection.csv", b"tiny," + R, b"tiny,ZZ"),
    "strength summary of another design": lambda f: _swap(f, "strength.csv", b"\ntiny,", b"\nlarge,"),
    "README of another revision": lambda f: _swap(
        f, "README.txt", b"tiny, revision " + R, b"tiny, revision ZZ"
    ),
    "README of a sample": lambda f: {**f, "README.txt": f["README.txt"] + SAMPLE.encode() + b"\r\n"},
    "guide missing": lambda f: {n: d for n, d in f.items() if n != "guide/array.html"},
    "guide's picture missing": lambda f: {n: d for n, d in f.items() if n != "guide/array-exploded.svg"},
    "guide of another revision": lambda f: _swap(f, "guide/array.html", b"revision " + R, b"revision ZZ"),
    "README of a draft": lambda f: {**f, "README.txt": f["README.txt"] + DRAFT.encode() + b"\r\n"},
}


EXPORTED = "not as it was exported"
SAYS = {  # what is then among the faults; of most that the file is another than the one exported and checked
    "cut file missing": f"dxf/{ELEMENT}.dxf: missing",
    "cut file of nothing": f"dxf/other_{REVISION}.dxf: not as it was packed",
    "cut file of another revision": "dxf/tiny-element-a5mm_ZZ.dxf: not as it was packed",
    "solid missing": f"step/{ELEMENT}.step: missing",
    "model with limits missing": f"step/{ELEMENT}-ap242.step: missing",
    "bill with another file": "is missing or differs from the bill",
    "bill missing": "bom.csv: missing",
    "drawing missing": f"pdf/{ELEMENT}.pdf: missing",
    "assembly drawing missing": f"pdf/tiny-array_{REVISION}.pdf: missing",
    "README of another revision": "README.txt: its first line is not 'tiny, revision",
    "README of a sample": "README.txt: says that it is a sample",
    "guide missing": "guide/array.html: missing",
    "guide's picture missing": "guide/array-exploded.svg: missing",
    "README of a draft": "README.txt: says that it is a draft",
}


@pytest.fixture(scope="module")
def packed(files):
    return {n: d for n, d in files.items() if n != "MANIFEST.sha256"}


def exported(packed: dict[str, bytes]) -> dict[str, str]:
    """SHA-256 of what an export had made of it."""
    return {
        n: hashlib.sha256(d).hexdigest()
        for n, d in packed.items()
        if n != "README.txt" and not n.startswith("nest/")
    }


@pytest.mark.parametrize("fault", [None, *TAMPERED])
def test_a_fault_in_the_zip_is_found(fault, packed, contents, tmp_path):
    """By what was packed; and what is packed by what was exported, and by what bills and guides name."""
    own = TAMPERED[fault](packed) if fault else packed
    path = tmp_path / "a.zip"
    path.write_bytes(archive_bytes(own, "2026-11-21"))
    faults = read_back(path, packed)
    assert bool(faults) == bool(fault)
    faults += check_contents(own, exported(packed), contents)
    assert any(SAYS.get(fault, EXPORTED) in one for one in faults) if fault else faults == []


def _entry(**other: object) -> tuple[zipfile.ZipInfo, bytes]:
    entry = zipfile.ZipInfo("more.txt", (2026, 11, 21, 0, 0, 0))
    entry.external_attr = MODE << 16
    for name, value in other.items():
        setattr(entry, name, value)
    return entry, b"more"


DIGEST = hashlib.sha256(b"more").hexdigest()
MORE = f"{DIGEST}  more.txt"
BY_FORM = {  # entries beside those of a release, of which more.txt was packed; and lines of its manifest
    "more.txt: appears twice": ([_entry(), _entry()], [MORE]),
    "../more.txt: not as it was packed": ([_entry(), _entry(filename="../more.txt")], [MORE]),
    "/more.txt: not as it was packed": ([_entry(), _entry(filename="/more.txt")], [MORE]),
    "more.txt: another date": ([_entry(date_time=(2026, 11, 22, 0, 0, 0))], [MORE]),
    "more.txt: another date or other permissions": ([_entry(external_attr=0o755 << 16)], [MORE]),
    "more.txt: missing": ([], [MORE]),
    "MANIFEST.sha256: missing": ([_entry()], None),
    "MANIFEST.sha256: not as it was packed": ([_entry()], []),
    "T.sha256: not as it was packed": ([_entry()], [f"{'0' * 64}  more.txt"]),
    "sha256: not as it was packed": ([_entry()], [MORE, f"{DIGEST}  less.txt"]),
}


def _zipped(path: Path, files: dict[str, bytes], lines: list[str] | None, entries: list) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in files.items():
            if name != "MANIFEST.sha256":
                archive.writestr(_entry(filename=name)[0], data)
        if lines is not None:
            archive.writestr(_entry(filename="MANIFEST.sha256")[0], "\n".join(lines) + "\n")
        for entry, data in entries:
            archive.writestr(entry, data)


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize("fault", BY_FORM)
def test_a_fault_of_the_zip_itself_is_found(fault, files, packed, tmp_path):
    entries, more = BY_FORM[fault]
    lines = files["MANIFEST.sha256"].decode().splitlines()
    _zipped(tmp_path / "a.zip", files, None if more is None else [*lines, *more], entries)
    (found,) = read_back(tmp_path / "a.zip", {**packed, "more.txt": b"more"})
    assert fault in found


def test_a_zip_that_was_written_by_hand_is_whole(files, packed, tmp_path):
    """The faults above are found by what is wrong alone."""
    _zipped(tmp_path / "a.zip", files, files["MANIFEST.sha256"].decode().splitlines(), [])
    assert read_back(tmp_path / "a.zip", packed) == []


def test_damage_is_found_anywhere(released, packed, tmp_path):
    """A bit turned in the middle of every entry, and the file cut off."""
    data = released.read_bytes()
    path = tmp_path / "a.zip"
    with zipfile.ZipFile(released) as archive:
        places = [
            (e.filename, e.header_offset + 30 + len(e.filename) + e.compress_size // 2)
            for e in archive.infolist()
        ]
    named = 0
    for name, at in places:
        path.write_bytes(data[:at] + bytes([data[at] ^ 4]) + data[at + 1 :])
        (found,) = read_back(path, packed)
        assert found == f"{name}: damaged" or found.startswith("not readable as a zip"), name
        named += "damaged" in found
    assert named
    path.write_bytes(data[: len(data) // 2])
    (found,) = read_back(path, packed)
    assert found.startswith("not readable as a zip")


# when nothing is released


def release(
    project: Path, capsys, *arguments: str, design: str = TINY_TEXT
) -> tuple[int, str, str, set[str]]:
    """Status, standard output and error, and what then lies in the folder of releases."""
    (project / "hardware" / "tiny.toml").write_text(design)
    status = main(
        [
            "release",
            str(project / "hardware" / "tiny.toml"),
            "--out",
            str(project / "out"),
            *OWNED,
            *arguments,
        ]
    )
    out, err = capsys.readouterr()
    there = {p.name for p in (project / "out").iterdir()} if (project / "out").exists() else set()
    return status, out, err, there


@pytest.fixture
def copy(project, tmp_path):
    shutil.copytree(project, tmp_path / "p")
    return tmp_path / "p"


WIDER = TINY_TEXT.replace("hinge_length = 0.88", "hinge_length = 0.90")
BY_GOLDEN = {
    "other geometry under the same revision": (WIDER, "other content than its golden file"),
    "a revision not taken up": (
        TINY_TEXT.replace(f'revision = "{REVISION}"', 'revision = "ZZ"'),
        "`make golden` takes it up",
    ),
}


@pytest.mark.parametrize("case", BY_GOLDEN)
def test_what_the_golden_file_does_not_have_is_refused_and_an_older_zip_left(case, copy, capsys):
    design, said = BY_GOLDEN[case]
    (copy / "out").mkdir()
    (copy / "out" / NAME).write_bytes(OLDER)
    status, out, err, there = release(copy, capsys, design=design)
    assert status == 1 and said in err and "nothing was written" in err and out == ""
    assert there == {NAME} and (copy / "out" / NAME).read_bytes() == OLDER


def test_without_a_golden_file_a_design_in_hardware_is_refused(copy, capsys):
    shutil.rmtree(copy / "exports")
    status, _, err, there = release(copy, capsys)
    assert status == 1 and "make golden" in err and there == set()


COARSE = "wire_diameter = 0.25", "wire_diameter = 0.60"  # its corners are wider than the fillets


@pytest.fixture
def coarse_shop(tmp_path):
    from tactcad.checks.shop import DEFAULT

    path = tmp_path / "coarse.toml"
    path.write_text(DEFAULT.read_text().replace(*COARSE))
    return path


def test_a_failed_check_is_refused_and_a_draft_says_so(copy, coarse_shop, capsys):
    (copy / "out").mkdir()
    (copy / "out" / NAME).write_bytes(OLDER)
    status, _, err, there = release(copy, capsys, "--shop", str(coarse_shop))
    assert status == 1 and "wire" in err and there == {NAME}
    status, out, _, there = release(copy, capsys, "--shop", str(coarse_shop), "--draft", "--json")
    record = json.loads(out)
    assert status == 0 and record["draft"] and record["failures"]
    draft = f"tiny-{REVISION}-PRELIMINARY"
    assert (
        there == {NAME, f"{draft}.zip", *(f"{draft}-{way}.zip" for way in WAYS)}
        and (copy / "out" / NAME).read_bytes() == OLDER
    )
    with zipfile.ZipFile(copy / "out" / f"tiny-{REVISION}-PRELIMINARY.zip") as archive:
        readme = archive.read("README.txt").decode()
        sheets = {n: pdf_runs(archive.read(n)) for n in archive.namelist() if n.endswith(".pdf")}
    assert len(sheets) == 15 and all("PRELIMINARY" in runs for pages in sheets.values() for runs in pages)
    assert DRAFT in readme.splitlines()[:5]
    flat = " ".join(readme.split())
    assert all(" ".join(failure.split()) in flat for failure in record["failures"])


def test_two_processes_write_equal_bytes_and_what_is_replaced_is_named(released, tmp_path, capsys):
    """This process and the fresh one; here the design stands outside hardware/, where it can have no golden
    file."""
    (tmp_path / "tiny.toml").write_text(TINY_TEXT)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / NAME).write_bytes(archive_bytes({"bom.csv": b""}, "2026-11-21"))
    assert (
        main(["release", str(tmp_path / "tiny.toml"), "--out", str(tmp_path / "out"), "--json", *OWNED]) == 0
    )
    out, err = capsys.readouterr()
    assert "replaces an earlier one" in err and "bom.csv" in json.loads(out)["replaced"]
    assert {p.name for p in (tmp_path / "out").iterdir()} == ALL
    for name in ALL:
        assert (tmp_path / "out" / name).read_bytes() == (released.parent / name).read_bytes()


def test_what_does_not_read_back_is_not_published(copy, capsys, monkeypatch):
    """A zip damaged between writing and reading: the older one stays, no part file is left."""
    from tactcad.release import make

    monkeypatch.setattr(make, "archive_bytes", lambda files, date: archive_bytes(files, date)[:-500])
    (copy / "out").mkdir()
    (copy / "out" / NAME).write_bytes(OLDER)
    status, _, err, there = release(copy, capsys)
    assert (
        status == 1
        and "does not hold" in err
        and there == {NAME}
        and (copy / "out" / NAME).read_bytes() == OLDER
    )


def test_bad_input_is_refused_before_any_work(copy, tmp_path, capsys):
    for arguments, named in (
        (("--shop", str(tmp_path / "none.toml")), "none.toml"),
        (("--shop", str(copy / "hardware" / "tiny.toml")), "unknown field"),
    ):
        status, out, err, there = release(copy, capsys, *arguments)
        assert status == 2 and named in err and err.count("\n") == 1 and out == "" and there == set()
    assert main(["release", str(tmp_path / "none.toml"), "--out", str(copy / "out")]) == 2
    status, _, err, there = release(
        copy, capsys, design=TINY_TEXT.replace("hinge_length = 0.88", "hinge_length = 0.5")
    )
    assert status == 2 and there == set()


# whose release it is


def test_without_owner_or_contact_it_is_refused_in_one_line(copy, capsys):
    design = copy / "hardware" / "tiny.toml"
    for arguments, missing in (
        ((), "design.organisation and design.contact"),
        (("--owner", OWNER), "design.contact"),
        (("--contact", CONTACT, "--draft"), "design.organisation"),
        (("--owner", "\u202eevil", "--contact", CONTACT), "--owner"),
    ):
        assert main(["release", str(design), "--out", str(copy / "out"), *arguments]) == 2
        out, err = capsys.readouterr()
        assert err.startswith(f"tactcad: {missing}: ") and err.count("\n") == 1 and out == ""
        assert not (copy / "out").exists()


def test_the_design_s_own_owner_and_contact_stand_in_zip_and_title_blocks(tmp_path, capsys):
    said = f'title = "A tiny one"\norganisation = "{OWNER}"\ncontact = "{CONTACT}"\n'
    (tmp_path / "tiny.toml").write_text(re.sub(r"title = .*\n", said, TINY_TEXT, count=1))
    assert main(["release", str(tmp_path / "tiny.toml"), "--out", str(tmp_path / "out")]) == 0
    for path in (tmp_path / "out").iterdir():
        with zipfile.ZipFile(path) as archive:
            last = archive.read("README.txt").decode().split("CONTACT")[1]
            assert OWNER in last and CONTACT in last
            sheets = [pdf_runs(archive.read(n)) for n in archive.namelist() if n.endswith(".pdf")]
        for runs in (runs for pages in sheets for runs in pages):
            assert OWNER in runs and "for manufacture" in runs and "tactcad" not in runs


def test_a_file_that_is_not_as_it_was_exported_is_found(packed, contents):
    assert check_contents(packed, {"bom.csv": DIGEST}, contents) == ["bom.csv: not as it was exported"]


def test_a_sample_says_so_everywhere_and_names_nobody(copy, capsys):
    design = copy / "hardware" / "tiny.toml"
    assert main(["release", str(design), "--out", str(copy / "out"), "--sample"]) == 0
    assert {p.name for p in (copy / "out").iterdir()} == {
        name.replace(f"-{REVISION}", f"-{REVISION}-SAMPLE") for name in ALL
    }
    for path in (copy / "out").iterdir():
        with zipfile.ZipFile(path) as archive:
            readme = archive.read("README.txt").decode()
            sheets = [pdf_runs(archive.read(n)) for n in archive.namelist() if n.endswith(".pdf")]
        assert SAMPLE in readme.splitlines() and OWNER not in readme
        assert readme.rstrip().endswith("None: this is a sample.")
        for runs in (runs for pages in sheets for runs in pages):
            assert "sample, not for order" in runs and "for manufacture" not in runs


def test_the_guide_travels_with_the_whole_zip(files, released):
    page = files["guide/array.html"].decode()
    pictures = re.findall(r'src="([^"]+)"', page)
    assert len(pictures) > 5 and {f"guide/{name}" for name in pictures} <= set(files)
    for way in WAYS:
        with zipfile.ZipFile(released.with_name(f"tiny-{REVISION}-{way}.zip")) as archive:
            assert not [n for n in archive.namelist() if n.startswith("guide/")]
