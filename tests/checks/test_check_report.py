"""Reports for machines read back with other readers, and the command over several designs."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest
from variants import TINY_TEXT

from tactcad.checks.check_report import Report, failure_table, json_bytes, junit_bytes
from tactcad.cli.main import main
from tactcad.design.messages import CheckFailure
from tactcad.parts.language.finding import Finding


def report() -> Report:
    made = Report("d", "A")
    part, scene = SimpleNamespace(part_no="d-plate"), SimpleNamespace(name="array")
    bad = Finding("web", "fail", "d-plate", (1.0, 2.0), 0.1, 0.5, 'web of 0.1 mm < 0.5 mm & "thin" <here>')
    worse = Finding("overlap", "fail", "S1", (), 3.0, 0.0, "S1 and S2 overlap")
    note = Finding("hinge", "flag", "d-plate", (), 0.1, 0.5, "quote it")
    made.run("wire-cut", lambda p: [bad, note], part)
    made.run("wire-cut", lambda p: [], SimpleNamespace(part_no="d-spacer"))
    made.run("interference", lambda s: [worse], scene)
    return made


def test_junit_has_a_case_for_every_check_and_every_failure():
    root = ElementTree.fromstring(junit_bytes([report(), Report("e", "A")]))
    suite, empty = root.findall("testsuite")
    assert (suite.get("tests"), suite.get("failures"), empty.get("tests")) == ("3", "2", "0")
    cases = {(c.get("classname"), c.get("name")): c for c in suite}
    assert set(cases) == {("d.wire-cut", "d-plate"), ("d.wire-cut", "d-spacer"), ("d.interference", "array")}
    bad = cases["d.wire-cut", "d-plate"]
    assert bad.find("failure").get("message") == 'web of 0.1 mm < 0.5 mm & "thin" <here>'
    assert "quote it" in bad.find("system-out").text
    assert cases["d.wire-cut", "d-spacer"].find("failure") is None


def test_a_check_that_yields_is_taken_at_its_word_and_its_refusal_is_a_flag():
    """What stops the estimator halfway stops it inside the check, not when the report is read."""

    def stops(part):
        yield Finding("web", "fail", part.part_no, (), 0.1, 0.5, "thin")
        raise CheckFailure("beyond the fit")

    made = Report("d", "A")
    made.run("web", stops, SimpleNamespace(part_no="d-plate"))
    (finding,) = made.findings
    assert (finding.severity, finding.message) == ("flag", "not checked: beyond the fit")


def test_json_and_table_name_every_failure():
    record = json.loads(json_bytes([report(), Report("e", "A")]))
    assert record["passed"] is False
    first, second = record["designs"]
    assert (first["passed"], second["passed"]) == (False, True)
    assert first["runs"] == {"wire-cut": 2, "interference": 1}
    head, _, *rows = failure_table([report()])
    assert head.split()[:3] == ["design", "part", "check"]
    assert [row.split()[:3] for row in rows] == [["d", "d-plate", "web"], ["d", "S1", "overlap"]]
    assert failure_table([Report("e", "A")]) == []


@pytest.mark.cad
def test_all_designs_are_checked_though_one_is_refused(tmp_path, capsys):
    refused = tmp_path / "refused.toml"
    refused.write_text("[design]\nname = 1\n")
    folder = tmp_path / "report"
    (tmp_path / "tiny.toml").write_text(TINY_TEXT, "utf-8")
    status = main(["check", str(refused), str(tmp_path / "tiny.toml"), "--report", str(folder)])
    out = capsys.readouterr().out
    assert status == 1
    assert "design.name" in out
    first, second = json.loads((folder / "check.json").read_bytes())["designs"]
    assert (
        not first["passed"] and second["passed"] and second["runs"]["interference"] == 3
    )  # array, setting, wiring
    suites = ElementTree.parse(folder / "junit.xml").getroot().findall("testsuite")
    assert [s.get("failures") for s in suites] == ["1", "0"]


def test_one_design_alone_that_is_refused_is_bad_input(tmp_path, capsys):
    refused = tmp_path / "refused.toml"
    refused.write_text("[design]\nname = 1\n")
    assert main(["check", str(refused)]) == 2
    assert "design.name" in capsys.readouterr().err


def test_every_check_runs_on_every_part_and_scene_that_it_is_for(macro, monkeypatch):
    """Which checks `tactcad check` calls, and on what, with every check and the kernel's work replaced by a
    note of the call; what a search for designs is limited by is those of them that need no solid."""
    from tactcad.checks import check, run
    from tactcad.scenes import make_scene, scene_names
    from tactcad.scenes.rig import poses

    calls = set()

    def noted(c):
        def find(subject, _):
            calls.add((c.name, getattr(subject, "part_no", None) or subject.name))
            return []

        return replace(c, run=find)

    known = {
        folder: tuple(map(noted, check.declared(folder)))
        for folder in ("described", "tactcad.checks.facing_rows", "on_solids")
    }
    for module in (check, run):
        monkeypatch.setattr(module, "declared", known.__getitem__)
    monkeypatch.setattr(run, "build", lambda part: SimpleNamespace(wrapped=part))
    names = scene_names(macro)
    report = run.run_checks(macro, names)
    scenes = [make_scene(macro, name) for name in names]
    posed = [make_scene(macro, name, pose) for name in names for pose in poses(macro, name)]
    parts = {p.part_no: p for s in scenes for p in s.parts}
    assert len(scenes) == 7 and len(posed) > 10
    of_design = (
        "strength",
        "fatigue",
        "clearance",
        "rigidity",
        "assembly",
        "circuit",
        "signals",
        "gauge limits",
    )
    expected = {(name, macro.name) for name in of_design}
    for number, part in parts.items():
        expected |= {("brep", number), ("step", number), ("mesh", number)}
        expected |= {("wire-cut", number)} if part.process == "wire-cut" else set()
        expected |= {("machining", number)} if part.process in ("milled", "turned", "ground") else set()
    expected |= {(name, s.name) for name in ("interference", "tools", "steps") for s in scenes}
    expected |= {("motion", s.name) for s in scenes if s.motions}
    expected |= {("configurations", s.name) for s in posed}
    assert report.runs["calibration travel"] == report.runs["moving weight"] == 1
    assert calls == expected
    calls.clear()
    assert check.quick_failures(macro) == check.slow_failures(macro) == []
    quick = {c.name for c in (*known["described"], *known["tactcad.checks.facing_rows"])}
    assert calls == {(name, subject) for name, subject in expected if name in quick}
    assert report.runs["configurations"] == len(posed) and report.runs["interference"] == len(scenes)
    assert report.runs["build"] == len(parts | {p.part_no: p for s in posed for p in s.parts})
    assert report.runs["scenes left out"] == 1


def test_a_scene_that_the_design_cannot_have_is_flagged_with_the_rule():
    from variants import variant

    from tactcad.checks.run import _left_out

    (finding,) = _left_out(variant({"grasping.moving_weight": 2.74}))
    assert (finding.check, finding.severity) == ("scene", "flag")
    assert "scene grasping left out: rule ballast_trims_moving_weight" in finding.message
