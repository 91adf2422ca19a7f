"""Digests are the same everywhere and differ for every difference; reasons are told in words."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass, replace
from math import nextafter

import pytest

from tactcad.contour import rectangle
from tactcad.export import inputs
from tactcad.export.inputs import (
    Inputs,
    digest,
    first_installed,
    flattened,
    inputs_from_json,
    inputs_of,
    library_versions,
    reasons,
    source_digest,
)
from tactcad.parts.language.description import Extrusion, Hole, Material, Part
from tactcad.scenes.scene import Placement, Scene

PART = Part(
    "E-4",
    "element",
    "wire-cut",
    Material("aluminium", 2810.0),
    Extrusion(rectangle(0, 0, 20, 8), 3.0),
    features=(Hole("h", (1.0, 1.0, 0.0), (0.0, 0.0, 1.0), 3.4, 3.0, True),),
)

WORDS = frozenset({"element", "key", "gauge", "wire", "slot"})  # its order depends on the hash seed

FRESH = """
from test_inputs import PART, WORDS
from tactcad.export.inputs import digest
print(digest((PART, WORDS)))
"""


@pytest.mark.parametrize("seed", ["0", "1", "77"])
def test_equal_in_fresh_processes_under_other_hash_seeds(seed):
    here = os.path.dirname(__file__)
    environment = {**os.environ, "PYTHONHASHSEED": seed}
    run = subprocess.run(
        [sys.executable, "-c", FRESH], cwd=here, env=environment, capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == digest((PART, WORDS))


@pytest.mark.parametrize(
    "other",
    [
        replace(PART, name="Element"),
        replace(PART, spares=1),
        replace(PART, features=()),
        replace(PART, body=Extrusion(rectangle(0, 0, 20, nextafter(8, 9)), 3.0)),
        replace(PART, body=Extrusion(rectangle(0, 0, 20, 8), 3)),
    ],
)
def test_every_difference_counts(other):
    assert digest(other) != digest(PART)


def test_an_equal_value_built_anew_has_the_same_digest():
    assert digest(replace(PART, body=Extrusion(rectangle(0, 0, 20, 8), 3.0))) == digest(PART)


@pytest.mark.parametrize(
    "a, b",
    [
        (("ab", "c"), ("a", "bc")),
        ((1, (2,)), ((1, 2),)),
        ((), ((),)),
        (1, 1.0),
        (1, True),
        (0.0, -0.0),
        ("1", 1),
        (None, "None"),
        ({"a": 1, "b": 2}, {"a": 2, "b": 1}),
        ({"a"}, ("a",)),
    ],
)
def test_no_two_values_share_an_encoding(a, b):
    assert digest(a) != digest(b)


def test_order_of_sets_and_dicts_does_not_count():
    assert digest({"a": 1, "b": 2}) == digest({"b": 2, "a": 1})
    assert digest({"x", "y", "z"}) == digest({"z", "y", "x"})


def test_what_has_no_stable_form_is_refused():
    with pytest.raises(TypeError, match="object"):
        digest((1, object()))


def test_a_thousand_placements_cost_one_part():
    many = Scene("array", tuple(Placement(f"E{i}", PART, (0.0, 4.0 * i, 0.0)) for i in range(1000)))
    assert digest(many) == digest(replace(many))
    assert digest(many) != digest(Scene("array", many.placements[:-1]))


def test_source_digest_follows_content_and_names(tmp_path, monkeypatch):
    monkeypatch.setattr(inputs, "PACKAGE", tmp_path)
    room = tmp_path / "parts"
    room.mkdir()
    (room / "a.py").write_text("x = 1")
    seen = {source_digest("parts")}
    (room / "a.py").write_text("x = 2")
    seen.add(source_digest("parts"))
    (room / "a.py").rename(room / "b.py")
    seen.add(source_digest("parts"))
    (room / "data.toml").write_text("x = 2")
    seen.add(source_digest("parts"))
    assert len(seen) == 4
    (room / "__pycache__").mkdir()
    (room / "__pycache__" / "b.cpython-311.pyc").write_bytes(b"0")
    assert source_digest("parts") in seen
    with pytest.raises(FileNotFoundError):
        source_digest("no such room")


def test_versions_of_what_is_installed_and_what_is_not():
    versions = library_versions(["numpy", "no-such-library"])
    import numpy

    assert versions["numpy"] == numpy.__version__
    assert versions["no-such-library"] == "(absent)"
    assert versions["python"] == sys.version.split()[0]


def test_of_bindings_that_stand_for_each_other_the_installed_one_is_named(monkeypatch):
    def version(name):
        if name != "cadquery-ocp-novtk":
            raise inputs.metadata.PackageNotFoundError(name)
        return "7.9.3.1"

    assert (
        first_installed("cadquery-ocp", "cadquery-ocp-novtk") == "cadquery-ocp"
    )  # the stand-in comes second
    monkeypatch.setattr(inputs.metadata, "version", version)
    assert first_installed("cadquery-ocp", "cadquery-ocp-novtk") == "cadquery-ocp-novtk"
    assert library_versions(["cadquery-ocp-novtk"])["cadquery-ocp-novtk"] == "7.9.3.1"
    assert first_installed("no-such", "nor-this") == "no-such"


@dataclass(frozen=True)
class Element:
    hinge_thickness: float
    sides: str = "one"


@dataclass(frozen=True)
class Design:
    element: Element
    row_arms: tuple[tuple[float, ...], ...]
    override: dict


DESIGN = Design(Element(0.25), ((4.0, 7.0), (8.0,)), {"3": Element(0.3)})


def test_flattened_paths():
    assert flattened(DESIGN) == {
        "element.hinge_thickness": 0.25,
        "element.sides": "one",
        "row_arms[0][0]": 4.0,
        "row_arms[0][1]": 7.0,
        "row_arms[1][0]": 8.0,
        "override.3.hinge_thickness": 0.3,
        "override.3.sides": "one",
    }


def test_reasons_in_words():
    before = Inputs(flattened(DESIGN), {"parts": "aa", "": "cc"}, {"build123d": "0.12.0", "numpy": "2.4.6"})
    now = Inputs(
        flattened(replace(DESIGN, element=Element(0.26), row_arms=((4.0, 7.0), (8.0, 5.5)))),
        {"parts": "bb", "": "dd"},
        {"build123d": "0.13.0", "numpy": "2.4.6"},
    )
    assert reasons(before, now) == [
        "element.hinge_thickness changed 0.25 -> 0.26",
        "row_arms[1][1] changed (absent) -> 5.5",
        "source of tactcad.parts changed",
        "source of tactcad changed",
        "build123d 0.12.0 -> 0.13.0",
    ]
    assert "row_arms[1][1] changed 5.5 -> (absent)" in reasons(now, before)
    assert reasons(None, now) == ["there is no record of an earlier export"]


def test_a_record_survives_its_file():
    now = inputs_of(DESIGN, ["contour", "parts"], ["numpy"])
    back = inputs_from_json(json.loads(json.dumps(now.as_json())))
    assert reasons(back, now) == []
    assert back.key == now.key


@pytest.mark.parametrize(
    "record", [None, 3, [], {}, {"values": {}}, {"values": 1, "sources": {}, "libraries": {}}]
)
def test_a_record_that_cannot_be_understood(record):
    assert inputs_from_json(record) is None
