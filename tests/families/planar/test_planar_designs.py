"""Two planar designs, as their files are read, refused, estimated and laid out."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cell_labs import loops_field
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from scipy.stats import truncnorm

from tactcad.contour.inside import side
from tactcad.design.family import family_of
from tactcad.design.load import parse
from tactcad.design.messages import InputError
from tactcad.export.inspection import inspection_bytes
from tactcad.families.planar import cell_array, parts
from tactcad.families.planar.cell_layout import PlanarLayout
from tactcad.families.planar.checks import CHECKS, check_strength
from tactcad.families.planar.rules import design_rules
from tactcad.families.planar.sensor import (
    chip_matrix,
    closing_force,
    object_errors,
    rows,
    stop_stress,
    strength,
)
from tactcad.parts.bought.standard_parts import dowel_limits
from tactcad.parts.rules import load
from tactcad.review.effect import Reviewed, same_elements
from tactcad.stacks.virtual_build import sensor

DESIGNS = Path(__file__).parents[3] / "hardware"
PLANAR, JAW = (DESIGNS / f"{name}-array.toml" for name in ("planar", "jaw"))


@pytest.fixture(scope="module", params=[PLANAR, JAW], ids=["planar", "jaw"])
def layout(request):
    return PlanarLayout(load(str(request.param)))


def test_kinds_alternate_like_a_chessboard(layout):
    p = layout.design.planar
    kinds = {(e.row, e.column): e.kind.name for e in layout.elements}
    assert len(kinds) == p.rows * p.columns
    for (j, i), kind in kinds.items():
        assert all(kinds.get(n, "") != kind for n in ((j + 1, i), (j, i + 1)))


def test_the_foil_s_area_by_hand(layout):
    """Border and webs, islands with ears, beams, (1 - pi/4) r^2 of every root's corner. Of the corners with
    the process' radius as many are inside as outside."""
    d, foil = layout.design, parts.foil(layout)
    x, y = layout.half
    area = 4 * x * y
    for e in layout.elements:
        t, o = e.kind.table, e.kind.opening
        held = 4 * e.kind.beam_length * t.beam_width + t.island**2
        if e.kind.pinwheel:
            held += 4 * t.ear * (e.kind.reach - t.island / 2)
        corners = (1 - np.pi / 4) * 16 * t.fillet**2
        area -= o**2 - held - corners
    assert foil.extrusion.section_area == pytest.approx(area, rel=1e-9)
    assert d.planar.thickness == foil.extrusion.thickness


def test_beams_are_as_wide_and_as_long_as_they_are_computed(layout):
    """Across each beam's middle the foil is material for its width, and slot beside it."""
    foil = parts.foil(layout)
    for e in layout.elements[:2]:
        for root in e.kind.cell.roots:
            (x, y), (u, v) = root.at, root.along
            middle = np.array([e.x + x + u * e.kind.beam_length / 2, e.y + y + v * e.kind.beam_length / 2])
            across = np.array([-v, u])
            half = e.kind.table.beam_width / 2
            for off, material in (
                (0.0, True),
                (half - 1e-3, True),
                (half + 1e-3, False),
                (-half - 1e-3, False),
            ):
                point = tuple(middle + off * across)
                inside = all(side(slot, point) < 0 for slot in foil.extrusion.openings)
                assert inside is material, (e.number, root, off)


def test_heights_add_up(layout):
    """From the board's underside to the pad: layer on layer, and the chip as far from the magnet as asked."""
    scene = cell_array.scene(layout.design)
    at = {p.designator: p for p in scene.placements}
    d = layout.design
    magnet, chip = at["M1"], at["U1"]
    assert magnet.origin[2] - (chip.origin[2] + layout.chip.height) == pytest.approx(d.hall.gap)
    cover = at["C1"]
    assert at["P1"].origin[2] + at["P1"].part.body.box[1][2] == pytest.approx(
        cover.origin[2] + cover.part.extrusion.thickness + d.post.stand_out
    )
    assert scene.size[2] > 0 and all(p.part.volume > 0 for p in scene.placements)


def test_estimate_tells_ratio_resolution_and_stops(layout):
    found = {row.kind: row for row in rows(layout, "", None)}
    soft, stiff = found["measuring"], found["reference"]
    assert 5 < stiff.stiffness / soft.stiffness < 20
    for row in found.values():
        kind = layout.kinds[row.kind]
        assert row.rated_force <= row.yield_force / layout.design.rating.yield_factor * (1 + 1e-9)
        assert (
            row.stop_force == pytest.approx(closing_force(layout, kind)) and row.stop_force > row.rated_force
        )
        # Goodman's line from the sheet metal's row, Marin's factor of a machined surface
        m, half = layout.design.material, row.rated_force * row.stress / row.force / 2
        marin = 4.51 * m.tensile_strength**-0.265
        assert 1 / row.fatigue_factor == pytest.approx(
            half / (marin * m.fatigue_strength) + half / m.tensile_strength
        )
        # noise: the chip's own, through the inverse of the matrix, by drawing it
        noise = np.array([layout.chip.noise_xy] * 2 + [layout.chip.noise_z]) * 1e-3
        drawn = np.linalg.solve(
            chip_matrix(layout, kind), (np.random.default_rng(1).normal(size=(4000, 3)) * noise).T
        )
        assert drawn.std(axis=1)[[0, 2]] == pytest.approx([row.force_noise_x, row.force_noise_z], rel=0.05)
    flags = {f.check: f for f in check_strength(layout.design) if f.part == "E2"}
    tired = flags["planar-fatigue"]
    assert tired.value == pytest.approx(tired.limit * soft.fatigue_factor) and tired.value < soft.rated_force
    table = list(csv.DictReader(io.StringIO(strength(layout).decode())))
    assert [r["element"] for r in table] == [e.designator for e in layout.elements]


def test_flags_name_each_kind_that_bears_too_little_or_stiffens(layout):
    """By the force asked for and each kind's cubic curve; at a fortieth of it none."""
    d, first = layout.design, {e.kind.name: e.designator for e in reversed(layout.elements)}
    told = []
    for share in (0.025, 1.0, 3.0):
        asked = replace(d, rating=replace(d.rating, force=share * d.rating.force))
        wanted = set()
        for row in rows(PlanarLayout(asked), "", None):
            bow = layout.kinds[row.kind].cell.stiffening
            roots = np.roots([bow, 0.0, 1.0, -row.rated_force / row.stiffness])  # F = K z (1 + bow z^2)
            sink = float(roots[np.isreal(roots)].real[0])
            if bow * sink**2 > d.rating.linearity:
                wanted.add(("planar-linear", first[row.kind]))
            if row.rated_force < asked.rating.force * (1.0 - 1e-6):
                wanted.add(("planar-rated-force", first[row.kind]))
        found = {(f.check, f.part) for check in CHECKS for f in check.run(asked, None)}
        found = {each for each in found if each[0] in ("planar-linear", "planar-rated-force")}
        assert found == wanted
        told.append(found)
    assert not told[0] and {check for check, _ in told[2]} == {"planar-rated-force", "planar-linear"}


def test_a_matrix_changes_as_the_field_of_the_simulator_does(layout):
    """Central differences of the tests' own current loops and exact turns, at rest and at the rated force."""
    shear, gap = layout.design.rating.shear, layout.design.hall.gap
    lever, m = layout.design.planar.thickness / 2 + layout.design.magnet.height, layout.magnet
    for row in {row.kind: row for row in rows(layout, "", None)}.values():
        cell, load = layout.kinds[row.kind].cell, np.zeros((6, 3))
        load[:3], load[3, 1], load[4, 0] = np.eye(3), -layout.pad_height, layout.pad_height

        def felt(force, cell=cell, load=load):
            move, bow = cell.compliance @ load @ force, cell.stiffening
            move[2] = brentq(lambda u: u * (1 + bow * u * u) - move[2], -1, 1)
            turned = Rotation.from_rotvec(move[3:])
            low = move[:3] + turned.apply([0, 0, -lever])
            at = turned.inv().apply(np.array([0, 0, -lever - gap]) - low)
            return turned.apply(loops_field(m.radius, m.height, m.remanence, at))

        def matrix(force, felt=felt):
            steps = 1e-3 * row.rated_force * np.eye(3)
            return np.array([(felt(force + s) - felt(force - s)) / (2 * s.max()) for s in steps]).T

        rest, rated = matrix(np.zeros(3)), matrix(row.rated_force * np.array([shear, 0, -1.0]))
        change = np.abs(rated - rest).max() / np.abs(rest).max()
        assert row.matrix_change == pytest.approx(change, abs=0.005)


def told(found, object_stiffness, matrices):
    """Relative error of K_obj, of a cell of each kind on it, pressed until one is at its rated force: by the
    slope of F_m / F_r and its errors, which are the noise and that of the matrices."""
    cells = [found["measuring"], found["reference"]]
    soft, stiff = (1 / c.stiffness + 1 / object_stiffness for c in cells)
    way = min(cells[0].rated_force * soft, cells[1].rated_force * stiff)
    noise = [c.force_noise_z * series / way for c, series in zip(cells, (soft, stiff))]
    return np.hypot(*[np.hypot(n, matrices) for n in noise]) * object_stiffness / (1 / stiff - 1 / soft)


def test_the_jaw_s_file_says_what_can_be_had_there():
    """Its jaw, K and noise by kind, and errors of K_obj."""
    lay = PlanarLayout(load(str(JAW)))
    assert 2 * np.array(lay.half) == pytest.approx([28.0, 10.0])
    said = " ".join(line[2:] for line in JAW.read_text("utf-8").splitlines() if line.startswith("# "))
    found = {row.kind: row for row in rows(lay, "", None)}
    soft, stiff = found["measuring"], found["reference"]
    assert f"K_m = {soft.stiffness:.2f} and K_r = {stiff.stiffness:.2f} N/mm, rated for " in said
    assert f"rated for {soft.rated_force:.2f} and {stiff.rated_force:.2f} N" in said
    for row in (soft, stiff):
        assert f"{1e3 * row.force_noise_x:.2f} mN" in said and f"{1e3 * row.force_noise_z:.2f} mN" in said
    errors = [[100 * told(found, k, m) for k in (0.5, 1.0, 5.0, 20.0)] for m in (0.0, 0.01)]
    assert [100 * e for e in object_errors(lay).values()] == pytest.approx(errors[0], rel=1e-6)
    text = "{:.1f} % at 0.5 N/mm, {:.1f} % at 1, {:.1f} % at 5 and {:.1f} % at 20".format(*errors[0])
    assert text in said and "{:.1f}, {:.1f}, {:.1f} and {:.1f} %".format(*errors[1]) in said


@pytest.mark.by_day(1, "hundreds of arrays each")
def test_arrays_as_made_have_the_stiffness_of_beams_as_cut(layout):
    """Foils and cuts drawn within their limits, each beam's own closed form: K of every cell, and how many
    arrays have all within 10 %. The stress on the stop is that of the thickest foil and the longest way."""
    d, t, known = layout.design, layout.design.planar.thickness, sensor(layout.design)
    cut = layout.process.tolerance(t)
    drawn = truncnorm(-2, 2).rvs((400, 2), random_state=7) / 2 * (d.foil_tolerance, cut)
    zero = {name: np.zeros((400, v.pieces)) for name, v in known.variables.items()}
    made = zero | {"foil: thickness": drawn[:, :1], "foil: growth of beams": drawn[:, 1:]}
    arrays = cell_array.Stacked(layout, made)
    found, near = cell_array.figures(arrays)["stiffness"], np.ones(400, bool)
    for e in layout.elements[:2]:
        b = e.kind.beam
        K = np.array([
            1 / replace(e.kind.cell, beam=replace(
                b, thickness=t + dt, width=b.width + dw, length=b.length - dw, fillet=b.fillet - dw / 2,
                bevel=0.2 * (t + dt),
            )).compliance[2, 2]
            for dt, dw in drawn
        ])  # fmt: skip
        assert found[:, e.number - 1] == pytest.approx(K, rel=0.005)
        near &= np.abs(K * e.kind.cell.compliance[2, 2] - 1) <= 0.1
    assert known.built(1000).near == pytest.approx(near.mean(), abs=0.05)
    (stress,) = [r for r in known.requirements if "from yielding" in r.name]
    worst = cell_array.Stacked(layout, {name: v.upper[np.newaxis] for name, v in known.variables.items()})
    thick = replace(d, planar=replace(d.planar, thickness=t + d.foil_tolerance))
    by_hand = [
        stop_stress(PlanarLayout(thick), kind, kind.table.stop_gap + parts.travel_limit(layout, kind))
        for kind in PlanarLayout(thick).used
    ]
    assert stress.value(worst)[0] == pytest.approx(np.array(by_hand) / d.material.yield_strength, rel=0.02)


def test_sheets_of_etched_parts_tell_undercut_and_tabs():
    """Both sides etch half the thickness: that over the etch factors read, 1.5 and 3.5. Nothing thinner than
    0.254 mm is etched without tabs; what a wire cuts has no undercut."""
    planar, jaw = (PlanarLayout(load(str(file))) for file in (PLANAR, JAW))
    made = parts.foil(planar), parts.upper_spacer(jaw), parts.upper_spacer(planar)
    assert [part.process for part in made] == ["etched", "etched", "wire-cut"]
    thin, thick, wire = (" ".join(part.notes) for part in made)
    assert "undercut 0.011 to 0.027 a side tabs on the upper" in thin
    assert "undercut 0.057 to 0.13 a side tabs, if any, on the upper" in thick
    assert "undercut" not in wire and "tabs, if any, on the upper" in wire


def test_the_guide_tells_how_the_array_is_fixed():
    """By its own screws, of the next length sold, through a machine's plate under the board; or bonded."""
    screwed, bonded = (PlanarLayout(load(str(file))) for file in (PLANAR, JAW))
    assert parts.mounting(screwed) == (10.0, 2.0) and parts.screw_length(screwed) == 8.0
    longest = replace(screwed.design.housing, cover_thickness=15.0)
    assert parts.mounting(PlanarLayout(replace(screwed.design, housing=longest)))[1] == 0.0
    text = {s.title: s.text for s in cell_array.scene(screwed.design).steps}
    assert (
        "the machine's plate, 2 mm thick" in text["Screws"] and "take screws M2x10 instead" in text["Screws"]
    )
    told = [s.text for s in cell_array.scene(bonded.design).steps if "to the jaw" in s.text]
    assert len(told) == 1


def test_etched_beams_are_beveled_and_those_cut_by_wire_are_not():
    """K of a soft cell goes with w - 1.5 c, c = 0.2 t; the sheet says over what a width is measured."""
    d = load(str(PLANAR))
    d = replace(d, measuring=replace(d.measuring, fillet=0.2, slot=0.5))  # what wire can cut too
    etched, wire = (
        PlanarLayout(replace(d, planar=replace(d.planar, process=name))) for name in ("etched", "wire-cut")
    )
    soft, plain = (lay.kinds["measuring"].cell.stiffness[2, 2] for lay in (etched, wire))
    assert soft / plain == pytest.approx(1 - 1.5 * 0.2 * 0.08 / 0.4, rel=3e-3)
    said = [any("over the bevel" in note for note in parts.foil(lay).notes) for lay in (etched, wire)]
    assert said == [True, False]


def test_the_foil_s_measurements_can_be_taken(layout):
    """Figures to a nanometre at most; instruments that read to a tenth of the limits' width, or the best."""
    text = list(csv.DictReader(io.StringIO(inspection_bytes(layout).decode())))
    assert len(text) == 3 * len(layout.elements)
    for row in text:
        limits = [row[c] for c in ("nominal", "lower", "upper")]
        assert all(len(v.partition(".")[2]) <= 6 for v in limits)
        reads = float(re.search(r", ([\d.]+) or better", row["how"])[1])
        assert reads <= (float(limits[2]) - float(limits[1])) / 10 + 1e-9 or reads == 0.0005


def test_three_components_come_back_from_the_field(layout):
    """Forces through compliance, magnet and the inverse matrix: small ones exactly, to the square of the
    motion."""
    from tactcad.families.planar.cell import wrench
    from tactcad.families.planar.field import felt
    from tactcad.families.planar.sensor import magnet_lever

    for kind in layout.used:
        force = np.array([2e-5, -1e-5, -1e-4])
        motion = kind.cell.compliance @ wrench(force, layout.pad_height)
        gap, lever = layout.design.hall.gap, magnet_lever(layout)
        change = felt(layout.magnet, gap, lever, motion) - felt(layout.magnet, gap, lever, np.zeros(6))
        assert np.linalg.solve(chip_matrix(layout, kind), change) == pytest.approx(force, rel=2e-3, abs=1e-8)


BROKEN = {
    "foil_suits_process": ("stop_gap = 0.045", "stop_gap = 0.02"),
    "islands_fit_pitch": ("island = 3.0", "island = 7.3"),
    "beams_can_be_cut": ("fillet = 0.1\n", "fillet = 0.05\n"),
    "beams_in_range": ("beam_width = 0.9", "beam_width = 1.3"),
    "island_takes_post": ("spigot = 0.8", "spigot = 1.5"),
    "island_lands_on_base": ("border = 5.0", "border = 5.0\nwell = 1.3"),
    "chips_fit": ("buses = 3", "buses = 2"),
    "screws_fit": ("cover_thickness = 3.0", "cover_thickness = 1.0"),
    "stop_protects": ("stop_gap = 0.22", "stop_gap = 0.6"),
    "posts_clear_cover": ("border = 5.0", "border = 5.0\nside_gap = 0.15"),
    "field_in_scale": ("gap = 1.8", "gap = 1.0"),
    "magnets_keep_apart": ("[hall]", "[magnet]\ndiameter = 4.0\n\n[hall]"),
    "foil_leaves_magnets_alone": ("1.4310-C1300", "maraging-300-aged"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_every_rule_refuses_its_witness_in_one_line(name):
    old, new = BROKEN[name]
    text = PLANAR.read_text("utf-8")
    assert old in text
    layout = PlanarLayout(parse(text.replace(old, new), "broken.toml"))
    (finding,) = design_rules()[name](layout)
    assert finding.limit and "\n" not in finding.broken


FAULTS = {  # by what was asked: a change of the design, the rule that it breaks, part of its message
    "beams that do not fit": ("island = 3.0", "island = 5.5", "beams_in_range", "w/s = 0.947"),
    "islands that meet": ("island = 3.0", "island = 7.3", "islands_fit_pitch", "island meets the frame"),
    "a slot too narrow": ("slot = 0.35", "slot = 0.09", "beams_can_be_cut", "slot narrower"),
    "a beam too narrow": ("beam_width = 0.4", "beam_width = 0.09", "beams_can_be_cut", "beam narrower"),
    "a web too narrow": (
        "web = 0.6", "web = 0.1\nprocess = \"wire-cut\"", "foil_suits_process", "narrower than the process",
    ),
    "magnets that pull their neighbours": (
        "[hall]", "[magnet]\nheight = 8.0\n\n[hall]", "magnets_keep_apart", "magnet pulls a measuring cell",
    ),
    "magnets that pull the foil": (
        "1.4310-C1300", "17-4PH-H900", "foil_leaves_magnets_alone", "magnetic foil",
    ),
    "magnets that meet the base": (
        "border = 5.0", "border = 5.0\nwell = 0.35", "island_lands_on_base", "magnet meets the base",
    ),
    "fields out of range": ("gap = 1.8", "gap = 1.0", "field_in_scale", "MLX90393 takes 50"),
    "a stop that closes too early": (
        "stop_gap = 0.22", "stop_gap = 0.12", "stop_protects", "closes before the rated force",
    ),
    "a stop that a tipped island closes too early": (
        "stop_gap = 0.22", "stop_gap = 0.21", "stop_protects", "closes before the rated force",
    ),
    "posts that meet the cover": (
        "border = 5.0", "border = 5.0\nside_gap = 0.21", "posts_clear_cover", "measuring cell meets",
    ),
    "posts that meet": ("pad = 2.4", "pad = 7.6", "island_takes_post", "meet at rated shear"),
    "chips that are read too seldom": (
        "buses = 3", "buses = 3\nrate = 61.0", "chips_fit", "36 chips MLX90393 are not read so often",
    ),
    "two chips of one address": ("buses = 3", "buses = 2", "chips_fit", "two would have one address"),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_each_named_fault_is_refused_by_its_rule(fault):
    old, new, name, said = FAULTS[fault]
    text = PLANAR.read_text("utf-8")
    assert old in text
    layout = PlanarLayout(parse(text.replace(old, new), "broken.toml"))
    found = [f for rule in design_rules().values() for f in rule(layout)]
    assert name in {f.check for f in found}, [f.broken for f in found]
    message = next(f.broken for f in found if f.check == name)
    assert said in message and "legal: " in message and "\n" not in message


def test_stops_and_cover_are_clear_at_the_rated_force_and_at_the_limits(layout):
    """By the compliance and the sheets: at the rated force with its shear towards a corner, no corner of an
    island meets its land at the least way down, and no post its opening's edge. Both rules bind there."""
    d, by = layout.design, {c.number: c for c in rows(layout, "", None)}
    made = ("foil", "cover", "base", "post", "lower_spacer")
    sheets = {name: getattr(parts, name)(layout) for name in made}

    def refused(rule, what, **tables):
        return any(what in f.broken for f in design_rules()[rule](PlanarLayout(replace(d, **tables))))

    limit = {(n, c.name): c for n, p in sheets.items() for c in p.characteristics}
    zone = {(n, g.features[0]): g.zone for n, p in sheets.items() for g in p.geometric}
    moved = []
    for e in layout.elements[:2]:
        kind, force = e.kind, by[e.number].rated_force
        c, height, shear = kind.cell.compliance, layout.pad_height, d.rating.shear * force
        tilt = c[4, 4] * shear * height
        straight, bow = force * c[2, 2], kind.cell.stiffening
        sink = brentq(lambda u, bow=bow, straight=straight: u * (1 + bow * u**2) - straight, 0, 1)
        corner = max(np.hypot(*line.start) for line in kind.island_outline(0.0))
        spacer = limit["lower_spacer", "thickness"]
        deep = float(re.search(r"±(\S+) deep", " ".join(sheets["base"].notes))[1])
        sunk = kind.table.stop_gap > spacer.nominal + 1e-9
        least = kind.table.stop_gap - (spacer.upper - spacer.nominal) - deep * sunk
        assert sink + tilt * corner <= least
        less = kind.table.stop_gap - (least - sink - tilt * corner) - 2e-4
        assert refused("stop_protects", "closes before", **{kind.name: replace(kind.table, stop_gap=less)})
        top = layout.pad_z - d.post.stand_out - d.planar.thickness / 2
        moved.append(c[0, 0] * shear + tilt * top)
    play = zone["cover", "post_opening"] + zone["foil", "spigot"]
    play += limit["foil", "spigot diameter"].upper - limit["post", "spigot diameter"].lower
    if layout.screwed:
        bores = [limit[n, "dowel hole diameter"].upper for n in ("foil", "cover")]
        play += zone["cover", "dowel_hole"] + zone["foil", "dowel_hole"]
        play += sum(bores) - 2 * dowel_limits("2")[0]
    opening, pad = limit["cover", "post opening diameter"], limit["post", "pad side diameter"]
    room = (opening.lower - pad.upper - play) / 2
    assert max(moved) <= room
    less = d.housing.side_gap - room + max(moved) - 2e-3
    assert refused("posts_clear_cover", "meets the cover", housing=replace(d.housing, side_gap=less))


def test_a_steel_base_is_no_legal_value():
    text = PLANAR.read_text("utf-8").replace("border = 5.0", 'border = 5.0\nplate_alloy = "17-4PH-H900"')
    with pytest.raises(InputError, match="housing.plate_alloy"):
        parse(text, "steel.toml")


def test_every_rule_has_a_witness():
    assert set(BROKEN) == set(design_rules())


def test_what_the_family_cannot_do_is_refused_in_one_line():
    design = load(str(PLANAR))
    with pytest.raises(InputError, match="does not take designs of this family"):
        family_of(design).must("variables", "target.base")


def test_forty_by_forty_cells_are_those_of_six_by_six(tmp_path):
    """1600 chips take a hundred buses of sixteen addresses, and a wide foil's posts more room; K does not
    depend on the number of cells."""
    text = PLANAR.read_text("utf-8").replace("rows = 6", "rows = 40").replace("columns = 6", "columns = 40")
    (tmp_path / "many.toml").write_text(
        text.replace("buses = 3", "buses = 100")
        .replace('"planar-array"', '"many"')
        .replace("border = 5.0", "border = 5.0\nside_gap = 0.47\nwell = 0.57")
    )
    many, few = (rows(PlanarLayout(load(str(path))), "", None) for path in (tmp_path / "many.toml", PLANAR))
    assert len(many) == 1600
    assert {(r.kind, r.stiffness) for r in many} == {(r.kind, r.stiffness) for r in few}


def test_a_design_without_a_title_has_one(tmp_path):
    """What `tactcad new` writes has none, and titles go into boards, drawings and headers."""
    text = "".join(line for line in PLANAR.read_text("utf-8").splitlines(True) if "title" not in line)
    (tmp_path / "untitled.toml").write_text(text.replace('"planar-array"', '"untitled"'))
    assert load(str(tmp_path / "untitled.toml")).design.title == "Planar tactile array, 6 x 6 cells"


def test_two_states_are_compared_cell_by_cell(layout):
    """Every row has its pairs, and a gap's change is seen in each cell's signal."""
    was = layout.design
    now = replace(was, hall=replace(was.hall, gap=2.0))
    names = [e.designator for e in layout.elements]
    assert same_elements(was, now) == list(zip(names, names))
    before, after = (Reviewed(d)._signals(len(names)) for d in (was, now))
    assert before == [row.signal for row in rows(layout, "", None)]
    assert all(b < a for a, b in zip(before, after))
