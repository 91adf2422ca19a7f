"""What all checks of a design found, kept from run to run: what asks after `tactcad check` need not run them
again."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from tactcad.checks.check_report import Case, Report
from tactcad.checks.shop import DEFAULT, load_shop
from tactcad.design.tree import CommonTables
from tactcad.parts.array.stiffness_table import Deflection
from tactcad.parts.language.finding import Finding
from tactcad.solids import USUAL, Meshing

from .cache import Cache
from .inputs import PACKAGE, digest, library_versions, source_digest
from .pipeline import LIBRARIES

MESHED_WITH = ("manifold3d", "trimesh")


def checked(
    design: CommonTables,
    names: Sequence[str],
    cache: Cache,
    shop_file: Path = DEFAULT,
    say: Callable[[int, int, str], None] = lambda done, total, text: None,
    strict: bool = False,
    meshing: Meshing = USUAL,
    anew: bool = False,
) -> Report:
    """The report of `run_checks`, from the cache if the same program checked the same design for this shop.

    Whose design it is, no check knows. With `anew` the checks run all the same, and their times are today's.
    """
    design = replace(design, design=replace(design.design, organisation=None, contact=None))
    rooms = sorted(p.name for p in PACKAGE.iterdir() if p.is_dir() and p.name[0] not in "._")
    made_by = [source_digest(room) for room in ("", *rooms)], library_versions((*LIBRARIES, *MESHED_WITH))
    key = digest(("checks", made_by, design, tuple(names), load_shop(shop_file), strict, meshing))
    kept = None if anew else cache.get(key)
    if kept is None:
        from tactcad.checks.run import run_checks  # loads the kernel

        report = run_checks(design, names, shop_file, say, strict, meshing)
        cache.put(key, json.dumps(asdict(report), default=float).encode())
        return report
    held = json.loads(kept)
    return Report(
        held["design"],
        held["revision"],
        [Case(**case | {"findings": tuple(map(_finding, case["findings"]))}) for case in held["cases"]],
        [Deflection(**line | {"fields": tuple(line["fields"])}) for line in held["deflections"]],
        held["size"] and tuple(held["size"]),
    )


def _finding(held: dict) -> Finding:
    return Finding(**held | {"place": tuple(held["place"])})
