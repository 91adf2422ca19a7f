"""A design as FreeCAD's own document (FCStd), made by FreeCAD where it is installed, without a screen."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tactcad.design.files import scratch_folder
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import Design
from tactcad.export.shapes import Shapes
from tactcad.scenes import make_scene

from .finding_facts import finding_facts
from .freecad_record import freecad_record
from .scene_facts import scene_facts

COMMANDS = ("freecad", "FreeCAD")
SCRIPT = Path(__file__).with_name("peers") / "freecad_document.py"
RELOAD = SCRIPT.with_name("freecad_reload.py")
SECONDS = 600  # chosen: a large array is imported in seconds, a first start on a slow disk in a minute


def program() -> str:
    """FreeCAD's window program, which alone keeps colours. Raises CheckFailure where it is not installed."""
    found = next(filter(None, map(shutil.which, COMMANDS)), None)
    if found is None:
        raise CheckFailure(
            "FreeCAD is not installed, no document was written; on Debian or Ubuntu: apt-get install freecad "
            "(0.20 or later), elsewhere see freecad.org"
        )
    return found


def refuse_no_document(out: str) -> None:
    """What keeps a document from being made at `out`, before any work.

    Raises InputError where it is no document's name, CheckFailure where FreeCAD is not installed.
    """
    if not out.endswith(".FCStd"):
        raise InputError("--freecad", "not a document of FreeCAD", value=out, legal="NAME.FCStd")
    program()


def freecad_document(
    design: Design, scene_names: Sequence[str], shapes: Shapes, say: Callable[[int, int, str], None]
) -> bytes:
    """The document.

    Parameters
    ----------
    design
        Must keep its rules.
    scene_names
        The scenes to hold; the first one is shown.
    shapes
        Makes solids, or takes them from its cache.
    say
        Receives (done, total, text) as the work goes on.

    Raises
    ------
    CheckFailure
        Where FreeCAD is not installed, or ends without a document.
    """
    command = program()
    scenes = tuple(make_scene(design, name) for name in scene_names)
    parts = {part.part_no: part for scene in scenes for part in scene.parts}
    total = len(parts) + 1
    say(0, total, "checks")
    findings = finding_facts(design, scenes, shapes, lambda *_: None)
    facts = [scene_facts(design, scene) for scene in scenes]
    record = freecad_record(design, facts, parts, findings)
    texts = (shapes.text_of(part) for part in parts.values())
    return made_by_freecad(command, record, texts, lambda n, what: say(n, total, what))


def reload_macro(arguments: Sequence[str], document: Path) -> bytes:
    """FreeCAD's macro that makes the document again, by this tactcad with these arguments, and reloads it."""
    text = RELOAD.read_text("utf-8")
    for line, value in (
        ('COMMAND = ["tactcad"]', [sys.executable, "-P", "-m", "tactcad", *arguments]),
        ('FOLDER = "."', os.getcwd()),
        ('DOCUMENT = "review.FCStd"', os.path.realpath(document)),
    ):
        text = text.replace(line, f"{line.partition(' ')[0]} = {value!r}")
    return text.encode()


def made_by_freecad(
    command: str, record: Mapping[str, Any], texts: Iterable[bytes], say: Callable[[int, str], None]
) -> bytes:
    """The document of a record.

    Parameters
    ----------
    command
        As `program` found it.
    record
        As `peers/freecad_document.py` reads it.
    texts
        The shapes of its parts (BREP), in their order.
    say
        Receives (done, text) as the work goes on.

    Raises
    ------
    CheckFailure
        Where FreeCAD ends without a document.
    """
    with scratch_folder("freecad") as folder:
        for n, (part, text) in enumerate(zip(record["parts"], texts, strict=True)):
            say(n + 1, part["part_no"])
            (folder / part["file"]).write_bytes(text)
        (folder / "record.json").write_text(json.dumps(record), encoding="utf-8")
        say(len(record["parts"]) + 1, "FreeCAD")
        return _run(command, folder)


def _run(command: str, folder: Path) -> bytes:
    out = folder / "review.FCStd"
    more = {"TACTCAD_RECORD": str(folder / "record.json"), "TACTCAD_OUT": str(out)}
    (folder / "user.cfg").write_text(profile())
    try:
        run = subprocess.run(
            [command, "-u", str(folder / "user.cfg"), str(SCRIPT)],
            env=environment(folder) | more,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            text=True,
            errors="replace",
            timeout=SECONDS,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CheckFailure(f"FreeCAD could not be run: {error}") from error
    if not out.is_file() or not (folder / "done").is_file():
        said = [line for line in (run.stdout + run.stderr).splitlines() if "rror" in line]
        raise CheckFailure("FreeCAD ended without a document" + (f": {said[-1]}" if said else ""))
    return out.read_bytes()


def environment(folder: Path) -> dict[str, str]:
    """Variables under which FreeCAD runs without a screen, and leaves nothing outside `folder`."""
    runtime = folder / "run"
    runtime.mkdir(mode=0o700)
    own = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "TMPDIR"), str(folder))
    return {**os.environ, **own, "QT_QPA_PLATFORM": "offscreen", "XDG_RUNTIME_DIR": str(runtime)}


def profile(*imports: str) -> str:
    """A user's settings as FreeCAD keeps them: no start page, and groups of settings of its importers."""

    def group(name: str, *inside: str) -> str:
        return f'<FCParamGroup Name="{name}">{"".join(inside)}</FCParamGroup>'

    general = group("General", '<FCText Name="AutoloadModule">PartWorkbench</FCText>')
    settings = group("Mod", group("Import", *imports)) if imports else ""
    tree = group("Root", group("BaseApp", group("Preferences", general, settings)))
    return f'<?xml version="1.0" encoding="UTF-8" standalone="no" ?>\n<FCParameters>{tree}</FCParameters>\n'
