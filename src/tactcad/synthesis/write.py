"""Files of a synthesis in a folder: the design, the report, a design for each alternative."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from tactcad.design.design_text import design_text
from tactcad.design.files import absolute, flush_entry, make_folder, refusal
from tactcad.design.held import MAKING, held_folder, sweep_folders
from tactcad.design.messages import InputError

from .synthesise import Synthesis
from .target_answer import answer
from .target_report import record, report_json, report_page


def refuse_taken(out: str | Path) -> None:
    """Raise InputError where `out` is no new or empty folder, which is replaced in one step."""
    path = absolute(out)
    if os.path.islink(path):
        legal = "the folder that it leads to, or a new folder"
        raise InputError("--out", "is a link", value=str(out), legal=legal)
    if os.path.lexists(path) and not (path.is_dir() and not os.listdir(path)):
        raise InputError(
            "--out", "is there already and not an empty folder", value=str(out), legal="a new folder"
        )


def refuse_unwritable(out: str | Path) -> None:
    """Raise as `write` would for a place that is taken or cannot be written to, and leave nothing there."""
    refuse_taken(out)
    folder = absolute(out)
    place = folder.parent
    while not os.path.lexists(place):
        place = place.parent
    try:
        with held_folder(place, folder.name):
            pass
    except OSError as error:
        raise refusal(str(out), error) from error


def write(got: Synthesis, out: str | Path) -> None:
    """design.toml, front/NAME.toml, report.json and report.html: the whole folder in one step, or nothing.

    Raises InputError where `out` is taken or cannot be written to, CheckFailure where there is no room.
    """
    folder = absolute(out)
    refuse_taken(out)
    make_folder(folder.parent)
    try:
        sweep_folders(folder.parent, folder.name)
        with held_folder(folder.parent, folder.name) as own:
            making = own / MAKING
            for name, data in _files(got):
                (making / name).parent.mkdir(parents=True, exist_ok=True)
                (making / name).write_bytes(data)
                flush_entry(making / name)
            making.rename(folder)  # an empty folder gives way, any other refuses
            flush_entry(folder.parent)
    except OSError as error:
        raise refusal(str(out), error) from error


def _files(got: Synthesis) -> Iterator[tuple[str, bytes]]:
    target = got.target.target.name
    heading = f"{target}: by `tactcad design`.\n{answer(record(got))}"
    yield "design.toml", design_text(got.design, heading).encode()
    for entry in got.front[1:]:
        name = f"{target[:24].rstrip('-')}-{entry.name.replace('.', '-')}"
        text = design_text(got.as_design(entry.found, name), f"{name}: {entry.what}.")
        yield f"front/{entry.name}.toml", text.encode()
    yield "report.json", report_json(got)
    yield "report.html", report_page(got)
