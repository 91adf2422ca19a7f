"""Bytes by key, kept from run to run; every entry is verified when it is read.

The key names everything that the bytes depend on (see inputs.py), so an entry is never out of date, only
absent. An entry is one file: a header line with the digest of key and bytes, then the bytes. One
that was truncated, altered or put under another key is reported, removed and built again. The cache is a
help, not a need: where it cannot be written the work is done without it. An export ends by taking out what was
used least recently beyond a bound.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

FORMAT = b"tactcad-cache-1"
# All designs in hardware/ take 50 MB a revision: room for ten of them, and a disk does not notice.
MOST_BYTES = 500_000_000
UNFINISHED = ".new-"


@dataclass(frozen=True)
class Cache:
    """A folder of entries; `say` gets one line when an entry is damaged or cannot be kept."""

    root: Path
    say: Callable[[str], None] = lambda text: print(text, file=sys.stderr)

    def get(self, key: str) -> bytes | None:
        """The bytes kept under the key, None where there are none or they are damaged."""
        path = self._path(key)
        try:
            header, _, data = path.read_bytes().partition(b"\n")
        except OSError:
            return None
        if header == _header(key, data):
            with suppress(OSError):
                os.utime(path)  # used now: `trim` goes by this
            return data
        self.say(f"cache: entry {path.name[:12]} is damaged and will be built again")
        with suppress(OSError):
            path.unlink()
        return None

    def put(self, key: str, data: bytes) -> None:
        """Keep the bytes under the key, whole or not at all."""
        path = self._path(key)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(prefix=UNFINISHED, dir=path.parent)
            try:
                with open(handle, "wb") as file:
                    fcntl.flock(file, fcntl.LOCK_EX)  # `trim` tells by it what a killed run left
                    file.write(_header(key, data) + b"\n" + data)
                os.replace(temporary, path)  # another process may put the same entry: the last one stays
            except BaseException:
                with suppress(OSError):
                    os.unlink(temporary)
                raise
        except OSError as error:
            self.say(f"cache: {self.root} cannot keep an entry ({error.strerror}); going on without")

    def get_or_make(self, key: str, make: Callable[[], bytes]) -> bytes:
        """The bytes kept under the key, or what `make` returns, which is then kept."""
        data = self.get(key)
        if data is None:
            data = make()
            self.put(key, data)
        return data

    def trim(self, most_bytes: int = MOST_BYTES) -> int:
        """Take out what was used least recently until `most_bytes` are left, and what killed runs left half written.

        Returns how many entries went. Another process may read or write meanwhile: what is gone for it is built again.
        """
        entries = []
        for path in self.root.glob("??/*"):
            with suppress(OSError):  # another process was faster
                if path.name.startswith(UNFINISHED):
                    _remove_if_left(path)
                else:
                    state = path.stat()
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
        name = hashlib.sha256(key.encode()).hexdigest()
        return self.root / name[:2] / name


def _remove_if_left(path: Path) -> None:
    """Remove an unfinished entry that no running process holds."""
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return
        path.unlink()


def default_root() -> Path:
    """TACTCAD_CACHE; or .cache/ in the checkout that this package runs from; or the user's cache folder."""
    if named := os.environ.get("TACTCAD_CACHE"):
        return Path(named)
    checkout = Path(__file__).parents[3]
    if (checkout / "pyproject.toml").is_file() and (checkout / "src").is_dir():
        return checkout / ".cache" / "tactcad"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "tactcad"


def _header(key: str, data: bytes) -> bytes:
    digest = hashlib.sha256(key.encode() + b"\0" + data).hexdigest()
    return b"%s %s" % (FORMAT, digest.encode())
