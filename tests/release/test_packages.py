"""The suppliers' packages beside a release: each with what its supplier needs, counted right, none lost."""

from __future__ import annotations

import csv
import hashlib
import io
import re
import shutil
import zipfile
from collections import Counter
from dataclasses import replace
from math import hypot, pi

import ezdxf
import pytest
from variants import TINY_TEXT, variant

from tactcad.checks.shop import DEFAULT, load_shop
from tactcad.cli.main import main
from tactcad.parts.array.layout import Layout
from tactcad.release import make
from tactcad.release.archive import archive_bytes
from tactcad.release.packages import packed, wire_time
from tactcad.release.readme import DRAFT
from tactcad.release.release_contents import ReleaseContents, ordered
from tactcad.release.verify import check_packages, read_back
from tactcad.scenes import make_scene, scene_names

pytestmark = [pytest.mark.cad, pytest.mark.slow]  # releases again and again

TEXT = TINY_TEXT.replace(
    'name = "tiny"', 'name = "tiny"\norganisation = "Tiny lab"\ncontact = "tiny@lab.example"'
)
REVISION = re.search(r'revision = "(\w+)"', TEXT).group(1)
STEM = f"tiny-{REVISION}"
MADE = ("wire-cutting", "milling-and-turning")
BOUGHT = ("purchase-mechanical", "purchase-electronic", "circuit-boards")
WAYS = (*MADE, "sheet", *BOUGHT)
README, ORDER, MANIFEST = "README.txt", "order.csv", "MANIFEST.sha256"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("packages")
    (folder / "tiny.toml").write_text(TEXT)
    assert main(["release", str(folder / "tiny.toml"), "--out", str(folder / "out")]) == 0
    return folder


def unpacked(path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.fixture(scope="module")
def whole(folder):
    return unpacked(folder / "out" / f"{STEM}.zip")


@pytest.fixture(scope="module")
def zips(folder):
    return {way: unpacked(folder / "out" / f"{STEM}-{way}.zip") for way in WAYS}


def rows(data: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(data.decode(), newline="")))


def test_the_sheets_of_the_readme_have_room_for_their_blanks(zips):
    """As many sheets as are named, of their size, hold the blanks' net area."""
    said = " ".join(zips["sheet"]["README.txt"].decode().split())
    pack = r"(?:a pack of (\d+) sheets, each )?"
    rooms = re.findall(rf"\((\d+) cm2 net, nested on {pack}([\d.]+) x ([\d.]+) mm\)", said)
    assert len(rooms) == said.count("cm2 net, nested") and any(high for _, high, _, _ in rooms)
    for net, high, width, height in rooms:
        assert float(net) - 0.5 <= int(high or 1) * float(width) * float(height) / 100


def stems(files: dict[str, bytes], folder: str) -> set[str]:
    return {
        name.split("/")[1].rsplit(f"_{REVISION}", 1)[0] for name in files if name.startswith(f"{folder}/")
    }


def bills(whole: dict[str, bytes]) -> list[dict[str, str]]:
    """Lines of every set-up's bill, a part's once: one set."""
    found: dict[str, dict[str, str]] = {}
    for name in sorted(n for n in whole if re.fullmatch(r"bom(-[a-z-]+)?\.csv", n)):
        for row in rows(whole[name]):
            held = found.setdefault(row["part_no"], row)
            if float(row["qty"]) > float(held["qty"]):
                found[row["part_no"]] = row
    return list(found.values())


def test_each_has_its_parts_files_and_no_other(whole, zips):
    bill = bills(whole)
    by_process = {}
    for row in bill:
        by_process.setdefault(row["process"], set()).add(row["part_no"])
    wire, machined = by_process["wire-cut"], by_process["milled"] | by_process["ground"]
    assert stems(zips["wire-cutting"], "dxf") == stems(zips["wire-cutting"], "pdf") == wire
    assert stems(zips["wire-cutting"], "step") == {"tiny-setting-fixture"}  # of the others contours say all
    assert stems(zips["milling-and-turning"], "pdf") == machined
    assert stems(zips["milling-and-turning"], "step") == machined
    assert stems(zips["sheet"], "dxf") == stems(whole, "dxf") - wire
    for way in ("sheet", "purchase-mechanical"):
        assert not stems(zips[way], "pdf") and not stems(zips[way], "step")
    assert stems(zips["circuit-boards"], "pdf") == {"tiny-circuit"}
    for way, files in zips.items():
        own = {README, ORDER, MANIFEST, "inspection-parts.csv"}
        for name, data in files.items():
            assert name in own or data == whole[name], (way, name)
        listed = dict(line.split("  ")[::-1] for line in files[MANIFEST].decode().splitlines())
        assert listed == {n: hashlib.sha256(d).hexdigest() for n, d in files.items() if n != MANIFEST}
    assert "inspection.csv" in zips["wire-cutting"] and "inspection.csv" not in zips["milling-and-turning"]
    measured = {row["part_no"] for row in rows(zips["milling-and-turning"]["inspection-parts.csv"])}
    assert measured and measured <= machined


def test_every_line_of_the_bill_is_ordered_once_with_its_spares(whole, zips):
    bill = {row["part_no"]: row for row in bills(whole)}
    lines = [row for way in (*MADE, *BOUGHT) for row in rows(zips[way][ORDER])]
    ordered_ = {n for n, row in bill.items() if row["process"] != "included"}  # a fitted board is its parts
    assert Counter(row["part_no"] for row in lines) == Counter(ordered_)
    for row in lines:
        of = bill[row["part_no"]]
        assert float(row["qty"]) == float(of["qty"])
        assert float(row["order"]) == pytest.approx(float(of["qty"]) + float(of["spares"]), abs=1e-9)
    element = next(row for row in lines if "element" in row["part_no"])
    assert (element["qty"], element["spares"], element["order"]) == ("1", "1", "2")  # one of every kind
    electronic = {row["part_no"] for row in rows(zips["purchase-electronic"][ORDER])}
    assert electronic == {n for n, row in bill.items() if row["process"] == "electronic"}
    assert "STRAIN-GAUGE" in electronic


def test_who_makes_the_boards_has_netlist_and_diagrams(zips):
    """Read from the package alone: the board's line names every file of the bare and the fitted boards."""
    files = zips["circuit-boards"]
    (board,) = rows(files[ORDER])
    assert board["part_no"] == "CIRCUIT-BOARD" and "tiny-board" in board["designation"]
    made = {name for name in files if name.startswith("circuit/boards/")}
    assert {board[name.removeprefix("circuit/boards/")] for name in made} == made
    for name in made:
        digest = board[f"{name.removeprefix('circuit/boards/')}_sha256"]
        assert hashlib.sha256(files[name]).hexdigest() == digest
    assert (
        sum(name.endswith(".gbr") for name in made) == 9 and sum(name.endswith(".drl") for name in made) == 2
    )
    (bill,) = (name for name in made if name.endswith("-bill.csv"))
    assert {n for row in rows(files[bill]) for n in row["designators"].split()} >= {
        "U1",
        "U2",
        "U3",
        "U4",
        "J1",
    }
    assert "CIRCUIT BOARD" in files[README].decode() and board["sheets"].endswith(
        f"tiny-circuit_{REVISION}.pdf"
    )


def test_what_comes_with_another_part_is_no_line_of_an_order(macro):
    """A stage is bought whole: its moving half stands in the bill and the scene, and is not ordered."""
    scenes = [make_scene(macro, name) for name in scene_names(macro)]
    halves = {p.part.part_no for s in scenes for p in s.placements if p.part.part_no.startswith("STAGE-")}
    assert {n.rsplit("-", 1)[1] for n in halves} == {"FIXED", "MOVING"}
    lines = {line.row.part_no for line in ordered(scenes, None, "all")}
    assert {n for n in halves if n in lines} == {n for n in halves if n.endswith("-FIXED")}


def test_material_standard_and_files_stand_in_every_line(zips):
    for way in (*MADE, "sheet"):
        for row in rows(zips[way][ORDER]):
            assert re.match(r"EN \d+", row["standard"]) and row["material"], row
            for kind in ("dxf", "pdf", "step"):
                if row.get(kind):
                    assert hashlib.sha256(zips[way][row[kind]]).hexdigest() == row[f"{kind}_sha256"]


def length(dxf: bytes) -> float:
    """mm of all contours of a cut file, as another library reads them."""
    total = 0.0
    for e in ezdxf.read(io.StringIO(dxf.decode())).modelspace():
        if e.dxftype() == "LINE":
            total += hypot(*(e.dxf.end - e.dxf.start).vec2)
        elif e.dxftype() == "ARC":
            total += e.dxf.radius * ((e.dxf.end_angle - e.dxf.start_angle) % 360) * pi / 180
        else:
            assert e.dxftype() == "CIRCLE"
            total += 2 * pi * e.dxf.radius
    return total


def test_the_wire_s_time_is_that_of_the_written_contours_at_the_stated_feed(zips):
    files = zips["wire-cutting"]
    text = " ".join(files[README].decode().split())
    area, most, skim, start = (
        float(re.search(pattern, text)[1])
        for pattern in (
            r"main cut of ([\d.]+) mm2/min",
            r"at most ([\d.]+) mm/min",
            r"further pass ([\d.]+) mm/min",
            r"and ([\d.]+) min for each contour",
        )
    )
    in_all = 0.0
    for row in rows(files[ORDER]):
        mm = length(files[row["dxf"]])
        assert float(row["cut_length_mm"]) == pytest.approx(mm, abs=1e-3)
        passes, height = int(row["passes"]), float(row["height_mm"])
        each = mm / min(area / height, most) + (passes - 1) * mm / skim + int(row["contours"]) * start
        each *= -(-float(row["order"]) // int(row["at_once"])) / float(row["order"])  # packs a piece
        assert float(row["minutes_each"]) == pytest.approx(each, abs=0.06)
        in_all += each * float(row["order"])
    assert float(re.search(r"About ([\d.]+) h", text)[1]) == pytest.approx(in_all / 60, abs=0.06)
    element = next(row for row in rows(files[ORDER]) if "element" in row["part_no"])
    assert element["passes"] == "4" and element["height_mm"] == "3"  # the hinge's +-5 um


def test_a_shop_s_own_feed_counts(tmp_path):
    text = DEFAULT.read_text("utf-8").replace("skim = 10\n", "skim = 5\n")
    (tmp_path / "shop.toml").write_text(text)
    element = make_scene(variant(), "array").placements[1].part
    slow, quick = (wire_time(element, load_shop(p).feed) for p in (tmp_path / "shop.toml", DEFAULT))
    assert slow.minutes - quick.minutes == pytest.approx((slow.passes - 1) * slow.length * (1 / 5 - 1 / 10))
    half = tmp_path / "half.toml"  # what it leaves out is as it comes
    half.write_text(re.sub(r"(?s)\[feed\].*?(?=\n#)", "", DEFAULT.read_text("utf-8")))
    assert load_shop(half).feed == load_shop().feed


def test_one_set_or_all(macro):
    """Counted by designators: one set is the largest set-up's, all are every rig's own and the array once."""
    scenes = [make_scene(macro, name) for name in scene_names(macro)]
    counts = {s.name: Counter(p.part.part_no for p in s.placements) for s in scenes}
    holds_the_array = {
        "setting",
        "wiring",
        "calibration",
        "grasping",
        "bonding",
    }  # the last one element of it
    rigs = [c - counts["array"] if n in holds_the_array else c for n, c in counts.items() if n != "array"]
    counts = {n: Counter({p: k for p, k in c.items() if "-MOVING" not in p}) for n, c in counts.items()}
    for sets, count in (("one", lambda n: max(c[n] for c in counts.values())), ("all", None)):
        lines = {line.row.part_no: line for line in ordered(scenes, None, sets)}
        for number in set().union(*counts.values()) - {f"{macro.name}-fitted-board"}:  # ordered as its parts
            meant = count(number) if count else counts["array"][number] + sum(c[number] for c in rigs)
            assert lines[number].qty == meant, (sets, number)
        assert lines["STRAIN-GAUGE"].qty == len(Layout(macro).elements)
        assert lines[f"{macro.name}-base"].qty == (1 if sets == "one" else 3), "none in the bonding fixture"
    assert [s.name for s in scenes if s.ready] == ["setting", "wiring", "calibration", "grasping"]


def test_the_element_in_the_bonding_fixture_is_one_of_the_arrays():
    design = variant()
    scenes = [make_scene(design, name) for name in ("array", "bonding")]
    lines = {line.row.part_no: line.qty for line in ordered(scenes, None, "all")}
    elements = [n for n in lines if "-element-" in n]
    assert sum(lines[n] for n in elements) == len(Layout(design).elements) == 10
    assert lines[f"{design.name}-bonding-nest"] == 1


def test_one_element_of_every_ten_of_a_kind_is_spare():
    scene = make_scene(variant({"array.row_arms": [[5] * 21 + [4], [5]]}), "array")
    lines = {line.row.part_no: line for line in ordered([scene], None, "one")}
    for arm, count, spares in ((5, 22, 3), (4, 1, 1)):
        line = lines[f"macro-array-element-a{arm}mm"]
        assert (line.qty, line.row.spares, line.order) == (count, spares, count + spares)


# every fault in a package is found


@pytest.fixture(scope="module")
def parts(folder, whole):
    from tactcad.parts.rules import load

    design = load(folder / "tiny.toml")
    scenes = [make_scene(design, name) for name in scene_names(design)]
    contents = ReleaseContents(design, scenes, (), (), False)
    return contents, packed(contents, whole, load_shop())


def swapped(files: dict[str, bytes], name: str, old: bytes, new: bytes) -> dict[str, bytes]:
    assert old in files[name], (name, old)
    return {**files, name: files[name].replace(old, new, 1)}


def recut(files: dict[str, bytes]) -> dict[str, bytes]:
    """Another cut file, as the order says."""
    name, other = f"dxf/{ELEMENT}.dxf", b"0\nEOF\n"
    old, new = (hashlib.sha256(data).hexdigest().encode() for data in (files[name], other))
    return {**swapped(files, ORDER, old, new), name: other}


def ordered_too(files: dict[str, bytes]) -> dict[str, bytes]:
    """A line of the order again, of a part of another name."""
    line = next(line for line in files[ORDER].splitlines(True) if b"COATING" in line)
    return {**files, ORDER: files[ORDER] + line.replace(b"COATING", b"GILDING", 1)}


ELEMENT = f"tiny-element-a5mm_{REVISION}"
FAULTS = {
    "another cut file": ("wire-cutting", lambda f: {**f, f"dxf/{ELEMENT}.dxf": b"0\nEOF\n"}),
    "another cut file, as its order says": ("wire-cutting", recut),
    "a cut file less": ("wire-cutting", lambda f: {n: d for n, d in f.items() if n != f"dxf/{ELEMENT}.dxf"}),
    "a file that nobody asked for": ("sheet", lambda f: {**f, "step/other.step": b""}),
    "a line of a part in no bill": ("purchase-electronic", ordered_too),
    "a draft's README": ("sheet", lambda f: {**f, README: f[README] + DRAFT.encode() + b"\r\n"}),
    "a quantity": ("purchase-mechanical", lambda f: swapped(f, ORDER, b",2,6,", b",2,7,")),
    "an element less": ("wire-cutting", lambda f: swapped(f, ORDER, b",1,1,2,", b",0,1,1,")),
    "a line less": (
        "purchase-electronic",
        lambda f: {
            **f,
            ORDER: b"".join(line for line in f[ORDER].splitlines(True) if b"COATING" not in line),
        },
    ),
    "a line twice": ("purchase-electronic", lambda f: {**f, ORDER: f[ORDER] + f[ORDER].splitlines(True)[1]}),
    "no order": ("milling-and-turning", lambda f: {n: d for n, d in f.items() if n != ORDER}),
    "another revision": ("sheet", lambda f: swapped(f, README, b"revision ", b"revision Z")),
    "an altered inspection sheet": (
        "wire-cutting",
        lambda f: swapped(f, "inspection.csv", b"hinge thickness", b"hinge"),
    ),
    "an altered limit": (
        "milling-and-turning",
        lambda f: swapped(f, "inspection-parts.csv", b"tiny-stop-plate,", b"tiny-stop-plate,x"),
    ),
}


SAYS = {  # of what could have been packed so; the others are found in the zip alone
    "a line of a part in no bill": "GILDING of an order is in no bill",
    "a draft's README": "README.txt: says that it is a draft",
    "a quantity": "7 with spares, not 4 and 2",
    "an element less": "tiny-element-a5mm: 0 ordered, 1 needed",
    "a line less": "COATING of the bills is in 0 packages",
    "a line twice": "STRAIN-GAUGE of the bills is in 2 packages",
    "another revision": "README.txt: its first line is not",
}


@pytest.mark.parametrize("fault", [None, *FAULTS])
def test_a_fault_in_a_package_is_found(fault, whole, zips, parts, tmp_path):
    contents, packages = parts
    tampered, readmes, in_zips = [], [], []
    for one in packages:
        own = files = {n: d for n, d in zips[one.package.name].items() if n != MANIFEST}
        if fault and FAULTS[fault][0] == one.package.name:
            files = FAULTS[fault][1](own)
        (tmp_path / one.package.name).write_bytes(archive_bytes(files, "2026-11-21"))
        in_zips += read_back(tmp_path / one.package.name, own)
        readmes.append(files[README])
        tampered.append(replace(one, files={ORDER: one.files[ORDER], **files}))
    faults = check_packages(tampered, readmes, whole, contents)
    assert bool(in_zips) == bool(fault)
    assert bool(faults) == (fault in SAYS) and any(SAYS.get(fault, "") in one for one in [*faults, ""])


def test_damage_of_a_package_is_found(folder, zips, tmp_path):
    packed, path = {n: d for n, d in zips["sheet"].items() if n != MANIFEST}, tmp_path / "a.zip"
    damaged = bytearray((folder / "out" / f"{STEM}-sheet.zip").read_bytes())
    damaged[len(damaged) // 3] ^= 4
    path.write_bytes(damaged)
    assert read_back(path, packed)
    path.write_bytes(damaged[: len(damaged) // 2])
    (found,) = read_back(path, packed)
    assert found.startswith("not readable as a zip")


# all or nothing


def test_a_package_that_does_not_read_back_leaves_all_zips_as_they_were(
    folder, tmp_path, monkeypatch, capsys
):
    out = tmp_path / "out"
    out.mkdir()
    older = {f"{STEM}{way}.zip": archive_bytes({"a": way.encode()}, "2026-11-20") for way in ("", "-sheet")}
    for name, data in older.items():
        (out / name).write_bytes(data)
    monkeypatch.setattr(make, "package_readme", lambda *_: b"of something else\r\n")
    assert main(["release", str(folder / "tiny.toml"), "--out", str(out)]) == 1
    assert "sheet: README.txt" in capsys.readouterr().err
    assert {p.name: p.read_bytes() for p in out.iterdir()} == older


def test_what_was_put_into_a_package_is_refused_before_any_design_s_work_and_kept(folder, tmp_path, capsys):
    """The package is of the second design."""
    out, name = tmp_path / "out", f"{STEM}-sheet.zip"
    out.mkdir()
    with zipfile.ZipFile(shutil.copy(folder / "out" / name, out), "a") as package:
        package.writestr("quotation.txt", "signed")
    quoted = (out / name).read_bytes()
    (tmp_path / "other.toml").write_text(TEXT.replace('name = "tiny"', 'name = "other"'))
    designs = [str(tmp_path / "other.toml"), str(folder / "tiny.toml")]
    assert main(["release", *designs, "--out", str(out)]) == 2
    err = capsys.readouterr().err
    assert f"{name} (changed: 'quotation.txt')" in err and err.count("\n") == 1
    assert {p.name: p.read_bytes() for p in out.iterdir()} == {name: quoted}
    assert main(["release", designs[1], "--out", str(out), "--keep"]) == 0
    kept = f"{STEM}-sheet-kept-1.zip"
    assert kept in capsys.readouterr().err and (out / kept).read_bytes() == quoted
    (out / kept).unlink()
    assert {p.name: p.read_bytes() for p in out.iterdir()} == {
        p.name: p.read_bytes() for p in (folder / "out").iterdir()
    }


def test_a_package_of_which_nothing_is_left_goes_with_the_release_that_replaces_it(
    folder, tmp_path, monkeypatch
):
    out = tmp_path / "out"
    out.mkdir()
    (out / f"{STEM}-sheet.zip").write_bytes(archive_bytes({"a": b""}, "2026-11-20"))
    monkeypatch.setattr(make, "packed", lambda *a: [one for one in packed(*a) if one.package.name != "sheet"])
    assert main(["release", str(folder / "tiny.toml"), "--out", str(out)]) == 0
    assert {p.name for p in out.iterdir()} == {f"{STEM}.zip"} | {
        f"{STEM}-{way}.zip" for way in WAYS if way != "sheet"
    }
