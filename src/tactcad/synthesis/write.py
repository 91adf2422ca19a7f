"""Files of a synthesis in a folder: the design, the report, a design for each alternative."""

from __future__ import annotations

import os
from pathlib import Path

from tactcad.design.design_text import design_text
from tactcad.design.files import absolute, make_folder, write_whole
from tactcad.design.messages import InputError

from .synthesise import Synthesis
from .target_report import answer, record, report_json, report_page


def refuse_taken(out: str | Path) -> None:
    """Raise InputError where `out` is no new or empty folder."""
    path = absolute(out)
    if os.path.lexists(path) and not (path.is_dir() and not os.listdir(path)):
        raise InputError(
            "--out", "is there already and not an empty folder", value=str(out), legal="a new folder"
        )


def write(got: Synthesis, out: str | Path) -> None:
    """design.toml, front/NAME.toml, report.json and, last, report.html."""
    folder = absolute(out)
    refuse_taken(out)
    make_folder(folder)
    heading = f"{got.target.target.name}: by `tactcad design`.\n{answer(got.target, record(got))}"
    write_whole(folder / "design.toml", design_text(got.design, heading).encode())
    if len(got.front) > 1:
        make_folder(folder / "front")
        for entry in got.front[1:]:
            name = f"{got.target.target.name[:24].rstrip('-')}-{entry.name.replace('.', '-')}"
            text = design_text(got.as_design(entry.found, name), f"{name}: {entry.what}.")
            write_whole(folder / "front" / f"{entry.name}.toml", text.encode())
    write_whole(folder / "report.json", report_json(got))
    write_whole(folder / "report.html", report_page(got))
