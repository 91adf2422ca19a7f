"""Every placed part is on the bill once, with its designators, and what is written reads back."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace

import pytest

from tactcad.contour import circle, rectangle
from tactcad.design.tree import Identity
from tactcad.parts.bought.electronic_parts import Supply
from tactcad.parts.language.description import Extrusion, Material, Part, Purchase
from tactcad.scenes.bom import (
    COLUMNS,
    bom_rows,
    check_bom,
    csv_bytes,
    incomplete,
    json_bytes,
    rows_from_csv,
    rows_from_json,
)
from tactcad.scenes.scene import Placement, Scene

# The columns that fabrication practice asks for, in its order, then ours.
ASKED = [
    "item",
    "part_no",
    "rev",
    "qty",
    "unit",
    "description",
    "make_buy",
    "material",
    "process",
    "finish",
    "standard_designation",
    "manufacturer",
    "mpn",
    "supplier",
    "alternates",
    "spares",
    "consumable",
    "file",
    "sha256",
    "mass_g",
    "source_verified",
    "designators",
    "has_solid",
]

BLOCK = Part(
    "X-a4",
    'block, 4 "wide"',
    "wire-cut",
    Material("7075", 2810.0, "T6"),
    Extrusion(rectangle(0, 0, 20, 10), 3.0),
)
PIN = Part(
    "ISO8734-3x30",
    "Dowel pin 3x30",
    "bought",
    Material("steel", 7850.0),
    Extrusion(circle((0, 0), 3), 30.0),
    purchase=Purchase("ISO 8734 3 m6 x 30 - A - St", alternates="DIN 6325", source_verified=True),
    spares=1,
)
GLUE = Supply("ADHESIVE", "gauge adhesive, kalthärtend", 1, "pack", "cyanoacrylate")
WIRE = Supply("WIRE", "lead wire", 1.5, "m", "AWG 36")
SCENE = Scene(
    "array",
    (Placement("DW1", PIN), Placement("E1", BLOCK), Placement("E2", BLOCK), Placement("DW2", PIN)),
    supplies=(GLUE, WIRE),
)
FILES = {"X-a4": ("dxf/X-a4.dxf", "ab" * 32)}
ISSUED = Identity("macro", "B", "2026-01-01")
ROWS = bom_rows(SCENE, ISSUED, FILES)


def written(rows) -> tuple[bytes, bytes]:
    return csv_bytes(rows), json_bytes(rows, "macro", "B", "array")


def test_columns_are_those_asked_for():
    assert list(COLUMNS) == ASKED


def test_lines_quantities_and_designators():
    assert [(r.item, r.part_no, r.qty, r.designators, r.has_solid) for r in ROWS] == [
        (1, "X-a4", 2, "E1 E2", True),
        (2, "ISO8734-3x30", 2, "DW1 DW2", True),
        (3, "ADHESIVE", 1, "", False),
        (4, "WIRE", 1.5, "", False),
    ]
    assert sum(r.qty for r in ROWS if r.has_solid) == len(SCENE.placements)


def test_made_and_bought_lines_say_what_a_buyer_needs():
    made, bought, *supplies = ROWS
    assert (made.make_buy, made.rev, made.file, made.sha256) == ("make", "B", *FILES["X-a4"])
    assert made.mass_g == pytest.approx(600 * 2.81e-3)
    assert made.material == "7075 T6"
    assert (bought.make_buy, bought.rev, bought.spares, bought.source_verified) == ("buy", "", 1, True)
    assert bought.standard_designation == "ISO 8734 3 m6 x 30 - A - St"
    assert all(row.consumable and not row.source_verified for row in supplies)


def test_both_files_read_back_to_the_rows():
    as_csv, as_json = written(ROWS)
    assert rows_from_csv(as_csv) == ROWS
    assert rows_from_json(as_json) == ROWS
    assert check_bom(SCENE, as_csv, as_json) == []


def test_the_files_by_other_readers():
    as_csv, as_json = written(ROWS)
    table = list(csv.DictReader(io.StringIO(as_csv.decode("utf-8"))))
    assert table[0]["description"] == 'block, 4 "wide"'
    assert table[2]["description"] == "gauge adhesive, kalthärtend"
    assert [row["has_solid"] for row in table] == ["true", "true", "false", "false"]
    assert [row["source_verified"] for row in table] == ["false", "true", "unread", "unread"]  # made, bought
    record = json.loads(as_json)
    assert (record["design"], record["revision"], record["scene"]) == ("macro", "B", "array")
    assert record["rows"][2]["mass_g"] is None


@pytest.mark.parametrize(
    ("spoiled", "expected"),
    [
        (ROWS[1:], {"the designators are not those of the scene", "2 solids instead of 4"}),
        (
            ROWS + ROWS[:1],
            {"the designators are not those of the scene", "6 solids instead of 4", "X-a4 is on two lines"},
        ),
        (
            (replace(ROWS[0], qty=3), *ROWS[1:]),
            {"X-a4: quantity 3 with designators 'E1 E2'", "5 solids instead of 4"},
        ),
        (
            (replace(ROWS[0], designators="E1"), *ROWS[1:]),
            {"the designators are not those of the scene", "X-a4: quantity 2 with designators 'E1'"},
        ),
        ((replace(ROWS[0], designators="E1 E3"), *ROWS[1:]), {"the designators are not those of the scene"}),
        (
            (replace(ROWS[0], has_solid=False), *ROWS[1:]),
            {"the designators are not those of the scene", "2 solids instead of 4"},
        ),
        (
            (*ROWS[:-1], replace(ROWS[-1], designators="A1-R1")),
            {f"{ROWS[-1].part_no}: quantity {ROWS[-1].qty} with designators 'A1-R1'"},
        ),
        (
            (ROWS[0], replace(ROWS[1], standard_designation=""), *ROWS[2:]),
            {f"{ROWS[1].part_no}: neither a standard designation nor a maker's number"},
        ),
        ((replace(ROWS[0], material=""), *ROWS[1:]), {"X-a4: no material"}),
    ],
)
def test_a_bill_that_is_not_the_scenes_is_seen(spoiled, expected):
    assert set(check_bom(SCENE, *written(spoiled))) == expected


def test_bills_that_differ_or_are_damaged_are_seen():
    as_csv, as_json = written(ROWS)
    assert check_bom(SCENE, csv_bytes((replace(ROWS[0], finish="x"), *ROWS[1:])), as_json) == [
        "CSV and JSON differ"
    ]
    for damaged in ((as_csv[:-20], as_json), (as_csv, as_json[:-20]), (b"", b"{}")):
        (said,) = check_bom(SCENE, *damaged)
        assert said.startswith("not readable as a bill of materials: ")


@pytest.mark.parametrize(
    "designation, complete",
    [
        ("ISO 4762 M3x10 A2-70", True),
        ("ISO 4762 M3x10 - 12.9", True),
        ("ISO 4762 M3x10", False),
        ("ISO 4026 M3x6 A2-21H", True),
        ("ISO 4026 M3x6", False),
        ("ISO 15 623-2Z", True),
        ("ISO 15 623", False),
        ("ISO 7089 3 A2", True),
        ("", False),
    ],
)
def test_designations_that_cannot_be_ordered(designation, complete):
    assert (not incomplete(replace(ROWS[1], standard_designation=designation))) == complete
