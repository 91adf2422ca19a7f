"""Chromium without a screen or a network, for tests of pages; its absence is a failure where a browser is
asked for (TACTCAD_NEEDS_BROWSER), else the tests are skipped."""

from __future__ import annotations

import io
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

# A virtual machine has no graphics card: the browser draws by software, which it does not offer by itself.
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
LOADED = 60_000  # ms, at most, on a busy machine
DRAWN = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
SET = """(input, value) => { input.value = value; input.dispatchEvent(new Event('input')); }"""
# Words of table cells that stand on two lines; a word ends at a blank or a hyphen.
BROKEN = """() => [...document.querySelectorAll('table')].flatMap((table) => {
  const found = [];
  for (const cell of table.querySelectorAll('td, th')) {
    const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
      for (const word of texts.currentNode.data.matchAll(/[^\\s-]+/g)) {
        const range = document.createRange();
        range.setStart(texts.currentNode, word.index);
        range.setEnd(texts.currentNode, word.index + word[0].length);
        if (range.getClientRects().length > 1) found.push(word[0]);
      }
    }
  }
  return found;
})"""


def chromium() -> str:
    """The browser's path; skips the test, or fails it, where there is none."""
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        why = "Chromium is not installed: on Debian, apt-get install chromium"
        if os.environ.get("TACTCAD_NEEDS_BROWSER"):
            pytest.fail(why)
        pytest.skip(why)
    return found


@contextmanager
def browser() -> Iterator[object]:
    """A running browser; Playwright's own are not needed."""
    path = chromium()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        running = play.chromium.launch(executable_path=path, args=[*SOFTWARE, "--no-sandbox"])
        yield running
        running.close()


class Opened:
    """A page opened from its file with the network off; `troubles` are errors and refused requests."""

    def __init__(
        self, running, path: Path, scheme: str = "light", size: tuple[int, int] = (1100, 640)
    ) -> None:
        width, height = size
        self.context = running.new_context(
            offline=True, color_scheme=scheme, viewport={"width": width, "height": height}
        )
        self.troubles: list[str] = []
        self.requests: list[str] = []
        self.page = self.context.new_page()
        self.page.on("pageerror", lambda error: self.troubles.append(str(error)))
        self.page.on("console", self._heard)
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("dialog", lambda dialog: (self.troubles.append(dialog.message), dialog.dismiss()))
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("html[data-ready]", timeout=LOADED)

    def _heard(self, message) -> None:
        if message.type in ("error", "warning"):
            self.troubles.append(message.text)

    def set(self, selector: str, value: float) -> None:
        """Move a slider."""
        self.page.locator(selector).evaluate(SET, value)

    def picture(self) -> np.ndarray:
        """The drawn view (rows, columns, 3), 0 to 255."""
        self.page.evaluate(DRAWN)
        shot = self.page.locator("#canvas canvas").first.screenshot()
        return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)

    def text(self, selector: str) -> str:
        return self.page.locator(selector).inner_text()

    def close(self) -> None:
        self.context.close()
