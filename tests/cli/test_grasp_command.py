"""`tactcad grasp`: what it says is what was pressed, and what cannot be pressed is refused in one line."""

from __future__ import annotations

import json

import pytest

from tactcad.cli.main import main
from tactcad.contact.elastic_body import Body
from tactcad.contact.press import pad_stiffness

SOFT = "E=0.5,nu=0.49,thickness=6"


def pressed(capsys, *options: str) -> dict:
    assert main(["grasp", "--json", *options]) == 0
    return json.loads(capsys.readouterr().out)


def test_springs_give_back_the_objects_stiffness_for_every_pair(capsys):
    """Equation (3) inverts equation (2): K_obj of a single rigid pad on that layer."""
    done = pressed(capsys, "--object", SOFT, "--rung", "springs")
    assert done["object_stiffness"] == pytest.approx(pad_stiffness(Body(0.5, 0.49, 6.0), 2.0, 3.0))
    assert [p["by_springs"] for p in done["pairs"]] == pytest.approx(
        [done["object_stiffness"]] * len(done["pairs"])
    )


def test_a_layer_couples_the_pads(capsys):
    """Each force is K times the deflection within the pressure's shift along the pad, and they add up to the
    load; equation (3), which knows no coupling, misses the object's stiffness."""
    done = pressed(capsys, "--object", SOFT, "--load", "2")
    by_no = {e["no"]: e for e in done["elements"]}
    assert sum(e["force"] for e in by_no.values()) == pytest.approx(2.0)
    for e in by_no.values():
        assert e["touches"] and not e["stopped"]
        assert e["deflection"] * e["stiffness"] == pytest.approx(e["force"], rel=0.05)
    assert done["rung"] == "layer" and done["pairs"]
    assert any(abs(p["by_springs"] / done["object_stiffness"] - 1) > 0.2 for p in done["pairs"])


def test_an_inclined_face_presses_the_near_pads_and_leaves_the_far_ones(capsys):
    level, inclined = (
        pressed(capsys, "--object", SOFT, "--load", "1", "--angle", a)["elements"] for a in ("0,0", "0,4")
    )
    assert all(e["touches"] for e in level)
    assert 2 <= sum(e["touches"] for e in inclined) < 10


def test_stops_close_under_a_heavy_load(capsys):
    elements = pressed(capsys, "--object", "E=20,nu=0.49,thickness=6", "--load", "60")["elements"]
    stopped = [e for e in elements if e["stopped"]]
    assert stopped and sum(e["force"] for e in elements) == pytest.approx(60.0)


def test_the_picture_is_written_and_names_every_element(capsys, tmp_path):
    assert main(["grasp", "--object", SOFT, "--out", str(tmp_path / "p.svg")]) == 0
    text = (tmp_path / "p.svg").read_text()
    assert text.startswith("<svg") and "no. 10" in text  # matplotlib keeps a comment for each text
    assert "K_obj" in capsys.readouterr().out


@pytest.mark.parametrize(
    "options, words",
    [
        (("--object", "E=0.5,nu=0.49"), "lacks thickness"),
        (("--object", SOFT + ",E=1"), "twice"),
        (("--object", "E=0.5,mu=0.49,thickness=6"), "mu"),
        (("--object", "E=soft,nu=0.49,thickness=6"), "not a number"),
        (("--object", "E=0.5,nu=0.6,thickness=6"), "from 0 to 0.5"),
        (("--object", "E=0.5,nu=0.49,thickness=0.1"), "at least 0.612 mm"),
        (("--object", SOFT, "--load", "-1"), "above 0 N"),
        (("--object", SOFT, "--angle", "1"), "two numbers are wanted"),
        (("--object", SOFT, "--angle", "0,80"), "from -30 to 30"),
        (("--object", SOFT, "--angle", "20,20", "--load", "0.01"), "1 of 10 pads"),
        (("--object", "E=0.5,nu=0.5,thickness=6", "--rung", "fem-object"), "rung layer reaches 0.5"),
        (("--object", "E=0.5,nu=0.5,thickness=6", "--rung", "large"), "rung layer reaches 0.5"),
        (("--object", "E=0.5,nu=0.49,thickness=inf", "--rung", "fem-object"), "layer reaches the half-space"),
        (("--object", "E=0.005,nu=0.49,thickness=6"), "rung large reaches 0.5"),
        (("--object", "E=0.005,nu=0.49,thickness=6", "--rung", "large"), "no rung reaches that"),
        (("--object", SOFT, "--rung", "springs", "--out", "p.svg"), "no pressure"),
    ],
)
def test_what_cannot_be_pressed_is_refused_in_one_line(capsys, options, words):
    assert main(["grasp", *options]) == 2
    said = capsys.readouterr()
    assert words in said.err and said.err.count("\n") == 1 and not said.out


def test_the_cheapest_rung_that_keeps_an_error_is_taken(capsys):
    """Separate springs keep next to nothing; the layer does, and where it is pressed deep, large strain. A
    rung by name that does not keep what is asked is refused."""
    for options, rung in (
        (("--object", "E=2000,nu=0.3,thickness=6", "--within", "95%"), "springs"),
        (("--object", "E=20,nu=0.3,thickness=6", "--load", "0.5", "--within", "5%"), "layer"),
        (("--object", "E=0.1,nu=0.3,thickness=6", "--load", "0.5", "--within", "2%"), "large"),
    ):
        done = pressed(capsys, *options)
        assert done["rung"] == rung and done["expected_error"] < 0.95
    assert main(["grasp", "--object", SOFT, "--within", "1%", "--rung", "springs"]) == 1
    said = capsys.readouterr()
    assert "the best of springs" in said.err and said.err.count("\n") == 1 and not said.out
    assert main(["grasp", "--object", SOFT, "--within", "0.01%"]) == 1
    assert "no rung" in capsys.readouterr().err
