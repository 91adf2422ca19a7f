"""The page: a record, its arrays and the viewer in one file of HTML that opens without server or network.

The viewer in three dimensions is three-cad-viewer (MIT), from the package ocp-viewer. It is read from the
installed package and never imported: its server is not needed.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tactcad.design.messages import CheckFailure, InputError, install

# The page's own script, in the order in which it is put together.
SCRIPTS = "data view tree panel measure strain strain_body controls changes start".split()
LIVE = "live"  # after those, if the page is served and follows a file
# Nothing is fetched: not even the page's own address. Scripts are the page's one, known by its digest, and
# the viewer, which that unpacks into a blob; the viewer sets styles itself and draws its symbols from data.
POLICY = (
    "default-src 'none'; script-src 'sha256-{digest}' blob:; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'"
)
ASKS = "; connect-src 'self'"  # a live page alone: the server that it came from
PACKAGE, DISTRIBUTION = "ocp_viewer", "ocp-viewer"
SCRIPT = "server/static/js/three-cad-viewer.esm.js"
STYLE = "server/static/css/three-cad-viewer.css"
INSTALL = install("review")
# The fifth major version's calls are what the page's script makes.
VERSION = re.compile(r'^const version = "(5\.[\d.]+)";', re.MULTILINE)


@dataclass(frozen=True)
class ViewerLibrary:
    """The viewer's script (an ES module) and style sheet, its own version, and that of the package."""

    script: bytes
    style: str
    version: str
    package: str


def viewer_library() -> ViewerLibrary:
    """The installed viewer.

    Raises
    ------
    InputError
        If it is not installed; the message gives the command.
    CheckFailure
        If it is not whole, or not of the version that the page needs.
    """
    spec = find_spec(PACKAGE)
    if spec is None or not spec.submodule_search_locations:
        raise InputError("the page's viewer", f"{DISTRIBUTION} is not installed", legal=INSTALL)
    folder = Path(next(iter(spec.submodule_search_locations)))
    try:
        script, style = (folder / SCRIPT).read_bytes(), (folder / STYLE).read_text("utf-8")
        package = version(DISTRIBUTION)
    except (OSError, UnicodeDecodeError, PackageNotFoundError):
        raise CheckFailure(f"{DISTRIBUTION} is installed without its viewer: {INSTALL}") from None
    found = VERSION.search(script.decode("utf-8", "replace"))
    if found is None:
        raise CheckFailure(f"{DISTRIBUTION} {package} holds no three-cad-viewer 5: {INSTALL}")
    return ViewerLibrary(script, style, found[1], package)


def review_page(record: Mapping[str, Any], block: bytes, library: ViewerLibrary) -> bytes:
    """The page (HTML, UTF-8).

    Parameters
    ----------
    record, block
        As `review_record` or `change_record` gives them; texts in it may hold anything, the
        page shows them as text.
    library
        The viewer.
    """
    folder, identity = files(__package__), record["design"]
    live = LIVE in record
    names = (*SCRIPTS, LIVE) if live else SCRIPTS
    script = "'use strict';\n" + "".join(folder.joinpath(f"{name}.js").read_text("utf-8") for name in names)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    licences = folder.joinpath("licences.txt").read_text("utf-8")
    licences = licences.replace("VERSION", library.version).replace("PACKAGE", library.package)
    places = {
        "POLICY": POLICY.format(digest=digest) + (ASKS if live else ""),
        "TITLE": escape(f"{identity['title']}, revision {identity['revision']}"),
        "STYLE": folder.joinpath("page.css").read_text("utf-8"),
        "VIEWER_STYLE": library.style.replace("</", "<\\/"),
        "LICENCES": escape(licences),
        "DATA": packed(_text(record).encode()),
        "BLOCK": packed(block),
        "VIEWER": packed(library.script),
        "SCRIPT": script,
    }
    page = folder.joinpath("page.html").read_text("utf-8")
    pieces = page.split("@@")  # text, name, text, name, ..., text: inserted text is not expanded again
    pieces[1::2] = [places[name] for name in pieces[1::2]]
    return "".join(pieces).encode()


def _text(record: Mapping[str, Any]) -> str:
    return json.dumps(record, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def packed(data: bytes) -> str:
    """Compressed (gzip, without time or name) and as base64."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()
