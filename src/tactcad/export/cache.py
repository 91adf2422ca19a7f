"""Bytes by key, kept from run to run; every entry is verified when it is read.

The key contains everything that the bytes depend on (see inputs.py), so an entry is never out of date, only
absent. An entry is one file: a header line with the digest of key and bytes, then the bytes; name and digest
are keyed with a secret that is stored beside the entries and readable by its owner only. Entries that were
truncated, altered, made without the secret or put under another key are reported, removed and built again.

The folder is one that tactcad made or found empty, and marked; any other is refused, and in its own only
regular files with the names of entries are read or removed. The cache is optional: where it cannot be written
the work is done without it. At the end of an export the least recently used entries beyond a bound are
removed.
"""

from __future__ import annotations

import fcntl
import hmac
import os
import re
import stat
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from tactcad.design.messages import InputError
from tactcad.ending import unfinished

FORMAT = b"tactcad-cache-2"
# All designs in hardware/ take 50 MB a revision: room for ten revisions, little for a disk.
MOST_BYTES = 500_000_000
UNFINISHED = ".new-"

# bford.info/cachedir: backup programs skip a folder with such a file
MARK_NAME = "CACHEDIR.TAG"
MARK = b"""Signature: 8a477f597d28d172789f06886806bc55
# Cache of tactcad: everything in this folder may be deleted at any time, and tactcad deletes in it.
"""
SECRET_NAME, SECRET_BYTES = "secret", 32
LIBRARIES = "libraries"


class Cache:
    """A folder of entries; `say` gets one line when an entry is damaged, and one when the folder is of no
    use.

    Raises InputError where `root` holds anything and is not marked as tactcad's.
    """

    def __init__(
        self, root: Path, say: Callable[[str], None] = lambda text: print(text, file=sys.stderr)
    ) -> None:
        self.root, self.say = root, say
        self._secret = b""  # empty: nothing is read or kept
        self._trouble: OSError | None = None  # why, reported at the first use
        self._complained = False
        try:
            root.mkdir(parents=True, exist_ok=True)
            _claim(root)
            self._secret = _secret(root / SECRET_NAME)
        except OSError as error:
            self._trouble = error

    def get(self, key: str) -> bytes | None:
        """The bytes kept under the key, None where there are none or they are damaged."""
        if self._trouble:
            self._complain(self._trouble)
            return None
        path = self._path(key)
        try:
            kept = None if path.parent.is_symlink() else _content(path)
        except FileNotFoundError:
            return None
        except OSError:  # a link, a folder
            kept = None
        header, _, data = (kept or b"").partition(b"\n")
        if hmac.compare_digest(header, self._header(key, data)):
            return data
        self.say(f"cache: entry {path.name[:12]} is damaged and will be built again")
        with suppress(OSError):
            path.unlink()
        return None

    def has(self, key: str) -> bool:
        """Whether something is kept under the key, damaged or not."""
        return not self._trouble and self._path(key).is_file()

    def put(self, key: str, data: bytes) -> None:
        """Keep the bytes under the key, whole or not at all."""
        if self._trouble:
            return
        path = self._path(key)
        try:
            path.parent.mkdir(exist_ok=True)
            if path.parent.is_symlink():
                return  # it leads out of the folder
            handle, temporary = tempfile.mkstemp(prefix=UNFINISHED, dir=path.parent)
            try:
                with unfinished(lambda: os.unlink(temporary)), open(handle, "wb") as file:
                    fcntl.flock(file, fcntl.LOCK_EX)  # by which `trim` recognises what a killed run left
                    file.write(self._header(key, data) + b"\n")
                    file.write(data)
                    file.flush()
                    os.replace(temporary, path)  # another process may put the same entry: the last one stays
            except BaseException:
                with suppress(OSError):
                    os.unlink(temporary)
                raise
        except OSError as error:
            self._complain(error)

    def get_or_make(self, key: str, make: Callable[[], bytes]) -> bytes:
        """The bytes kept under the key, or what `make` returns, which is then kept."""
        data = self.get(key)
        if data is None:
            data = make()
            self.put(key, data)
        return data

    def trim(self, most_bytes: int = MOST_BYTES) -> int:
        """Remove the least recently used entries until `most_bytes` are left, and what killed runs left half
        written.

        Returns how many entries were removed. Another process may read or write meanwhile: it builds again
        what it misses.
        """
        if self._trouble:
            return 0
        entries = []
        for path in _own_files(self.root):
            with suppress(OSError):  # another process was faster
                if path.name.startswith(UNFINISHED):
                    _remove_if_left(path)
                else:
                    state = path.lstat()
                    entries.append((state.st_mtime_ns, path.name, state.st_size, path))
        excess, gone = sum(size for _, _, size, _ in entries) - most_bytes, 0
        for _, _, size, path in sorted(entries):
            if excess <= 0:
                break
            with suppress(OSError):
                path.unlink()
                gone += 1
            excess -= size
        return gone

    def _path(self, key: str) -> Path:
        name = hmac.digest(self._secret, key.encode(), "sha256").hex()
        return self.root / name[:2] / name

    def _header(self, key: str, data: bytes) -> bytes:
        digest = hmac.new(self._secret, key.encode() + b"\0", "sha256")
        digest.update(data)
        return b"%s %s" % (FORMAT, digest.hexdigest().encode())

    def _complain(self, error: OSError) -> None:
        if not self._complained:
            why = f"{error.strerror}: {error.filename2 or error.filename or self.root}"
            self.say(f"cache: {self.root} cannot keep an entry ({why}); going on without")
        self._complained = True


def default_root() -> Path:
    """TACTCAD_CACHE; or .cache/ in the checkout that this package runs from; or the user's cache folder."""
    if named := os.environ.get("TACTCAD_CACHE"):
        return Path(named)
    checkout = Path(__file__).parents[3]
    if (checkout / "pyproject.toml").is_file() and (checkout / "src").is_dir():
        return checkout / ".cache" / "tactcad" / "entries"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "tactcad" / "entries"


def take_libraries_in() -> None:
    """Have matplotlib and ezdxf keep their lists of fonts in our cache, in this process and those it starts.

    They are not loaded yet: where, they ask the environment then. ezdxf knows XDG_CACHE_HOME only.
    """
    root = default_root()
    os.environ |= {"TACTCAD_CACHE": str(root), "XDG_CACHE_HOME": str(root / LIBRARIES)}
    os.environ.setdefault("MPLCONFIGDIR", str(root / LIBRARIES / "matplotlib"))


def _claim(root: Path) -> None:
    """Mark an empty folder; raises InputError where it is another's."""
    names = os.listdir(root)  # before the mark is read: who put anything there had marked it
    mark = _content(root / MARK_NAME) if MARK_NAME in names else b""
    if mark == MARK:
        return
    if set(names) - {MARK_NAME, LIBRARIES} or mark is None or not MARK.startswith(mark):
        raise InputError(
            str(root),
            "holds files that are not tactcad's, so it cannot be the cache",
            legal="in TACTCAD_CACHE: a new or empty folder, or one that tactcad made its cache before",
        )
    (root / MARK_NAME).write_bytes(MARK)  # another process may do the same


def _secret(path: Path) -> bytes:
    """32 random bytes that only this user can read, drawn on first use.

    Raises PermissionError where the file is not this user's.
    """
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK, 0o600)
    with open(handle, "r+b", buffering=0) as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        state = os.fstat(handle)
        if state.st_uid != os.geteuid() or not stat.S_ISREG(state.st_mode) or state.st_nlink != 1:
            raise PermissionError(0, f"{path.name} in it is not this user's own file")
        known = file.read(SECRET_BYTES + 1)
        if len(known) != SECRET_BYTES or state.st_mode & 0o077:  # a killed run's, or others may have read it
            os.fchmod(handle, 0o600)
            known = os.urandom(SECRET_BYTES)
            file.seek(0)
            file.truncate()
            file.write(known)
        return known


def _content(path: Path) -> bytes | None:
    """The bytes of a regular file, None where it is something else or larger than the whole cache.

    Records the use of the file, by which `trim` decides.
    """
    with open(path, "rb", opener=_without_waiting) as file:
        state = os.fstat(file.fileno())
        if not stat.S_ISREG(state.st_mode) or state.st_size > MOST_BYTES:
            return None
        with suppress(OSError):
            os.utime(file.fileno())
        return file.read()


def _without_waiting(path: str, flags: int) -> int:
    """Open a file without following links and without waiting for a pipe's writer."""
    return os.open(path, flags | os.O_NOFOLLOW | os.O_NONBLOCK)


def _own_files(root: Path) -> Iterator[Path]:
    """The regular files below `root` that are named as entries, finished or not; no link is followed."""
    with suppress(OSError), os.scandir(root) as folders:
        for folder in folders:
            if re.fullmatch("[0-9a-f]{2}", folder.name) and folder.is_dir(follow_symlinks=False):
                named = re.compile(f"{folder.name}[0-9a-f]{{62}}|{re.escape(UNFINISHED)}.*")
                with suppress(OSError), os.scandir(folder) as files:
                    yield from (
                        Path(file.path)
                        for file in files
                        if named.fullmatch(file.name) and file.is_file(follow_symlinks=False)
                    )


def _remove_if_left(path: Path) -> None:
    """Remove an unfinished entry that no running process holds."""
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return
        path.unlink()
