"""What is said of an element that the estimator does not reach: the design's own fields, and no figure."""

from __future__ import annotations

import csv
import io

import pytest
from variants import variant

from tactcad.cli.main import main
from tactcad.design.design_text import design_text
from tactcad.design.load import paths
from tactcad.export.strength_table import strength_bytes
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import PATHS
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import overloads

DEEP = variant({"element.body_height": 20.0})  # L/Hb of the short arms is beyond the fit
OWN = variant({"element.override.3.fillet_radius": 0.02})


def rows(design) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(strength_bytes(Layout(design)).decode(), newline="")))


def test_the_fields_are_the_design_s():
    assert set(PATHS.values()) <= set(paths(variant()))


@pytest.mark.parametrize(
    "design, element_no, named",
    [
        (DEEP, 1, "array.row_arms: load_arm 3, element.body_height: body_height 20"),
        (OWN, 3, "element.override.3.fillet_radius: fillet_radius 0.02, element.hinge_thickness: "),
    ],
)
def test_a_blank_row_says_which_fields_with_their_values(design, element_no, named):
    row = rows(design)[element_no - 1]
    assert named in row["not_known_because"] and row["stiffness_N_per_mm"] == ""
    assert overloads(Layout(design))[element_no - 1].refused == row["not_known_because"]


def test_the_command_names_them_too(tmp_path, capsys):
    (tmp_path / "deep.toml").write_text(design_text(OWN))
    assert main(["estimate", str(tmp_path / "deep.toml")]) == 1
    err = capsys.readouterr().err
    assert (
        "element 3: r/t is outside" in err and "element.override.3.fillet_radius: fillet_radius 0.02" in err
    )


@pytest.mark.parametrize("design", [DEEP, OWN, variant()])
def test_a_sheet_says_that_a_gap_is_not_rated_just_where_the_row_is_blank(design):
    layout = Layout(design)
    for place, row in zip(layout.elements, rows(design)):
        notes = [note for note in element(layout, place).notes if "stop gap not rated" in note]
        assert bool(notes) == bool(row["not_known_because"]) == (row["rated_force_N"] == "")
        assert all(row["not_known_because"] in note for note in notes)


def test_a_gap_that_the_design_states_is_its_own():
    given = variant({"element.override.3.fillet_radius": 0.02, "stop.gaps": {"6": 0.1}})
    layout = Layout(given)
    assert not [n for n in element(layout, layout.elements[2]).notes if "not rated" in n]
