"""A store of finished tasks at any address that fsspec knows: s3://bucket/path, gs://..., sftp://...

An entry is one object: a line with the SHA-256 of key and bytes, then the bytes. It is written whole or not
at all, by fsspec's transactions, and verified when it is read. Whoever may write there is trusted.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from tactcad.design.messages import CheckFailure, InputError
from tactcad.export.contents import sha256_of

Kind = TypeVar("Kind")


class FarStore:
    """The store at an address; entries' names are digests of their keys.

    Raises
    ------
    InputError
        Where fsspec does not know such addresses, what it needs for them is not installed, or there can be no
        store.
    CheckFailure
        Later, where the place does not answer or refuses.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        self._files, self._root = files_at(address, make=True)

    def get(self, key: str) -> bytes | None:
        """The bytes kept under the key, None where there are none or they are damaged."""

        def read() -> bytes | None:
            try:
                return self._files.cat_file(self._path(key))
            except FileNotFoundError:
                return None

        kept = self._tried(read)
        if kept is None:
            return None
        header, _, data = kept.partition(b"\n")
        return data if header == _header(key, data) else None

    def put(self, key: str, data: bytes) -> None:
        """Keep the bytes under the key."""

        def write() -> None:
            with self._files.transaction, self._files.open(self._path(key), "wb") as file:
                file.write(_header(key, data) + b"\n")
                file.write(data)

        self._tried(write)

    def has(self, key: str) -> bool:
        """Whether something is kept under the key."""
        return self._tried(lambda: self._files.exists(self._path(key)))

    def _path(self, key: str) -> str:
        return f"{self._root.rstrip('/')}/{sha256_of(key.encode())}"

    def _tried(self, ask: Callable[[], Kind]) -> Kind:
        try:
            return ask()
        except Exception as error:  # each kind of place has its own
            raise self._refusal(error) from error

    def _refusal(self, error: Exception) -> CheckFailure:
        return CheckFailure(f"--store {self.address}: {_why(error)}; what was finished is kept")


def files_at(address: str, make: bool = False) -> tuple[Any, str]:
    """fsspec's file system of an address, and the path in it. Raises InputError where there can be none."""
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


def _header(key: str, data: bytes) -> bytes:
    return sha256_of(key.encode() + b"\0" + data).encode()
