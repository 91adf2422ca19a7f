"""Entries come back as they went in, or not at all."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tactcad.design.messages import InputError
from tactcad.export.cache import Cache, default_root

DATA = bytes(range(256)) * 40


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def cache(tmp_path, said) -> Cache:
    return Cache(tmp_path / "cache", said.append)


def entry(cache: Cache) -> Path:
    (path,) = cache.root.glob("??/*")
    return path


@pytest.mark.parametrize("data", [DATA, b"", b"\n", b"a\nb\n"])
def test_what_was_put_comes_back(cache, said, data):
    assert cache.get("key") is None
    cache.put("key", data)
    assert cache.get("key") == data
    assert cache.get("other key") is None
    assert not said


def test_made_once(cache):
    made = []

    def make() -> bytes:
        made.append(1)
        return DATA

    assert [cache.get_or_make("key", make) for _ in range(3)] == [DATA] * 3
    assert len(made) == 1


def truncated(path: Path) -> None:
    os.truncate(path, path.stat().st_size - 1)


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def lengthened(path: Path) -> None:
    path.write_bytes(path.read_bytes() + b"x")


def one_bit_flipped(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[-1000] ^= 1
    path.write_bytes(data)


def header_altered(path: Path) -> None:
    path.write_bytes(b"x" + path.read_bytes())


@pytest.mark.parametrize("damage", [truncated, emptied, lengthened, one_bit_flipped, header_altered])
def test_damage_is_noticed_reported_and_repaired(cache, said, damage):
    cache.put("key", DATA)
    damage(entry(cache))
    assert cache.get_or_make("key", lambda: DATA) == DATA
    assert len(said) == 1
    assert "damaged" in said[0]
    assert cache.get("key") == DATA
    assert len(said) == 1


def test_an_entry_under_another_key_is_noticed(cache, said):
    cache.put("one", b"1")
    one = entry(cache)
    cache.put("two", b"2")
    (two,) = (p for p in cache.root.glob("??/*") if p != one)
    one.replace(two)
    assert cache.get("two") is None
    assert "damaged" in said[0]


def test_a_place_that_cannot_be_written_costs_time_only(tmp_path, said):
    (tmp_path / "file").write_text("")
    cache = Cache(tmp_path / "file" / "cache", said.append)
    assert cache.get_or_make("key", lambda: DATA) == DATA
    assert "going on without" in said[0]


WRITER = """
import sys
from pathlib import Path
from tactcad.export.cache import Cache
cache = Cache(Path(sys.argv[1]), lambda text: sys.exit(text))
for turn in range(300):
    data = b"%d" % (turn % 3) * 50_000
    cache.put(f"key {turn % 3}", data)
    assert cache.get(f"key {turn % 3}") == data
"""


def test_two_processes_at_once(tmp_path):
    runs = [subprocess.Popen([sys.executable, "-c", WRITER, str(tmp_path)]) for _ in range(2)]
    assert [run.wait() for run in runs] == [0, 0]
    assert not list(tmp_path.rglob("*.part"))


def test_where_it_lies(monkeypatch, tmp_path):
    monkeypatch.delenv("TACTCAD_CACHE", raising=False)
    assert default_root() == Path(__file__).parents[2] / ".cache" / "tactcad" / "entries"
    monkeypatch.setenv("TACTCAD_CACHE", str(tmp_path))
    assert default_root() == tmp_path


def entries(cache: Cache) -> dict[str, int]:
    """Size of every entry, by the key that a test gave it."""
    return {key: len(data) for key in ("old", "middle", "new") if (data := cache.get(key)) is not None}


def used(cache: Cache, key: str, seconds: float) -> None:
    """As if the entry had last been used at that time."""
    (path,) = (p for p in cache.root.glob("??/*") if p.read_bytes().endswith(b"\n" + key.encode() * 1000))
    os.utime(path, (seconds, seconds))


def test_what_was_used_least_recently_goes_first(cache):
    for n, key in enumerate(("old", "middle", "new")):
        cache.put(key, key.encode() * 1000)
        used(cache, key, 1000.0 + n)
    total = sum(p.stat().st_size for p in cache.root.glob("??/*"))
    assert cache.trim(total) == 0
    assert cache.trim(total - 1) == 1
    assert set(entries(cache)) == {"middle", "new"}


def test_reading_is_using(cache):
    for n, key in enumerate(("old", "middle", "new")):
        cache.put(key, key.encode() * 1000)
        used(cache, key, 1000.0 + n)
    assert cache.get("old")
    assert cache.trim(4000) == 2
    assert set(entries(cache)) == {"old"}


def test_a_clock_that_was_set_back_costs_time_only(cache):
    """Entries from the future count as used last; the bound holds all the same, and nothing wrong comes
    back."""
    for key, year_from_now in (("old", 0), ("middle", 1), ("new", -50)):
        cache.put(key, key.encode() * 1000)
        used(cache, key, 1.8e9 + year_from_now * 3.15e7)
    assert cache.trim(7000) == 2
    assert entries(cache) == {"middle": 6000}


def test_what_a_killed_run_left_half_written_goes(cache):
    cache.put("old", b"x")
    left = entry(cache).with_name(f".{entry(cache).name}.tactcad-abcdefgh.part")
    left.write_bytes(b"half")
    cache.trim()
    assert not left.exists() and cache.get("old") == b"x"


def test_what_a_running_process_writes_stays(cache):
    cache.put("old", b"x")
    writing = entry(cache).with_name(f".{entry(cache).name}.tactcad-abcdefgh.part")
    script = (
        "import fcntl, sys; file = open(sys.argv[1], 'wb'); fcntl.flock(file, fcntl.LOCK_EX)\n"
        "print(1, flush=True); sys.stdin.read()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", script, str(writing)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as writer:
        writer.stdout.readline()
        cache.trim()
        assert writing.exists()
    cache.trim()
    assert not writing.exists()


TRIMMER = """
import sys
from pathlib import Path
from tactcad.export.cache import Cache
cache = Cache(Path(sys.argv[1]), lambda text: None)
for turn in range(300):
    data = b"%d" % (turn % 7) * 5_000
    assert cache.get_or_make(f"key {turn % 7}", lambda: data) == data
    cache.trim(20_000)
"""


def test_two_processes_trim_at_once(tmp_path):
    runs = [subprocess.Popen([sys.executable, "-c", TRIMMER, str(tmp_path)]) for _ in range(3)]
    assert [run.wait() for run in runs] == [0, 0, 0]
    assert sum(p.stat().st_size for p in tmp_path.glob("??/*")) <= 20_000


def test_trimming_where_there_is_no_cache(cache):
    assert cache.trim() == 0


# --- whose folder it is ---


def others_files(root: Path) -> dict[str, bytes]:
    """What somebody else may keep in a folder, some of it named as entries are."""
    name = "ab" * 32
    files = {f"ab/{name}": b"1", "ab/thesis.txt": b"2", "zz/.new-plan": b"3", "photo.jpg": b"4"}
    for path, data in files.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(data)
    return files


def test_a_folder_of_others_is_refused(tmp_path, said):
    files = others_files(tmp_path)
    with pytest.raises(InputError, match="TACTCAD_CACHE"):
        Cache(tmp_path, said.append)
    assert {str(p.relative_to(tmp_path)): p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == files


@pytest.mark.parametrize(
    "mark", [b"", b"Signature: 8a47", b"Signature: 8a477f597d28d172789f06886806bc55\n# borg\n"]
)
def test_a_mark_is_ours_or_a_killed_runs(tmp_path, mark):
    """Another program's mark is none of ours; our own may be unfinished, as long as nothing else is there."""
    (tmp_path / "CACHEDIR.TAG").write_bytes(mark)
    if b"borg" in mark:
        with pytest.raises(InputError):
            Cache(tmp_path)
        return
    Cache(tmp_path).put("key", DATA)
    assert Cache(tmp_path).get("key") == DATA
    (tmp_path / "CACHEDIR.TAG").write_bytes(mark)
    with pytest.raises(InputError):
        Cache(tmp_path)


def test_trimming_takes_nothing_but_entries(cache):
    """Files that others put into the cache stay, and so does what links and folders in it lead to."""
    cache.put("old", DATA)
    elsewhere = cache.root.parent / "elsewhere"
    files = others_files(elsewhere)
    (cache.root / "thesis.txt").write_text("three years")
    own = entry(cache)
    (own.parent / "notes").write_text("mine")
    (own.parent / ("0" * 64)).write_text("another folder's name")
    (own.parent / f"{own.parent.name}{'0' * 62}").symlink_to(elsewhere / "photo.jpg")
    (cache.root / ("ab" if own.parent.name != "ab" else "cd")).symlink_to(elsewhere / "ab")
    left = {p for p in cache.root.rglob("*") if p != own}
    assert cache.trim(0) == 1
    assert {*cache.root.rglob("*")} == left
    assert {
        str(p.relative_to(elsewhere)): p.read_bytes() for p in elsewhere.rglob("*") if p.is_file()
    } == files


def as_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def as_device(path: Path) -> None:
    path.unlink()
    path.symlink_to("/dev/zero")


def as_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def too_large(path: Path) -> None:
    os.truncate(path, 10**12)


@pytest.mark.parametrize("change", [as_pipe, as_device, as_folder, too_large])
def test_what_is_no_file_is_no_entry(cache, said, change):
    """And it is not waited for."""
    cache.put("key", DATA)
    change(entry(cache))
    assert cache.get_or_make("key", lambda: b"anew") == b"anew"
    assert "damaged" in said[0]
    if change is not as_folder:
        assert cache.get("key") == b"anew"


def test_the_cache_begins_at_once_in_several_processes(tmp_path):
    script = (
        "import sys; from pathlib import Path; from tactcad.export.cache import Cache\n"
        "cache = Cache(Path(sys.argv[1]), sys.exit); cache.put('key', b'1')\n"
        "sys.exit(cache.get('key') != b'1')"
    )
    runs = [subprocess.Popen([sys.executable, "-c", script, tmp_path / "new"]) for _ in range(4)]
    assert [run.wait() for run in runs] == [0] * 4
