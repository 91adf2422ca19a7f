"""The viewer in three dimensions that a page carries: three-cad-viewer (MIT), from the package ocp-viewer.

It is read from the installed package and never imported: its server is not needed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from tactcad.design.extras import install
from tactcad.design.messages import CheckFailure, InputError

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
        Where it is not installed; says how to get it.
    CheckFailure
        Where it is not whole, or not of the version that the page needs.
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
