"""Reads the suppliers' packages back, and reports how they differ from the whole zip."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from tactcad.export import inspection
from tactcad.export.contents import sha256_of
from tactcad.parts.description import NOT_ORDERED
from tactcad.scenes import bom

from .archive import MANIFEST
from .packages import ORDER, PART_INSPECTION, SHEET, Packed, table_rows
from .release_contents import ReleaseContents
from .verify import README, bill_of, mark_faults, read_back

OWN = (README, MANIFEST, ORDER, PART_INSPECTION, inspection.NAME)


def check_packages(
    paths: Sequence[Path], packages: Sequence[Packed], whole: Path, contents: ReleaseContents
) -> list[str]:
    """What is wrong with the written packages; empty where nothing is.

    Parameters
    ----------
    paths, packages
        The written zips, and what they are to hold, in the same order.
    whole
        The whole zip, found right.
    contents
        What the release is about.
    """
    every, _ = read_back(whole)
    wrong, orders = [], []
    for path, one in zip(paths, packages, strict=True):
        files, faults = read_back(path)
        faults = faults or [*_package_faults(files, every, one, contents)]
        wrong += [f"{one.package.name}: {fault}" for fault in faults]
        if one.package is not SHEET and ORDER in files:  # its lines are made by others
            orders += table_rows(files[ORDER])
    return wrong or [*_order_faults(orders, every, contents)]


def _package_faults(
    files: Mapping[str, bytes], every: Mapping[str, bytes], one: Packed, contents: ReleaseContents
) -> Iterator[str]:
    """As in the whole zip, named by a line of the order, and every file that a line names."""
    named = dict(_named(files.get(ORDER, b"")))
    for path, data in files.items():
        if path in OWN:
            continue
        if data != every.get(path):
            yield f"{path}: not as in the whole zip"
        if path not in named:
            yield f"{path}: no line of {ORDER} names it"
    for path, digest in named.items():
        if sha256_of(files.get(path, b"")) != digest:
            yield f"{path}: not here as {ORDER} has it"
    if inspection.NAME in files and files[inspection.NAME] != every.get(inspection.NAME):
        yield f"{inspection.NAME}: not as in the whole zip"
    listed = table_rows(every.get(PART_INSPECTION, b""))
    yield from (
        f"{PART_INSPECTION}: {row['part_no']}: not as in the whole zip"
        for row in table_rows(files.get(PART_INSPECTION, b""))
        if row not in listed
    )
    identity = contents.design.design
    title = f"{identity.name}, revision {identity.revision}: {one.package.title}"
    if files.get(README, b"").decode().splitlines()[:1] != [title]:
        yield f"{README}: its first line is not {title!r}"
    yield from mark_faults(files, contents)


def _named(order: bytes) -> Iterator[tuple[str, str]]:
    for row in table_rows(order):
        for name, path in row.items():
            if path and f"{name}_sha256" in row:
                yield path, row[f"{name}_sha256"]


def _order_faults(
    orders: Sequence[Mapping[str, str]], every: Mapping[str, bytes], contents: ReleaseContents
) -> Iterator[str]:
    """Every line of the bills stands in one package, once, with at least what the largest set-up needs (for
    one set just that), and its spares."""
    needed: dict[str, float] = {}
    spares: dict[str, float] = {}
    for scene in contents.scenes:
        for row in bom.rows_from_csv(every[bill_of(scene)]):
            if row.process not in NOT_ORDERED:
                needed[row.part_no] = max(needed.get(row.part_no, 0.0), row.qty)
                spares[row.part_no] = row.spares
    counts = Counter(row["part_no"] for row in orders)
    yield from (f"{n} of the bills is in {counts[n]} packages" for n in needed if counts[n] != 1)
    yield from (f"{n} of an order stands in no bill" for n in counts if n not in needed)
    for line in orders:
        number, qty = line["part_no"], float(line["qty"])
        least = needed.get(number, 0.0)
        if qty < least or (contents.sets == "one" and qty != least):
            yield f"{number}: {qty:g} ordered, {least:g} needed"
        if float(line["order"]) != round(qty + spares.get(number, 0.0), 6):
            yield f"{number}: {line['order']} with spares, not {qty:g} and {spares.get(number, 0.0):g}"
