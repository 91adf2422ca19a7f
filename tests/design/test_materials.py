"""The table of materials against figures as published, and what a design may say of a material."""

from __future__ import annotations

import json

import pytest
from variants import DROP, HARDWARE, table, variant

from tactcad.checks.described.wirecut import check_wirecut
from tactcad.checks.shop import load_shop
from tactcad.cli.main import main
from tactcad.design.load import from_table
from tactcad.design.materials import ALLOYS, MOST_DIFFERENCE, PROPERTIES, family, modulus_per_kelvin
from tactcad.design.messages import InputError
from tactcad.drawing.parts.part_sheet import notes_of
from tactcad.paper import array_model
from tactcad.parts.array.element import element
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.supplies import array_supplies
from tactcad.release.readme import readme_bytes
from tactcad.release.release_contents import ReleaseContents
from tactcad.scenes import make_scene

KSI, LB_PER_CUBIC_INCH = 6.894757, 27679.9  # MPa, kg/m3

# As the sources that data/materials.csv cites print them, in their own units.
PUBLISHED = {
    "6061-T6": {  # Aluminum Association, typical: 10000 ksi, 0.0975 lb/in3, 40, 14 and 45 ksi
        "youngs_modulus": 10000 * KSI,
        "density": 0.0975 * LB_PER_CUBIC_INCH,
        "yield_strength": 40 * KSI,
        "fatigue_strength": 14 * KSI,
        "tensile_strength": 45 * KSI,
        "conductivity": 167,
    },
    "2024-T3": {"youngs_modulus": 10600 * KSI},
    "7075-T6": {  # btimetals.com
        "youngs_modulus": 10300 * KSI,
        "density": 0.101 * LB_PER_CUBIC_INCH,
        "yield_strength": 73 * KSI,
        "fatigue_strength": 23 * KSI,
        "tensile_strength": 83 * KSI,
        "conductivity": 130,
    },
    "Ti-6Al-4V-annealed": {  # MatWeb MTP644
        "youngs_modulus": 16500 * KSI,
        "density": 0.16 * LB_PER_CUBIC_INCH,
        "yield_strength": 120 * KSI,
        "fatigue_strength": 74 * KSI,
        "tensile_strength": 131 * KSI,
        "poisson": 0.342,  # MTP643
    },
    "17-4PH-H900": {  # MMPDS 2.6.9 and ASTM A693
        "youngs_modulus": 28500 * KSI,
        "density": 0.282 * LB_PER_CUBIC_INCH,
        "yield_strength": 170 * KSI,
        "tensile_strength": 190 * KSI,
    },
    "1.4310-C1300": {"youngs_modulus": 185e3, "yield_strength": 147 * KSI, "tensile_strength": 1300},
    "1.4310-C1000": {  # elgiloy.com, 301 half hard
        "youngs_modulus": 193e3,
        "density": 7880,
        "yield_strength": 110 * KSI,
        "tensile_strength": 150 * KSI,
        "conductivity": 16.2,
    },
    "1.4310-C1500": {"youngs_modulus": 185e3, "tensile_strength": 1500},  # EN 10151; at 1800 MPa
    "17-7PH-TH1050": {  # azom.com 6779; ASTM A693
        "youngs_modulus": 29588 * KSI,
        "density": 0.282 * LB_PER_CUBIC_INCH,
        "yield_strength": 150 * KSI,
        "tensile_strength": 180 * KSI,
    },
    "1.4034-hardened": {  # kooz.si; AK Steel's type 420 strip
        "youngs_modulus": 220e3,
        "density": 7730,
        "conductivity": 30,
        "yield_strength": 195 * KSI,
        "tensile_strength": 230 * KSI,
        "fatigue_strength": 670,  # makeitfrom.com, hardened 420
    },
    "maraging-300-aged": {
        "youngs_modulus": 27500 * KSI,
        "yield_strength": 270 * KSI,
        "tensile_strength": 280 * KSI,
    },
    "C17200-TF00": {
        "youngs_modulus": 19000 * KSI,
        "density": 8260,
        "yield_strength": 960,
        "tensile_strength": 1100,
    },
    "C17200-TH04": {  # ASTM B194
        "youngs_modulus": 131e3,
        "yield_strength": 165 * KSI,
        "tensile_strength": 190 * KSI,
    },
}


@pytest.mark.parametrize("name", ALLOYS)
def test_published_figures_lie_within_the_row_s_spread(name):
    row = ALLOYS[name]
    for key, value in PUBLISHED[name].items():
        assert value == pytest.approx(getattr(row, key), rel=row.spread[key]), key


# Published moduli at room temperature and 70 to 80 K above it, by row.
WARMER = {
    "17-4PH-H900": (200.0, 195.0, 80.0),  # EN 10088-1, grade 630
    "1.4310-C1300": (200.0, 194.0, 80.0),  # EN 10088-1, austenitic grades
    "1.4034-hardened": (215.0, 205.0, 180.0),  # EN 10088-1, 13 % chromium
    "maraging-300-aged": (27.8, 27.1, 130 / 1.8),  # ASME B31.1, nickel steels
    "C17200-TF00": (14.0, 13.7, 130 / 1.8),  # ASME B31.1, tin bronze
    "Ti-6Al-4V-annealed": (15.5, 15.0, 130 / 1.8),  # ASME B31.1, unalloyed titanium
}


def test_the_modulus_falls_by_the_alloy_s_own_share_per_kelvin():
    for name, (cold, warm, kelvin) in WARMER.items():
        assert modulus_per_kelvin(name) == pytest.approx((1 - warm / cold) / kelvin, rel=0.02)
    for name in ("6061-T6", "2024-T3", "7075-T6"):
        assert 4e-4 <= modulus_per_kelvin(name) <= 5e-4
    assert modulus_per_kelvin("mine") == max(map(modulus_per_kelvin, ALLOYS))
    design = of("17-4PH-H900")
    assert array_model.from_design(design).modulus_per_kelvin == modulus_per_kelvin("17-4PH-H900")


def test_every_row_is_whole():
    families = ["aluminium"] * 3 + ["titanium"] + ["steel"] * 7 + ["copper"] * 2
    assert [family(row.density) for row in ALLOYS.values()] == families
    for row in ALLOYS.values():
        assert row.standard and row.temper and row.source
        assert set(PROPERTIES) < set(row.spread) and 0 < min(row.spread.values())
        assert max(row.spread.values()) <= MOST_DIFFERENCE
        assert 0 < row.fatigue_strength < row.yield_strength < row.tensile_strength
        # an isotropic solid's bulk modulus is positive, and metals' E/density is 23 to 27 MPa m3/kg but for
        # copper's 15
        assert 14 < row.youngs_modulus / row.density < 28 and 0.25 < row.poisson < 0.35


def design(tree):
    return from_table(table({"material": tree["material"], "origin": tree["origin"]}))


def refused(changes, origin=None):
    tree = {"material": {"alloy": "7075-T6", **changes}, "origin": origin or {}}
    with pytest.raises(InputError) as caught:
        design(tree)
    return caught.value


def test_titanium_s_data_under_aluminium_s_name_is_refused_whatever_the_origin_says():
    found = refused(
        {"youngs_modulus": 114000, "density": 4430},
        {"material.youngs_modulus": "measured", "material.density": "measured"},
    )
    assert found.where == "material.youngs_modulus" and "58.3% above 7075-T6's 72000" in str(found)
    assert "a label of its own" in found.legal
    assert refused({"density": 4430}).where == "material.density"
    assert refused({"magnetic": "yes"}).where == "material.magnetic"


@pytest.mark.parametrize(
    "name", ["youngs_modulus", "poisson", "density", "yield_strength", "fatigue_strength"]
)
def test_a_value_within_the_spread_passes_one_beyond_asks_for_its_source_one_beyond_ten_per_cent_is_refused(
    name,
):
    row, path = ALLOYS["7075-T6"], f"material.{name}"
    value = lambda off: getattr(row, name) * (1 + off)  # noqa: E731
    for sign in (-1, 1):
        inside, outside = sign * row.spread[name], sign * 0.1001
        plain = design({"material": {"alloy": row.name, name: value(inside)}, "origin": {}})
        assert [d.relative for d in plain.differences] == [pytest.approx(inside)]
        assert refused({name: value(outside)}, {path: "measured: lot 7"}).where == path
        if row.spread[name] < 0.09:
            between = sign * 0.0999
            assert f'"{path}"' in refused({name: value(between)}).legal
            named = design(
                {"material": {"alloy": row.name, name: value(between)}, "origin": {path: "measured: lot 7"}}
            )
            assert [d.origin for d in named.differences] == ["measured: lot 7"]
    assert design({"material": {"alloy": row.name}, "origin": {}}).differences == ()


OWN = {
    "youngs_modulus": 45000,
    "poisson": 0.35,
    "density": 1770,
    "yield_strength": 200,
    "fatigue_strength": 97,
}


def test_a_label_of_its_own_is_taken_in_full_and_only_so():
    made = design({"material": {"alloy": "AZ31B-H24", **OWN}, "origin": {}})
    assert made.material.alloy == "AZ31B-H24" and made.material.density == 1770 and made.differences == ()
    assert made.material.tensile_strength is None and made.material.magnetic is None
    for left_out in OWN:
        rest = {k: v for k, v in OWN.items() if k != left_out}
        found = refused({"alloy": "AZ31B-H24", **rest})
        assert found.where == "material.alloy" and f"{left_out} is not given" in str(found)


@pytest.mark.parametrize(
    "alloy", ["7075T6", "7075-t6", "7075 T6", "EN AW-7075-T6", "17-4 PH H900", "ti6al4v annealed"]
)
def test_a_name_of_the_table_in_another_spelling_is_no_label_of_its_own(alloy):
    assert "a name of the table" in str(refused({"alloy": alloy, **OWN}))


@pytest.mark.parametrize("alloy", ["7075-T651", "17-4PH H1025", "sheet 17075-T60"])
def test_another_temper_is_a_label_of_its_own(alloy):
    assert design({"material": {"alloy": alloy, **OWN}, "origin": {}}).material.alloy == alloy


def estimate(path, capsys):
    assert main(["estimate", str(path)]) == 0
    text = capsys.readouterr().out
    assert main(["estimate", str(path), "--json"]) == 0
    return text, json.loads(capsys.readouterr().out)


def test_both_stiffnesses_are_said_where_the_paper_s_modulus_stands_for_the_alloy_s(tmp_path, capsys):
    """The second by estimating the design again with the table's modulus."""
    source = (HARDWARE / "macro-array.toml").read_text("utf-8")
    (tmp_path / "real.toml").write_text(source.replace("youngs_modulus = 69000", "youngs_modulus = 72000"))
    text, document = estimate(HARDWARE / "macro-array.toml", capsys)
    plain, real = estimate(tmp_path / "real.toml", capsys)
    ours, table = ([row["stiffness"] for row in d["elements"]] for d in (document, real))
    assert [k * document["stiffness_factor"] for k in ours] == pytest.approx(table, rel=1e-12)
    assert "Young's modulus 69000 MPa is 4.2% below 7075-T6's 72000 (paper: 69000 MPa" in text
    assert f"every K is +4.3%: {max(table):.4g} instead of {max(ours):.4g} N/mm" in text
    (difference,) = document["material_differences"]
    assert (difference["property"], difference["value"], difference["table"]) == (
        "youngs_modulus",
        69000,
        72000,
    )
    assert (
        real["material_differences"] == [] and "stiffness_factor" not in real and "own modulus" not in plain
    )


def sheet_notes(d):
    layout = Layout(d)
    return " ".join(notes_of(element(layout, layout.elements[0]), ())).lower()


def test_no_sheet_speaks_of_what_a_cutter_cannot_use():
    """Data that the model took instead of the material's own are told by `tactcad estimate` alone."""
    assert variant().differences
    assert sheet_notes(variant()) == sheet_notes(variant({"material.youngs_modulus": DROP}))


def of(name):
    return variant({"material.alloy": name, **{f"material.{key}": DROP for key in PROPERTIES}})


@pytest.mark.parametrize(
    ("name", "metal", "magnetic"),
    [("7075-T6", "aluminium", False), ("17-4PH-H900", "steel 17-4PH-H900", True)],
)
def test_notes_follow_the_material(name, metal, magnetic):
    d = of(name)
    notes = sheet_notes(d)
    assert "anti-electrolysis" in notes
    assert ("demagnetise" in notes) == magnetic
    readme = readme_bytes(ReleaseContents(d, [make_scene(d, "array")], (), (), False), ()).decode()
    assert ("pits without it" in " ".join(readme.split())) == (metal == "aluminium")
    assert array_supplies(Layout(d))[0].description.endswith(f"for {metal}")


def test_a_titanium_sheet_asks_for_the_general_wall():
    """The hinge's flag names the wall that this shop wants of a metal that is not aluminium."""
    shop = load_shop()
    for name, wall in (("7075-T6", shop.limits.wall_aluminium), ("Ti-6Al-4V-annealed", shop.limits.wall)):
        layout = Layout(of(name))
        (flag,) = [f for f in check_wirecut(element(layout, layout.elements[0]), shop) if f.check == "hinge"]
        assert flag.limit == wall


STEEL = "maraging-300-aged"


@pytest.mark.parametrize(
    "alloy, chuck, harm",
    [
        ("7075-T6", "a magnetic chuck does not hold it", "pits"),
        ("Ti-6Al-4V-annealed", "a magnetic chuck does not hold it", "discolours"),
        ("1.4310-C1300", "a magnetic chuck does not hold it", "corrodes"),
        (STEEL, "on a magnetic chuck, demagnetised afterwards", "corrodes"),
    ],
)
def test_what_its_magnetism_and_metal_ask_of_the_shop_stands_in_the_notes(alloy, chuck, harm):
    from tactcad.parts.array.clamp import stop_plate
    from tactcad.parts.array.element import spacer

    row = ALLOYS[alloy]
    own = ("youngs_modulus", "poisson", "density", "yield_strength", "fatigue_strength")
    layout = Layout(variant({"material.alloy": alloy, **{f"material.{n}": getattr(row, n) for n in own}}))
    notes = notes_of(spacer(layout), ())
    assert any(chuck in note for note in notes)
    assert f"Anti-electrolysis supply: without it {alloy} {harm}" in notes
    assert any("on a magnetic chuck, demagnetised" in note for note in stop_plate(layout).notes)


def test_of_a_sheet_of_unknown_magnetism_the_note_promises_nothing():
    from tactcad.parts.language.description import Material
    from tactcad.parts.language.stock import held_for_grinding

    assert held_for_grinding(Material("own", 5000.0)) == "on a magnetic chuck only if a magnet draws it"
