"""A machine that refuses, and others at the same files: full disks, read-only folders, open files, exports at
once."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import (
    MODULE,
    assert_sound,
    assert_tidy,
    contents,
    environment,
    refused,
    tactcad_forked,
    tactcad_run,
)

# Runs "$@" with a small disk of its own mounted on $1; the mount is gone with the process.
SMALL_DISK = 'mkdir -p "$1" && mount -t tmpfs -o size="$2" none "$1" && shift 2 && exec "$@"'
READ_ONLY = 'mount --bind "$1" "$1" && mount -o remount,bind,ro "$1" && shift && exec "$@"'


def in_own_mounts(script: str, *arguments: str | Path) -> list[str]:
    """A command that may mount things without anybody seeing it; skips where the machine allows nobody to."""
    own = ["unshare", "--user", "--map-root-user", "--mount"]
    try:
        allowed = (
            subprocess.run(
                [*own, "mount", "-t", "tmpfs", "none", "/mnt"], capture_output=True, check=False
            ).returncode
            == 0
        )
    except FileNotFoundError:
        allowed = False
    if not allowed:
        pytest.skip("no mounts for this user here: the tests by file size limit and permissions stand for it")
    return [*own, "sh", "-c", script, "sh", *map(str, arguments)]


# --- disk full ---


@pytest.mark.by_day(1, "two exports each")
@pytest.mark.parametrize("most_bytes", [3_000, 0, 1, 12_000, 150_000])
def test_no_file_larger_than_this(bench, exported, most_bytes):
    """What a quota does: any file, of export or cache, is refused at that size. Needs no rights."""
    out = exported / "exports" / "out"

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))

    assert max(map(len, bench.files["B"].values())) > 150_000
    done = tactcad_run(
        "export", "B.toml", "--out", "exports/out", cwd=exported, env=environment(exported), preexec_fn=limit
    )
    assert "File too large" in refused(done, status=1)
    assert contents(out) == bench.files["A"]
    assert_tidy(out, exported)
    done = tactcad_forked("export", "B.toml", "--out", "exports/out", cwd=exported, env=environment(exported))
    assert done.returncode == 0 and contents(out) == bench.files["B"]
    assert_tidy(out, exported)


ON_SMALL_DISK = """
import json, shutil, sys
from pathlib import Path
from command_line import Bench, assert_sound, assert_tidy, contents, environment, refused, tactcad_run
disk, work = Path(sys.argv[1]), Path(sys.argv[2])
env = environment(work)

def export(name):
    return tactcad_run("export", f"{name}.toml", "--out", str(disk / "exports" / "out"), cwd=work, env=env)

assert export("A").returncode == 0
out = disk / "exports" / "out"
before = contents(out)
pages = sum(-(-len(data) // 4096) for data in before.values())
for left in (0, 1, pages // 4, pages - 5):
    with (disk / "filler").open("wb") as filler:
        filler.write(bytes(shutil.disk_usage(disk).free - 4096 * left))
    assert "No space left on device" in refused(export("B"), status=1)
    assert contents(out) == before
    assert_tidy(out, work)
    (disk / "filler").unlink()
assert export("B").returncode == 0
assert_sound(out)
assert contents(out) != before
assert_tidy(out, work)
print("as it should be")
"""


@pytest.mark.slow  # mounts a disk, starts six exports
def test_full_disk(work):
    """A disk of its own, filled until nothing is free, or a page, a quarter of an export, all of one but five
    pages."""
    command = in_own_mounts(SMALL_DISK, work / "disk", "8M")
    path = os.pathsep.join([str(Path(__file__).parent), environment(work)["PYTHONPATH"]])
    done = subprocess.run(
        [*command, sys.executable, "-c", ON_SMALL_DISK, work / "disk", work],
        cwd=work,
        capture_output=True,
        text=True,
        env=environment(work, PYTHONPATH=path),
        check=False,
        timeout=300,
    )
    assert done.stdout == "as it should be\n", done.stderr


@pytest.mark.slow  # a cold export in a fresh process
def test_full_disk_for_the_cache_costs_time_only(bench, work):
    """The cache's disk is full from the start: a cold export is whole, and says what it could not keep."""
    command = in_own_mounts(SMALL_DISK, work / "disk", "64k")
    env = environment(work, TACTCAD_CACHE=str(work / "disk" / "cache"))
    done = tactcad_run(
        "export", "A.toml", "--out", "exports/out", cwd=work, env=env, command=[*command, *MODULE]
    )
    assert done.returncode == 0, done.stderr.decode()
    assert b"going on without" in done.stderr
    assert contents(work / "exports" / "out") == bench.files["A"]


def own(work: Path) -> dict[str, bytes]:
    """What lies in the folder but for what libraries keep in their user's home."""
    return {path: data for path, data in contents(work).items() if not path.startswith("home/")}


@pytest.mark.by_day(1, "a fresh process each")
@pytest.mark.parametrize(
    "command", ["estimate", "calibrate", "diff", pytest.param("validate", marks=pytest.mark.nightly)]
)
def test_no_room_for_a_single_file(work, command):
    """The other commands that write: no file, or the earlier one."""
    hardware = Path(__file__).parents[2] / "hardware"
    (work / "out.file").write_text("earlier")
    arguments = {
        "calibrate": [str(hardware / "examples" / "calibration.csv"), "--out", "out.file"],
        "diff": ["A.toml", "B.toml", "--html", "out.file"],
        "validate": ["--out", "report"],
        "estimate": ["--batch", "designs.csv", "--out", "out.file"],
    }
    (work / "designs.csv").write_text(
        "hinge_thickness,hinge_length,fillet_radius,load_arm,arm_height,body_height,body_length,poisson,youngs_modulus,width\n"
        + "0.25,0.75,0.15,4,2.5,5,3,0.33,72000,3\n" * 30
    )
    env, before = environment(work), own(work)

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

    said = refused(tactcad_run(command, *arguments[command], cwd=work, env=env, preexec_fn=limit), status=1)
    assert "File too large" in said and "nothing was changed" in said
    assert own(work) == before


@pytest.mark.by_day(1, "a fresh process each")
@pytest.mark.parametrize(
    "arguments", [["schema"], ["estimate", "A.toml"], ["diff", "A.toml", "B.toml", "--json"]], ids=" ".join
)
def test_full_standard_output(work, arguments):
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [*MODULE, *arguments],
            cwd=work,
            env=environment(work),
            stdout=full,
            stderr=subprocess.PIPE,
            check=False,
        )
    assert (done.returncode, done.stderr) == (
        1,
        b"tactcad: the output cannot be written: No space left on device\n",
    )


# --- places that cannot be written to ---


@pytest.mark.parametrize(
    "place", ["A.toml/out", "/proc/out", "/sys/out", "/dev/full", "/dev/null", "x" * 300, "loop", "loop/out"]
)
def test_places_that_not_even_root_can_write_to(work, place):
    (work / "loop").symlink_to("loop")
    before = contents(work / "cache"), sorted(p.name for p in work.iterdir())
    assert place[-50:] in refused(  # a long path is shown by its two ends
        tactcad_forked("export", "A.toml", "--out", place, cwd=work, env=environment(work))
    )
    assert (contents(work / "cache"), sorted({p.name for p in work.iterdir()} - {"home", "tmp"})) == before


def test_read_only_file_system(bench, exported):
    """The folder of an earlier export is mounted read-only: for root too."""
    out = exported / "exports" / "out"
    command = in_own_mounts(READ_ONLY, exported / "exports")
    done = tactcad_run(
        "export",
        "B.toml",
        "--out",
        "exports/out",
        cwd=exported,
        env=environment(exported),
        command=[*command, *MODULE],
    )
    assert "Read-only file system" in refused(done)
    assert contents(out) == bench.files["A"]
    assert_tidy(out, exported)


AS_NOBODY = """
import os, sys
from tactcad.cli.main import main
main(["export", "A.toml", "--out", "warm/out"])  # root reads the program, whoever may read it
sys.stderr.flush()
os.dup2(os.open("said", os.O_CREAT | os.O_WRONLY, 0o666), 2)
if os.geteuid() == 0:
    os.seteuid(65534)  # root may write everywhere; nobody may not
sys.exit(main(["export", "B.toml", "--out", "exports/out"]))
"""


def test_folder_without_permission(bench, exported):
    out = exported / "exports" / "out"
    for folder in [exported, *exported.parents[:3]]:
        folder.chmod(folder.stat().st_mode | 0o055)
    (exported / "exports").chmod(0o555)
    try:
        done = tactcad_run(cwd=exported, env=environment(exported), command=[sys.executable, "-c", AS_NOBODY])
    finally:
        (exported / "exports").chmod(0o755)
    assert done.returncode == 2, done.stderr.decode()
    said = (exported / "said").read_text()
    assert said.startswith("tactcad: ") and "Permission denied" in said and said.count("\n") == 1
    assert contents(out) == bench.files["A"]
    assert_tidy(out, exported)


@pytest.mark.slow  # starts two processes
def test_folder_that_is_gone(work):
    (work / "gone").mkdir()
    leave = ["sh", "-c", 'rmdir "$PWD" && exec "$@"', "sh", *MODULE]
    for arguments in (
        ["export", str(work / "A.toml"), "--out", "out"],
        ["diff", str(work / "A.toml"), str(work / "B.toml"), "--html", "x"],
    ):
        (work / "gone").mkdir(exist_ok=True)
        said = refused(tactcad_run(*arguments, cwd=work / "gone", env=environment(work), command=leave))
        assert "No such file or directory" in said


# --- others at the same files ---


@pytest.mark.slow  # exports twice
def test_output_file_open_elsewhere(bench, exported):
    """Who is half through a file of the old export reads that file to its end."""
    out = exported / "exports" / "out"
    largest = max(bench.files["A"], key=lambda path: len(bench.files["A"][path]))
    with (out / largest).open("rb") as reader:
        begun = reader.read(1000)
        done = tactcad_run(
            "export", "B.toml", "--out", "exports/out", cwd=exported, env=environment(exported)
        )
        assert done.returncode == 0, done.stderr.decode()
        assert begun + reader.read() == bench.files["A"][largest]
    assert contents(out) == bench.files["B"]
    assert_tidy(out, exported)


def together(commands: list[list[str]], cwd: Path, env: dict[str, str], refusal: str = "(?!)") -> None:
    """All end well, or are refused in words that `refusal` matches."""
    runs = [
        subprocess.Popen([*MODULE, *c], cwd=cwd, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for c in commands
    ]
    for run in runs:
        said = run.communicate(timeout=240)[1].decode()
        assert (run.returncode == 0 or re.search(refusal, said)) and "Traceback" not in said, said


@pytest.mark.slow  # starts four exports
def test_four_exports_at_once_into_one_directory(bench, work):
    out = work / "exports" / "out"
    env = environment(work)
    refusal = "No such file|holds what is not as tactcad wrote it"  # who looks while another writes
    together([["export", f"{name}.toml", "--out", "exports/out"] for name in "ABAB"], work, env, refusal)
    assert contents(out) in bench.files.values()
    assert_tidy(out, work)
    done = tactcad_forked("export", "A.toml", "--out", "exports/out", cwd=work, env=env)
    assert done.returncode == 0 and contents(out) == bench.files["A"]


@pytest.mark.nightly
def test_two_exports_at_once_with_one_cold_cache(bench, work):
    shutil.rmtree(work / "cache")
    together([["export", f"{name}.toml", "--out", f"{name}/out"] for name in "AB"], work, environment(work))
    for name in "AB":
        assert contents(work / name / "out") == bench.files[name]
        assert_tidy(work / name / "out", work)


@pytest.mark.slow  # starts exports; by day tests/export/test_cache.py
def test_a_cache_beyond_its_bound_is_trimmed_by_the_next_export(bench, work):
    """Entries that look like 300 MB each (without taking it) were used long ago: they go, and those in use
    stay."""
    own = set(contents(work / "cache"))
    for n in range(3):
        path = work / "cache" / f"{n:02d}" / f"{n:02d}{'0' * 62}"
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"old")
        os.truncate(path, 300_000_000)
        os.utime(path, (n, n))
    together([["export", f"{name}.toml", "--out", f"{name}/out"] for name in "AB"], work, environment(work))
    assert sum(p.stat().st_size for p in (work / "cache").rglob("*") if p.is_file()) <= 500_000_000
    assert set(contents(work / "cache")) - own == {f"02/02{'0' * 62}"}
    assert contents(work / "A" / "out") == bench.files["A"]


@pytest.mark.slow  # a cold export; by day tests/export/test_pipeline.py
def test_damaged_cache_entries_are_built_again(bench, work):
    """Every entry is damaged in one of five ways; no damage reaches the export, and all of it is said."""
    entries = sorted((work / "cache").glob("??/*"))
    for n, path in enumerate(entries):
        data = bytearray(path.read_bytes())
        if n % 5 == 0:
            os.truncate(path, len(data) * n // len(entries))
        elif n % 5 == 1:
            data[n * 7919 % len(data)] ^= 0x20
            path.write_bytes(data)
        elif n % 5 == 2:
            path.write_bytes(b"")
        elif n % 5 == 3:
            path.write_bytes((bench.cache / entries[n - 1].relative_to(work / "cache")).read_bytes())
        else:
            path.unlink()
            path.mkdir()
    done = tactcad_forked("export", "A.toml", "--out", "exports/out", cwd=work, env=environment(work))
    assert done.returncode == 0 and b"Traceback" not in done.stderr, done.stderr.decode()
    assert done.stderr.count(b"is damaged and will be built again") > 10
    assert b" 0 taken from the cache" in done.stderr
    assert contents(work / "exports" / "out") == bench.files["A"]
    assert_sound(work / "exports" / "out")
