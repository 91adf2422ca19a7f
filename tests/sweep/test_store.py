"""A store at an address of fsspec's: its own memory, and a folder that other processes reach."""

from __future__ import annotations

import json
import pickle

import fsspec
import pyarrow.parquet as pq
import pytest
from small_study import ELEMENTS, finished, swept, tables, written

from tactcad.cli.main import main
from tactcad.design.messages import CheckFailure
from tactcad.sweep.measured import made_by
from tactcad.sweep.on_dask import SweepTask
from tactcad.sweep.store import FarStore, store_apart
from tactcad.sweep.study import read_study

GRID = ELEMENTS.replace(', "fem-plane"', "").replace("steps = 4", "steps = 2")


@pytest.fixture
def store(tmp_path):
    return FarStore(f"memory://{tmp_path}")


def objects(store: FarStore) -> list[str]:
    return fsspec.filesystem("memory").find(store.address.removeprefix("memory://"))


def test_what_is_put_is_got(store):
    assert store.get("a") is None
    store.put("a", b"1\n2")
    store.put("b", b"")
    assert store.get("a") == b"1\n2" and store.get("b") == b"" and len(objects(store)) == 2


@pytest.mark.parametrize("change", [lambda d: d[:-1], lambda d: d[:10], lambda d: d + b"x", lambda d: b""])
def test_a_damaged_entry_is_none(store, change):
    store.put("a", b"result")
    files, (path,) = fsspec.filesystem("memory"), objects(store)
    files.pipe_file(path, change(files.cat_file(path)))
    assert store.get("a") is None
    store.put("a", b"result")
    assert store.get("a") == b"result"


def test_an_entry_under_another_key_is_none(store):
    store.put("a", b"result")
    store.put("b", b"another")
    files, (one, other) = fsspec.filesystem("memory"), objects(store)
    files.cp_file(one, other)
    assert [store.get("a"), store.get("b")].count(None) == 1


def test_what_ends_while_it_is_written_leaves_nothing(store, monkeypatch):
    """Of a killed worker no half entry is left under the name of a whole one."""
    files = fsspec.filesystem("memory")
    monkeypatch.setattr(type(files.open("/x", "wb")), "commit", lambda self: 1 / 0)
    with pytest.raises(CheckFailure, match="division by zero; what was finished is kept"):
        store.put("a", b"result")
    assert not [path for path in objects(store) if not path.endswith("/x")]


@pytest.mark.parametrize(
    "address, said",
    [
        ("nosuch://x/y", "Protocol not known"),
        ("s3://b/x", "s3fs"),
        ("memory://x", "workers are others"),
        ("study.toml", "File exists; found 'study.toml'; legal: a folder"),
        ("local:///proc/nope", "No such file or directory; found 'local:///proc/nope'"),
    ],
)
def test_an_address_that_cannot_be_is_one_line(tmp_path, capsys, monkeypatch, address, said):
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", str(written(tmp_path)), "--out", str(tmp_path / "out"), "--store", address]) == 2
    err = capsys.readouterr().err
    assert err.startswith("tactcad: --store: ") and said in err and err.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("address", ["out", "out/far", "link", "local://{}/done/../done", "done/store"])
def test_a_store_is_no_studys_folder(tmp_path, capsys, monkeypatch, address):
    """Refused before anything is made; what lies in the other study's folder stays as it is."""
    monkeypatch.chdir(tmp_path)
    path = written(tmp_path)
    assert finished(path, tmp_path / "done") == 0
    (tmp_path / "link").symlink_to("done")
    before = sorted(tmp_path.rglob("*"))
    capsys.readouterr()
    assert main(["sweep", str(path), "--out", "out", "--store", address.format(tmp_path)]) == 2
    err = capsys.readouterr().err
    assert err.startswith("tactcad: --store: ") and err.count("\n") == 1, err
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("address", ["out/store", "./out/../out/store/", "file:" + "//{}/out/store"])
def test_the_default_store_spelled_out(tmp_path, monkeypatch, address):
    monkeypatch.chdir(tmp_path)
    path, out, address = written(tmp_path), tmp_path / "out", address.format(tmp_path)
    assert store_apart(address, out) is None
    assert finished(path, out) == 0
    assert main(["sweep", str(path), "--out", "out", "--store", address]) == 0  # nothing is left to compute
    assert store_apart("far", out) == str(tmp_path / "far")  # a worker has another working folder


def test_a_place_that_refuses_is_one_line(tmp_path):
    store = FarStore(f"local://{tmp_path}/store")
    (tmp_path / "store").rmdir()
    (tmp_path / "store").write_text("no folder")
    with pytest.raises(CheckFailure) as refused:
        store.put("a", b"result")
    assert "\n" not in str(refused.value) and "--store local://" in str(refused.value)


def test_a_workers_refusal_reaches_the_client(tmp_path):
    """Of a worker that lacks what the address needs."""
    study = read_study(written(tmp_path))
    done = SweepTask(study, made_by(study.measure.what), str(tmp_path), 0, 24, "s3://b/x").carry_out()
    assert (
        done.unable.startswith("cannot go on: --store") and "s3fs" in pickle.loads(pickle.dumps(done)).unable
    )


@pytest.mark.slow  # two sweeps in processes
def test_fields_in_another_order_share_nothing(tmp_path):
    """Both studies hold the same designs, in another order: each row is its own design's."""
    head, thickness, rest = GRID.partition('[vary."element.hinge_thickness"]')
    fields, measure = rest.split("[measure]")
    field, arm = fields.split("[vary.")
    swapped = f"{head}[vary.{arm}{thickness}{field}[measure]{measure}"
    found = []
    for n, text in enumerate((GRID, swapped)):
        folder = tmp_path / str(n)
        folder.mkdir()
        done = swept(written(folder, text), "--out", folder / "out", "--store", tmp_path / "far", "--json")
        assert json.loads(done.stdout)["computed"] == 4
        rows = pq.read_table(folder / "out" / "results.parquet").to_pylist()
        found.append({(r["element.hinge_thickness"], r["array.row_arms[0][3]"]): r for r in rows})
        assert [r["number"] for r in rows] == [1, 2, 3, 4]
    one, other = found
    assert len(one) == 4 and one.keys() == other.keys()
    assert all(one[k]["solid.E4.stiffness"] == other[k]["solid.E4.stiffness"] for k in one)
    assert [r["number"] for r in one.values()] != [other[k]["number"] for k in one]


@pytest.mark.slow  # three sweeps
def test_a_study_kept_there_goes_on_from_any_folder(tmp_path):
    """The tables are those of a store in the folder; another folder finds all finished."""
    path, address = written(tmp_path), f"local://{tmp_path}/far"
    near = swept(path, "--out", tmp_path / "near")
    far = swept(path, "--out", tmp_path / "a", "--store", address, "--json")
    assert near.returncode == far.returncode == 0, far.stderr
    assert not (tmp_path / "a" / "store").exists()
    again = swept(path, "--out", tmp_path / "b", "--store", address, "--json")
    assert (json.loads(far.stdout)["computed"], json.loads(again.stdout)["computed"]) == (24, 0)
    assert tables(tmp_path / "near") == tables(tmp_path / "a") == tables(tmp_path / "b")
