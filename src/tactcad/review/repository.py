"""The git work tree that a design stands in: its revisions, their files, and a checkout of one for a while.

git itself refuses a repository of another owner (safe.directory). Hooks do not run: nothing of a repository
is executed by looking into it.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from tactcad.design.files import scratch_folder
from tactcad.design.messages import InputError
from tactcad.ending import unfinished

SCRATCH = "revision"  # purpose of the temporary folder
TREE = "tree"  # the worktree in it
# Of the variables that lead git elsewhere than to the folder it is given, these are the user's settings.
KEPT = ("GIT_CONFIG", "GIT_CEILING_DIRECTORIES")
LEGAL = "a design in a git work tree of your own"


def repository_of(file: Path) -> Repository:
    """The repository of the folder where a file stands, or stood. Raises InputError where there is none, git
    is not installed, or git refuses it."""
    folder = next(f for f in file.parents if f.is_dir())
    run = _git(folder, "rev-parse", "--show-toplevel")
    if run.returncode:
        raise InputError(str(folder), f"no revisions here: {_first_line(run.stderr)}", legal=LEGAL)
    return Repository(Path(os.fsdecode(run.stdout.removesuffix(b"\n"))))


@dataclass(frozen=True)
class Repository:
    """A work tree, by its root."""

    root: Path

    def path_of(self, file: Path) -> str:
        """A file's path in the repository, with "/". Raises InputError where it lies outside."""
        try:
            return file.relative_to(self.root.resolve()).as_posix()
        except ValueError:
            raise InputError(str(file), f"not in the repository {self.root}", legal=LEGAL) from None

    def commit(self, revision: str) -> str:
        """The full name of a commit. Raises InputError where `revision` names none."""
        named = revision and not revision.startswith("-") and "\0" not in revision
        # what begins with "-" is no revision to git either, but could be read as an option
        run = self._run("rev-parse", "--verify", "--quiet", f"{revision}^{{commit}}") if named else None
        if run is None or run.returncode:
            legal = "a commit, branch or tag, as HEAD~3"
            raise InputError("revision", f"none in {self.root}", value=revision, legal=legal)
        return os.fsdecode(run.stdout.strip())

    def file(self, commit: str, path: str, most_bytes: int) -> bytes | None:
        """A committed file's content; None where the commit has no such file, or a larger one."""
        size = self._run("cat-file", "-s", f"{commit}:{path}")
        if size.returncode or int(size.stdout) > most_bytes:
            return None
        run = self._run("cat-file", "blob", f"{commit}:{path}")
        return None if run.returncode else run.stdout

    @contextmanager
    def checked_out(self, commit: str) -> Iterator[Path]:
        """A worktree of the commit in a temporary folder, `tree` in what is yielded, removed when the block
        ends, also by a signal.

        Raises InputError where git cannot make it.
        """
        with scratch_folder(SCRATCH) as folder:
            self._forget_killed()
            tree = folder / TREE
            with unfinished(lambda: self._remove(tree)):
                try:
                    run = self._run("worktree", "add", "--detach", "--quiet", str(tree), commit)
                    if run.returncode:
                        raise InputError(commit, f"cannot be checked out: {_first_line(run.stderr)}")
                    yield folder
                finally:
                    self._remove(tree)

    def _forget_killed(self) -> None:
        """Take worktrees of killed runs off the repository's list; their folders are swept already."""
        listed = os.fsdecode(self._run("worktree", "list", "--porcelain").stdout)
        for line in listed.splitlines():
            tree = Path(line.removeprefix("worktree "))
            ours = line.startswith("worktree ") and tree.name == TREE
            if ours and tree.parent.name.startswith(f"tactcad-{SCRATCH}.") and not tree.exists():
                self._remove(tree)

    def _remove(self, tree: Path) -> None:
        # forced twice: one that was interrupted while it was made is still locked
        self._run("worktree", "remove", "--force", "--force", str(tree))

    def _run(self, *arguments: str) -> subprocess.CompletedProcess[bytes]:
        return _git(self.root, *arguments)


def _git(folder: Path, *arguments: str) -> subprocess.CompletedProcess[bytes]:
    """git in that folder, whatever repository the environment names."""
    own = {k: v for k, v in os.environ.items() if not k.startswith("GIT_") or k.startswith(KEPT)}
    command = ["git", "-C", str(folder), "-c", f"core.hooksPath={os.devnull}", "-c", "core.fsmonitor=false"]
    try:
        return subprocess.run(
            [*command, *arguments],
            env=own | {"LC_ALL": "C"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
        )
    except FileNotFoundError:
        raise InputError("git", "not installed: revisions cannot be read", legal="two designs") from None


def _first_line(said: bytes) -> str:
    lines = said.decode(errors="replace").strip().splitlines() or ["git gave no reason"]
    return lines[0].removeprefix("fatal: ")
