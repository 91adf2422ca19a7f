"""Showing from Python: the example notebook run whole, its page in a browser, what OCP CAD Viewer gets."""

from __future__ import annotations

import base64
import io
import json
import re
import socket
import subprocess
import sys
import threading
from html.parser import HTMLParser
from pathlib import Path

import nbformat
import numpy as np
import pytest
from browser import DRAWN, LOADED
from faults.command_line import environment, one_by_one, tactcad_run
from nbclient import NotebookClient
from PIL import Image
from test_review_command import carried
from variants import variant
from websockets.sync.server import serve

from tactcad.design.messages import CheckFailure, InputError
from tactcad.parts.rules import load
from tactcad.review import show as showing
from tactcad.review.facts import scene_facts

pytestmark = pytest.mark.slow  # starts a browser

NOTEBOOK = Path(__file__).parents[2] / "docs" / "notebooks" / "review.ipynb"


class Frame(HTMLParser):
    """The page in a frame, and the frame's other attributes."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.frames: list[dict[str, str]] = []
        self.feed(text)
        (self.attributes,) = self.frames
        self.page = self.attributes.pop("srcdoc").encode()

    def handle_starttag(self, tag, attrs) -> None:
        assert tag == "iframe"
        self.frames.append(dict(attrs))


# --- the notebook ---


def test_the_notebook_is_committed_as_it_was_written():
    notebook = nbformat.read(NOTEBOOK, 4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code and all(not cell.outputs and cell.execution_count is None for cell in code)


@pytest.mark.cad
def test_the_notebook_runs_and_shows_what_it_tells(tmp_path):
    """Whole, where nothing lies: both designs, what 5 um do to K, what changed, and a refusal."""
    notebook = nbformat.read(NOTEBOOK, 4)
    place = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources=place).execute()
    said = {cell.id: cell.outputs[0] for cell in notebook.cells if cell.get("outputs")}

    for cell, thickness in (("published", 0.25), ("thicker", 0.255)):
        record = json.loads(carried(framed(said[cell]).page, "data"))
        assert hinges(record) == {thickness} and len(record["scenes"][0]["placed"]) == 40

    # between the round hinge's power of 2.5 and the beam's of 3, as printed
    changes = re.findall(r"^E\d+ .* ([+-][\d.]+)%$", said["numbers"].text, re.MULTILINE)
    assert len(changes) == 10
    assert all(100 * (1.02**2.5 - 1) - 0.1 < float(c) < 100 * (1.02**3 - 1) for c in changes)

    page = framed(said["changes"]).page
    (cause,) = json.loads(carried(page, "data"))["changes"]["causes"]
    assert cause["what"] == "element.hinge_thickness: 0.25 -> 0.255"
    assert {f"E{n} added" for n in range(1, 11)} <= set(cause["pieces"]["array"])
    assert (tmp_path / "changes.html").read_bytes() == page

    assert "legal:" in said["refused"].text and said["refused"].text.count("\n") == 1


def framed(output) -> Frame:
    return Frame(output.data["text/html"])


def hinges(record) -> set[float]:
    """Nominal hinge thicknesses of its parts, mm."""
    limits = [limit for part in record["parts"] for limit in part["limits"]]
    return {limit["nominal"] for limit in limits if limit["name"] == "hinge thickness"}


# --- the functions ---


@pytest.fixture(scope="module")
def one(tmp_path_factory) -> Path:
    """The file of a design of one element."""
    path = tmp_path_factory.mktemp("show") / "one.toml"
    path.write_text(one_by_one(6, "A"), "utf-8")
    return path


SHOW = """
from pathlib import Path
from tactcad.parts.rules import load
from tactcad.review.show import show
page = Path("one.html").read_bytes()
for design in ("one.toml", Path("one.toml"), load("one.toml")):
    assert show(design).html == page, design
"""


@pytest.mark.cad
def test_shown_is_the_page_that_the_command_writes(one):
    """By processes of one environment: the number of threads enters the last digit of a strain."""
    env = environment(one.parent)
    arguments = ("review", one.name, "--scene", "array", "--out", "one.html")
    done = tactcad_run(*arguments, cwd=one.parent, env=env)
    assert done.returncode == 0, done.stderr
    done = subprocess.run(
        [sys.executable, "-c", SHOW], cwd=one.parent, env=env, capture_output=True, check=False, timeout=600
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.cad
def test_a_design_against_itself_shows_no_change(one):
    shown = showing.show_changes(one, load(one))
    changes = json.loads(carried(shown.html, "data"))["changes"]
    assert changes["causes"] == changes["differences"] == []
    assert [side["source"] for side in changes["sides"]] == [str(one), "after"]
    assert list(changes["counts"]["array"]) == ["same"]


def test_a_title_is_text_in_the_frame():
    title, page = "</iframe><img src=x onerror=alert(1)>\"'&amp;", b'<p title="\'&quot;">&lt;\xc2\xb5</p>'
    frame = Frame(showing.ShownPage(title, page)._repr_html_())
    assert frame.attributes["title"] == title and frame.page == page


def test_what_cannot_be_shown_is_refused(one):
    for act in (showing.show, showing.show_in_vscode, lambda d: showing.show_changes(d, one)):
        with pytest.raises(InputError, match="no design of that name"):
            _with_a_viewer(act, "no-such-design")
        with pytest.raises(InputError, match="rule "):
            _with_a_viewer(act, variant({"element.hinge_thickness": 0.03}))
    with pytest.raises(InputError, match="no such scene in this design"):
        showing.show(one, "grasping")


def _with_a_viewer(act, design) -> None:
    """As if one listened: the design is read after that is known."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(showing, "_listening", lambda: None)
        act(design)


@pytest.mark.cad
def test_the_page_draws_in_its_frame_and_reaches_nothing_outside(one, running, tmp_path):
    """A notebook's page around it, from a file, with the network off."""
    shown = showing.show(one)._repr_html_()
    around = tmp_path / "notebook.html"
    around.write_text(f"<!doctype html><title>notebook</title>{shown}", "utf-8")
    context = running.new_context(offline=True, viewport={"width": 1200, "height": 800})
    page, troubles, asked = context.new_page(), [], []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on("console", lambda m: troubles.append(m.text) if m.type in ("error", "warning") else None)
    page.on("request", lambda request: asked.append(request.url))
    page.goto(around.as_uri())
    inside = page.frame_locator("iframe")
    inside.locator("html[data-ready=true]").wait_for(state="attached", timeout=LOADED)
    inside.locator("[data-designator=E1] b").first.click()
    assert "macro-array-element-a6mm" in inside.locator("#part-number").inner_text()
    inside.locator("#show-about").click()
    inside.locator("#about button").click()
    assert not inside.locator("#about").is_visible()
    page.evaluate(DRAWN)
    shot = Image.open(io.BytesIO(inside.locator("#canvas canvas").first.screenshot())).convert("RGB")
    assert len(np.unique(np.asarray(shot).reshape(-1, 3), axis=0)) > 50  # shades; of a blank one it is 1
    frame = page.frames[1]
    assert frame.evaluate("() => { try { return parent.document.title; } catch { return 'refused'; } }") == (
        "refused"
    )
    assert troubles == []
    assert all(url.startswith(("file:", "blob:", "data:")) for url in asked)
    context.close()


# --- OCP CAD Viewer ---

SHOWN = """
import os, sys
from tactcad.review.show import show_in_vscode
assert "ocp_vscode" not in sys.modules
try:
    show_in_vscode("macro-array")
except Exception as error:
    print(f"{type(error).__name__}: {error}")
os.environ["OCP_PORT"] = sys.argv[1]
show_in_vscode("macro-array")
"""


class Viewer:
    """What OCP CAD Viewer is at its other end: answers with an empty configuration, keeps the rest."""

    def __init__(self) -> None:
        self.received: dict[bytes, list[bytes]] = {}
        self.server = serve(self._take, "127.0.0.1", 0, max_size=None)
        self.port = self.server.socket.getsockname()[1]
        self.thread = threading.Thread(target=self.server.serve_forever)
        self.thread.start()

    def _take(self, connection) -> None:
        for message in connection:
            data = message if isinstance(message, bytes) else message.encode()
            self.received.setdefault(data[:2], []).append(data[2:])
            if data[:2] == b"C:":  # its configuration, or its state
                state = {"command": "status", "text": {}}
                connection.send(json.dumps(state if json.loads(data[2:]) == "status" else {}))
            elif data[:2] == b"B:":
                connection.send(json.dumps({"ok": True}))

    def close(self) -> None:
        self.server.shutdown()
        self.thread.join()


@pytest.fixture(scope="module")
def arrived(tmp_path_factory):
    """What ocp_vscode sent of the published array, and what was printed; at first no viewer listens."""
    folder = tmp_path_factory.mktemp("viewer")
    with socket.socket() as taken:  # bound, but nobody listens
        taken.bind(("127.0.0.1", 0))
        env = environment(folder, OCP_PORT=str(taken.getsockname()[1]))
        viewer = Viewer()
        try:
            command = [sys.executable, "-c", SHOWN, str(viewer.port)]
            done = subprocess.run(
                command, env=env, cwd=folder, capture_output=True, text=True, check=False, timeout=600
            )
        finally:
            viewer.close()
    assert done.returncode == 0, done.stderr
    (data,) = viewer.received[b"D:"]
    return json.loads(data)["data"], done.stdout


def leaves(node, path=()):
    """Every part of the tree, with the names above it."""
    if "parts" not in node:
        yield path, node
    for child in node.get("parts", ()):
        yield from leaves(child, (*path, node["name"]))


def turned(quaternion, vector):
    x, y, z, w = quaternion
    axis = np.array([x, y, z])
    return vector + 2 * np.cross(axis, np.cross(axis, vector) + w * np.asarray(vector))


@pytest.mark.cad
def test_every_designator_arrives_in_its_sub_assembly_with_its_colour_and_place(arrived, macro, macro_scene):
    found = {node["name"]: (path, node) for path, node in leaves(arrived[0]["shapes"])}
    under = {p["designator"]: p["under"] for p in scene_facts(macro, macro_scene)["placed"]}
    assert len(found) == len(macro_scene.placements) == 40 and len(set(under.values())) > 1
    for p in macro_scene.placements:
        path, node = found[p.designator]
        assert path == ("array", *under[p.designator])
        assert node["color"] == p.part.colour.lower() and node["alpha"] == 1.0
        place, quaternion = node["loc"]
        # the viewer moves a part by its own place and then by those of what holds it
        assert place == pytest.approx(p.origin, abs=1e-9)
        for vector in np.eye(3):
            assert turned(quaternion, vector) == pytest.approx(np.array(p.rotation) @ vector, abs=1e-9)


@pytest.mark.cad
def test_equal_parts_arrive_once_and_are_the_parts(arrived, macro_scene):
    """Volumes of the meshes by the divergence theorem against the closed forms."""
    parts = {p.designator: p.part for p in macro_scene.placements}
    shapes, tree = arrived[0]["instances"], arrived[0]["shapes"]
    kinds = {node["name"]: node["shape"]["ref"] for _, node in leaves(tree)}
    assert len(shapes) == len(set(kinds.values())) == len(macro_scene.parts)
    for designator, kind in kinds.items():
        points = _numbers(shapes[kind]["vertices"], np.float32).reshape(-1, 3)
        a, b, c = (points[_numbers(shapes[kind]["triangles"], np.int32)[k::3]] for k in range(3))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
        assert volume == pytest.approx(parts[designator].volume, rel=0.03), designator


def _numbers(sent, kind):
    assert sent["codec"] == "b64" and np.dtype(sent["dtype"]) == kind
    return np.frombuffer(base64.b64decode(sent["buffer"]), kind).astype(float if kind == np.float32 else int)


@pytest.mark.cad
def test_where_no_viewer_listens_one_line_says_how_to_open_one(arrived):
    (said,) = [line for line in arrived[1].splitlines() if "Failure" in line]
    assert said.startswith("CheckFailure: no OCP CAD Viewer listens: ") and "Open viewer" in said


def test_a_missing_package_is_said_with_the_remedy(monkeypatch):
    monkeypatch.setattr(showing, "find_spec", lambda name: None)
    with pytest.raises(CheckFailure, match="ocp-vscode is not installed: pip install ocp-vscode"):
        showing.show_in_vscode("macro-array")
