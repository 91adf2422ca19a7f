"""The printed schema against the loader: what one accepts the other does, at both ends of every range."""

from __future__ import annotations

import dataclasses
import json
import math
import re
import subprocess
import sys

import pytest
from variants import table, variant

from tactcad.design.family import all_families, family_of, section_types
from tactcad.design.load import from_table, names, read
from tactcad.design.messages import InputError
from tactcad.design.schema import json_schema, text_schema
from tactcad.design.tree import NO_TABLES, Design

FILE = json.loads(json.dumps(json_schema()))  # of whichever family
SCHEMA = FILE["anyOf"][list(all_families()).index("facing-rows")]


def complaints(value, schema, path="$") -> list[str]:
    """What a JSON Schema checker would say; knows just the words that our schema uses, and refuses others."""
    known = {
        "$schema",
        "title",
        "description",
        "default",
        "format",
        "type",
        "properties",
        "required",
        "additionalProperties",
        "patternProperties",
        "minimum",
        "maximum",
        "enum",
        "pattern",
        "items",
        "minItems",
        "maxItems",
    }
    assert set(schema) <= known, f"{path}: unknown words {set(schema) - known}"
    kinds = {"object": dict, "array": list, "string": str, "number": (int, float), "integer": (int, float)}
    whole = schema["type"] != "integer" or (isinstance(value, (int, float)) and value == int(value))
    if not isinstance(value, kinds[schema["type"]]) or isinstance(value, bool) or not whole:
        return [f"{path}: not a {schema['type']}"]
    found = []
    if schema["type"] in ("number", "integer"):
        if not schema.get("minimum", -math.inf) <= value <= schema.get("maximum", math.inf):
            found.append(f"{path}: out of range")
    elif schema["type"] == "string":
        if value not in schema.get("enum", [value]) or not re.search(schema.get("pattern", ""), value):
            found.append(f"{path}: not usable text")
    elif schema["type"] == "array":
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", math.inf):
            found.append(f"{path}: wrong length")
        found += [c for i, v in enumerate(value) for c in complaints(v, schema["items"], f"{path}[{i}]")]
    else:
        found += [f"{path}.{name}: missing" for name in schema.get("required", ()) if name not in value]
        for name, child in value.items():
            rule = schema.get("properties", {}).get(name)
            for pattern, other in schema.get("patternProperties", {}).items():
                rule = other if rule is None and re.search(pattern, name) else rule
            if rule is None:
                rule = schema.get("additionalProperties", True)
            if rule is False:
                found.append(f"{path}.{name}: unknown")
            elif rule is not True:
                found += complaints(child, rule, f"{path}.{name}")
    return found


def accepted(tree: dict) -> bool:
    try:
        from_table(tree)
    except InputError:
        return False
    return True


def spec_paths() -> list[str]:
    return [
        f"{section}.{f.name}"
        for section, kind in section_types(Design).items()
        if section != "origin"
        for f in dataclasses.fields(kind)
        if "spec" in f.metadata and f.name != "gaps"
    ]


def schema_of(path: str) -> dict:
    section, name = path.split(".")
    return SCHEMA["properties"][section]["properties"][name]


@pytest.mark.parametrize("name", names())
def test_the_shipped_designs_fit_the_schema(name):
    schemas = dict(zip(all_families(), FILE["anyOf"]))
    family = family_of(read(name)).name
    assert [f for f, schema in schemas.items() if complaints(table(base=name), schema) == []] == [family]


def test_the_checker_itself_sees_what_is_wrong():
    for changes, said in (
        ({"element.hinge_thicknes": 1}, "unknown"),
        ({"element.hinge_thickness": 0}, "out of range"),
        ({"element.hinge_thickness": True}, "not a number"),
        ({"design.name": "../x"}, "text"),
        ({"array.row_arms": [[4]] * 3}, "length"),
        ({"element.override.0": {}}, "unknown"),
        ({"stop.gaps": {"4": 99}}, "out of range"),
    ):
        assert said in complaints(table(changes), SCHEMA)[0]
    assert complaints({}, SCHEMA)[0].endswith("missing")


@pytest.mark.parametrize("path", [p for p in spec_paths() if schema_of(p)["type"] == "number"])
def test_ranges_in_the_schema_are_the_loaders(path):
    low, high = schema_of(path)["minimum"], schema_of(path)["maximum"]
    assert low < high
    own = {"material.alloy": "a label of its own"}  # whose values are bound by no table
    for value in (low, high, low + (high - low) / 3):
        assert accepted(table({path: value, **own})), value
        assert complaints(table({path: value, **own}), SCHEMA) == []
    for value in (math.nextafter(low, -math.inf), math.nextafter(high, math.inf)):
        assert not accepted(table({path: value, **own})), value
        assert complaints(table({path: value, **own}), SCHEMA)


@pytest.mark.parametrize("path", [p for p in spec_paths() if schema_of(p)["type"] == "integer"])
def test_whole_numbers_in_the_schema_are_the_loaders(path):
    low, high = schema_of(path)["minimum"], schema_of(path)["maximum"]
    for value in (low, high, float(low)):
        assert accepted(table({path: value})), value
        assert complaints(table({path: value}), SCHEMA) == []
    for value in (low - 1, high + 1, low + 0.5):
        assert not accepted(table({path: value})), value
        assert complaints(table({path: value}), SCHEMA)


@pytest.mark.parametrize("path", [p for p in spec_paths() if "enum" in schema_of(p)])
def test_choices_in_the_schema_are_the_loaders(path):
    for option in schema_of(path)["enum"]:
        assert accepted(table({path: option, "material.alloy": "a label of its own"}))
    assert not accepted(table({path: "something else"}))


@pytest.mark.parametrize(
    "path", ["design.name", "design.title", "design.revision", "design.date", "design.author"]
)
@pytest.mark.parametrize(
    "text",
    [
        "macro",
        "A",
        "AB",
        "2026-11-21",
        "",
        " ",
        "a b",
        "../x",
        "\u00e9",
        "a\nb",
        "a\u202eb",
        "x" * 81,
        "-a",
        "a-",
    ],
)
def test_text_is_legal_for_the_schema_as_for_the_loader(path, text):
    tree = table({path: text})
    assert accepted(tree) == (complaints(tree, SCHEMA) == [])


def test_defaults_in_the_schema_are_what_a_design_without_them_gets():
    checked = 0
    for path in spec_paths():
        section, name = path.split(".")
        if "default" in schema_of(path):
            bare = variant({}, base="soft-tissue")
            if getattr(bare, section) is None or name in table(base="soft-tissue").get(section, {}):
                continue
            got = getattr(getattr(bare, section), name)
            assert (list(got) if isinstance(got, tuple) else got) == schema_of(path)["default"], path
            checked += 1
    assert checked > 40


def test_every_table_and_field_stands_in_the_text_with_its_meaning():
    text = text_schema()
    for f in dataclasses.fields(Design):
        if f.name not in NO_TABLES:
            assert f"[{f.name}]" in text
    for path in spec_paths():
        section, name = path.split(".")
        block = text[text.index(f"[{section}]") :].split("\n\n")[0]
        line = next(line for line in block.splitlines() if line.split()[:1] == [name])
        assert len(line.split()) > 1, "no meaning"
    assert "[element.override.N]" in text and "[origin]" in text


def test_the_command_prints_both():
    for arguments, check in (([], text_schema().strip()), (["--json"], None)):
        run = subprocess.run(
            [sys.executable, "-m", "tactcad", "schema", *arguments],
            capture_output=True,
            text=True,
            check=True,
        )
        assert run.stdout.strip() == check if check else json.loads(run.stdout) == FILE
        assert run.stderr == ""
