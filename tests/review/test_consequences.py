"""What a change means: thirty edits of three designs, each found, with its consequence, and nothing else."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from dataclasses import dataclass, field
from functools import cache
from math import log
from pathlib import Path

import pytest

from tactcad.cli.main import main, parser_of
from tactcad.design.load import from_table
from tactcad.design.tree import Design
from tactcad.export.inputs import flattened, nested
from tactcad.export.sides import Side, compare_sides, design_side
from tactcad.lab.array_estimate import estimate
from tactcad.parts.array.hinge_section import thickness_elasticity
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load
from tactcad.review.causes import Edit, causes
from tactcad.review.consequences import KINDS, meaning
from tactcad.review.effect import SensorEffect
from tactcad.review.summary import MOST_LINES, effect_lines, lines, markdown
from tactcad.stacks.virtual_build import sensor

ROOT = Path(__file__).parents[2]
HARDWARE = ROOT / "hardware"
SOFT, MACRO, SMALL = "soft-tissue", "macro-array", "smallest-bearing"
ARRAYS = 20  # built virtually: figures of yield have a test of their own
OF_ARRAY = {"spacer", "end-plate-head", "end-plate-tapped"}


@pytest.fixture(autouse=True)
def few_arrays(monkeypatch):
    monkeypatch.setattr("tactcad.review.effect.COUNT", ARRAYS)


def edited(name: str, *edits: tuple[str, str]) -> str:
    """A shipped design's text with these pieces of it replaced, each once."""
    text = (HARDWARE / f"{name}.toml").read_text()
    for old, new in edits:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    return text


@cache
def side(text: str) -> Side:
    return design_side("text", "design", tomllib.loads(text))


def compared(old: str, new: str):
    """Changes and meaning between two designs' texts."""
    sides = side(old), side(new)
    return compare_sides(*sides), meaning(*sides)


@dataclass(frozen=True)
class Seed:
    """An edit, the field that it changes, and what must come of it: elements whose K changes, made parts with
    other content under their number, new parts, and bought parts whose count changes (patterns)."""

    design: str
    edits: tuple[tuple[str, str], ...]
    path: str
    elements: str = ""
    revised: frozenset[str] = frozenset()
    added: frozenset[str] = frozenset()
    bill: str = ""
    figures: frozenset[str] = field(default=frozenset())


def seed(design: str, old: str, new: str, path: str, **means) -> Seed:
    for name in ("revised", "added", "figures"):
        means[name] = frozenset(means.get(name, ()))
    return Seed(design, ((old, new),), path, **means)


SOFT_E = {"element-a5mm", "element-a9mm"}
MACRO_E = {f"element-a{n}mm" for n in (4, 5, 6, 7, 8)}
SMALL_E = {"element-a4mm", "element-a8mm"}
FIXTURE = {"bonding-nest", "bonding-clamp"}
SPRING = {"stiffness", "rated_force", "signal_per_force", "stop_gap"}

SEEDS = {
    "5 um of hinge, soft": seed(
        SOFT, "hinge_thickness = 0.15", "hinge_thickness = 0.155", "element.hinge_thickness",
        elements="E1 E2 E3 E4 E5 E6 E7 E8", revised=SOFT_E | {"bonding-nest"}, figures=SPRING,
    ),
    "two elements swapped, soft": seed(
        SOFT, "[[5, 9, 5, 9]", "[[9, 5, 5, 9]", "array.row_arms", elements="E1 E2", figures=SPRING,
    ),
    "a screw hole moved by 0.05": seed(
        SOFT, "[gauge]", "[holes]\nscrew_offsets = [3.75, 14.5]\n[gauge]", "holes.screw_offsets",
        revised=SOFT_E | OF_ARRAY,
    ),
    "another alloy": seed(
        SOFT, 'alloy = "2024-T3"', 'alloy = "7075-T6"', "material.alloy",
        elements="E1 E2 E3 E4 E5 E6 E7 E8", revised=SOFT_E | {"spacer"}, figures=SPRING,
    ),
    "one element's hinge": seed(
        SOFT, "[gauge]", "[element.override.3]\nhinge_thickness = 0.16\n[gauge]",
        "element.override.3.hinge_thickness", elements="E3",
        added={"element-a5mm-t0.16mm", "bonding-nest-t0.16mm", "bonding-clamp-t0.16mm"},
        bill=r"soft-tissue-(element-a5mm|bonding-nest|bonding-clamp)(-t0\.16mm)?|ISO8734-3x24-pin|PAD-4x1x1-rubber",
        figures={"stiffness", "signal_per_force", "stop_gap"},
    ),
    "an element added, soft": seed(
        SOFT, "[[5, 9, 5, 9]", "[[5, 9, 9, 5, 9]", "array.row_arms",
        revised=OF_ARRAY | {"carrier", "stop-plate"}, added={"blank"},
        bill=r".*-(spacer|element-a9mm|blank)|ISO8734-3x(28|30)-pin|STRAIN-GAUGE|BRIDGE-RESISTOR|TERMINAL|LEAD-WIRE-(RD|WH|BK)"
        "|IRLML6244TRPBF|LINK-(0R|WIRE)",
    ),
    "pad 0.05 higher": seed(
        SOFT, "pad_height = 1.6", "pad_height = 1.65", "element.pad_height",
        revised=SOFT_E | FIXTURE | {"setting-fixture"},
    ),
    "another gauge factor": seed(
        SOFT, "[gauge]", "[gauge]\nfactor = 2.0", "gauge.factor", figures={"signal_per_force"},
    ),
    "a tighter limit": seed(
        SOFT, "[gauge]", "[tolerance]\nload_arm = 0.04\n[gauge]", "tolerance.load_arm", revised=SOFT_E,
    ),
    "less force asked for": seed(
        SOFT, "\nforce = 0.3", "\nforce = 0.25", "rating.force", figures={"rated_force"},
    ),
    "a note": seed(SOFT, "a gauge needs a flat face", "gauges need one", "origin.element.sides"),
    "a title": seed(SOFT, "Soft tissue array 2 x 4", "Soft array 2 x 4", "design.title"),
    "a date": seed(SOFT, 'date = "2026-11-28"', 'date = "2026-11-29"', "design.date"),
    "5 um of hinge, macro": seed(
        MACRO, "hinge_thickness = 0.25", "hinge_thickness = 0.255", "element.hinge_thickness",
        elements="E1 E2 E3 E4 E5 E6 E7 E8 E9 E10", revised=MACRO_E | {"bonding-nest"}, figures=SPRING,
    ),
    "rounder corners": seed(
        MACRO, "\ncorner_radius = 0.3", "\ncorner_radius = 0.35", "element.corner_radius", revised=MACRO_E,
    ),
    "thicker end plates": seed(
        MACRO, "end_plate_thickness = 8.0", "end_plate_thickness = 9.0", "clamp.end_plate_thickness",
        revised={"end-plate-head", "end-plate-tapped", "carrier", "ballast"},
    ),
    "a dowel hole moved by 0.05": seed(
        MACRO, "dowel_offsets = [9.1]", "dowel_offsets = [9.15]", "holes.dowel_offsets",
        revised=MACRO_E | OF_ARRAY,
    ),
    "more excitation": seed(
        MACRO, "excitation = 2.7", "excitation = 2.8", "readout.excitation", figures={"signal_per_force"}
    ),
    "a thicker stop plate": seed(
        MACRO, "stop_plate_thickness = 4.0", "stop_plate_thickness = 4.5", "clamp.stop_plate_thickness",
        revised={"stop-plate", "end-plate-head", "end-plate-tapped", "riser", "ballast"},
    ),
    "neighbours swapped": seed(
        MACRO, "[8, 5, 4, 5, 7]", "[8, 4, 5, 5, 7]", "array.row_arms", elements="E7 E8",
        figures={"stiffness", "signal_per_force", "stop_gap"},
    ),
    "a longer cart": seed(MACRO, "length = 70.0", "length = 72.0", "cart.length", revised={"cart-plate"}),
    "one more ring of holes": seed(MACRO, "rings = 3", "rings = 4", "holder.rings", revised={"holder-lid"}),
    "the axis's threads moved by 0.05": seed(
        MACRO, "mount_pitch_y = 32.0", "mount_pitch_y = 32.05", "clamp.mount_pitch_y",
        revised={"carrier", "array-mount", "foot", "ballast"},
    ),
    "Young's modulus": seed(
        SMALL, "youngs_modulus = 69000", "youngs_modulus = 70000", "material.youngs_modulus",
        elements="E1 E2 E3 E4", revised={"element-a8mm"},  # the other's gap is rounded down to the same
        figures={"stiffness", "signal_per_force", "stop_gap"},
    ),
    "5 um of slot": seed(
        SMALL, "hinge_length = 0.88", "hinge_length = 0.885", "element.hinge_length", elements="E1 E2 E3 E4",
        revised=SMALL_E | OF_ARRAY | FIXTURE | {"carrier", "stop-plate", "setting-fixture"},
        figures={"stiffness", "rated_force", "signal_per_force"},
    ),
    "5 um of fillet": seed(
        SMALL, "fillet_radius = 0.30", "fillet_radius = 0.305", "element.fillet_radius",
        elements="E1 E2 E3 E4", revised=SMALL_E | {"bonding-nest"},
        figures={"stiffness", "rated_force", "signal_per_force"},
    ),
    "less travel": seed(SMALL, "[calibration]", "[calibration]\ntravel = 0.1", "calibration.travel"),
    "an element and longer screws": seed(
        SMALL, "[[4, 8], [8, 4]]", "[[4, 8, 6], [8, 4]]", "array.row_arms",
        revised={"spacer", "end-plate-tapped", "carrier", "stop-plate", "ballast", "setting-fixture"},
        added={"element-a6mm", "blank", "setting-strip"},
        bill=r".*-(spacer|blank|element-a6mm|setting-strip)|ISO4762-M3x(20|25)-A2-70-screw|ISO8734-3x(24|28)-pin|STRAIN-GAUGE"
        r"|BRIDGE-RESISTOR|TERMINAL|LEAD-WIRE-(RD|WH|BK)|IRLML6244TRPBF|LINK-(0R|WIRE)",
    ),
    "wheels 0.05 further apart": seed(
        SMALL, "wheel_base = 44.0", "wheel_base = 44.05", "cart.wheel_base", revised={"cart-plate"},
    ),
    "another sample": seed(
        SMALL, "thickness = 6.0", "thickness = 6.5", "sample.thickness", revised={"riser"},
        bill="SAMPLE-24x24x6(.5)?-rubber",
    ),
    "plates of another alloy": seed(
        SMALL, "[calibration]", '[clamp]\nplate_alloy = "7075-T6"\n[calibration]', "clamp.plate_alloy",
        revised={
            "end-plate-head", "end-plate-tapped", "carrier", "base", "post", "array-mount", "axis-plate",
            "gauge-plate", "cart-plate", "holder-body", "holder-lid", "riser", "foot", "bar", "platform",
            "weight-pin", "ballast",
        },
    ),
}  # fmt: skip


def stiffness(design: Design) -> dict[str, float]:
    """By designator, as `tactcad estimate` has it."""
    return {f"E{row.number}": row.stiffness for row in estimate(Layout(design), "solid")}


# up to a second each; of each kind of edit one is left for every run
NIGHTLY = {
    "rounder corners", "thicker end plates", "a dowel hole moved by 0.05", "a thicker stop plate",
    "a longer cart", "one more ring of holes", "plates of another alloy", "another sample", "5 um of fillet",
    "an element added, soft", "the axis's threads moved by 0.05", "5 um of hinge, macro",
}  # fmt: skip


@pytest.mark.by_day(4, "half a second each")
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.nightly) if n in NIGHTLY else n for n in SEEDS]
)
def test_a_seeded_edit_is_found_with_its_consequence_and_nothing_else(name):
    wanted = SEEDS[name]
    old, new = edited(wanted.design), edited(wanted.design, *wanted.edits)
    changes, meant = compared(old, new)
    [cause] = meant.consequences
    assert cause.what.startswith(f"{wanted.path}: ")
    effect = cause.effect

    own = lambda names: {n.removeprefix(f"{wanted.design}-") for n in names}  # noqa: E731
    assert {e.new for e in effect.elements if e.stiffness} == set(wanted.elements.split())
    assert {figure for e in effect.elements for figure in e.figures} == wanted.figures
    assert own(effect.parts_revised) == wanted.revised
    assert own(effect.parts_added) == wanted.added
    assert not effect.parts_removed and not effect.scenes_added and not effect.scenes_removed
    assert [n for n in effect.bill if not re.fullmatch(wanted.bill, n)] == []
    assert bool(effect.bill) == bool(wanted.bill)

    # of the parts of the record of geometry no other changes, and each that changes has its sheet made anew
    touched = {c.path[1] for c in changes if c.path[0] == "parts" and c.path[-1] != "qty"}
    made = {number for number in touched if number.startswith(wanted.design)}
    assert own(made) <= wanted.revised | wanted.added
    if cause.kind == "value":
        assert own(s for s in effect.sheets if not s.startswith("assembly ")) == wanted.revised | wanted.added
        section = wanted.path.rsplit(".", 1)[0]
        assert all(c.path[1].startswith(section) for c in changes if c.path[0] == "values")

    # K is what the estimate of either design says
    before, after = (stiffness(from_table(tomllib.loads(text))) for text in (old, new))
    for element in effect.elements:
        if element.stiffness:
            ratio = element.stiffness.new / element.stiffness.old
            assert ratio == pytest.approx(after[element.new] / before[element.old], rel=1e-8)


def test_there_are_thirty_seeds_on_three_designs():
    assert len(SEEDS) >= 30 and len({s.design for s in SEEDS.values()}) == 3


@pytest.mark.parametrize(("name", "thickness"), [(SMALL, 0.25), (SOFT, 0.15)])
def test_five_micrometres_of_hinge_change_k_as_the_model_s_derivative_says(name, thickness):
    """Some 5 % at 0.25 mm: K goes with t to the power of 2.4 (beside a body that gives way) to 3 (a leaf)."""
    thicker = thickness + 0.005
    stated = (f"hinge_thickness = {thickness}", f"hinge_thickness = {thicker:g}")
    _, meant = compared(edited(name), edited(name, stated))
    layout = Layout(load(str(HARDWARE / f"{name}.toml")))
    assert len(meant.consequences[0].effect.elements) == len(layout.elements)
    for element, place in zip(meant.consequences[0].effect.elements, layout.elements):
        exponent = log(1.0 + element.stiffness.change) / log(thicker / thickness)
        assert 2.4 < exponent < 3.0
        assert exponent == pytest.approx(thickness_elasticity(layout, place), rel=0.01)
        assert name == SOFT or element.stiffness.change == pytest.approx(0.05, abs=0.003)


def test_the_modulus_changes_k_in_proportion():
    _, meant = compared(edited(SMALL), edited(SMALL, ("= 69000", "= 70000")))
    changes = [e.stiffness.change for e in meant.consequences[0].effect.elements]
    assert changes == pytest.approx(4 * [1 / 69], rel=1e-7)


def test_a_hinge_stands_above_a_moved_chamfer_and_a_note_below():
    _, meant = compared(
        edited(SMALL),
        edited(
            SMALL,
            ('title" = "chosen: what it is', 'title" = "chosen: its name'),
            ("pad_height = 2.0", "pad_height = 2.0\ncorner_radius = 0.4"),
            ("[calibration]", "[gauge]\nfactor = 1.5\n[clamp]\nend_plate_margin = 0.6\n[calibration]"),
            ("hinge_thickness = 0.25", "hinge_thickness = 0.255"),
        ),
    )
    order = [c.what.split(":")[0] for c in meant.consequences]
    # a gauge reads 29 % less, but K, rated force and yield count before the other figures
    assert order[:2] == ["element.hinge_thickness", "gauge.factor"]
    assert order[-1] == "origin.design.title"
    assert set(order[2:-1]) == {"element.corner_radius", "clamp.end_plate_margin"}
    assert meant.interactions == ()  # a corner does nothing to K


def test_what_the_causes_do_beyond_their_sum_is_said():
    """A slot of a thicker hinge: K goes with t to a power that the slot's length changes."""
    _, meant = compared(
        edited(SMALL),
        edited(
            SMALL,
            ("hinge_thickness = 0.25", "hinge_thickness = 0.35"),
            ("hinge_length = 0.88", "hinge_length = 1.4"),
        ),
    )
    assert len(meant.interactions) == 4 and meant.interactions[0].startswith("E1: K ")
    said = re.fullmatch(r"E1: K (\S+) % by the causes one by one, (\S+) % together", meant.interactions[0])
    singles = [e.effect.elements[0].stiffness for e in meant.consequences]
    product = 100 * (singles[0].new / singles[0].old * singles[1].new / singles[1].old - 1)
    assert float(said[1]) == pytest.approx(product, rel=0.01)
    whole = meant.together.elements[0].stiffness
    assert float(said[2]) == pytest.approx(100 * whole.change, rel=0.01)


def test_causes_that_only_work_together_are_one():
    """Sheet and pitch go together; a stated spacer does not let one change without the other."""
    _, meant = compared(
        edited(SMALL, ("row_pitch", "spacer = 1.0\nrow_pitch")),
        edited(
            SMALL,
            ("row_pitch", "spacer = 1.0\nrow_pitch"),
            ("thickness = 3.0", "thickness = 2.9"),
            ("pitch = 4.0", "pitch = 3.9"),
        ),
    )
    (both,) = meant.consequences
    assert both.what == "sheet.thickness: 3 -> 2.9; array.pitch: 4 -> 3.9" and both.effect == meant.together
    text = "\n".join(lines(meant))
    assert both.what in text and "refused" not in text


def test_yield_and_the_check_of_it_turn(monkeypatch):
    """Fillets left loose: some hinges yield before their stop closes; counted as `tactcad build` counts."""
    monkeypatch.setattr("tactcad.review.effect.COUNT", 200)
    loose = ("[gauge]", "[tolerance]\nfillet_radius = 0.2\n[gauge]")
    old, new = edited(SOFT), edited(SOFT, loose, ("pad_height = 1.6", "pad_height = 1.65"))
    _, meant = compared(old, new)
    fillet, pad = meant.consequences  # first: it makes a check fail
    assert fillet.what.startswith("tolerance.fillet_radius") and fillet.effect.now_fails
    shares = [sensor(from_table(tomllib.loads(text))).built(200).share for text in (old, edited(SOFT, loose))]
    assert [fillet.effect.yield_share.old, fillet.effect.yield_share.new] == shares
    assert shares[0] > 0.995 > shares[1]
    assert any("virtual arrays" in text for text in fillet.effect.now)
    assert pad.effect.yield_share is None and not pad.effect.now_fails


@pytest.mark.parametrize(
    "edit",
    [
        ("thickness = 2.0", "thickness = 2"),  # another way to write it
        ("[gauge]", "# a remark\n[gauge]"),
        ("[gauge]", "[gauge]\nfactor = 2.1"),  # the default, written out
        ("[rating]\nforce = 0.3\noverload_force = 5.0\n", "[rating]\noverload_force = 5.0\nforce = 0.3\n"),
    ],
)
def test_texts_that_mean_the_same_have_no_causes(edit):
    changes, meant = compared(edited(SOFT), edited(SOFT, edit))
    assert changes == [] and meant.consequences == () and not meant.together


def test_a_rig_less_is_one_cause():
    old = tomllib.loads(edited(SMALL))
    new = {k: v for k, v in old.items() if k != "grasping"}
    assert [str(c) for c in causes(old, new)] == ["[grasping] removed"]


def test_arm_lengths_with_a_point_keep_their_gaps():
    design = from_table(
        tomllib.loads(edited(SOFT, ("[gauge]", '[stop]\ngaps = {5=0.1, "9.5"=0.2}\n[gauge]')))
    )
    assert from_table(nested(flattened(design))).stop.gaps == {5.0: 0.1, 9.5: 0.2}


def rebuilt(folder: Path, seed_: int) -> str:
    """What diff says of the shipped design against itself at another path, under another hash seed."""
    place = folder / f"at {seed_}"
    place.mkdir()
    (place / "again.toml").write_text(edited(SMALL))
    run = subprocess.run(
        [
            sys.executable,
            "-m",
            "tactcad",
            "diff",
            str(ROOT / "exports/golden/smallest-bearing.json"),
            "again.toml",
        ],
        cwd=place,
        env=os.environ | {"PYTHONHASHSEED": str(seed_), "PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        check=True,
    )
    return run.stdout


SAME = "not compared: a golden file holds no design values\nno difference: "


@pytest.mark.by_day(1, "a fresh process each")
@pytest.mark.parametrize("seed_", [1, 2, *(pytest.param(n, marks=pytest.mark.nightly) for n in range(3, 21))])
def test_a_rebuild_under_another_hash_seed_and_path_shows_nothing(tmp_path, seed_):
    assert rebuilt(tmp_path, seed_).startswith(SAME)


def test_the_summary_is_short_and_holds_no_markup(tmp_path, capsys):
    """More causes than it shows, with hostile texts: code spans alone, which nothing in them ends."""
    hostile = "`<img src=x>` | @everyone [a](http://b)"
    owner = "".join(f'\n{field} = "me"' for field in ("author", "organisation", "contact"))
    without_notes = edited(SOFT, ("hinge_thickness = 0.15", "hinge_thickness = 0.155")).split("[origin]")[0]
    (tmp_path / "a.toml").write_text(edited(SOFT))
    (tmp_path / "b.toml").write_text(
        without_notes.replace("Soft tissue array 2 x 4", hostile).replace(
            "\nrevision", owner + "\nrevision", 1
        )
    )
    out, page = tmp_path / "c.md", tmp_path / "c.html"
    sides = [str(tmp_path / name) for name in ("a.toml", "b.toml")]
    assert main(["diff", *sides, "--markdown", str(out), "--html", str(page)]) == 0
    text = out.read_text()
    assert len(text.splitlines()) <= MOST_LINES
    assert re.search(r"… and \d+ more causes\.", text)
    outside = re.sub(r"`[^`\n]*`", "", text)
    assert not re.search(r"[<>@\[\]]", outside) and "everyone" not in outside
    assert "\u2039img src=x>' \u00a6 @everyone [a] (http://b)" in text and not re.search(r"<|\]\(", text)
    assert len({line.count("|") for line in text.splitlines() if line.startswith("|")}) == 1
    assert "<img" not in page.read_text() and "&lt;img src=x&gt;" in page.read_text()
    assert "What it means" in page.read_text()


def test_a_size_that_changes_in_print_only_is_told():
    size = (64.0, 40.0, 26.0)
    assert [*effect_lines(SensorEffect(size=(size, (64.02, 40.0, 26.0))))] == []
    (said,) = effect_lines(SensorEffect(size=(size, (64.0, 47.0, 26.0))))
    assert said == "overall size: 64.0 x 40.0 x 26.0 mm -> 64.0 x 47.0 x 26.0 mm"


def test_the_summary_of_no_change_says_so():
    same = side(edited(SOFT))
    assert "No difference." in markdown(same, same, [], meaning(same, same))


FAIL_ON: dict[str, tuple[tuple[str, str], set[str]]] = {
    "note": (("a gauge needs a flat face", "gauges need one"), {"changes"}),
    "gain": (("[gauge]", "[gauge]\nfactor = 2.0"), {"changes"}),
    "hinge": (
        ("hinge_thickness = 0.15", "hinge_thickness = 0.155"),
        {"changes", "geometry", "stiffness", "revision"},
    ),
    "limit": (("[gauge]", "[tolerance]\nload_arm = 0.04\n[gauge]"), {"changes", "geometry", "revision"}),
    "tip": (("[gauge]", "[tolerance]\ntip = 0.1\n[gauge]"), {"changes", "geometry", "checks", "revision"}),
    "new letter": (('revision = "M"', 'revision = "N"'), {"changes"}),
}


@pytest.mark.parametrize("name", FAIL_ON)
def test_the_exit_status_is_by_fail_on(tmp_path, capsys, name):
    edit, kinds = FAIL_ON[name]
    (tmp_path / "new.toml").write_text(edited(SOFT, edit))
    sides = [str(HARDWARE / "soft-tissue.toml"), str(tmp_path / "new.toml")]
    asked = [word for kind in KINDS for word in ("--fail-on", kind)]
    assert main(["diff", *sides, *asked]) == 1
    assert set(re.findall(r"--fail-on (\w+) is met", capsys.readouterr().err)) == kinds


def test_nothing_met_is_no_failure(capsys):
    sides = [str(HARDWARE / "soft-tissue.toml")] * 2
    assert main(["diff", *sides]) == 0
    assert main(["diff", *sides, *(word for kind in KINDS for word in ("--fail-on", kind))]) == 0


def test_the_command_offers_every_kind():
    [action] = [a for a in parser_of("diff")._actions if "--fail-on" in a.option_strings]
    assert tuple(action.choices) == tuple(KINDS)


def test_what_the_sides_do_not_tell_cannot_be_failed_on(capsys):
    golden = str(ROOT / "exports" / "golden" / "soft-tissue.json")
    assert main(["diff", golden, golden, "--fail-on", "checks"]) == 2
    assert capsys.readouterr().err.startswith("tactcad: --fail-on: nothing to check on both sides")


def test_rows_that_one_family_alone_has_are_told():
    """As between an array of rows and one of cells, of which only the first states them."""
    rows = [[4.0, 6.0]]
    for old, new, said in ((None, rows, "(not stated) -> "), (rows, None, " -> (not stated)")):
        assert said in str(Edit(("array", "row_arms"), old, new))
