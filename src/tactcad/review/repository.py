"""The git work tree that a design stands in: its revisions, their files, and a checkout of one for a while.

Nothing of a repository runs, whatever it holds. git finds it and names its commits, and refuses one of
another owner (safe.directory); objects are read through an empty repository of ours, to which that one lends
its objects and nothing else: no settings, hooks, filters or replacements. Nothing is ever fetched.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from tactcad.design.files import scratch_folder
from tactcad.design.messages import InputError

TREE = "tree"  # a checkout in its folder
# Of the variables that lead git elsewhere than to the folder it is given, these are the user's settings.
KEPT = ("GIT_CONFIG", "GIT_CEILING_DIRECTORIES")
# A partial clone names a command that fetches what is missing (core.sshCommand, ext::): none may start.
NO_FETCH = {"GIT_ALLOW_PROTOCOL": "", "GIT_NO_LAZY_FETCH": "1"}
LEGAL = "a design in a git work tree of your own"
LINK, SUBMODULE = b"120000", b"160000"  # modes of git's tree entries
# A name, as git check-ref-format takes it, and steps to parents. What searches (:/text, ^{/text}) or looks
# into the reflog (@{-1}) is none.
REVISION = re.compile(
    r"(?!-)((?:(?!@\{|\.\.)[^\0-\x20\x7f~^:?*\[\\])+)((?:[~^][0-9]*)*)(?:\^\{(?:commit)?\})?"
)


@contextmanager
def repository_of(file: Path) -> Iterator[Repository]:
    """The repository of the folder where a file stands, or stood. Raises InputError where there is none, git
    is not installed, or git refuses it."""
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
        """A file's path in the repository, with "/". Raises InputError where it lies outside."""
        try:
            return file.relative_to(self.root.resolve()).as_posix()
        except ValueError:
            raise InputError(str(file), f"not in the repository {self.root}", legal=LEGAL) from None

    def commit(self, revision: str) -> str:
        """The full name of a commit. Raises InputError where `revision` names none."""
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
        """A committed file's content; None where the commit has no such file, or a larger one. Raises
        InputError where the clone lacks it."""
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
        where git cannot make it."""
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
