"""Matrices, forces and K_obj from simulated readings: noise, set-ups, tilted magnets, neighbours."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import cell_labs
import cell_oracle
import numpy as np
import pytest
from cell_labs import Errors
from lab.layer_labs import Bench
from scipy.stats import binom

from tactcad.cli.main import main
from tactcad.contact.elastic_body import Body
from tactcad.contact.press import PadsOnBody, pad_stiffness
from tactcad.families.planar import cell_calibration, cell_grasp, cell_matrices, cell_pads, cell_response
from tactcad.families.planar.cell_layout import PlanarLayout
from tactcad.families.planar.sensor import chip_matrix
from tactcad.lab import grasp
from tactcad.lab.calibration_file import Sensitivity
from tactcad.lab.layer_fit import fit
from tactcad.lab.pads import layers
from tactcad.lab.readings import GraspReadings
from tactcad.parts.rules import load

PLANAR = Path(__file__).parents[3] / "hardware" / "planar-array.toml"
LOADS = np.linspace(0.1, 0.5, 5)


@cache
def small(rows: int = 2, columns: int = 2) -> PlanarLayout:
    design = load(str(PLANAR))
    return PlanarLayout(replace(design, planar=replace(design.planar, rows=rows, columns=columns)))


@cache
def lab(seed: int = 3) -> cell_labs.Lab:
    return cell_labs.made(small(), np.random.default_rng(seed))


def calibrated(tmp_path, rng, made, errors, runs=4, sinks=False):
    file = tmp_path / "calibration.csv"
    file.write_text(cell_labs.calibration_csv(made, rng, errors, 0.3, runs, sinks))
    return cell_calibration.calibrate(made.layout, file, 0.95)


def known_of(tmp_path, cells):
    (tmp_path / "cal.csv").write_text(cell_matrices.to_csv(cells))
    return cell_matrices.read_matrices(str(tmp_path / "cal.csv"))


def test_the_simulator_and_the_program_agree_on_a_perfect_array():
    """Loops of current against discs of charge; bends within what first-order turns leave at eight tenths of
    the soft cells' rated force."""
    perfect = cell_labs.made(small(), np.random.default_rng(0), spread=0.0)
    every = cell_response.neighbours(small(), small().elements).reshape(4, 3, 4, 3)
    for i, e in enumerate(small().elements):
        own = perfect.straight[i, :, i]
        assert own == pytest.approx(chip_matrix(small(), e.kind) * [1, 1, -1], abs=1e-4 * np.abs(own).max())
        force = np.zeros((1, 4, 3))
        force[0, i] = (0.047, -0.028, 0.282)
        off = perfect.fields(force)[0, i] - perfect.rest[i] - own @ force[0, i]
        assert off == pytest.approx(cell_response.bend(small(), e.kind, force[0, i : i + 1])[0], abs=0.02)
        for j in range(4):
            if i != j:
                limit = 2e-4 * np.abs(perfect.straight[i, :, j]).max()
                assert perfect.straight[i, :, j] == pytest.approx(every[i, :, j], abs=limit)


def test_without_errors_matrix_and_forces_come_back(tmp_path):
    """Magnets are tilted and off their places all the same."""
    made, rng = lab(), np.random.default_rng(1)
    none = Errors((0.0, 0.0, 0.0), 0.0, 0.0, 0.0)
    cells = calibrated(tmp_path, rng, made, none, runs=2, sinks=True)
    for i, c in enumerate(cells):
        assert c.matrix == pytest.approx(chords(made)[i], abs=1e-3 * np.abs(c.matrix).max())
        assert c.stiffness == pytest.approx(made.stiffness[i], rel=2e-3)
    known = known_of(tmp_path, cells)
    force = np.stack(
        [
            0.03 * LOADS[:, None] * [1, -1, 2, 0],
            -0.02 * LOADS[:, None] * [1, 1, 1, 3],
            cell_labs.pressed(made, LOADS, 3.0),
        ],
        axis=-1,
    )
    (tmp_path / "grasp.csv").write_text(cell_labs.grasp_csv(made, rng, none, LOADS, force))
    (read,) = cell_grasp.fields(small(), tmp_path / "grasp.csv")
    found = cell_grasp.forces(small(), read, known, 0.95)
    assert found.force.swapaxes(0, 1) == pytest.approx(force, abs=2e-3)


def chords(made) -> np.ndarray:
    """Each cell's field by the largest load along each axis over that load, without the design's bend."""
    out = np.empty((4, 3, 3))
    for i, e in enumerate(made.layout.elements):
        for k, full in enumerate((0.12, 0.12, 0.3)):
            force = np.zeros((4, 3))
            force[i, k] = full
            change = (made.fields(force) - made.rest)[i]
            out[i, :, k] = (change - cell_response.bend(made.layout, e.kind, force[i : i + 1])[0]) / full
    return out


def covered(tmp_path, draws: int, errors: Errors, arrays: int = 1, seed: int = 11) -> dict[str, float]:
    """Shares of intervals that hold the truth, and the largest median, of any cell, of their half-widths over
    those of an estimator that knows the nuisances' laws; every array has magnets and beams of its own."""
    rng, bows = np.random.default_rng(seed), cell_oracle.law_of_bows(small(), 5, 4)
    hits: dict[str, list] = {"matrix": [], "force": [], "pair": []}
    over: dict[str, list] = {"force over ideal": [], "pair over ideal": []}
    for number in range(arrays):
        made = lab(3 + number)
        force, truth = np.zeros((len(LOADS), 4, 3)), chords(made)
        force[..., 2] = cell_labs.pressed(made, LOADS, 3.0)
        force[..., 0], force[..., 1] = 0.1 * force[..., 2], -0.05 * force[..., 2]
        ideal = cell_oracle.of_forces(made, errors, 0.3, bows, force)
        ideal_pair = cell_oracle.of_object(made, errors, 0.3, bows, force, 3.0)
        for _ in range(draws // arrays):
            cells = calibrated(tmp_path, rng, made, errors, sinks=True)
            hits["matrix"] += [np.abs(c.matrix - m) <= c.half_width for c, m in zip(cells, truth)]
            known = known_of(tmp_path, cells)
            (tmp_path / "grasp.csv").write_text(cell_labs.grasp_csv(made, rng, errors, LOADS, force))
            (read,) = cell_grasp.fields(small(), tmp_path / "grasp.csv")
            found = cell_grasp.forces(small(), read, known, 0.95)
            hits["force"].append(np.abs(found.force[:, -1] - force[-1]) <= found.half_width[:, -1])
            over["force over ideal"].append(found.half_width[:, -1] / ideal)
            around = cell_grasp.by_neighbours(small(), read, found, known, 0.95)
            hits["pair"] += [i.low <= 3.0 <= i.high for i in around]
            over["pair over ideal"].append([(i.high - i.low) / 2.0 for i in around] / ideal_pair)
    shares = {name: float(np.mean(v)) for name, v in hits.items()}
    return shares | {name: float(np.median(v, axis=0).max()) for name, v in over.items()}


@pytest.mark.slow  # thirty simulated labs
def test_intervals_hold_as_often_as_they_say(tmp_path):
    """30 draws of four cells, nine entries and three forces; the nightly one has 2000 and tighter bounds."""
    found = covered(tmp_path, 30, Errors(), 3)
    assert 0.93 <= found["matrix"] <= 0.97 and 0.92 <= found["force"] <= 0.98 and found["pair"] >= 0.92
    for name in ("force over ideal", "pair over ideal"):
        assert 0.9 < found[name] < 1.3, found


@pytest.mark.nightly
@pytest.mark.parametrize("errors", [Errors(), Errors(own=2e-3, shared=2e-3)])
def test_intervals_of_2000_draws(tmp_path, errors, record_property):
    """40 arrays, of errors that are each cell's own, and that a run shares: five minutes."""
    found = covered(tmp_path, 2000, errors, 40, 7)
    record_property("shares that hold the truth, and widths over an ideal's", str(found))
    print(found)
    assert all(0.93 <= found[name] <= 0.97 for name in ("matrix", "force", "pair")), found
    assert found["force over ideal"] < 1.3 and found["pair over ideal"] < 1.3, found


def moduli(tmp_path, arrays: int, draws: int, E: float, angle: float, seed: int = 13) -> np.ndarray:
    """Whether modulus and K_obj of a layer of 6 mm within 5 % are held, and the modulus' half-width,
    relative, [draw, 3]. Pads couple through the layer by the tests' own code; posts differ in length."""
    rng, layout = np.random.default_rng(seed), small()
    pads, _ = cell_pads.springs(layout.design)
    (at,) = layers(layout.design, "6+-5%", 0.49)
    off = (-0.04, 0.0, 0.04)
    rigid = np.full(len(pads.x), 1e9)  # a pad does not turn as it sinks
    benches = [Bench(pads.x, pads.y, pads.length, pads.width, rigid, 0.49, 6.0 * (1 + e)) for e in off]
    out = []
    for number in range(arrays):
        made, i, turn = lab(3 + number), rng.integers(len(off)), rng.uniform(0.0, 2.0 * np.pi)
        slope = np.tan(np.radians(angle)) * np.array([np.cos(turn), np.sin(turn)])
        height = rng.uniform(0.0, 2.0 * cell_pads.limit(layout.design), len(made.stiffness))
        sink = benches[i].sinks(E, made.stiffness, height, slope, LOADS)
        force = np.array([0.1, -0.05, 1.0]) * (made.stiffness[:, None] * sink).T[..., None]
        single = E * at.unit * (1 + off[i]) ** at.unit_by_thickness
        for _ in range(draws // arrays):
            known = known_of(tmp_path, calibrated(tmp_path, rng, made, Errors(), sinks=True))
            (tmp_path / "grasp.csv").write_text(cell_labs.grasp_csv(made, rng, Errors(), LOADS, force))
            (read,) = cell_grasp.fields(layout, tmp_path / "grasp.csv")
            signals, springs = cell_grasp.as_rows(read, cell_grasp.forces(layout, read, known, 0.95), known)
            plain = grasp.evaluate(signals, springs)
            whole = grasp.on_layers(plain, cell_grasp.with_rest(signals), springs, [at], 0.95)
            m, k = whole.layer.modulus, whole.combined
            out.append([m.low <= E <= m.high, k.low <= single <= k.high, (m.high - m.low) / 2.0 / E])
    return np.array(out)


@pytest.mark.by_day(1, "a second each")
@pytest.mark.parametrize("turn", [37.0, 127.0, 157.0])
def test_four_cells_find_a_face_that_some_do_not_touch(turn):
    """4 degrees, forces almost without noise, by single patches: within 5 %; where two pads bear, it is said.
    While approaches did not follow a step the fit stopped at 0.03 to 0.7 MPa instead of 0.3."""
    pads, _ = cell_pads.springs(small().design)
    (at,) = layers(small().design, "6+-5%", 0.49)
    on = Bench(pads.x, pads.y, pads.length, pads.width, np.full(4, 1e9), 0.49, 6.0)
    slope = np.tan(np.radians(4.0)) * np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
    load, K, one = np.array([0.0, *LOADS]), 1 / pads.compliance[:, 0, 0], np.ones(4)
    force = K[:, None] * on.sinks(0.3, K, 0.01 * one, slope, load)
    force += 1e-5 * np.random.default_rng(1).standard_normal(force.shape)
    errors = (K, 0.003 * K, K, 0.003 * K, 0 * one, 1e6 * one, 1e12 * one, 0 * one)
    known = Sensitivity(at.number, *errors)
    found = fit(at, at.number, load, force[None], known)
    readings = GraspReadings(1, at.number, load, np.zeros(len(load), int), force)
    said = grasp.on_layers(grasp.evaluate(readings, known), readings, known, [at], 0.95)
    bearing = (force[:, -1] > 0.02 * force.max()).sum()
    assert ("fewer than three pads" in " ".join(said.warnings)) == (bearing < 3)
    assert found.modulus[0, 0] == pytest.approx(0.3, rel=0.05)
    assert np.radians(found.angle[0, :, 0]) == pytest.approx(slope, abs=0.005)


@pytest.mark.slow  # 40 simulated labs
def test_a_layer_s_modulus_is_held_by_four_cells(tmp_path):
    """40 labs: as often as 95 % allow. Loads taken for readings had made it 88 % of 200."""
    found = moduli(tmp_path, 20, 40, 0.3, 1.0)
    assert found[:, 0].sum() >= binom.ppf(1e-3, 40, 0.95) and found[:, 1].sum() >= binom.ppf(1e-3, 40, 0.95)
    assert np.median(found[:, 2]) < 0.2


@pytest.mark.nightly
@pytest.mark.parametrize("E, angle", [(0.1, 0.0), (0.3, 0.0), (0.3, 1.0), (1.0, 0.0), (1.0, 0.5)])
def test_moduli_of_2000_labs(tmp_path, E, angle):
    found = moduli(tmp_path, 500, 2000, E, angle)
    print(E, angle, found.mean(axis=0), np.median(found[:, 2]))
    assert (0.93 <= found[:, :2].mean(axis=0)).all() and (found[:, :2].mean(axis=0) <= 0.98).all()


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """The small design as a file, its calibration, and a grasp in which the last pad is pushed sideways."""
    folder, rng = tmp_path_factory.mktemp("cells"), np.random.default_rng(2)
    text = PLANAR.read_text("utf-8").replace("rows = 6", "rows = 2").replace("columns = 6", "columns = 2")
    (folder / "small.toml").write_text(text.replace('"planar-array"', '"small"'))
    (folder / "calibration.csv").write_text(cell_labs.calibration_csv(lab(), rng, Errors(), 0.3, sinks=True))
    force = np.zeros((len(LOADS), 4, 3))
    force[..., 2] = cell_labs.pressed(lab(), LOADS, 3.0)
    force[:, 3, 0] = 0.8 * force[:, 3, 2]
    (folder / "grasp.csv").write_text(cell_labs.grasp_csv(lab(), rng, Errors(), LOADS, force))
    return folder, force


def run(*words) -> int:
    return main([str(w) for w in words])


def test_from_readings_to_a_map(bench, capsys):
    folder, force = bench
    design, cal, map_ = (folder / name for name in ("small.toml", "cal.csv", "map.svg"))
    assert run("calibrate", folder / "calibration.csv", "--design", design, "--out", cal) == 0
    said = capsys.readouterr().out
    assert "crosstalk" in said and said.count("measuring") == 2
    asked = ("stiffness", folder / "grasp.csv", "--calibration", cal, "--design", design)
    assert run(*asked, "--json", "--picture", map_) == 0
    (sample,) = json.loads(capsys.readouterr().out)["samples"]
    assert [c["kind"] for c in sample["cells"]] == ["reference", "measuring", "measuring", "reference"]
    for i, cell in enumerate(sample["cells"]):
        last = cell["states"][-1]
        off = np.abs(np.array(last["force"]) - force[-1, i])
        assert (off <= 2.0 * np.array(last["half_width"])).all(), cell
        assert last["slips"] is (i == 3) and last["stopped"] is False
        assert cell["object"]["low"] <= 3.0 <= cell["object"]["high"]
    assert sample["combined"]["low"] <= 3.0 <= sample["combined"]["high"]
    drawn = map_.read_text("utf-8")
    assert drawn.startswith("<svg")
    assert run(*asked) == 0
    assert "slips" in capsys.readouterr().out


@pytest.mark.nightly
def test_a_layer_s_modulus_comes_back(bench, capsys, tmp_path):
    """Forces by every patch of round pads on the layer; the estimator has squares and few numbers each, whose
    tables take 15 s."""
    folder, _ = bench
    pads, _ = cell_pads.springs(small().design)
    round_ = replace(pads, length=2.4, width=2.4, disc=True, compliance=pads.compliance.copy())
    round_.compliance[:, 0, 0] = 1 / lab().stiffness
    on = PadsOnBody(round_, Body(0.15, 0.49, 6.0))
    force = np.zeros((len(LOADS), 4, 3))
    force[..., 2] = [on.press(load=p).force for p in LOADS]
    rng, design, cal = np.random.default_rng(5), folder / "small.toml", tmp_path / "cal.csv"
    (tmp_path / "grasp.csv").write_text(cell_labs.grasp_csv(lab(), rng, Errors(), LOADS, force))
    assert run("calibrate", folder / "calibration.csv", "--design", design, "--out", cal) == 0
    asked = (
        "stiffness",
        tmp_path / "grasp.csv",
        "--calibration",
        cal,
        "--design",
        design,
        "--thickness",
        "6",
    )
    capsys.readouterr()
    assert run(*asked, "--json") == 0
    (sample,) = json.loads(capsys.readouterr().out)["samples"]
    modulus = sample["modulus_MPa"]
    assert modulus["low"] <= 0.15 <= modulus["high"] < 2.0 * modulus["low"], modulus
    assert sample["touching"] == [1, 2, 3, 4]


def test_grasp_says_what_the_chips_feel(bench, capsys):
    """A signal is the cell's matrix times its pad's force."""
    folder, _ = bench
    asked = ("grasp", "--object", "E=0.1,nu=0.49,thickness=8", "--load", "0.2", "--rung", "springs")
    assert run(asked[0], folder / "small.toml", *asked[1:], "--json") == 0
    done = json.loads(capsys.readouterr().out)
    assert done["signal_unit"] == "mT" and sum(e["force"] for e in done["elements"]) == pytest.approx(0.2)
    for place, e in zip(small().elements, done["elements"]):
        felt = -chip_matrix(small(), place.kind)[2, 2] * e["force"]
        assert e["signal"] == pytest.approx(abs(felt), rel=1e-9)
    assert run(asked[0], folder / "small.toml", *asked[1:]) == 0
    assert " uT " in capsys.readouterr().out


@pytest.mark.parametrize("thickness", [2.0, 6.0, np.inf])
def test_a_square_of_a_pad_s_area_is_nearly_as_stiff(thickness):
    body, side = Body(1.0, 0.49, thickness), cell_pads.side(small().design)
    square, disc = pad_stiffness(body, side, side), pad_stiffness(body, 2.4, 2.4, disc=True)
    assert 1.0 <= square / disc < 1.03


def test_one_cell_feels_forces_and_no_object(bench, tmp_path, capsys, recwarn):
    folder, _ = bench
    text = (
        (folder / "small.toml")
        .read_text()
        .replace("rows = 2", "rows = 1")
        .replace("columns = 2", "columns = 1")
    )
    (tmp_path / "one.toml").write_text(text)
    for name in ("calibration", "grasp"):
        header, *rows = (folder / f"{name}.csv").read_text().splitlines()
        own = [r for r in rows if r.split(",")[header.split(",").index("element")] == "1"]
        (tmp_path / f"{name}.csv").write_text("\n".join([header, *own]) + "\n")
    of = ("--design", tmp_path / "one.toml")
    assert run("calibrate", tmp_path / "calibration.csv", *of, "--out", tmp_path / "cal.csv") == 0
    asked = ("stiffness", tmp_path / "grasp.csv", "--calibration", tmp_path / "cal.csv", *of)
    assert run(*asked, "--picture", tmp_path / "map.svg") == 0
    assert "K_obj of all cells wants 3 loads above zero, and two cells or more" in capsys.readouterr().out
    assert not [w for w in recwarn if issubclass(w.category, RuntimeWarning)]
    body = ("--object", "E=0.1,nu=0.49,thickness=8", "--load", "0.2")
    assert run("grasp", tmp_path / "one.toml", *body) == 2
    assert "one pad makes no pair" in capsys.readouterr().err


def changed(text: str, line: int, **cells: str) -> str:
    """The table with cells of one line changed, by column."""
    lines = text.splitlines()
    names, row = lines[0].split(","), lines[line].split(",")
    for name, value in cells.items():
        row[names.index(name)] = value
    return "\n".join([*lines[:line], ",".join(row), *lines[line + 1 :]]) + "\n"


@pytest.mark.parametrize(
    "cells, said",
    [
        ({"bz": "51"}, ":6:8: MLX90393 is out of its range"),
        ({"element": "9"}, ":6:1: design small has no such cell"),
        ({"fy": "0.1"}, "the loads of run 1 are along no axis"),
        ({"run": "44"}, "too few loads in run"),
        ({"fx": "one"}, ":6:3:"),
    ],
)
def test_bad_calibrations_are_refused(bench, tmp_path, capsys, cells, said):
    folder, _ = bench
    (tmp_path / "bad.csv").write_text(changed((folder / "calibration.csv").read_text(), 5, **cells))
    out = tmp_path / "cal.csv"
    assert run("calibrate", tmp_path / "bad.csv", "--design", folder / "small.toml", "--out", out) == 2
    assert said in capsys.readouterr().err and not out.exists()


def test_signs_and_missing_runs_are_refused(bench, tmp_path, capsys):
    folder, _ = bench
    text = (folder / "calibration.csv").read_text()
    header, *rows = text.splitlines()
    one = [r for r in rows if r.split(",")[1] not in ("6", "9", "12")]
    (tmp_path / "one.csv").write_text("\n".join([header, *one]) + "\n")
    assert run("calibrate", tmp_path / "one.csv", "--design", folder / "small.toml") == 2
    assert "too few runs along z" in capsys.readouterr().err
    away = [",".join([*(c := r.split(","))[:2], c[2], c[3], str(-float(c[4])), *c[5:]]) for r in rows]
    (tmp_path / "away.csv").write_text("\n".join([header, *away]) + "\n")
    assert run("calibrate", tmp_path / "away.csv", "--design", folder / "small.toml") == 2
    assert "bz goes against fz" in capsys.readouterr().err


def test_bad_grasps_are_refused(bench, tmp_path, capsys):
    folder, _ = bench
    design, cal = folder / "small.toml", tmp_path / "cal.csv"
    assert run("calibrate", folder / "calibration.csv", "--design", design, "--out", cal) == 0
    header, *rows = (folder / "grasp.csv").read_text().splitlines()
    for kept, said in (
        ([r for r in rows if not r.startswith("0,")], "has no reading without load"),
        (rows[:-1], "element 4 has no reading at load 0.5 N"),
        ([r for r in rows if r.startswith("0,")], "no load above zero"),
    ):
        (tmp_path / "bad.csv").write_text("\n".join([header, *kept]) + "\n")
        capsys.readouterr()
        assert run("stiffness", tmp_path / "bad.csv", "--calibration", cal, "--design", design) == 2
        assert said in capsys.readouterr().err
    few = "\n".join(cal.read_text().splitlines()[:-1]) + "\n"
    cal.write_text(few)
    assert run("stiffness", folder / "grasp.csv", "--calibration", cal, "--design", design) == 2
    assert "element 4 was not calibrated" in capsys.readouterr().err
    for option in ("--load-cell", "--run-scatter"):
        assert run("calibrate", folder / "calibration.csv", "--design", design, option, "0.5") == 2
        assert f"{option}: does not take designs of this family" in capsys.readouterr().err
