"""Bytes by key, kept from run to run; every entry is verified when it is read, and all may be deleted.

The key contains everything that the bytes depend on (see inputs.py), so an entry is never out of date, only
absent. An entry is one file named by the key's digest: a line with the digest of key and bytes, then the
bytes. Entries that were truncated, altered or put under another key are reported, removed and built again.

The folder is one that tactcad made, or found empty, and marked; any other is refused, and only files named
like entries are removed. The cache is optional: if it cannot be written, the work is done without it. At the
end of an export the least recently used entries beyond a bound are removed.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tactcad.design.files import read_bytes
from tactcad.design.messages import InputError
from tactcad.design.staging import remove_left, staged_file

from .manifest import sha256_of

# All designs in hardware/ take 50 MB a revision: room for ten revisions, little for a disk.
MOST_BYTES = 500_000_000
LIBRARIES = "libraries"

# bford.info/cachedir: backup programs skip a folder with such a file
MARK_NAME = "CACHEDIR.TAG"
MARK = b"""Signature: 8a477f597d28d172789f06886806bc55
# Cache of tactcad: everything in this folder may be deleted at any time, and tactcad deletes in it.
"""


def as_entry(key: str, data: bytes) -> bytes:
    """The bytes with a line before them, by which `from_entry` verifies them."""
    return sha256_of(key.encode() + b"\0" + data).encode() + b"\n" + data


def from_entry(key: str, entry: bytes) -> bytes | None:
    """The bytes of an entry; None if it is damaged, or another key's."""
    data = entry.partition(b"\n")[2]
    return data if as_entry(key, data) == entry else None


class Cache:
    """A folder of entries; `say` gets one line when an entry is damaged, and one when the folder is of no
    use.

    Raises InputError if `root` holds anything and is not marked as tactcad's.
    """

    def __init__(
        self, root: Path, say: Callable[[str], None] = lambda text: print(text, file=sys.stderr)
    ) -> None:
        self.root, self.say = root, say
        self._ours = self._complained = False
        try:
            root.mkdir(parents=True, exist_ok=True)
            _claim(root)
            self._ours = True
        except OSError as error:
            self._complain(error)

    def get(self, key: str) -> bytes | None:
        """The bytes kept under the key, None if there are none or they are damaged."""
        path = self._path(key)
        if not os.path.lexists(path):
            return None
        try:
            data = from_entry(key, read_bytes(path, MOST_BYTES, "an entry of the cache"))
        except InputError:
            data = None
        with suppress(OSError):  # another process removed it, or a folder
            if data is not None:
                os.utime(path)  # by which `trim` decides
            elif os.path.lexists(path):
                self.say(f"cache: entry {path.name[:12]} is damaged and will be built again")
                path.unlink()
        return data

    def put(self, key: str, data: bytes) -> bool:
        """Keep the bytes under the key, whole or not at all; whether that could be."""
        path = self._path(key)
        try:
            if self._ours:
                path.parent.mkdir(exist_ok=True)
                with staged_file(path) as part:
                    part.write_bytes(as_entry(key, data))
                    part.replace(path)  # another process may put the same entry: the last one stays
        except OSError as error:
            self._complain(error)
            return False
        return self._ours

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

        Returns how many entries were removed. Another process may read or write meanwhile: it builds missing
        entries again.
        """
        entries = []
        for path in self._files():
            with suppress(OSError):  # another process was faster
                if path.name.startswith("."):
                    remove_left(path)
                else:
                    state = path.stat()
                    entries.append((state.st_mtime_ns, path.name, state.st_size, path))
        excess, gone = sum(size for _, _, size, _ in entries) - most_bytes, 0
        for _, _, size, path in sorted(entries):
            if excess <= 0:
                break
            path.unlink(missing_ok=True)
            gone, excess = gone + 1, excess - size
        return gone

    def _path(self, key: str) -> Path:
        name = sha256_of(key.encode())
        return self.root / name[:2] / name

    def _files(self) -> list[Path]:
        """Entries, and those that are being written; links are somebody's."""
        folders = [f for f in self.root.glob("[0-9a-f][0-9a-f]") if self._ours and not f.is_symlink()]
        files = [file for folder in folders for file in folder.glob("*")]
        form = re.compile(r"[0-9a-f]{64}|\.[0-9a-f]{64}\.tactcad-.{8}\.part")
        return [
            file
            for file in files
            if form.fullmatch(file.name)
            and file.name.lstrip(".")[:2] == file.parent.name
            and file.is_file()
            and not file.is_symlink()
        ]

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
    """Mark an empty folder; raises InputError if it is another's."""
    names = os.listdir(root)  # before the mark is read: who put anything there had marked it
    mark = read_bytes(root / MARK_NAME, MOST_BYTES, "a cache's mark") if MARK_NAME in names else b""
    if mark == MARK:
        return
    if set(names) - {MARK_NAME, LIBRARIES} or not MARK.startswith(mark):
        raise InputError(
            str(root),
            "holds files that are not tactcad's, so it cannot be the cache",
            legal="in TACTCAD_CACHE: a new or empty folder, or one that tactcad made its cache before",
        )
    (root / MARK_NAME).write_bytes(MARK)  # another process may do the same
