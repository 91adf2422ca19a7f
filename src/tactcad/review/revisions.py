"""A git revision as a side of a comparison: a design as it was committed, and if asked for its code.

The present code reads the design's text. A revision's own code runs only if the user asks for it: from a
checkout, in a process of its own, and tells the record of geometry by the command that every revision has:
the difference from a golden file without parts. If it does not run here, the revision's committed golden file
stands for it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tactcad.design.files import read_bytes
from tactcad.design.load import MOST_BYTES, find, from_table
from tactcad.design.messages import InputError
from tactcad.design.toml_text import parse_toml
from tactcad.export.geometry import Record
from tactcad.export.golden_file import MOST_BYTES as MOST_GOLDEN
from tactcad.export.golden_file import SCHEMA, read_golden
from tactcad.export.golden_schema import faults
from tactcad.export.inputs import flattened
from tactcad.export.sides import Side, design_side, design_values, read_side

from .repository import TREE, Repository, repository_of

WORKING = "."  # in place of a revision: the files as they stand
CODE = "src/tactcad/__main__.py"
SECONDS = 300  # a revision's code may take; chosen: the largest array takes some 30
# The tactcad of that folder or none: an installed one must not stand in for it, which is found out before
# anything of that folder runs.
DRIVER = """\
import importlib.util, runpy, sys
source = sys.argv.pop(1)
sys.path.insert(0, source)
found = importlib.util.find_spec("tactcad").origin
if not str(found).startswith(source):
    sys.exit(f"{found} is loaded instead")
runpy.run_module("tactcad", run_name="__main__", alter_sys=True)
"""


class _NotBuilt(Exception):
    """The revision's code does not run here, or gives no record; says why."""


def revision_sides(
    old: str, new: str, design: str, their_code: Callable[[str], None] | None = None
) -> tuple[Side, Side]:
    """Two revisions of one design.

    Parameters
    ----------
    old, new
        Commits, branches or tags, as HEAD~3; WORKING for the files as they stand, by the present code.
    design
        A path, or a name in hardware/.
    their_code
        Receives what is about to run, from where: each revision's own code. None: no code of theirs runs,
        the present one reads their designs.

    Raises
    ------
    InputError
        Where there is no repository, no such revision, no such design in it, or no way to compare it.
    """
    file = design_file(design)
    with repository_of(file) as repository:
        path = repository.path_of(file)
        named = [(name, None if name == WORKING else repository.commit(name)) for name in (old, new)]

        def side(name: str, commit: str | None, other: bytes | None) -> Side:
            if commit is None:
                return read_side(str(file))
            return _Revision(repository, name, commit, path).side(their_code, other)

        def text(commit: str | None) -> bytes | None:
            if commit is None:
                return read_bytes(file, MOST_BYTES, "a design file (TOML)")
            return repository.file(commit, path, MOST_BYTES)

        (first, one), (second, other) = named
        return side(first, one, None), side(second, other, text(one))


def design_file(design: str) -> Path:
    """Where the design's file stands at the end of all links, or would stand: a revision may have what is
    gone now. Raises InputError as `find` does."""
    try:
        file = find(design)
    except InputError:
        file = Path("hardware") / f"{design}.toml"
    if "\0" in design:
        raise InputError("DESIGN", "a NUL in its name", value=design, legal="a path or a name")
    return Path(os.path.realpath(file))


@dataclass(frozen=True)
class _Revision:
    repository: Repository
    name: str
    commit: str
    path: str

    @property
    def source(self) -> str:
        return f"{self.name}:{self.path}"

    def side(self, their_code: Callable[[str], None] | None, other: bytes | None) -> Side:
        """The side; its own code, where it runs, is asked for the `other` side's design, too."""
        text = self._file(self.path, MOST_BYTES)
        if text is None:
            raise InputError(self.source, "no such design in that revision", legal="one that was committed")
        try:
            table = parse_toml(text.decode("utf-8-sig"), self.source)
        except UnicodeDecodeError:
            raise InputError(self.source, "is not UTF-8 text", legal="a design file (TOML)") from None
        if their_code is None or self._file(CODE, MOST_BYTES) is None:
            told = f"the code of {self.name}: its design is by the present code"
            return design_side(self.source, "revision", table, (told,))
        their_code(f"runs {CODE} of {self.name} ({self.commit[:12]}) of {str(self.repository.root)!r} as you")
        folder = self.repository.checked_out(self.commit)
        try:
            side = self._told(table, _record(folder, folder / TREE / self.path))
        except _NotBuilt as why:
            told = f"geometry of {self.name}, which was not built ({why}): its golden file stands for it"
            return replace(self._told(table, self._golden(table, folder, why)), untold=(told,))
        if other is None:
            return side
        (folder / "other.toml").write_bytes(other)
        try:
            return replace(side, of_other=_record(folder, folder / "other.toml"))
        except _NotBuilt as why:
            told = f"the codes: that of {self.name} refuses the other design ({why})"
            return replace(side, untold=(told,))

    def _told(self, table: dict[str, Any], record: Record) -> Side:
        """The side with this record by its own code; its values as far as the present code can read them."""
        try:
            values = design_values(flattened(from_table(table)))
        except InputError:
            values = None
        sections = {name: record[name] for name in ("parts", "scenes", "elements")}
        return Side(
            self.source,
            "revision",
            record["design"],
            record["revision"],
            sections,
            values,
            table=table,
            own_code=True,
        )

    def _golden(self, table: dict[str, Any], folder: Path, why: _NotBuilt) -> Record:
        """The golden file that was committed beside the design's hardware/."""
        file, name = Path(self.path), table.get("design", {}).get("name")
        place = file.parent.parent / "exports" / "golden" / f"{name}.json"
        data = self._file(place.as_posix(), MOST_GOLDEN) if file.parent.name == "hardware" else None
        if data is None:
            refused = f"its code does not run here ({why}), and it has no golden file"
            raise InputError(self.source, refused, legal="without --their-code")
        (folder / "golden.json").write_bytes(data)
        return read_golden(folder / "golden.json")

    def _file(self, path: str, most_bytes: int) -> bytes | None:
        return self.repository.file(self.commit, path, most_bytes)


def _record(folder: Path, design: Path) -> Record:
    """What the code in the folder's checkout makes of a design. Raises _NotBuilt."""
    nothing = {"schema": SCHEMA, "design": "none", "revision": "A", "parts": {}, "scenes": {}, "elements": {}}
    (folder / "nothing.json").write_text(json.dumps(nothing))
    source = folder / TREE / "src"
    # -I: neither PYTHONPATH nor the working folder is looked into, and no sitecustomize of theirs
    command = [sys.executable, "-I", "-c", DRIVER, str(source), "diff", "nothing.json", str(design), "--json"]
    try:
        run = subprocess.run(
            command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS, check=False
        )
    except subprocess.TimeoutExpired:
        raise _NotBuilt(f"its code took more than {SECONDS} s") from None
    if run.returncode:
        said = run.stderr.decode(errors="replace").strip().splitlines() or [f"exit status {run.returncode}"]
        raise _NotBuilt(said[-1][:200].replace(str(folder / TREE), "").removeprefix("tactcad: "))
    try:
        return _from_nothing(json.loads(run.stdout))
    except (ValueError, LookupError, TypeError) as error:
        raise _NotBuilt(f"its record cannot be understood: {error}") from None


def _from_nothing(said: dict[str, Any]) -> Record:
    """The record whose every part, scene and element was said to be added. Raises ValueError, LookupError or
    TypeError where it is none."""
    record: Record = {"schema": SCHEMA, **{name: said["new"][name] for name in ("design", "revision")}}
    record |= {"parts": {}, "scenes": {}, "elements": {}}
    for change in said["changes"]:
        if change["kind"] == "added":
            section, name = change["path"]
            record[section][name] = change["new"]
    if wrong := faults(record, SCHEMA):
        raise ValueError(wrong)
    return record
