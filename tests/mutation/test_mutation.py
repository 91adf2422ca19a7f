"""The table of mutations is complete, each changes something and has tests; that one fails for each is
tests/night.py's."""

from __future__ import annotations

import ast

import mutants
import pytest


def test_every_check_is_in_the_table():
    """What reports, what refuses a design and what reads a file back: all of it has a mutation, and each has
    tests."""
    every = mutants.every()
    labels = [m.label for m in every]
    assert len(set(labels)) == len(labels)
    assert not mutants.unknown_gates()

    from tactcad.design.family import all_families
    from tactcad.scenes.rig import all_rigs

    in_table = {m.name for m in every if m.kind == "rule"}
    wanted: set[str] = set()
    for family in all_families().values():
        wanted |= {*family.rules(), *(r.name for rig in all_rigs(family.spec).values() for r in rig.rules)}
    assert in_table == wanted
    modules = {m.module for m in every if m.kind == "finding"}
    for path in mutants.checking():
        module = path.relative_to(mutants.SOURCE / "tactcad").as_posix()
        calls = [n for n in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(n, ast.Call)]
        makes = mutants.PASS_ON.intersection(ast.unparse(call.func).rpartition(".")[2] for call in calls)
        handed_on = path.name == "check_report.py"  # what others found
        assert (module in modules) == bool(makes and not handed_on), module
    assert not [m.label for m in every if not mutants.tests_of(m)]


@pytest.mark.slow  # writes the source of every mutant
def test_every_mutant_is_another_program():
    for mutant in mutants.every():
        mutant.source()


def test_a_name_that_cannot_be_told_is_noticed():
    """A finding whose name is put together at run time has to be spelt out in the table."""
    tree = ast.parse("def check(part):\n    yield Finding('new-' + part.kind, 'fail')")
    with pytest.raises(AssertionError, match="add it to SPELT_OUT"):
        mutants.names_of_findings("checks/new.py", tree)
