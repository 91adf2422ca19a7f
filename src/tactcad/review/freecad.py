"""A design, or the changes between two, as FreeCAD's own document (FCStd): made by an installed FreeCAD,
without a screen, from a record in plain data.
"""

from __future__ import annotations

import dataclasses
import json
import os
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tactcad import shutdown
from tactcad.design.family import family_of
from tactcad.design.files import scratch_folder
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import NO_TABLES, CommonTables
from tactcad.export.shapes import Shapes
from tactcad.lab.array_estimate import ELEMENT
from tactcad.mechanics.ladder import DEFAULT_RUNG
from tactcad.parts.language.description import Part, Vector
from tactcad.scenes import make_scene

from .changed_scene import LOOKS, PieceKind, ScenePiece, changed_scenes
from .facts import Facts, FindingFact, finding_facts, scene_facts

COMMANDS = ("freecad", "FreeCAD")
SCRIPT = Path(__file__).with_name("peers") / "freecad_document.py"
RELOAD = SCRIPT.with_name("freecad_reload.py")
SECONDS = 600  # chosen: a large array is imported in seconds, a first start on a slow disk in a minute
Row = Sequence[str | float]
# The spreadsheet's columns: lengths in mm, as the document's.
ESTIMATES = (
    ELEMENT["number"].shown_as(heading="element"),
    *ELEMENT.some("arm", "load_arm", "stiffness", "expected_error", "stiffness_ratio", "force"),
    ELEMENT["deflection"].shown_as(unit="mm", scale=1.0),
    ELEMENT["gauge_strain"].shown_as(unit="microstrain"),
    ELEMENT["stress"],
    ELEMENT["rated_force"],
    ELEMENT["rated_deflection"].shown_as(heading="rated deflection", unit="mm", scale=1.0),
)


def program() -> str:
    """FreeCAD's window program, which alone keeps colours. Raises CheckFailure if it is not installed."""
    found = next(filter(None, map(shutil.which, COMMANDS)), None)
    if found is None:
        raise CheckFailure(
            "FreeCAD is not installed, no document was written; on Debian or Ubuntu: apt-get install freecad "
            "(0.20 or later), elsewhere see freecad.org"
        )
    return found


def refuse_no_document(out: str) -> None:
    """Refuse, before any work, if no document can be made at `out`.

    Raises InputError if it is no document's name, CheckFailure if FreeCAD is not installed.
    """
    if not out.endswith(".FCStd"):
        raise InputError("--freecad", "not a document of FreeCAD", value=out, legal="NAME.FCStd")
    program()


def freecad_document(
    design: CommonTables, scene_names: Sequence[str], shapes: Shapes, say: Callable[[int, int, str], None]
) -> bytes:
    """The document.

    Parameters
    ----------
    design
        Must keep its rules.
    scene_names
        The scenes to hold; the first one is shown.
    shapes
        Makes solids, or takes them from its cache.
    say
        Receives (done, total, text) as the work goes on.

    Raises
    ------
    CheckFailure
        If FreeCAD is not installed, or ends without a document.
    """
    command = program()
    scenes = tuple(make_scene(design, name) for name in scene_names)
    parts = {part.part_no: part for scene in scenes for part in scene.parts}
    total = len(parts) + 1
    say(0, total, "checks")
    findings = finding_facts(design, scenes, shapes, lambda *_: None)
    facts = [scene_facts(design, scene) for scene in scenes]
    record = freecad_record(design, facts, parts, findings)
    texts = (shapes.text_of(part) for part in parts.values())
    return made_by_freecad(command, record, texts, lambda n, what: say(n, total, what))


def freecad_record(
    design: CommonTables, scenes: Sequence[Facts], parts: Mapping[str, Part], findings: Sequence[FindingFact]
) -> dict[str, Any]:
    """The record; `file` of each part, its shape as BREP, is `part_file` of its place in `parts`."""
    identity = design.design
    return {
        "label": f"{identity.name} {identity.revision}",
        "about": [
            (name, getattr(identity, name) or "") for name in ("title", "name", "revision", "date", "author")
        ],
        "tables": {
            "Parameters": [("field", "value", "unit", "meaning", "origin"), *parameter_rows(design)],
            "Estimates": estimate_rows(design),
        },
        "parts": [
            {
                "part_no": p.part_no,
                "file": part_file(n),
                "colour": p.colour,
                "transparency": 0,
                "properties": _properties(p, identity.of_part(p.part_no).revision),
            }
            for n, p in enumerate(parts.values())
        ],
        "scenes": [_scene(scene, findings) for scene in scenes],
    }


def part_file(number: int) -> str:
    """Name of the file with the shape of the part that is at this place (from 0)."""
    return f"{number}.brep"


def parameter_rows(design: CommonTables) -> list[Row]:
    """Every field of the design that has a value: path, value, unit, meaning and origin."""
    rows: list[Row] = []
    for section in dataclasses.fields(design):
        table = getattr(design, section.name)
        if section.name in NO_TABLES or table is None:
            continue
        rows += _fields(section.name, table, design.origin)
        for inner in ("override", "unchanged"):
            for key, own in getattr(table, inner, {}).items():
                rows += _fields(f"{section.name}.{inner}.{key}", own, design.origin)
    return rows


def _fields(path: str, table: Any, origin: Mapping[str, str]) -> list[Row]:
    rows: list[Row] = []
    for f in dataclasses.fields(table):
        value = getattr(table, f.name)
        if "spec" in f.metadata and value is not None:
            name, spec = f"{path}.{f.name}", f.metadata["spec"]
            plain = value if isinstance(value, (int, float, str)) else _listed(value)
            rows.append((name, plain, spec.unit, spec.meaning, origin.get(name, "")))
    return rows


def _listed(value: Any) -> str:
    pairs = value.items() if isinstance(value, Mapping) else enumerate(value)
    named = isinstance(value, Mapping)
    return ", ".join(f"{k}: {v}" if named else str(v) for k, v in pairs)


def estimate_rows(design: CommonTables) -> list[Row]:
    """A heading and a row for each element, with the family's estimates; one row with the reason if it is out
    of the estimator's range."""
    try:
        family = family_of(design)
        rows = family.estimate.rows(family.layout(design), DEFAULT_RUNG, None)
    except CheckFailure as error:
        return [("not estimated",), (str(error),)]
    shown = [f for f in ESTIMATES if hasattr(rows[0], f.name)]
    cells = ((f.value(row) for f in shown) for row in rows)
    return [
        tuple(", ".join(filter(None, (f.heading, f.unit))) for f in shown),
        *(
            tuple("" if v is None else v if isinstance(v, int) else float(f"{v:.6g}") for v in row)
            for row in cells
        ),
    ]


def _properties(part: Part, revision: str) -> list[tuple[str, str]]:
    """Name and text of what FreeCAD shows of a part."""
    bought = part.purchase.designation if part.purchase else ""
    return [
        ("PartNumber", part.part_no),
        ("Title", part.name),
        ("Revision", "" if part.purchase else revision),
        ("Process", part.process),
        ("Material", str(part.material)),
        ("Mass", f"{part.mass:.4g} g"),
        ("Order", bought),
    ]


def _scene(scene: Facts, findings: Sequence[FindingFact]) -> dict[str, Any]:
    at = {p["designator"]: p for p in scene["placed"]}
    return {
        "name": scene["name"],
        "placed": scene["placed"],
        "findings": [
            {"label": f"{finding.severity}: {name}", "severity": finding.severity, "check": finding.check}
            | {"message": f"{finding.about}: {finding.message}", "at": _where(finding, at.get(name))}
            | {"way": at[name]["way"] if name in at else (0.0, 0.0, 0.0)}
            for finding in findings
            if finding.scene in ("", scene["name"])
            for name in _about(finding, at)
        ],
    }


def _about(finding: FindingFact, at: Mapping[str, Facts]) -> list[str]:
    """Places of a finding's marks: at its designators, else once at the scene's origin."""
    if finding.scene and finding.place:
        return [finding.check]
    here = [d for d in finding.designators if d in at]
    return here if finding.designators else [finding.about]


def _where(finding: FindingFact, placed: Facts | None) -> Vector:
    """Place of the mark in the scene, mm."""
    x, y, z = (*finding.place, 0.0, 0.0, 0.0)[:3]
    if placed is None:
        return (x, y, z)
    at = [
        sum(r * v for r, v in zip(row, (x, y, z))) + o for row, o in zip(placed["rotation"], placed["origin"])
    ]
    return (at[0], at[1], at[2])


def freecad_changes(
    designs: tuple[CommonTables, CommonTables],
    shapes: tuple[Shapes, Shapes],
    changes: Sequence[Row],
    say: Callable[[int, int, str], None],
) -> bytes:
    """The document.

    Parameters
    ----------
    designs
        Before and after; both must keep their rules.
    shapes
        Makers of their solids.
    changes
        Rows of the spreadsheet of changes, the first its heading.
    say
        Receives (done, total, text) as the work goes on.

    Raises
    ------
    CheckFailure
        If FreeCAD is not installed or ends without a document, or the designs have no scene in common.
    """
    command = program()
    scenes = changed_scenes(designs, shapes, say)
    record, texts = changes_record(designs, scenes, changes)
    return made_by_freecad(command, record, texts, lambda done, what: say(done, len(texts) + 1, what))


def changes_record(
    designs: tuple[CommonTables, CommonTables], scenes: dict[str, list[ScenePiece]], changes: Sequence[Row]
) -> tuple[dict[str, Any], list[bytes]]:
    """The record, and the shapes (BREP) of its parts; equal shapes are in it once."""
    from tactcad.solids.step import to_bytes

    parts: dict[tuple[bytes, PieceKind], dict[str, Any]] = {}
    texts: list[bytes] = []
    placed: dict[str, list[dict[str, Any]]] = {name: [] for name in scenes}
    for name, pieces in scenes.items():
        for piece in pieces:
            key = (to_bytes(piece.shape), piece.kind)
            if key not in parts:
                parts[key] = _part(piece, len(parts))
                texts.append(key[0])
            placed[name].append(piece.row(piece.designator, parts[key]["part_no"]))
    a, b = (design.design for design in designs)
    record = {
        "label": f"{a.name} {a.revision} to {b.name} {b.revision}",
        "about": [
            ("before", f"{a.name}, revision {a.revision}"),
            ("after", f"{b.name}, revision {b.revision}"),
            *(
                (f"{name}: {kind}", str(count))
                for name, pieces in scenes.items()
                for kind, count in sorted(Counter(p.kind for p in pieces).items())
            ),
        ],
        "tables": {"Changes": changes},
        "parts": list(parts.values()),
        "scenes": [{"name": name, "placed": rows, "findings": []} for name, rows in placed.items()],
    }
    return record, texts


def _part(piece: ScenePiece, number: int) -> dict[str, Any]:
    colour, transparency = LOOKS[piece.kind]
    remark = f"{piece.kind}, {piece.remark}" if piece.remark else piece.kind
    return {
        "part_no": f"{piece.part_no} {piece.kind} {number}",
        "file": part_file(number),
        "colour": colour,
        "transparency": transparency,
        "properties": [("PartNumber", piece.part_no), ("Material", remark)],
    }


def reload_macro(arguments: Sequence[str], document: Path) -> bytes:
    """FreeCAD's macro that makes the document again, by this tactcad with these arguments, and reloads it."""
    text = RELOAD.read_text("utf-8")
    for line, value in (
        ('COMMAND = ["tactcad"]', [sys.executable, "-P", "-m", "tactcad", *arguments]),
        ('FOLDER = "."', os.getcwd()),
        ('DOCUMENT = "review.FCStd"', os.path.realpath(document)),
    ):
        text = text.replace(line, f"{line.partition(' ')[0]} = {value!r}")
    return text.encode()


def made_by_freecad(
    command: str, record: Mapping[str, Any], texts: Iterable[bytes], say: Callable[[int, str], None]
) -> bytes:
    """The document of a record.

    Parameters
    ----------
    command
        As `program` found it.
    record
        As `peers/freecad_document.py` reads it.
    texts
        The shapes of its parts (BREP), in their order.
    say
        Receives (done, text) as the work goes on.

    Raises
    ------
    CheckFailure
        If FreeCAD ends without a document.
    """
    with scratch_folder("freecad") as folder:
        for n, (part, text) in enumerate(zip(record["parts"], texts, strict=True)):
            say(n + 1, part["part_no"])
            (folder / part["file"]).write_bytes(text)
        (folder / "record.json").write_text(json.dumps(record), encoding="utf-8")
        say(len(record["parts"]) + 1, "FreeCAD")
        return _run(command, folder)


def _run(command: str, folder: Path) -> bytes:
    out = folder / "review.FCStd"
    more = {"TACTCAD_RECORD": str(folder / "record.json"), "TACTCAD_OUT": str(out)}
    (folder / "user.cfg").write_text(profile())
    try:
        run = shutdown.run(
            [command, "-u", str(folder / "user.cfg"), str(SCRIPT)],
            SECONDS,
            env=environment(folder) | more,
            text=True,
            errors="replace",
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CheckFailure(f"FreeCAD could not be run: {error}") from error
    if not out.is_file() or not (folder / "done").is_file():
        said = [line for line in (run.stdout + run.stderr).splitlines() if "rror" in line]
        raise CheckFailure("FreeCAD ended without a document" + (f": {said[-1]}" if said else ""))
    return out.read_bytes()


def environment(folder: Path) -> dict[str, str]:
    """Variables under which FreeCAD runs without a screen, and leaves nothing outside `folder`."""
    runtime = folder / "run"
    runtime.mkdir(mode=0o700)
    own = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "TMPDIR"), str(folder))
    return {**os.environ, **own, "QT_QPA_PLATFORM": "offscreen", "XDG_RUNTIME_DIR": str(runtime)}


def profile(*imports: str) -> str:
    """A user's settings as FreeCAD keeps them: no start page, and groups of settings of its importers."""

    def group(name: str, *inside: str) -> str:
        return f'<FCParamGroup Name="{name}">{"".join(inside)}</FCParamGroup>'

    general = group("General", '<FCText Name="AutoloadModule">PartWorkbench</FCText>')
    settings = group("Mod", group("Import", *imports)) if imports else ""
    tree = group("Root", group("BaseApp", group("Preferences", general, settings)))
    return f'<?xml version="1.0" encoding="UTF-8" standalone="no" ?>\n<FCParameters>{tree}</FCParameters>\n'
