"""Git revisions as sides of a comparison, in repositories made for it."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tactcad.cli.main import main
from tactcad.design.messages import InputError
from tactcad.export.golden_file import golden_bytes, golden_record
from tactcad.parts.rules import load
from tactcad.review.revisions import repository_of

ROOT = Path(__file__).parents[2]
SHIPPED = (ROOT / "hardware" / "smallest-bearing.toml").read_text()
THICKER = SHIPPED.replace("hinge_thickness = 0.25", "hinge_thickness = 0.255")
DESIGN = "hardware/small.toml"

# A program of another time: it tells the record beside it, and leaves a word that it ran.
STUB = """\
import json, os, pathlib, sys, time
here = pathlib.Path(__file__).parent
assert sys.argv[1] == "diff" and sys.argv[-1] == "--json", sys.argv
pathlib.Path(os.environ["RAN"]).open("a").write(f"{here}\\n")
if os.environ.get("WAIT"):
    time.sleep(60)
text = pathlib.Path(sys.argv[3]).read_text()
record = json.loads((here / ("thick.json" if "0.255" in text else "thin.json")).read_text())
changes = [
    {"kind": "added", "path": [section, name], "old": None, "new": value}
    for section in ("parts", "scenes", "elements") for name, value in record[section].items()
]
head = {"design": record["design"], "revision": record["revision"]}
print(json.dumps({"new": head, "changes": changes}))
"""


@pytest.fixture(autouse=True)
def few_arrays(monkeypatch):
    monkeypatch.setattr("tactcad.review.effect.COUNT", 20)


class Work:
    """A git work tree of one design."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.git("init", "--quiet", "--initial-branch=main")

    def git(self, *arguments: str) -> str:
        identity = ["-c", "user.name=t", "-c", "user.email=t@example.org", "-c", "commit.gpgsign=false"]
        run = subprocess.run(
            ["git", "-C", str(self.folder), *identity, *arguments], check=True, capture_output=True, text=True
        )
        return run.stdout

    def write(self, path: str, text: str) -> None:
        (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / path).write_text(text)

    def commit(self, design: str) -> None:
        self.write(DESIGN, design)
        self.git("add", "--all")
        self.git("commit", "--quiet", "--allow-empty", "--message=a change")

    def state(self) -> tuple[str, str, str]:
        """What a comparison must leave as it was."""
        return self.git("status", "--porcelain"), self.git("worktree", "list"), self.git("show-ref", "--head")


@pytest.fixture
def work(tmp_path, monkeypatch):
    """Two revisions: the shipped design, and 5 um more of hinge; no code of their own."""
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", os.devnull)
    monkeypatch.delenv("GIT_DIR", raising=False)
    (tmp_path / "repository").mkdir()
    work = Work(tmp_path / "repository")
    work.commit(SHIPPED)
    work.commit(THICKER)
    monkeypatch.chdir(work.folder)
    monkeypatch.setenv("RAN", str(tmp_path / "ran"))
    return work


def records(factor: float) -> dict[str, str]:
    """What the stub tells: the present record of either design, K times a factor."""
    told = {}
    for name, text in (("thin", SHIPPED), ("thick", THICKER)):
        path = Path(f"{name}.toml")
        path.write_text(text)
        record = golden_record(load(str(path.resolve())))
        path.unlink()
        for element in record["elements"].values():
            element["stiffness_n_per_mm"] *= factor
        told[name] = json.dumps(record)
    return told


def with_code(work: Work, factor: float) -> None:
    work.write("src/tactcad/__init__.py", "")
    work.write("src/tactcad/__main__.py", STUB)
    for name, text in records(factor).items():
        work.write(f"src/tactcad/{name}.json", text)


def diff(capsys, *arguments: str) -> dict:
    assert main(["diff", *arguments, "--json"]) == 0
    told = capsys.readouterr()
    ran = re.findall(r"tactcad: --their-code runs src/tactcad/__main__.py of (\S+) \(", told.err)
    assert bool(ran) == ("--their-code" in arguments), told.err
    return json.loads(told.out)


def causes(record: dict) -> list[str]:
    return [c["what"] for c in record["meaning"]["consequences"]]


def test_revision_to_revision(work, capsys):
    before = work.state()
    told = diff(capsys, "HEAD~1", "HEAD", "small")
    assert causes(told) == ["element.hinge_thickness: 0.25 -> 0.255"]
    change = told["meaning"]["consequences"][0]["effect"]["elements"][0]["stiffness"]["relative"]
    assert change == pytest.approx(0.05, abs=0.003)
    assert [told[side]["source"] for side in ("old", "new")] == [f"HEAD~1:{DESIGN}", f"HEAD:{DESIGN}"]
    assert told["not_compared"] == [
        f"the code of {r}: its design is by the present code" for r in ("HEAD~1", "HEAD")
    ]
    assert work.state() == before


def test_a_revision_against_itself_shows_nothing(work, capsys):
    told = diff(capsys, "HEAD", "main", "hardware/small.toml")
    assert told["identical"] and causes(told) == []


@pytest.mark.slow  # compares revisions in processes, again and again
def test_what_is_not_committed_does_not_count_but_as_the_files_that_stand(work, capsys, monkeypatch):
    """A dirty tree, from another folder and with git's variables set, as in a hook."""
    work.write(DESIGN, THICKER.replace("arm_height = 2.6", "arm_height = 2.7"))
    work.write("hardware/other.toml", "no design")
    monkeypatch.chdir("/")
    path = str(work.folder / DESIGN)
    assert causes(diff(capsys, "HEAD~1", "HEAD", path)) == ["element.hinge_thickness: 0.25 -> 0.255"]
    assert causes(diff(capsys, "HEAD", ".", path)) == ["element.arm_height: 2.6 -> 2.7"]
    monkeypatch.setenv("GIT_DIR", "/nowhere")
    assert causes(diff(capsys, "HEAD", ".", path)) == ["element.arm_height: 2.6 -> 2.7"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nothing", "HEAD", "small"], "revision: none in .*; found 'nothing'; legal: a commit"),
        (["HEAD", "HEAD~9", "small"], "revision: none in .*; found 'HEAD~9'"),
        (["HEAD:hardware", "HEAD", "small"], "revision: none in "),
        (["HEAD", "HEAD", "hardware/gone.toml"], "HEAD:hardware/gone.toml: no such design in that revision"),
        (["HEAD", "HEAD", "gone"], "HEAD:hardware/gone.toml: no such design in that revision"),
        (["HEAD", "HEAD", "/dev/null"], "/dev: no revisions here: not a git repository"),
        (["--", "--upload-pack=x", "HEAD", "small"], "revision: none in .*; found '--upload-pack=x'"),
        *(
            (
                [name, "HEAD", "small"],
                rf"revision: none in .*; found {re.escape(repr(name))}; legal: a commit",
            )
            for name in (":/a", "HEAD^{/a}", "HEAD^{tree}", "@{-1}", "HEAD@{1}", "main@{u}", "HEAD~1..main")
        ),
        (["--", "--all", "HEAD", "small"], "revision: none in .*; found '--all'"),
        (["HEAD", "--their-code", "HEAD"], "--their-code: goes with revisions only"),
        (["HEAD", "HEAD"], "DESIGN: no design of that name"),
    ],
)
def test_bad_input_is_one_line(work, capsys, arguments, said):
    before = work.state()
    assert main(["diff", *arguments]) == 2
    told = capsys.readouterr()
    assert told.out == "" and re.fullmatch(rf"tactcad: {said}.*\n", told.err)
    assert work.state() == before


@pytest.mark.parametrize("hashes", ["sha1", "sha256"])
def test_every_way_to_name_and_to_keep_commits_is_read(tmp_path, monkeypatch, hashes):
    """Branch, tag, abbreviated, upstream; packed, borrowed, from a linked worktree."""
    monkeypatch.setenv("GIT_DEFAULT_HASH", hashes)
    work = Work(tmp_path)
    work.commit(SHIPPED)
    work.git("tag", "--annotate", "--message=one", "v1")
    work.commit(THICKER)
    work.git("gc", "--quiet")
    work.git("clone", "--quiet", "--shared", str(tmp_path), str(tmp_path / "clone"))
    clone, linked = Work(tmp_path / "clone"), tmp_path / "linked\nfolder"
    clone.git("worktree", "add", "--quiet", "-b", "topic/a", str(linked), "v1")
    one, two = (clone.git("rev-parse", name).strip() for name in ("topic/a", "main"))
    with repository_of(linked / DESIGN) as repository:
        for name in (
            "HEAD",
            "@",
            "topic/a",
            "v1",
            "v1^{}",
            "origin/main~1^{commit}",
            "origin/main~1",
            "main^1",
            one,
            one[:10],
            f"v1-0-g{one[:7]}",
        ):
            assert repository.commit(name) == one
        for name in ("main", "origin/main", "refs/remotes/origin/HEAD", two):
            assert repository.commit(name) == two
        assert repository.file(one, DESIGN, 10**6) == SHIPPED.encode()
        assert repository.file(two, DESIGN, 10**6) == THICKER.encode()
        assert repository.file(two, "hardware/gone.toml", 10**6) is None


def test_what_a_partial_clone_lacks_is_said_and_not_fetched(work, tmp_path, monkeypatch, capsys):
    work.git("config", "uploadpack.allowFilter", "true")
    away = ("--no-checkout", "--filter=blob:none", work.folder.as_uri(), str(tmp_path / "clone"))
    work.git("clone", "--quiet", *away)
    (tmp_path / "clone" / "hardware").mkdir()
    shutil.copy(DESIGN, tmp_path / "clone" / DESIGN)
    monkeypatch.chdir(tmp_path / "clone")
    assert main(["diff", "HEAD", ".", "small"]) == 2
    said = capsys.readouterr().err
    assert re.fullmatch(r"tactcad: .*small.toml: not in this partial clone; legal: a whole clone\n", said)
    assert main(["diff", "HEAD", ".", "gone"]) == 2
    assert "no such design in that revision" in capsys.readouterr().err


def test_a_path_that_was_no_file_is_said_as_what_it_was(work):
    """A link, a submodule; and a file whose name looks like a pattern of git's."""
    odd = work.folder / "hardware" / ":(top)odd.toml"
    odd.write_text(SHIPPED)
    (work.folder / "hardware" / "link.toml").symlink_to("small.toml")
    work.git("add", "hardware")
    work.git(
        "update-index", "--add", "--cacheinfo", f"160000,{work.git('rev-parse', 'HEAD').strip()},hardware/sub"
    )
    work.git("commit", "-q", "-m", "odd")
    with repository_of(odd) as repository:
        head = repository.commit("HEAD")
        assert repository.file(head, "hardware/:(top)odd.toml", 10**6) == SHIPPED.encode()
        assert repository.file(head, "hardware/sub", 10**6) is None
        with pytest.raises(InputError, match="is a link in that revision"):
            repository.file(head, "hardware/link.toml", 10**6)


def test_without_git_it_is_one_line(work, capsys, monkeypatch):
    monkeypatch.setenv("PATH", str(work.folder))
    assert main(["diff", "HEAD", "HEAD", "small"]) == 2
    assert capsys.readouterr().err.startswith("tactcad: git: not installed")


def test_a_repository_of_another_owner_is_refused_by_git(work, capsys, monkeypatch):
    with_code(work, 1.0)
    work.commit(THICKER)
    monkeypatch.setenv("GIT_TEST_ASSUME_DIFFERENT_OWNER", "1")
    if subprocess.run(["git", "status"], capture_output=True, check=False).returncode == 0:
        pytest.skip("this git has no such switch for tests")
    # the switch has to pass: only git's own settings do
    monkeypatch.setattr("tactcad.review.revisions.KEPT", ("GIT_",))
    assert main(["diff", "HEAD~1", "HEAD", "small"]) == 2
    assert "dubious ownership" in capsys.readouterr().err and not Path(os.environ["RAN"]).exists()


def test_a_revision_s_own_code_tells_its_geometry_and_its_part_is_said(work, capsys):
    """Older code with 10 % more K: a cause of its own beside the hinge."""
    with_code(work, 1.1)
    work.commit(SHIPPED)
    with_code(work, 1.0)
    work.commit(THICKER)
    before = work.state()
    told = diff(capsys, "HEAD~1", "HEAD", "small", "--their-code")
    assert causes(told) == ["code: HEAD~1 -> HEAD", "element.hinge_thickness: 0.25 -> 0.255"]
    code, hinge = (c["effect"]["elements"] for c in told["meaning"]["consequences"])
    assert [e["stiffness"]["relative"] for e in code] == pytest.approx(4 * [1 / 1.1 - 1], rel=1e-6)
    whole = {
        c["path"][1]: c["new"] / c["old"] for c in told["changes"] if c["path"][-1] == "stiffness_n_per_mm"
    }
    for a, b in zip(code, hinge):
        both = (1 + a["stiffness"]["relative"]) * (1 + b["stiffness"]["relative"])
        assert whole[a["new"]] == pytest.approx(both, rel=1e-6)
    ran = Path(os.environ["RAN"]).read_text().split()
    assert len(set(ran)) == 2 and not any(Path(place).exists() for place in ran)
    assert work.state() == before


def test_no_other_code_than_the_present_one_runs(work, capsys):
    with_code(work, 1.1)
    work.commit(SHIPPED)
    told = diff(capsys, "HEAD~1", "HEAD", "small")
    assert causes(told) == ["element.hinge_thickness: 0.255 -> 0.25"]
    assert told["not_compared"][1] == "the code of HEAD: its design is by the present code"
    assert not Path(os.environ["RAN"]).exists()


@pytest.mark.slow  # compares revisions in processes
def test_where_the_code_does_not_run_its_golden_file_stands_for_it(work, capsys):
    with_code(work, 1.0)
    work.write("src/tactcad/__main__.py", "raise ImportError('a library of that time')")
    work.commit(SHIPPED)
    assert main(["diff", "HEAD", ".", "small", "--their-code"]) == 2
    _, said = capsys.readouterr().err.splitlines()
    assert "a library of that time" in said and "no golden file" in said

    name = load(DESIGN).name
    work.write(f"exports/golden/{name}.json", golden_bytes(golden_record(load(DESIGN))).decode())
    work.commit(SHIPPED)
    work.write(DESIGN, THICKER)
    told = diff(capsys, "HEAD", ".", "small", "--their-code")
    assert causes(told) == ["element.hinge_thickness: 0.25 -> 0.255"]
    assert re.search(
        r"geometry of HEAD, which was not built \(.*a library of that time", told["not_compared"][0]
    )
    assert any(c["path"][-1] == "stiffness_n_per_mm" for c in told["changes"])


def test_another_tactcad_never_stands_in_for_the_revision_s(work, capsys):
    """A package of the revision that cannot be found: not the installed one's word for it."""
    work.write("src/tactcad/__main__.py", STUB)  # without __init__.py the installed package comes first
    work.commit(SHIPPED)
    assert main(["diff", "HEAD", ".", "small", "--their-code"]) == 2
    assert "is loaded instead" in capsys.readouterr().err and not Path(os.environ["RAN"]).exists()


def test_a_design_that_breaks_a_rule_of_today_is_named(work, capsys):
    """And how to compare it."""
    work.commit(SHIPPED.replace("hinge_thickness = 0.25", "hinge_thickness = 3.0"))
    assert main(["diff", "HEAD~1", "HEAD", "small"]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"tactcad: HEAD:{DESIGN}: element.") and said.rstrip().endswith("--their-code")


def test_a_design_that_the_present_code_refuses_has_no_causes(work, capsys):
    """Its own code may have taken it; what the records tell is compared."""
    with_code(work, 1.0)
    work.commit(SHIPPED.replace("pad_height = 2.0", "pad_height = 2.0\npad_weight = 1.0"))
    work.write(DESIGN, THICKER)
    told = diff(capsys, "HEAD", ".", "small", "--their-code")
    assert causes(told) == []
    assert "element.pad_weight: unknown field" in told["meaning"]["untold"][0]
    assert len(told["meaning"]["together"]["elements"]) == 4


@pytest.mark.by_day(1, "processes each")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_an_interrupted_comparison_leaves_nothing(work, tmp_path, capsys, number):
    """Killed, the next run removes what is left."""
    with_code(work, 1.0)
    work.commit(THICKER)
    before = work.state()
    (tmp_path / "tmp").mkdir()
    own = os.environ | {"WAIT": "1", "TMPDIR": str(tmp_path / "tmp"), "PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-m", "tactcad", "diff", "HEAD", "HEAD", "small", "--their-code"]
    run = subprocess.Popen(command, env=own, stderr=subprocess.DEVNULL)
    waited = time.monotonic()
    while not Path(os.environ["RAN"]).exists() and time.monotonic() - waited < 60:
        time.sleep(0.05)
    child = re.search(r"\d+", Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text())
    run.send_signal(number)
    assert run.wait(60) in (128 + number, -number)
    if number == signal.SIGKILL:
        os.kill(int(child[0]), signal.SIGKILL)
        assert list((tmp_path / "tmp").iterdir())
        subprocess.run(command, env={**own, "WAIT": ""}, check=True, capture_output=True)
    assert work.state() == before
    assert [p for p in (tmp_path / "tmp").iterdir() if p.name.startswith("tactcad-")] == []


@pytest.mark.nightly
def test_the_project_s_own_revisions_compare(tmp_path, monkeypatch, capsys):
    """The real program, committed twice, its design edited in between."""
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", os.devnull)
    work = Work(tmp_path)
    shutil.copytree(
        ROOT / "src" / "tactcad",
        tmp_path / "src" / "tactcad",
        symlinks=True,
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    work.commit(SHIPPED)
    work.commit(THICKER)
    monkeypatch.chdir(tmp_path)
    told = diff(capsys, "HEAD~1", "HEAD", "small", "--their-code")
    assert causes(told) == ["element.hinge_thickness: 0.25 -> 0.255"]
    (note,) = told["not_compared"]  # both designs are checked, by the present code
    assert note.startswith("checks and virtual builds by a revision's own code")
