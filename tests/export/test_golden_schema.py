"""Every way in which a golden file can be no golden file, on a shipped one with one value spoiled."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import pytest

from tactcad.export.golden_file import faults

RECORD = json.loads((Path(__file__).parents[2] / "exports" / "golden" / "soft-tissue.json").read_text())
PART = next(iter(RECORD["parts"]))
DROP = object()


def spoilt(path: tuple[str, ...], value: object) -> dict:
    record = copy.deepcopy(RECORD)
    node = record
    for key in path[:-1]:
        node = node[key]
    if value is DROP:
        del node[path[-1]]
    else:
        node[path[-1]] = value
    return record


def test_the_shipped_one_has_no_fault():
    assert faults(RECORD, RECORD["schema"]) == ""


@pytest.mark.parametrize(
    "path, value, said",
    [
        (("schema",), "another", "its schema is not"),
        (("design",), 3, "no design or no revision"),
        (("revision",), DROP, "no design or no revision"),
        (("parts",), [], "parts is no table of tables"),
        (("elements",), {"1": 2}, "elements is no table of tables"),
        (("remarks",), {}, "'remarks' is not known"),
        (("parts", PART, "process"), DROP, f"part {PART}: it has no process"),
        (("parts", PART, "holes"), {"h": {"at": {"x": 1}}}, f"part {PART}: holes is no table of plain rows"),
        (("parts", PART, "limits"), DROP, f"part {PART}: limits is no table of plain rows"),
        (("parts", PART, "contours"), DROP, f"part {PART}: it has no contours"),
        (("parts", PART, "contours"), [[]], f"part {PART}: a contour is no list of rows of numbers"),
        (("parts", PART, "contours"), [[["a", 1]]], f"part {PART}: a contour is no list of rows of numbers"),
        (("parts", PART, "contours"), [[[0.0, 0.0, 1.0]]], f"part {PART}: a contour cannot be read"),
        (("parts", PART, "volume"), {"mm3": 1}, f"part {PART}: it holds more than plain values"),
        (("scenes", "array", "placed"), DROP, "scene array: has other tables than placed and bom"),
        (("scenes", "array", "more"), {}, "scene array: has other tables than placed and bom"),
        (("scenes", "array", "bom"), {"1": {"qty": {}}}, "scene array: a row holds more than plain values"),
        (("elements", "1"), {"K": {}}, "element 1: holds more than plain values"),
    ],
)
def test_one_spoilt_value_is_named(path, value, said):
    assert said in faults(spoilt(path, value), RECORD["schema"])


def test_what_is_no_table_is_no_record():
    assert "its schema is not" in faults([RECORD], RECORD["schema"])
