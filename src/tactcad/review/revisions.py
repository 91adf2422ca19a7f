"""A git revision as a side of a comparison: the committed design, and on request its code.

The present code reads the design's text. A revision's own code runs only if the user asks for it: from a
checkout, in a process of its own, and gives the record of geometry by a command that every revision has: the
difference from a golden file without parts. If it does not run here, the revision's committed golden file is
used.

Nothing else of a repository runs. git finds it and names its commits, and refuses one of another owner
(safe.directory); objects are read through an empty repository of ours, to which that one lends its objects
and nothing else: no settings, hooks, filters or replacements. Nothing is ever fetched.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tactcad import shutdown
from tactcad.design.files import read_bytes, scratch_folder
from tactcad.design.load import MOST_BYTES, find, from_table
from tactcad.design.messages import InputError
from tactcad.design.text_values import parse_toml
from tactcad.export.geometry import Record
from tactcad.export.golden_file import MOST_BYTES as MOST_GOLDEN
from tactcad.export.golden_file import SCHEMA, faults, read_golden
from tactcad.export.inputs import flattened
from tactcad.export.sides import Side, design_side, design_values, read_side

WORKING = "."  # in place of a revision: the present files
CODE = "src/tactcad/__main__.py"
SECONDS = 300  # a revision's code may take; chosen: the largest array takes some 30
TREE = "tree"  # a checkout in its folder
# Of the variables that lead git elsewhere than to the folder it is given, these are the user's settings.
KEPT = ("GIT_CONFIG", "GIT_CEILING_DIRECTORIES")
# A partial clone names a command that fetches what is missing (core.sshCommand, ext::): none may start.
NO_FETCH = {"GIT_ALLOW_PROTOCOL": "", "GIT_NO_LAZY_FETCH": "1"}
LEGAL = "a design in a git work tree of your own"
LINK, SUBMODULE = b"120000", b"160000"  # modes of git's tree entries
# A name, as git check-ref-format takes it, and steps to parents. Searches (:/text, ^{/text}) and the reflog
# (@{-1}) are excluded.
REVISION = re.compile(
    r"(?!-)((?:(?!@\{|\.\.)[^\0-\x20\x7f~^:?*\[\\])+)((?:[~^][0-9]*)*)(?:\^\{(?:commit)?\})?"
)
# The tactcad of that folder or none: an installed one must not replace it, which is tested before anything of
# that folder runs.
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
    """The revision's code does not run here, or gives no record; with the reason."""


def revision_sides(
    old: str, new: str, design: str, their_code: Callable[[str], None] | None = None
) -> tuple[Side, Side]:
    """Two revisions of one design.

    Parameters
    ----------
    old, new
        Commits, branches or tags, as HEAD~3; WORKING for the present files, by the present code.
    design
        A path, or a name in hardware/.
    their_code
        Receives each revision's own code before it runs. None: no code of theirs runs, the present one reads
        their designs.

    Raises
    ------
    InputError
        If there is no repository, no such revision, no such design in it, or no way to compare it.
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
    """The design's file with all links resolved, even if it is absent now: a revision may have it. Raises
    InputError as `find` does."""
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
        """The side; if its own code runs, it also evaluates the `other` side's design."""
        text = self._file(self.path, MOST_BYTES)
        if text is None:
            raise InputError(self.source, "no such design in that revision", legal="one that was committed")
        try:
            table = parse_toml(text.decode("utf-8-sig"), self.source)
        except UnicodeDecodeError:
            raise InputError(self.source, "is not UTF-8 text", legal="a design file (TOML)") from None
        if their_code is None or self._file(CODE, MOST_BYTES) is None:
            told = f"the code of {self.name}: its design is by the present code"
            try:
                return design_side(self.source, "revision", table, (told,))
            except InputError as error:  # rules of today refuse designs of then
                raise InputError(self.source, f"{error}; by its own rules: --their-code") from None
        their_code(f"runs {CODE} of {self.name} ({self.commit[:12]}) of {str(self.repository.root)!r} as you")
        folder = self.repository.checked_out(self.commit)
        try:
            side = self._side_of(table, _record(folder, folder / TREE / self.path))
        except _NotBuilt as why:
            told = (
                f"geometry of {self.name}, which was not built ({why}): its golden file is compared instead"
            )
            return replace(self._side_of(table, self._golden(table, folder, why)), untold=(told,))
        if other is None:
            return side
        (folder / "other.toml").write_bytes(other)
        try:
            return replace(side, of_other=_record(folder, folder / "other.toml"))
        except _NotBuilt as why:
            told = f"the codes: that of {self.name} refuses the other design ({why})"
            return replace(side, untold=(told,))

    def _side_of(self, table: dict[str, Any], record: Record) -> Side:
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
        """The committed golden file of the design's hardware/."""
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
    """A design's record by the code in the folder's checkout. Raises _NotBuilt."""
    nothing = {"schema": SCHEMA, "design": "none", "revision": "A", "parts": {}, "scenes": {}, "elements": {}}
    (folder / "nothing.json").write_text(json.dumps(nothing))
    source = folder / TREE / "src"
    # -I: no PYTHONPATH, no working folder, and no sitecustomize of theirs
    command = [sys.executable, "-I", "-c", DRIVER, str(source), "diff", "nothing.json", str(design), "--json"]
    try:
        run = shutdown.run(command, SECONDS, cwd=folder)
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
    """The record in which every part, scene and element is an addition. Raises ValueError, LookupError or
    TypeError if it is none."""
    record: Record = {"schema": SCHEMA, **{name: said["new"][name] for name in ("design", "revision")}}
    record |= {"parts": {}, "scenes": {}, "elements": {}}
    for change in said["changes"]:
        if change["kind"] == "added":
            section, name = change["path"]
            record[section][name] = change["new"]
    if wrong := faults(record, SCHEMA):
        raise ValueError(wrong)
    return record


@contextmanager
def repository_of(file: Path) -> Iterator[Repository]:
    """The repository of a file's folder. Raises InputError if there is none, git is not installed, or git
    refuses it."""
    folder = next(f for f in file.parents if f.is_dir())
    run = _git(folder, "rev-parse", "--show-toplevel")
    if run.returncode:
        raise InputError(str(folder), f"no revisions here: {_first_line(run.stderr)}", legal=LEGAL)
    root = Path(os.fsdecode(run.stdout.removesuffix(b"\n")))
    told = _git(root, "rev-parse", "--show-object-format", "--git-path", "objects").stdout
    hashes, _, objects = os.fsdecode(told.removesuffix(b"\n")).partition("\n")
    with scratch_folder("revision") as scratch:
        (scratch / "git" / "refs").mkdir(parents=True)
        (scratch / "git" / "HEAD").write_text("ref: refs/heads/none\n")
        settings = f"[core]\nrepositoryFormatVersion = 1\n[extensions]\nobjectFormat = {hashes}\n"
        (scratch / "git" / "config").write_text(settings)
        yield Repository(root, root / objects, scratch)


@dataclass(frozen=True)
class Repository:
    """A work tree, by its root; its objects, and a temporary folder with the repository that reads them."""

    root: Path
    objects: Path
    scratch: Path

    def path_of(self, file: Path) -> str:
        """A file's path in the repository, with "/". Raises InputError if it lies outside."""
        try:
            return file.relative_to(self.root.resolve()).as_posix()
        except ValueError:
            raise InputError(str(file), f"not in the repository {self.root}", legal=LEGAL) from None

    def commit(self, revision: str) -> str:
        """The full name of a commit. Raises InputError if `revision` names none."""
        found = REVISION.fullmatch(revision)
        named = found and _git(self.root, "rev-parse", "--verify", "--quiet", found[1])
        if found and named and not named.returncode:
            name = os.fsdecode(named.stdout.strip())
            run = self._run("rev-parse", "--verify", "--quiet", f"{name}{found[2]}^{{commit}}")
            if not run.returncode:
                return os.fsdecode(run.stdout.strip())
        legal = "a commit, branch or tag, as HEAD~3"
        raise InputError("revision", f"none in {self.root}", value=revision, legal=legal)

    def file(self, commit: str, path: str, most_bytes: int) -> bytes | None:
        """A committed file's content; None if the commit has no such file, or a larger one. Raises
        InputError if the clone lacks it."""
        listed = self._run("ls-tree", "--full-tree", commit, "--", path)
        mode = listed.stdout.split(b" ", 1)[0]
        if not listed.returncode and mode in (b"", SUBMODULE):
            return None
        if mode == LINK:
            legal = "a revision in which it is a file"
            raise InputError(f"{commit[:12]}:{path}", "is a link in that revision", legal=legal)
        size = self._run("cat-file", "-s", f"{commit}:{path}")
        if size.returncode:
            raise InputError(f"{commit[:12]}:{path}", "not in this partial clone", legal="a whole clone")
        if int(size.stdout) > most_bytes:
            return None
        run = self._run("cat-file", "blob", f"{commit}:{path}")
        return None if run.returncode else run.stdout

    def checked_out(self, commit: str) -> Path:
        """A folder with the commit's files in TREE, there as long as the repository is. Raises InputError
        if git cannot make it."""
        folder = self.scratch / commit
        (folder / TREE).mkdir(parents=True, exist_ok=True)
        places = {"GIT_WORK_TREE": str(folder / TREE), "GIT_INDEX_FILE": str(folder / "index")}
        run = self._run("read-tree", "-u", "--reset", commit, **places)
        if run.returncode:
            raise InputError(commit, f"cannot be checked out: {_first_line(run.stderr)}")
        return folder

    def _run(self, *arguments: str, **places: str) -> subprocess.CompletedProcess[bytes]:
        ours = {"GIT_DIR": str(self.scratch / "git"), "GIT_OBJECT_DIRECTORY": str(self.objects)}
        no_settings = {"GIT_CONFIG_NOSYSTEM": "1", "GIT_CONFIG_GLOBAL": os.devnull, "GIT_ATTR_NOSYSTEM": "1"}
        no_settings["GIT_LITERAL_PATHSPECS"] = "1"  # a file may be named :x.toml
        return _git(self.scratch, *arguments, **ours, **no_settings, **places)


def _git(folder: Path, *arguments: str, **more: str) -> subprocess.CompletedProcess[bytes]:
    """git in that folder, whatever repository the environment names."""
    own = {k: v for k, v in os.environ.items() if not k.startswith("GIT_") or k.startswith(KEPT)}
    try:
        return subprocess.run(
            ["git", "-C", str(folder), *arguments],
            env=own | NO_FETCH | {"LC_ALL": "C"} | more,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
        )
    except FileNotFoundError:
        raise InputError("git", "not installed: revisions cannot be read", legal="two designs") from None


def _first_line(said: bytes) -> str:
    lines = said.decode(errors="replace").strip().splitlines() or ["git gave no reason"]
    return lines[0].removeprefix("fatal: ")
