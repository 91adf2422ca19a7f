"""The page: facts, meshes and the viewer in one file of HTML that opens without server or network."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from tactcad import __version__
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.export.shapes import Shapes
from tactcad.parts.element import element_number
from tactcad.parts.layout import Layout
from tactcad.scenes import make_scene

from .element_facts import element_facts
from .finding_facts import finding_facts
from .mesh_pack import MeshPack, mesh_pack
from .part_facts import part_facts
from .scene_facts import scene_facts
from .strain_field import strain_field
from .viewer_library import ViewerLibrary, viewer_library

SCHEMA = "tactcad-review-1"
# The page's own script, in the order in which it is put together.
SCRIPTS = ("data", "view", "tree", "panel", "measure", "strain", "controls", "start")
# Nothing is fetched: not even the page's own address. Scripts are the page's one, known by its digest, and
# the viewer, which that unpacks into a blob; the viewer sets styles itself and draws its symbols from data.
POLICY = (
    "default-src 'none'; script-src 'sha256-{digest}' blob:; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'"
)


def review_page(
    design: Design,
    scene_names: Sequence[str],
    shapes: Shapes,
    say: Callable[[int, int, str], None],
    sheets: Mapping[str, str],
) -> bytes:
    """The page (HTML, UTF-8), equal bytes for equal input.

    Parameters
    ----------
    design
        Must keep its rules.
    scene_names
        The scenes to show, the first one first.
    shapes
        Makes solids, or takes them from its cache.
    say
        Receives (done, total, text) as the work goes on.
    sheets
        Drawing sheets (SVG) by part number.

    Raises
    ------
    CheckFailure
        Where the viewer is not installed.
    """
    library = viewer_library()
    scenes = tuple(make_scene(design, name) for name in scene_names)
    parts = list({part.part_no: part for scene in scenes for part in scene.parts}.values())
    total = len(parts) + 2
    say(0, total, "estimates and virtual builds")
    elements, made, lines = element_facts(design, scenes)
    done = iter(range(1, total))
    pack = mesh_pack(parts, shapes, lambda part_no: say(next(done), total, part_no))
    say(total - 1, total, "checks")
    findings = finding_facts(design, scenes, shapes, lambda *_: None)
    strains, block = _strains(design, pack)
    identity = design.design
    record = {
        "schema": SCHEMA,
        "tactcad": __version__,
        "design": {
            name: getattr(identity, name)
            for name in ("name", "title", "revision", "date", "author", "organisation")
        },
        "parts": [
            {
                **asdict(part_facts(p, made.variables, lines)),
                "mesh": pack.table[p.part_no],
                "box": pack.boxes[p.part_no],
            }
            for p in parts
        ],
        "scenes": [asdict(scene_facts(design, scene)) for scene in scenes],
        "array": asdict(elements),
        "rating": design.rating.force,
        "strains": strains,
        "findings": [asdict(f) for f in findings],
        "sheets": dict(sheets),
    }
    say(total, total, "done")
    return assembled(f"{identity.title}, revision {identity.revision}", record, block, library)


def _strains(design: Design, pack: MeshPack) -> tuple[dict[str, Any], bytes]:
    """By element part number the strain field's arrays in the block, which it continues."""
    layout, block = Layout(design), pack.block
    table: dict[str, Any] = {}
    for place in layout.elements:
        number = element_number(design, place)
        if number in table:
            continue
        try:
            field = strain_field(layout, place)
        except CheckFailure as error:
            table[number] = {"why_not": str(error)}
            continue
        table[number] = {"load_arm": place.load_arm, "hinge_x": place.hinge_x, "hinge": place.hinge.t}
        for name, kind in (("points", "<f4"), ("moved", "<f4"), ("strain", "<f4"), ("quads", "<u4")):
            array = np.ascontiguousarray(getattr(field, name), kind)
            table[number][name] = (len(block), int(array.size))
            block += array.tobytes()
    return table, block


def assembled(title: str, record: Mapping[str, Any], block: bytes, library: ViewerLibrary) -> bytes:
    """The page of a record.

    Parameters
    ----------
    title
        Of the window.
    record
        What the page's script reads; plain data.
    block
        The arrays that the record points into.
    library
        The viewer.
    """
    folder = files(__package__)
    script = "'use strict';\n" + "".join(folder.joinpath(f"{name}.js").read_text("utf-8") for name in SCRIPTS)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    places = {
        "POLICY": POLICY.format(digest=digest),
        "TITLE": escape(title),
        "STYLE": folder.joinpath("page.css").read_text("utf-8"),
        "VIEWER_STYLE": library.style.replace("</", "<\\/"),
        "LICENCES": _licences(folder.joinpath("licences.txt").read_text("utf-8"), library),
        "DATA": packed(_text(record).encode()),
        "BLOCK": packed(block),
        "VIEWER": packed(library.script),
        "SCRIPT": script,
    }
    page = folder.joinpath("page.html").read_text("utf-8")
    pieces = page.split("@@")  # text, name, text, name, ..., text: what is put in is not read again
    pieces[1::2] = [places[name] for name in pieces[1::2]]
    return "".join(pieces).encode()


def _text(record: Mapping[str, Any]) -> str:
    return json.dumps(record, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def packed(data: bytes) -> str:
    """Compressed (gzip, without time or name) and as base64."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


def _licences(text: str, library: ViewerLibrary) -> str:
    return escape(text.replace("VERSION", library.version).replace("PACKAGE", library.package))
