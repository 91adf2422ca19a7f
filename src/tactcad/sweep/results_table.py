"""The table of a study: chunk by chunk from the store to Parquet and CSV, never whole in memory."""

from __future__ import annotations

import hashlib
import io
from collections import Counter
from collections.abc import Iterable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactcad.design.files import whole_file

if TYPE_CHECKING:
    import pyarrow as pa

PARQUET, CSV = "results.parquet", "results.csv"
ROWS_A_GROUP = 1 << 16  # of Parquet: a reader takes a row group at once
SELDOM = 16  # rows a value from which on a column repeats; chosen: with fewer, a dictionary saves little
LOOKED_AT = 1 << 13  # first rows that tell; chosen: counting values takes longer than writing them
MOST_REASONS = 1000  # that are counted; of more, the rest counts as one


@dataclass
class Tally:
    """A table's summary: rows, refused ones with reasons, most frequent first; its files' SHA-256."""

    rows: int = 0
    refused: int = 0
    reasons: Counter[str] = field(default_factory=Counter)
    sha256: dict[str, str] = field(default_factory=dict)

    def add(self, table: pa.Table) -> None:
        import pyarrow.compute as pc

        self.rows += table.num_rows
        refused = table.filter(pc.invert(table["valid"]))
        self.refused += refused.num_rows
        for entry in refused["reason"].value_counts().to_pylist():
            known = entry["values"] in self.reasons or len(self.reasons) < MOST_REASONS
            self.reasons[entry["values"] if known else "other reasons"] += entry["counts"]


class _Digested(io.BufferedWriter):
    """A file with its digest computed on writing: reading it back would take as long again."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path, "wb"))
        self.sha256 = hashlib.sha256()

    def write(self, data: Any) -> int:
        self.sha256.update(data)
        return super().write(data)


def write_tables(folder: Path, chunks: Iterable[pa.Table], with_csv: bool, varied: Iterable[str]) -> Tally:
    """Write results.parquet, and results.csv if asked, each whole or not at all.

    Parameters
    ----------
    folder
        The study's.
    chunks
        Tables of one schema, in the order of the designs.
    with_csv
        Whether CSV is also written.
    varied
        Columns whose words are the user's: in CSV none is a formula.

    Raises
    ------
    InputError, CheckFailure
        As `whole_file`.
    """
    import pyarrow.csv
    import pyarrow.parquet as pq

    tally = Tally()
    with ExitStack() as stack:
        files: dict[str, _Digested] = {}
        writers: list = []
        for table in _grouped(chunks):
            if not writers:
                for name in (PARQUET, *([CSV] if with_csv else [])):
                    place = stack.enter_context(whole_file(folder / name))
                    files[name] = stack.enter_context(_Digested(place))
                parquet = pq.ParquetWriter(files[PARQUET], table.schema, **_encoded(table))
                writers.append(stack.enter_context(parquet))
                if with_csv:
                    writers.append(stack.enter_context(pyarrow.csv.CSVWriter(files[CSV], table.schema)))
            for n, writer in enumerate(writers):
                writer.write_table(_without_formulas(table, varied) if n else table)
            tally.add(table)
    tally.sha256 = {name: file.sha256.hexdigest() for name, file in files.items()}
    return tally


def _without_formulas(table: pa.Table, names: Iterable[str]) -> pa.Table:
    """For CSV: an apostrophe before each word that a spreadsheet would run, or that begins with one, so that
    the first can always be removed again."""
    import pyarrow.compute as pc

    for name in names:
        if table[name].type == "string":
            words = pc.replace_substring_regex(table[name], r"^('*[=+\-@\t\r])", r"'\1")
            table = table.set_column(table.column_names.index(name), name, words)
    return table


def _encoded(first: pa.Table) -> dict[str, Any]:
    """Parquet's encoding of a study's columns. Drawn numbers neither repeat nor compress, and trying doubles
    the time. Repeated values are kept as a dictionary and runs of places in it; designs' own numbers as
    steps."""
    import pyarrow as pa
    import pyarrow.compute as pc

    names, head = first.column_names, first.slice(0, LOOKED_AT)
    repeat = [n for n in names if SELDOM * pc.count_distinct(head[n]).as_py() <= head.num_rows]
    return {
        "use_dictionary": repeat,
        "column_encoding": {"number": "DELTA_BINARY_PACKED"},
        "compression": {n: "snappy" if pa.types.is_string(first[n].type) else "none" for n in names},
    }


def _grouped(chunks: Iterable[pa.Table]) -> Iterable[pa.Table]:
    """Small chunks joined to row groups."""
    import pyarrow as pa

    waiting: list[pa.Table] = []
    rows = 0
    for chunk in chunks:
        waiting.append(chunk)
        rows += chunk.num_rows
        if rows >= ROWS_A_GROUP:
            yield pa.concat_tables(waiting).combine_chunks()
            waiting, rows = [], 0
    if waiting:
        yield pa.concat_tables(waiting).combine_chunks()
