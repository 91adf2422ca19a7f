"""Bytes by key, kept from run to run; every entry is verified when it is read.

The key names everything that the bytes depend on (see inputs.py), so an entry is never out of date, only
absent. An entry is one file: a header line with the digest of key and bytes, then the bytes. One
that was truncated, altered or put under another key is reported, removed and built again. The cache is a
help, not a need: where it cannot be written the work is done without it.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

FORMAT = b"tactcad-cache-1"


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
            handle, temporary = tempfile.mkstemp(prefix=".new-", dir=path.parent)
            try:
                with open(handle, "wb") as file:
                    file.write(_header(key, data) + b"\n" + data)
                os.replace(temporary, path)  # another process may put the same entry: the last one stays
            except BaseException:
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

    def _path(self, key: str) -> Path:
        name = hashlib.sha256(key.encode()).hexdigest()
        return self.root / name[:2] / name


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
