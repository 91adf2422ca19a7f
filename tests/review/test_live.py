"""`tactcad view`: who is answered, what a save shows, and what is said of a text that gives no model."""

from __future__ import annotations

import http.client
import json
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager
from functools import partial

import numpy as np
import pytest
from browser import DRAWN, LOADED
from faults.command_line import environment, one_by_one

from tactcad.cli.main import main
from tactcad.design.messages import InputError

pytestmark = pytest.mark.slow  # starts a browser

TEXT = one_by_one(6, "A")
HINGE = "hinge_thickness = 0.25"
THICKER = TEXT.replace(HINGE, "hinge_thickness = 0.3", 1)
THICK = TEXT.replace(HINGE, "hinge_thickness = 0.4", 1)
BROKEN = TEXT.replace(HINGE, "hinge_thickness = 3.0", 1)
HOSTILE = TEXT.replace("[element]\n", "[element]\n\"<img src=x onerror='alert(1)'>\" = 1\n", 1)


@pytest.fixture(scope="module")
def shapes(tmp_path_factory):
    """Makers of solids that share a cache."""
    from tactcad.export.cache import Cache
    from tactcad.export.shapes import Shapes

    cache = Cache(tmp_path_factory.mktemp("live") / "cache")
    return lambda: Shapes(cache, "tests")


@pytest.fixture
def live(shapes, tmp_path):
    from tactcad.review.live import Live

    (tmp_path / "d.toml").write_text(TEXT, "utf-8")
    return Live(tmp_path / "d.toml", "array", shapes)


@contextmanager
def serving(live, port: int = 0):
    from tactcad.review.live import LiveServer
    from tactcad.review.review_page import viewer_library

    with LiveServer(lambda: live, viewer_library(), port) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.05,))
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


@pytest.fixture
def server(live):
    with serving(live) as one:
        yield one


def saved(live, text: str, looks: int = 1) -> None:
    live.path.write_text(text, "utf-8")
    for _ in range(looks):
        live.look()


def answer(server, path: str, host: str | None = None, method: str = "GET"):
    """Status and body; the path goes out as it stands."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    connection.putrequest(method, path, skip_host=True)
    if host != "":
        connection.putheader("Host", host or f"127.0.0.1:{server.server_port}")
    connection.endheaders()
    got = connection.getresponse()
    return got.status, got.read()


def stiffness(record) -> float:
    return record["array"]["elements"]["E1"]["estimate"]["stiffness"]


def estimates(text: str) -> tuple[float, float, float]:
    """K in N/mm, rated force and force at yield in N of the one element, as `tactcad estimate` has them."""
    from tactcad.design.load import parse
    from tactcad.lab.array_estimate import estimate
    from tactcad.mechanics.ladder import DEFAULT_RUNG
    from tactcad.parts.array.layout import Layout

    row = estimate(Layout(parse(text, "d.toml")), DEFAULT_RUNG)[0]
    return row.stiffness, row.rated_force, row.yield_force


def test_only_who_has_the_token_is_answered_and_no_path_is_a_file(server):
    token, port = server.token, server.server_port
    status, page = answer(server, f"/{token}/")
    assert status == 200 and b"connect-src 'self'" in page
    assert answer(server, f"/{token}/", f"localhost:{port}")[0] == 200
    for path in (
        "/",
        f"/{token}",
        f"/{token[:-1]}/",
        f"/{token}x/",
        f"//{token}/x",
        f"/{token}/d.toml",
        f"/{token}/../{token}/",
        f"/{token}/../../../../etc/passwd",
        f"/{token}//etc/passwd",
        f"/{token}/%2e%2e/",
        f"/{token}/?x",
        f"/{token}/events",
        f"/{token}/events?version=-1&model=0",
        f"/{token}/events?version=1&model=1&file=/etc/passwd",
        "/events?version=9&model=9",
        "/x/events?version=9&model=9",
        f"http://127.0.0.1:{port}/{token}/",
    ):
        assert answer(server, path)[0] == 404, path
    assert answer(server, f"/{token}/", method="POST")[0] == 501


@pytest.mark.parametrize("host", ["", "evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1"])
def test_another_name_for_this_machine_is_refused(server, host):
    """A page elsewhere can have its own name mean this machine; the browser then sends that name."""
    status, body = answer(server, f"/{server.token}/", host.format(port=server.server_port))
    assert status == 403 and b"<" not in body


def test_it_listens_on_this_machines_own_address_alone(server):
    assert server.socket.getsockname()[0] == "127.0.0.1"
    with serving(server.live) as other:
        assert other.token != server.token and len(other.token) >= 32


def test_a_save_gives_the_new_model_and_tells_what_changed(live, server):
    before = stiffness(live.record)
    saved(live, THICKER)
    status, body = answer(server, f"/{server.token}/events?version=0&model=0")
    line, _, block = body.partition(b"\n")
    told = json.loads(line)
    assert status == 200 and told["live"]["version"] == told["live"]["model"] == 1
    # a beam with a round notch bends as t^2.5
    assert stiffness(told["record"]) / before == pytest.approx((0.3 / 0.25) ** 2.5, rel=0.02)
    changes = {(c["about"], c["what"]): (c["before"], c["after"]) for c in told["live"]["changes"]}
    assert changes["", "element.hinge_thickness"] == (0.25, 0.3)
    assert changes["E1", "K, N/mm"] == (before, stiffness(told["record"]))
    # the mesh in the block is the thicker part: its volume by the divergence theorem
    (part,) = (p for p in told["record"]["parts"] if "element" in p["part_no"])
    start, count = part["mesh"]["vertices"]
    points = np.frombuffer(block, "<f4", count, start).reshape(-1, 3).astype(float)
    start, count = part["mesh"]["triangles"]
    a, b, c = (points[np.frombuffer(block, "<u4", count, start)[k::3]] for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(part["volume_mm3"], rel=1e-3)
    assert part["limits"][0]["nominal"] == 0.3


def test_a_comment_changes_nothing(live):
    saved(live, TEXT + "\n# more\n", looks=2)
    assert live.shown.version == 0


def test_only_changed_parts_are_meshed(live, monkeypatch):
    from tactcad.solids import triangles

    meshed, whole = [], triangles.facets
    monkeypatch.setattr(triangles, "facets", lambda *a: meshed.append(1) or whole(*a))
    saved(live, TEXT.replace(HINGE, "hinge_thickness = 0.26", 1))
    assert live.shown.model == 1 and len(meshed) == 1


@pytest.mark.parametrize(
    "text, said",
    [(BROKEN, "element.hinge_thickness"), (TEXT[:2000] + '\nx = "', "is not TOML"), ("", "missing table")],
)
def test_what_is_wrong_is_said_and_the_last_good_model_stays(live, text, said):
    record = live.record
    saved(live, text)
    assert live.shown.version == 0  # an editor may be half way
    live.look()
    assert said in live.shown.message and "\n" not in live.shown.message
    assert live.record is record and live.shown.model == 0
    saved(live, TEXT)
    assert live.shown.message == "" and live.shown.version == 2


def test_a_file_that_goes_and_comes_back(live):
    live.path.unlink()
    for _ in range(3):
        live.look()
    assert live.shown.version == 1 and "no such file" in live.shown.message
    saved(live, THICKER)
    assert live.shown.message == "" and live.shown.model == 2


def test_an_error_nobody_thought_of_is_said_too(live, monkeypatch, capsys):
    import tactcad.review.live as module

    def fails(*_):
        raise RuntimeError("the kernel gave up")

    monkeypatch.setattr(module, "live_record", fails)
    saved(live, THICKER, looks=2)
    assert live.shown.message == "RuntimeError: the kernel gave up"
    assert "Traceback" in capsys.readouterr().err


def test_a_taken_port_and_bad_starts_are_one_line(live, server, capsys):
    port = server.server_port
    with pytest.raises(InputError, match=r"--port: cannot be used"), serving(live, port):
        pass
    for arguments, said in (
        ([str(live.path), "--port", str(port)], f"found {port}"),
        ([str(live.path), "--port", "70000"], "--port"),
        ([str(live.path), "--scene", "grasping"], "no such scene"),
        (["nowhere.toml"], "no such file"),
    ):
        assert main(["view", *arguments]) == 2
        assert said in capsys.readouterr().err


def test_a_taken_port_is_refused_before_a_model_is_made(live, server, monkeypatch):
    import tactcad.review.live as module

    made = []
    monkeypatch.setattr(module, "live_record", lambda *_: made.append(1))
    assert main(["view", str(live.path), "--port", str(server.server_port)]) == 2
    assert not made


def test_a_port_is_given_back_where_the_design_has_no_model(live):
    from tactcad.review.live import LiveServer

    with serving(live) as one:
        port, library = one.server_port, one.library

    def fails():
        raise InputError("d.toml", "no model", legal="one")

    with pytest.raises(InputError, match="no model"):
        LiveServer(fails, library, port)
    with LiveServer(lambda: live, library, port) as again:
        assert again.server_port == port


def test_the_command_prints_its_address_and_ends_on_ctrl_c(tmp_path):
    (tmp_path / "d.toml").write_text(TEXT, "utf-8")
    command = [sys.executable, "-m", "tactcad", "view", "d.toml"]
    with subprocess.Popen(
        command,
        cwd=tmp_path,
        env=environment(tmp_path),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=partial(
            signal.signal, signal.SIGINT, signal.SIG_DFL
        ),  # a job in the background ignores it
    ) as run:
        said = run.stdout.readline().decode()
        assert said.startswith("d.toml: http://127.0.0.1:")
        with pytest.raises(
            subprocess.TimeoutExpired
        ):  # it stays, with the kernel loaded after the first page
            run.wait(8)
        run.send_signal(signal.SIGINT)
        assert run.wait(30) == 130 and run.stderr.read().count(b"\n") == 1


def test_the_page_follows_the_file(running, live, server):
    page = running.new_page(viewport={"width": 1100, "height": 640})
    troubles: list[str] = []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on("console", lambda m: troubles.append(m.text) if m.type in ("error", "warning") else None)
    page.on("dialog", lambda dialog: (troubles.append(dialog.message), dialog.dismiss()))
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))

    def follows(text: str, version: int, looks: int = 1) -> np.ndarray:
        saved(live, text, looks)
        page.wait_for_selector(f"html[data-version='{version}']", state="attached", timeout=LOADED)
        return picture()

    def picture() -> np.ndarray:
        import io

        from PIL import Image

        page.evaluate(DRAWN)
        shot = page.locator("#canvas canvas").first.screenshot()
        return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)

    def differ(a: np.ndarray, b: np.ndarray) -> float:
        return float((np.abs(a - b).max(axis=2) > 30).mean())

    page.goto(server.url)
    page.wait_for_selector("html[data-ready]", timeout=LOADED)
    page.click("[data-designator=E1] > .row > b")
    page.keyboard.press("i")
    page.click("#views button >> nth=1")
    first = picture()
    # the same part, thicker: the picture changes at the hinge alone, so the eye stays
    thick = follows(THICK, 1)
    assert 0 < differ(first, thick) < 0.02
    k = f"{stiffness(live.record):.4g} N/mm"
    assert k in page.inner_text("#panel") and page.inner_text("#part-number") == "macro-array-element-a6mm"
    assert "element.hinge_thickness 0.25 \u2192 0.4" in page.inner_text("#live-first")
    page.click("#live summary")
    told = [row.split("\t") for row in page.inner_text("#live-all").splitlines()]
    for what, estimated in zip(
        ("K, N/mm", "rated force, N", "yield force, N"), zip(*map(estimates, (TEXT, THICK)))
    ):
        rows = [row[2:5:2] for row in told if row[:2] == ["E1", what]]
        assert rows == ([[f"{value:.4g}" for value in estimated]] if len(set(estimated)) > 1 else [])
    # what is said to have changed reads other after than before, the mass by its seventh figure, too
    assert all(row[2] != row[4] for row in told if len(row) > 4)
    assert any(row[1] == "mass, g" for row in told if len(row) > 4)
    page.click("#live summary")
    assert page.locator("#tree [data-designator] > .row > input:checked").count() == 1
    # another part: it is drawn anew, and what was chosen and hidden stays so
    page.click("#views button >> nth=1")
    longer = follows(TEXT.replace("row_arms = [[6", "row_arms = [[8", 1), 2)
    assert page.inner_text("#part-number") == "macro-array-element-a8mm"
    assert page.locator("#tree [data-designator] > .row > input:checked").count() == 1
    assert differ(thick, longer) > 0.005
    # texts that give no model are shown as text, over the last good one
    for text, version, said in ((BROKEN, 3, "hinge_thickness"), (HOSTILE, 4, "<img src=x")):
        assert len(np.unique(follows(text, version, looks=2).reshape(-1, 3), axis=0)) > 10
        assert said in page.inner_text("#live.broken") and "last good model" in page.inner_text("#live-said")
        assert page.inner_text("#part-number") == "macro-array-element-a8mm"
    assert page.locator("#live img").count() == 0
    # the file is gone: one line, and the page as it stood
    live.path.unlink()
    live.look()
    live.look()
    page.wait_for_selector("html[data-version='5']", state="attached", timeout=LOADED)
    assert "no such file" in page.inner_text("#live-said") and "\n" not in page.inner_text("#live-said")
    assert len(np.unique(picture().reshape(-1, 3), axis=0)) > 10
    assert page.inner_text("#part-number") == "macro-array-element-a8mm"
    back = follows(TEXT, 6)
    assert page.locator("#live.broken").count() == 0 and differ(back, longer) > 0.005
    assert troubles == [] and all(u.startswith((server.url, "blob:", "data:")) for u in asked)
    page.close()
