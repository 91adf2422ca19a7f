"""A design file followed while it is written: the last good model, and what is wrong with the text since."""

from __future__ import annotations

import importlib
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tactcad.design.files import read_text
from tactcad.design.load import MOST_BYTES, parse
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import Design
from tactcad.export.shapes import Shapes
from tactcad.parts.rules import refuse_broken
from tactcad.scenes import chosen_scenes

from .live_record import live_record, number_changes

POLL = 0.1  # s between two looks at the file; chosen: a tenth of the second in which a change is to be seen


@dataclass(frozen=True)
class LiveState:
    """What the page is to show.

    version  grows with every change of the rest
    model    version at which the model changed last
    seconds  that the model took from the file's reading on
    message  why the file as it is now gives no model, "" where it does
    changes  of `number_changes`, from the model before
    """

    version: int
    model: int
    file: str
    seconds: float
    message: str
    changes: tuple[dict[str, Any], ...]


def load_kernel() -> None:
    """Load the kernel now: a first model from the cache did without, and the first save would wait for it."""
    for module in ("build", "bytes", "facets"):
        importlib.import_module(f"tactcad.solids.{module}")


class Live:
    """The file's last good model. One thread calls `look` again and again, others wait for changes."""

    def __init__(self, path: Path, scene: str, shapes: Callable[[], Shapes]) -> None:
        """`shapes` gives makers of solids that share their cache: one knows its shapes by part number, which
        stays when the part changes. Raises InputError where the file is no design that keeps its rules."""
        self.path, self.scene, self.shapes = path, scene, shapes
        self.changed = threading.Condition()
        self._text: str | None = None
        self._trouble = ""
        started = time.perf_counter()
        self._text = self._read()
        self.design, self.record, self.block = self._made(self._text)
        self.shown = LiveState(0, 0, str(path), time.perf_counter() - started, "", ())

    def look(self) -> None:
        """Take up the file where it changed."""
        started = time.perf_counter()
        try:
            text: str | None = self._read()
        except InputError as error:
            self._later(None, str(error))
            return
        if text == self._text:
            self._trouble = ""
            return
        assert text is not None
        try:
            design, record, block = self._made(text)
        except (InputError, CheckFailure) as error:
            self._later(text, str(error))
        except Exception as error:  # what is being written may be what nobody tried: the page stays up
            traceback.print_exc()
            self._later(text, f"{type(error).__name__}: {error}")
        else:
            self._take(text, (design, record, block), started)

    def state(self) -> tuple[LiveState, dict[str, Any], bytes]:
        """What is to be shown, with the record and the block of the same version."""
        with self.changed:
            return self.shown, self.record, self.block

    def after(self, version: int, seconds: float) -> tuple[LiveState, dict[str, Any], bytes]:
        """The same once it is another version than that, or after so many seconds."""
        with self.changed:
            self.changed.wait_for(lambda: self.shown.version != version, seconds)
            return self.state()

    def _read(self) -> str:
        return read_text(self.path, MOST_BYTES, "a design file (TOML)")

    def _made(self, text: str) -> tuple[Design, dict[str, Any], bytes]:
        design = parse(text, str(self.path))
        refuse_broken(design)
        (scene,) = chosen_scenes(design, [self.scene])
        return design, *live_record(design, scene, self.shapes())

    def _later(self, text: str | None, message: str) -> None:
        """Show the message when it stands at a second look: an editor may be writing, or replacing, the
        file."""
        if message != self._trouble:
            self._trouble = message
            return
        self._text = text
        if message != self.shown.message:
            s = self.shown
            self._tell(LiveState(s.version + 1, s.model, s.file, s.seconds, message, s.changes))

    def _take(self, text: str, made: tuple[Design, dict[str, Any], bytes], started: float) -> None:
        design, record, block = made
        changes = number_changes((self.design, self.record), (design, record))
        self._text, self._trouble, s = text, "", self.shown
        if not changes and not s.message:
            return  # a comment
        new = s.version + 1
        with self.changed:
            self.design, self.record, self.block = made
            kept = tuple(map(asdict, changes)) or s.changes  # a mended text may be the one before
            model = new if changes else s.model
            self._tell(LiveState(new, model, s.file, time.perf_counter() - started, "", kept))

    def _tell(self, shown: LiveState) -> None:
        with self.changed:
            self.shown = shown
            self.changed.notify_all()
