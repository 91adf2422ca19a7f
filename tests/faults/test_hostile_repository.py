"""Two repositories made to attack whoever looks into them: one by its settings, one by its code as well.
Nothing of theirs runs, whatever command is given there. Every trap leaves its name and is shown to spring."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from command_line import ROOT, environment, one_by_one

from tactcad.review.revisions import _git

pytestmark = pytest.mark.slow  # nearly every command

# The console script: `python -m tactcad` looks for modules in the working folder before any of ours runs.
TACTCAD = str(Path(sys.executable).with_name("tactcad"))
DESIGN = "hardware/small.toml"
THIN = one_by_one(5.0, "A")
THICK = THIN.replace("\nhinge_thickness = 0.25\n", "\nhinge_thickness = 0.255\n")
CAUSE = "element.hinge_thickness: 0.25 -> 0.255"
STUDY = """
study = {name = "hinges", design = "hardware/small.toml", sampling = "sobol", count = 64, seed = 1}
vary = {"element.hinge_thickness" = {range = [0.25, 0.33]}}
measure = {what = ["solid"]}
"""
COMMANDS = """\
diff HEAD~1 HEAD small --json --html d.html --review d-review.html --markdown d.md; diff main . small
export small --scene array --drawings --guide; review exports/macro-array
check small; review small --scene array; build small --count 50
golden small; release small --sample
sweep study.toml --out swept; sweep plot swept
design target.toml --out made --in 3
validate --out validated; new mine.toml --from soft-tissue; estimate mine.toml"""
# What git runs if it heeds them; PLACE is the folder around the clone.
SETTINGS = """\
core.fsmonitor PLACE/trap fsmonitor
core.hooksPath PLACE/hooks
core.sshCommand PLACE/trap ssh
core.gitProxy PLACE/hooks/proxy
extensions.partialClone ssh
remote.ssh.url ssh://nowhere/repository
remote.ext.url ext::PLACE/trap ext
remote.proxied.url git://nowhere/repository
remote.near.url PLACE/near
remote.near.uploadpack PLACE/trap uploadpack
remote.helped.url http://127.0.0.1:1/
remote.helped.vcs trapped
protocol.allow always
filter.trap.smudge PLACE/trap smudge; cat
filter.trap.clean PLACE/trap clean; cat
filter.long.process PLACE/trap process
diff.trap.textconv PLACE/trap textconv
diff.external PLACE/trap external
submodule.recurse true
submodule.inner.url PLACE/near
submodule.inner.update !PLACE/trap submodule"""
REMOTES = ("ssh", "ext", "proxied", "near", "helped")
TEX = "import matplotlib.pyplot as plt; plt.figure().suptitle('a'); plt.savefig('/dev/null', format='svg')"


class Clone:
    """A repository of four commits, and the names that its traps have left in the folder around it."""

    def __init__(self, place: Path, code: dict[str, str]) -> None:
        self.place, self.folder, self.words = place, place / "clone", place / "words"
        self.env = environment(place, PATH=f"{place / 'bin'}:{os.environ['PATH']}")
        self.program("trap", f"echo $1 >> {self.words}; exit 1")
        for name in ("bin/latex", "bin/git-remote-trapped", "hooks/proxy"):
            self.program(name, f"{place}/trap {Path(name).name}")
        for name in ("post-checkout", "post-index-change", "reference-transaction"):
            self.program(f"hooks/{name}", f"{place}/trap {name}; exit 0")
        self.git("init", "--quiet", "--initial-branch=main", str(self.folder), at=place)
        (self.folder / "inner").mkdir()
        target = (ROOT / "hardware" / "targets" / "better-array.toml").read_text()
        for path, text in {"study.toml": STUDY, "target.toml": target, **code}.items():
            self.write(path, text)
        for text in (THIN.replace("0.25\n", "0.245\n"), THICK, THIN, THICK):
            self.write(DESIGN, text)
            self.git("add", "--all")
            self.git(
                "-c", "user.name=t", "-c", "user.email=t@example.org", "commit", "--quiet", "--message=a"
            )
            if text == THIN:  # the last one has a submodule and attributes
                digest = self.git("rev-parse", "HEAD")
                self.git("update-index", "--add", "--cacheinfo", f"160000,{digest},inner")
                self.write(".gitmodules", '[submodule "inner"]\n path = inner\n url = ./inner\n')
                self.write(".gitattributes", "*.toml filter=trap diff=trap\n*.py filter=long\n")
        self.git("branch", "gone", "HEAD~3")
        self.git("replace", f"HEAD~1:{DESIGN}", f"HEAD~2:{DESIGN}")
        shutil.copytree(self.folder / ".git", place / "near")
        for digest in [self.git("rev-parse", name) for name in (f"HEAD~3:{DESIGN}", "HEAD~3")]:
            (self.folder / ".git" / "objects" / digest[:2] / digest[2:]).unlink()
        promisors = [f"remote.{name}.promisor true" for name in REMOTES]
        for line in [*SETTINGS.replace("PLACE", str(place)).splitlines(), *promisors]:
            self.git("config", "--file", str(place / "more"), *line.split(" ", 1), at=place)
        for line in ("extensions.partialClone ssh", "core.repositoryFormatVersion 1"):
            self.git("config", *line.split())
        self.git("config", "include.path", str(place / "more"))

    def program(self, name: str, line: str) -> None:
        (self.place / name).parent.mkdir(exist_ok=True)
        (self.place / name).write_text(f"#!/bin/sh\n{line}\n")
        (self.place / name).chmod(0o755)

    def write(self, path: str, text: str) -> None:
        (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / path).write_text(text)

    def git(self, *arguments: str, at: Path | None = None) -> str:
        done = self.run("git", *arguments, at=at)
        assert done.returncode == 0, done.stderr
        return done.stdout.decode().strip()

    def run(self, *command: str, at: Path | None = None, **env: str) -> subprocess.CompletedProcess[bytes]:
        own = {"cwd": at or self.folder, "env": {**self.env, **env}, "stdin": subprocess.DEVNULL}
        return subprocess.run(command, capture_output=True, check=False, timeout=600, **own)

    def sprung(self) -> set[str]:
        """The traps that have sprung since this was asked."""
        said = set(self.words.read_text().split()) if self.words.exists() else set()
        self.words.unlink(missing_ok=True)
        return said


@pytest.fixture(scope="module")
def by_settings(tmp_path_factory) -> Clone:
    main = {"src/tactcad/__init__.py": "", "src/tactcad/__main__.py": "import sys; sys.exit('theirs')"}
    return Clone(tmp_path_factory.mktemp("settings"), main)


@pytest.fixture(scope="module")
def by_code(tmp_path_factory) -> Clone:
    """A module of every name that anything here could import, at the root; and the code of a revision."""
    place = tmp_path_factory.mktemp("code")
    trap = f"open({str(place / 'words')!r}, 'a').write(__name__ + '\\n')\n"
    names = {n for n in (*sys.stdlib_module_names, *packages_distributions()) if n.isidentifier()}
    names |= {"tactcad", "conftest", "sitecustomize", "usercustomize"}
    names |= {f"src/{n}" for n in ("sitecustomize", "usercustomize", "tactcad/__init__", "tactcad/__main__")}
    more = {"src/trap.pth": f"import sys; {trap}", "matplotlibrc": "text.usetex: True\n"}
    return Clone(place, {f"{name}.py": trap for name in names} | more)


def test_the_traps_of_settings_spring_for_plain_git(by_settings):
    for command, traps in {
        "status": {"fsmonitor"},
        "-c filter.long.process= checkout --detach": {"post-checkout", "reference-transaction"},
        f"hash-object {DESIGN}": {"clean"},
        f"cat-file --filters HEAD:{DESIGN}": {"smudge"},
        "cat-file --filters HEAD:src/tactcad/__main__.py": {"process"},
        f"cat-file --textconv HEAD:{DESIGN}": {"textconv"},
        "rev-parse --verify gone^{commit}": {"ssh", "ext", "proxy", "uploadpack", "git-remote-trapped"},
        "diff HEAD~1 HEAD~2": {"external"},
        "-c protocol.file.allow=always submodule update --init": {"submodule"},
    }.items():
        by_settings.run("git", *command.split())
        assert traps <= (sprung := by_settings.sprung()), (command, sprung)
    assert by_settings.git("cat-file", "blob", f"HEAD~1:{DESIGN}") == THICK.strip()  # replaced


def test_the_traps_of_code_spring_for_plain_python(by_code):
    for command, env, trap in (
        (["-c", "import tactcad"], {}, "tactcad"),
        (["-m", "tactcad"], {}, "importlib"),
        (["-c", ""], {"PYTHONPATH": "src"}, "sitecustomize"),
        (["-P", "-m", "pytest", "--collect-only"], {}, "conftest"),
        (["-P", "-c", TEX], {}, "latex"),
    ):
        by_code.run(sys.executable, *command, **env)
        assert trap in (sprung := by_code.sprung()), (command, sprung)


@pytest.mark.parametrize("commands", COMMANDS.splitlines())
def test_nothing_of_theirs_runs(by_code, commands):
    for command in commands.split("; "):
        done = by_code.run(TACTCAD, *command.split())
        assert by_code.sprung() == set()
        assert done.returncode == 0 and b"Traceback" not in done.stderr, done.stderr.decode()


def test_nothing_of_theirs_runs_where_the_page_is_live(by_code):
    own = {"cwd": by_code.folder, "env": by_code.env, "stdout": subprocess.PIPE}
    with subprocess.Popen([TACTCAD, "view", DESIGN], **own) as run:
        assert b"http://127.0.0.1:" in run.stdout.readline()
        run.send_signal(signal.SIGINT)
    assert by_code.sprung() == set()


@pytest.mark.parametrize("old, status", [("HEAD~1", 0), ("HEAD~3", 2), ("gone", 2), ("HEAD~4", 2)])
def test_what_was_committed_is_read_and_what_is_missing_is_not_fetched(by_settings, old, status):
    """HEAD~1 has the hinge that it was committed with, not the one that refs/replace puts there."""
    done = by_settings.run(TACTCAD, "diff", old, "HEAD", "small")
    assert done.returncode == status and (status or CAUSE in done.stdout.decode()), done.stderr.decode()
    assert by_settings.sprung() == set()


def test_where_git_names_commits_it_fetches_nothing(by_settings):
    assert _git(by_settings.folder, "rev-parse", "--verify", "gone^{commit}").returncode != 0
    assert by_settings.sprung() == set()


def test_a_bare_repository_that_a_plain_clone_brings_is_no_way_in(by_settings, by_code):
    inner = by_code.folder / "bare"
    shutil.copytree(by_settings.folder / ".git", inner)
    shutil.copytree(by_settings.folder / "hardware", inner / "hardware")
    by_settings.git("config", "--file", str(inner / "config"), "core.worktree", str(inner), at=inner.parent)
    by_settings.run("git", "status", at=inner)
    assert "fsmonitor" in by_settings.sprung()
    done = by_settings.run(TACTCAD, "diff", "HEAD~1", "HEAD", DESIGN, at=inner)
    assert done.returncode == 0 and CAUSE in done.stdout.decode(), done.stderr.decode()
    assert by_settings.sprung() == set()


def test_their_code_runs_alone_where_it_is_asked_for(by_settings, by_code):
    """The package, found where it was committed: no filter, hook, sitecustomize or module of the root."""
    done = by_code.run(TACTCAD, "diff", "HEAD", ".", "small", "--their-code")
    assert by_code.sprung() == {"tactcad", "__main__"}
    first, second = done.stderr.decode().splitlines()
    assert first.startswith("tactcad: --their-code runs src/tactcad/__main__.py of HEAD (")
    assert str(by_code.folder) in first and "its record cannot be understood" in second
    done = by_settings.run(TACTCAD, "diff", "HEAD", ".", "small", "--their-code")
    assert by_settings.sprung() == set() and b"(theirs)" in done.stderr
