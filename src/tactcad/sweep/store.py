"""The folder of a study: its mark, the finished results, and the final table.

DIR/study.json names the study by digest; DIR/store, or another place, holds one entry for every task that is
finished, each written in one step and verified when it is read (tactcad.export.cache, or `FarStore` at an
address that fsspec knows: s3://bucket/path, gs://...); the rest is written whole at the end.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from tactcad.design.files import absolute, make_folder, read_json, write_whole
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.staging import OWN
from tactcad.export.cache import MARK_NAME, Cache, as_entry, from_entry
from tactcad.export.manifest import sha256_of

from .measured import EXPORT, as_bytes, export_folder, from_bytes
from .study import Study

if TYPE_CHECKING:
    import pyarrow as pa

# Not "tactcad-...": an export takes a folder marked so for its own, and refuses to lie inside it.
SCHEMA = "sweep-1"
MARK, STORE = "study.json", "store"
MOST_BYTES = 100_000


class StudyStore:
    """Finished results of a study: an entry a task.

    Parameters
    ----------
    study
        The study.
    folder
        Its path; absolute, so that a worker with another working folder finds it.
    made_by
        Digest of the rooms and libraries behind the results (`measured.made_by`).
    store
        Address of the store if it is not in the folder.
    """

    def __init__(self, study: Study, folder: Path, made_by: str, store: str | None = None) -> None:
        self.study, self.folder = study, folder
        self._prefix = f"{SCHEMA} {study.identity} {made_by}"
        self._said: list[str] = []
        self._store = FarStore(store) if store else Cache(folder / STORE, self._said.append)

    def get(self, start: int, stop: int) -> pa.Table | None:
        """Kept results of these designs; None if they are not finished, or the entry is damaged."""
        data = self._store.get(self._key(start, stop))
        table = from_bytes(data) if data is not None else None
        return None if table is None or self._lacks_files(start, table) else table

    def put(self, start: int, stop: int, table: pa.Table) -> None:
        """Keep it. Raises CheckFailure if that cannot be."""
        if not self._store.put(self._key(start, stop), as_bytes(table)):
            why = " ".join(self._said[-1:]).removesuffix("; going on without")
            raise CheckFailure(f"{self.folder}: a result cannot be kept: {why}")

    def tidy(self, alone: bool = False) -> None:
        """Remove what killed workers left half written; `alone`, what our own stopped ones were writing."""
        if isinstance(self._store, Cache):
            self._store.trim(sys.maxsize)
        for left in (self.folder / STORE).glob("??/.*.part") if alone else ():
            left.unlink(missing_ok=True)

    def _key(self, start: int, stop: int) -> str:
        return f"{self._prefix} {start} {stop}"

    def _lacks_files(self, start: int, table: pa.Table) -> bool:
        """Whether a finished export is missing or changed."""
        if EXPORT not in self.study.measure.what:
            return False
        wanted = table["manifest_sha256"][0].as_py()
        manifest = export_folder(self.folder, start + 1) / "manifest.json"
        there = sha256_of(manifest.read_bytes()) if manifest.is_file() else ""
        return there != wanted


def claimed(study: Study, out: str | Path) -> Path:
    """The folder, absolute, made and marked as this study's.

    Raises
    ------
    InputError
        If it holds another study, or anything else.
    """
    folder = absolute(out)
    make_folder(folder)
    if not (folder / MARK).exists():
        killed = f".{MARK}{OWN}"  # the temporary mark of a killed run
        if left := sorted(n for n in os.listdir(folder) if not n.startswith(killed)):
            what = f"holds files that are no study's, such as {left[0]}"
            raise InputError(str(out), what, legal="a new or empty folder, or one of this study")
        mark = {"schema": SCHEMA, "name": study.study.name, "study": study.identity}
        write_whole(folder / MARK, (json.dumps(mark, indent=1) + "\n").encode())
    found = mark_of(folder)
    if found.get("study") != study.identity:
        what = f"holds another study, or this one as it was before a change: {found.get('name')}"
        raise InputError(str(out), what, value=study.study.name, legal="a folder of its own for every study")
    return folder


def store_apart(address: str, folder: Path) -> str | None:
    """The address of a store, absolute if it is a path; None if it is the folder's own. Raises InputError if
    it is another place in the folder, another study's folder or store, or no address."""
    files, root = files_at(address)
    if "file" not in files.protocol:
        return address
    place, home, own = (Path(os.path.realpath(p)) for p in (root, folder, folder / STORE))
    if place == own:
        return None
    if home in (place, *place.parents) or (place / MARK).exists() or (place / MARK_NAME).exists():
        what, legal = "is a study's own folder, or its store", "a place apart; left out: DIR/store"
        raise InputError("--store", what, value=address, legal=legal)
    return root


def mark_of(folder: Path) -> dict[str, Any]:
    """The folder's mark of its study. Raises InputError if it is no study's."""
    there = (folder / MARK).exists()
    found = read_json(folder / MARK, MOST_BYTES, "a study's mark") if there else None
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        raise InputError(
            str(folder), "is not the folder of a study", legal="DIR of `tactcad sweep --out DIR`"
        )
    return found


Kind = TypeVar("Kind")


class FarStore:
    """The store at an address; entries' names are digests of their keys.

    Raises
    ------
    InputError
        If fsspec does not know such addresses, a package for them is not installed, or there can be no store.
    CheckFailure
        Later, if the place does not answer or refuses.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        self._files, self._root = files_at(address, make=True)

    def get(self, key: str) -> bytes | None:
        """The bytes kept under the key, None if there are none or they are damaged."""

        def read() -> bytes | None:
            try:
                return self._files.cat_file(self._path(key))
            except FileNotFoundError:
                return None

        entry = self._tried(read)
        return None if entry is None else from_entry(key, entry)

    def put(self, key: str, data: bytes) -> bool:
        """Keep the bytes under the key."""

        def write() -> None:
            with self._files.transaction, self._files.open(self._path(key), "wb") as file:
                file.write(as_entry(key, data))

        self._tried(write)
        return True

    def _path(self, key: str) -> str:
        return f"{self._root.rstrip('/')}/{sha256_of(key.encode())}"

    def _tried(self, ask: Callable[[], Kind]) -> Kind:
        try:
            return ask()
        except Exception as error:  # each kind of place has its own
            what = f"--store {self.address}: {_why(error)}; what was finished is kept"
            raise CheckFailure(what) from error


def files_at(address: str, make: bool = False) -> tuple[Any, str]:
    """fsspec's file system of an address, and the path in it. Raises InputError if there can be none."""
    import fsspec

    try:
        files, root = fsspec.url_to_fs(address)
        if make:
            files.makedirs(root, exist_ok=True)
    except Exception as error:  # each kind of place has its own
        legal = "a folder, or an address such as s3://bucket/path"
        raise InputError("--store", _why(error), value=address, legal=legal) from error
    return files, root


def _why(error: Exception) -> str:
    """In one line."""
    text = getattr(error, "strerror", None) or str(error)
    return " ".join(text.split()) or type(error).__name__
