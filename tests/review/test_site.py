"""The documentation's site in a real browser, opened from its file with the network off."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from browser import BROKEN

from tactcad.synthesis.target_report import STYLE, table

ROOT = Path(__file__).parents[2]
SIZES = ((1400, 900), (1920, 1080), (800, 1000), (390, 844))
pytestmark = pytest.mark.slow  # builds the site, starts a browser


@pytest.fixture(scope="module")
def site() -> Path:
    done = subprocess.run(["packaging/docs.sh"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return ROOT / "exports" / "docs"


@pytest.fixture
def opened(running, site):
    """Opens a page of the site; nothing but files may be asked for."""
    contexts, asked = [], []

    def open_(name: str, scheme: str = "light", size: tuple[int, int] = (1400, 900)):
        width, height = size
        contexts.append(
            running.new_context(
                offline=True, color_scheme=scheme, viewport={"width": width, "height": height}
            )
        )
        page = contexts[-1].new_page()
        page.on("request", lambda request: asked.append(request.url))
        page.on("pageerror", lambda error: asked.append(str(error)))
        page.goto((site / name).as_uri())
        return page

    yield open_
    for context in contexts:
        context.close()
    assert all(url.startswith(("file:", "data:", "blob:")) for url in asked)


def test_it_is_searched_without_a_server(opened):
    page = opened("index.html")
    page.keyboard.press("Control+k")
    page.locator("input:visible").first.fill("hinge thickness")
    page.wait_for_selector("a[href*='reference-schema.html']:visible mark, a:visible:has-text('[element]')")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_is_light_or_dark_as_the_system_is(opened, scheme):
    page = opened("mechanics.html", scheme)
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)")
    assert (max(ground) < 60) == (scheme == "dark")
    formulas = page.locator(".formula math")
    assert formulas.count() == 4 and "\\frac" not in page.content()
    assert formulas.first.bounding_box()["height"] > 150  # five lines


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize(
    "name", ["index.html", "mechanics.html", "reference-schema.html", "tutorial-sensor.html"]
)
def test_no_cell_is_narrower_than_its_longest_word(opened, name, size):
    page = opened(name, size=size)
    assert page.evaluate(BROKEN) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]


def test_the_report_of_a_target_fits_a_phone(running, tmp_path):
    """A table that is wider is scrolled by itself, not with the page."""
    wide = table([f"column-{n}" for n in range(12)], [["0123456789"] * 12])
    (tmp_path / "report.html").write_text(f"<style>{STYLE}</style>{wide}")
    page = running.new_page(viewport={"width": 390, "height": 844})
    page.goto((tmp_path / "report.html").as_uri())
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.close()
