"""`tactcad review` as a command: size, equal bytes in two processes, refusals, and the page of an export."""

from __future__ import annotations

import base64
import gzip
import json
import re
from pathlib import Path

import pytest
from faults.command_line import environment, one_by_one, refused, tactcad_forked, tactcad_run

from tactcad.export.manifest import sealed

pytestmark = pytest.mark.slow  # makes whole pages

MOST_ARRAY, MOST_ALL = 6_000_000, 12_000_000


@pytest.fixture(scope="module")
def work(tmp_path_factory) -> Path:
    """A folder with a design of one element."""
    folder = tmp_path_factory.mktemp("review")
    (folder / "one.toml").write_text(one_by_one(6, "A"), "utf-8")
    return folder


def carried(page: bytes, name: str) -> bytes:
    """What the page carries under that name."""
    (text,) = re.findall(rf'<script type="application/gzip" id="{name}">([^<]*)</script>'.encode(), page)
    return gzip.decompress(base64.b64decode(text))


@pytest.fixture(scope="module")
def made(work):
    """The page, and the same made by another process with a cold cache and another hash seed."""
    pages = []
    for n, seed in enumerate("12"):
        env = environment(work, TACTCAD_CACHE=str(work / f"cache-{n}"), PYTHONHASHSEED=seed)
        done = tactcad_run("review", "one.toml", "--out", f"{n}.html", "--json", cwd=work, env=env)
        assert done.returncode == 0, done.stderr
        said = json.loads(done.stdout)
        assert said["files"] == {f"{n}.html": (work / f"{n}.html").stat().st_size}
        assert said["scenes"] == ["array", "setting", "wiring"]
        pages.append((work / f"{n}.html").read_bytes())
    return pages


def test_two_processes_give_equal_bytes(made):
    assert made[0] == made[1]


def test_the_page_is_small_and_fetches_nothing(made):
    page = made[0]
    assert len(page) < MOST_ARRAY
    own = re.sub(rb'<script type="application/gzip".*?</script>', b"", page)
    style = own.index(b"<style>"), own.rindex(b"</style>")
    text = (own[: style[0]] + own[style[1] :]).decode()
    assert not re.search(r"""(src|href|action)\s*=\s*["'](?!")|url\(|https?://""", text)
    assert "default-src 'none'" in text and "innerHTML" not in text and "eval(" not in text
    assert "Permission is hereby granted" in text


def test_its_meshes_are_the_parts(made):
    """Volumes of the meshes by the divergence theorem against the closed forms; edges end on them."""
    import numpy as np

    record, block = json.loads(carried(made[0], "data")), carried(made[0], "block")
    for part in record["parts"]:
        found = {}
        for name, (start, count) in part["mesh"].items():
            kind = "<f4" if name in ("vertices", "normals", "edges", "obj_vertices") else "<u4"
            found[name] = np.frombuffer(block, kind, count, start)
        points, normals = (found[name].reshape(-1, 3).astype(float) for name in ("vertices", "normals"))
        a, b, c = (points[found["triangles"][k::3]] for k in range(3))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
        assert volume == pytest.approx(part["volume_mm3"], rel=0.02), part["part_no"]
        # normals look outwards, as the triangles do
        outwards = np.cross(b - a, c - a)
        assert (np.einsum("ij,ij->i", outwards, normals[found["triangles"][::3]]) >= -1e-12).all()
        assert found["triangles_per_face"].sum() * 3 == len(found["triangles"])
        assert found["segments_per_edge"].sum() * 6 == len(found["edges"])
        low, high = np.array(part["box"])
        assert (points >= low).all() and (points <= high).all()


def test_an_exports_page_is_its_designs(work, made):
    env = environment(work, TACTCAD_CACHE=str(work / "cache-0"))
    done = tactcad_forked("export", "one.toml", "--out", "exported", cwd=work, env=env)
    assert done.returncode == 0, done.stderr
    done = tactcad_forked("review", "exported", "--out", "exported.html", cwd=work, env=env)
    assert done.returncode == 0, done.stderr
    assert (work / "exported.html").read_bytes() == made[0]
    done = tactcad_forked("review", "exported", "--out", "exported/step/page.html", cwd=work, env=env)
    assert "would overwrite exported, which is read" in refused(done)
    manifest = work / "exported" / "manifest.json"
    record = json.loads(manifest.read_text())
    record["inputs"]["libraries"]["build123d"] = "0.1"
    del record["seal"]
    manifest.chmod(0o644)
    manifest.write_bytes(sealed(record))
    done = tactcad_forked("review", "exported", "--out", "other.html", cwd=work, env=env)
    assert "made by another version of tactcad: build123d 0.1 ->" in refused(done)
    assert not (work / "other.html").exists()


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["nowhere"], "no design of that name"),
        (["one.toml", "--scene", "grasping"], "no such scene in this design"),
        (["one.toml", "--out", "one.toml"], "one.toml"),
        (["one.toml", "--out", "no/such/folder/review.html"], "no/such/folder"),
    ],
)
def test_bad_input_is_one_line(work, arguments, said):
    done = tactcad_forked("review", *arguments, cwd=work, env=environment(work))
    assert said in refused(done, done.returncode) and done.returncode in (1, 2)


@pytest.mark.nightly
def test_sizes_of_the_published_array_and_of_all_its_rigs(tmp_path):
    for arguments, most in ((["--scene", "array"], MOST_ARRAY), ([], MOST_ALL), (["--drawings"], MOST_ALL)):
        done = tactcad_run(
            "review", "macro-array", *arguments, "--out", "m.html", cwd=tmp_path, env=environment(tmp_path)
        )
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "m.html").stat().st_size < most
