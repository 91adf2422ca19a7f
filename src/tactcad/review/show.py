"""Showing a design from Python: as a page in a notebook, and in OCP CAD Viewer for VS Code."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import CommonTables
from tactcad.export.inputs import flattened, nested
from tactcad.export.sides import compare_sides, design_side
from tactcad.parts.rules import refuse_broken
from tactcad.scenes import chosen_scenes, make_scene

from .change_record import change_record
from .consequences import meaning
from .facts import scene_facts
from .review_page import review_page, viewer_library
from .review_record import review_record
from .subject import shapes_of, subject

HEIGHT = 720  # px of a page in a notebook; chosen: the whole page fits a laptop's screen with its cell
VSCODE = "ocp_vscode"
INSTALL = "pip install ocp-vscode, of the same version as the extension OCP CAD Viewer"
OPEN = "in VS Code run the command 'OCP CAD Viewer: Open viewer', elsewhere `python -m ocp_viewer`"


@dataclass(frozen=True)
class ShownPage:
    """A page with its title; `html` (UTF-8) is the file that `tactcad review` writes.

    As the last value of a notebook's cell it shows itself, without a server: the whole page lies in the
    cell's output.
    """

    title: str
    html: bytes = field(repr=False)

    def _repr_html_(self) -> str:
        # a frame without an origin of its own: the page's script cannot reach the notebook
        return (
            f'<iframe title="{escape(self.title)}" sandbox="allow-scripts allow-forms" '
            f'style="width: 100%; height: {HEIGHT}px; border: 0" '
            f'srcdoc="{escape(self.html.decode())}"></iframe>'
        )


def show(design: str | Path | CommonTables, scene: str = "array") -> ShownPage:
    """The review page of one scene of a design.

    Parameters
    ----------
    design
        A path, a name in hardware/, an export's folder, or a design that was read and perhaps changed.
    scene
        One of `tactcad.scenes.scene_names`.

    Raises
    ------
    InputError
        If there is no such design or scene, or the design breaks a rule.
    CheckFailure
        If the page's viewer, the extra `review`, is not installed.
    """
    library = viewer_library()  # report a missing one before any work
    read, sheets = _read(design)
    shapes = shapes_of(read, warnings.warn)
    record, block = review_record(read, chosen_scenes(read, [scene]), shapes, _quiet, sheets)
    shapes.cache.trim()
    return ShownPage(_title(read), review_page(record, block, library))


def show_changes(before: str | Path | CommonTables, after: str | Path | CommonTables) -> ShownPage:
    """The page of what changed between two designs, and what each change means.

    Parameters
    ----------
    before, after
        As `show` takes them; both are built by the present code.

    Raises
    ------
    InputError
        As `show`.
    CheckFailure
        As `show`, and if the designs have no scene in common.
    """
    library = viewer_library()
    designs = _read(before)[0], _read(after)[0]
    old, new = (
        design_side(name, "design", nested(flattened(design)))
        for name, design in zip((_named(before, "before"), _named(after, "after")), designs)
    )
    shapes = shapes_of(designs[0], warnings.warn), shapes_of(designs[1], warnings.warn)
    record, block = change_record(
        (old, new), designs, shapes, compare_sides(old, new), meaning(old, new), _quiet
    )
    return ShownPage(record["design"]["title"], review_page(record, block, library))


def show_in_vscode(design: str | Path | CommonTables, scene: str = "array") -> None:
    """The parts of one scene in OCP CAD Viewer: a tree of sub-assemblies and designators, with colours.

    Parameters
    ----------
    design, scene
        As `show` takes them.

    Raises
    ------
    InputError
        As `show`.
    CheckFailure
        If the package ocp-vscode is not installed, or no viewer listens.
    """
    viewer = _listening()
    read, _ = _read(design)
    (name,) = chosen_scenes(read, [scene])
    made, shapes = make_scene(read, name), shapes_of(read, warnings.warn)
    under = {p["designator"]: p["under"] for p in scene_facts(read, made)["placed"]}
    solids = {part.part_no: shapes.of(part) for part in made.parts}
    tree = importlib.import_module("tactcad.solids.assembly_tree")  # loads the kernel
    viewer.show(tree.assembly_tree(made, solids, under), progress="")


def _listening() -> ModuleType:
    """The package ocp-vscode, with a viewer that listens. Raises CheckFailure if there is none."""
    if find_spec(VSCODE) is None:
        raise CheckFailure(f"ocp-vscode is not installed: {INSTALL}")
    package = importlib.import_module(VSCODE)

    def listens() -> bool:
        port = package.get_port()  # looks for one at its first call
        return port is not None and package.port_check(port, package.get_host())

    if not listens():
        package.find_and_set_port()  # one may have been opened since
        if not listens():
            raise CheckFailure(f"no OCP CAD Viewer listens: {OPEN}")
    return package


def _read(design: str | Path | CommonTables) -> tuple[CommonTables, Mapping[str, str]]:
    """The design, which keeps its rules, and the drawing sheets (SVG by part number) that lie with it."""
    if isinstance(design, CommonTables):
        refuse_broken(design)
        return design, {}
    if not isinstance(design, str | Path):
        legal = "a path, a name in hardware/, or a design; of a scene its name, as show(design, scene)"
        raise InputError("design", "no design", value=type(design).__name__, legal=legal)
    seen = subject(str(design))
    return seen.design, seen.sheets


def _named(design: str | Path | CommonTables, otherwise: str) -> str:
    return otherwise if isinstance(design, CommonTables) else str(design)


def _title(design: CommonTables) -> str:
    return f"{design.design.title}, revision {design.design.revision}"


def _quiet(done: int, total: int, text: str) -> None:
    """No progress: a notebook shows by itself that it is busy."""
