"""make review: opens every exported STEP and DXF file in real FreeCAD, headless, and compares it with the
bill of materials and the manifest; and every assembly in FreeCAD's window program, for the tree and the
colours that a person sees; and FreeCAD's own document of each design. Installs nothing; reports missing
programs and how to get them.

usage: python review.py exports/NAME...
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from math import isclose
from pathlib import Path

import document
import screen
import window

from tactcad.parts.rules import load
from tactcad.scenes import make_scene

INSIDE = Path(__file__).with_name("in_freecad.py")
# Debian's freecad-python3 belongs to the system's Python, others bring a command of their own.
CANDIDATES = (["/usr/bin/python3"], ["freecadcmd"], ["FreeCADCmd"])
AGREES = 1e-6  # share of a volume, area or length


def main(folders: list[str]) -> int:
    freecad = next((c for c in CANDIDATES if answers(c)), None)
    if freecad is None:
        print(
            "make review: FreeCAD is not installed, nothing was reviewed.\n"
            "make review: on Debian or Ubuntu: apt-get install freecad-python3",
            file=sys.stderr,
        )
        return 1
    wrong = []
    for folder in map(Path, folders):
        if not (folder / "manifest.json").is_file():
            wrong.append(f"{folder}: no export there; run make export first")
            continue
        findings = review(freecad, folder)
        wrong += [f"{folder}: {text}" for text in findings]
    for text in wrong:
        print(f"make review: {text}", file=sys.stderr)
    return 1 if wrong else 0


def answers(command: list[str]) -> bool:
    try:
        return open_files(command, []) is not None
    except OSError:
        return False


def open_files(command: list[str], paths: list[str]) -> dict | None:
    """FreeCAD's output for the files; None if it cannot be asked."""
    run = subprocess.run([*command, str(INSIDE), *paths], capture_output=True, text=True, check=False)
    lines = [line for line in run.stdout.splitlines() if line.startswith("REVIEW ")]
    return json.loads(lines[-1].removeprefix("REVIEW ")) if lines else None


def review(freecad: list[str], folder: Path) -> list[str]:
    manifest = json.loads((folder / "manifest.json").read_text())
    parts = {p["part_no"]: p for p in manifest["parts"]}
    files = [f for f in manifest["files"] if f["path"].endswith((".step", ".dxf"))]
    report = open_files(freecad, [str(folder / f["path"]) for f in files])
    if report is None:
        return ["FreeCAD ended without a report (it crashed on one of the files)"]
    program = window.command()
    wrong = [] if program else ["FreeCAD's window program is not there: nobody saw tree and colours"]
    wrong += scene_faults(manifest)
    assemblies = [folder / f["path"] for f in files if f["kind"] == "step-assembly"]
    trees = window.shown(program, assemblies) if program else {}
    for f in files:
        found = report["files"][str(folder / f["path"])]
        if f["kind"] in ("step-part", "step-pmi"):
            wrong += part_faults(f["path"], found, parts[f["part_no"]])
        elif f["kind"] == "step-assembly":
            bill = bill_of(folder, f["path"])
            wrong += assembly_faults(f["path"], found, bill, parts)
            if program:
                wrong += window.tree_faults(f["path"], trees.get(folder / f["path"]), bill)
        elif f["kind"] == "dxf":  # not a board's outline: no part has it
            wrong += cut_faults(f["path"], found, parts[f["part_no"]])
    if program:
        wrong += own_document_faults(freecad, folder, manifest["design"], parts)
    solids = sum(len(found.get("solids", ())) for found in report["files"].values())
    print(
        f"{folder}: FreeCAD {report['version']} opened {len(files)} files with {solids} solids, the trees "
        f"too, {len(wrong)} findings"
    )
    return wrong


def own_document_faults(freecad: list[str], folder: Path, name: str, parts: dict[str, dict]) -> list[str]:
    """FreeCAD's document of the design, made anew, against the export."""
    bills, seen_by = document.bills_of(folder), window.command()
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor() as beside:
        path = Path(scratch) / f"{name}.FCStd"
        chosen = [word for scene in bills for word in ("--scene", scene)]
        made = subprocess.run(
            [sys.executable, "-m", "tactcad", "review", str(folder), "--freecad", str(path), *chosen],
            capture_output=True,
            text=True,
            check=False,
        )
        if made.returncode:
            return [f"tactcad review --freecad: {made.stderr.strip().splitlines()[-1]}"]
        kept = folder.with_name(f"{folder.name}-freecad.png")
        picture = None  # made beside the others: it waits for a screen to settle
        if seen_by and screen.command():
            picture = beside.submit(screen.screen_faults, seen_by, path, kept)
        report = open_files(freecad, [str(path)])
        if report is None:
            return [f"{path.name}: FreeCAD ended without a report"]
        scenes = [make_scene(load(name), scene) for scene in bills]
        want = {p.part_no: p.colour for scene in scenes for p in scene.parts}
        found = report["files"][str(path)]
        wrong = document.document_faults(found, document.colours(path), bills, parts, want)
        if picture is None:
            print(f"{folder}: no picture of FreeCAD's window: apt-get install freecad xvfb xauth")
            return wrong
        return wrong + picture.result()


def scene_faults(manifest: dict) -> list[str]:
    """Every scene of the export has an assembly, and every assembly the bill of its scene."""
    bills = {
        Path(f["path"]).stem.removeprefix("bom").lstrip("-") or "array"
        for f in manifest["files"]
        if f["kind"] == "bom"
    }
    stem = f"{manifest['design']}-"
    models = {
        Path(f["path"]).stem.rpartition("_")[0].removeprefix(stem)
        for f in manifest["files"]
        if f["kind"] == "step-assembly"
    }
    return (
        []
        if bills == models
        else [f"assemblies of {', '.join(sorted(models))}, bills of {', '.join(sorted(bills))}"]
    )


def bill_of(folder: Path, path: str) -> list[dict]:
    """The bill of materials that belongs to an assembly: bom-SCENE.json, or the array's bom.json."""
    named = [p for p in folder.glob("bom-*.json") if f"-{p.stem.removeprefix('bom-')}_" in path]
    return json.loads((named[0] if named else folder / "bom.json").read_text())["rows"]


def part_faults(path: str, found: dict, part: dict) -> list[str]:
    solids = found["solids"]
    if len(solids) != 1:
        return [f"{path}: {len(solids)} solids instead of one"]
    return solid_faults(path, solids[0], part)


def solid_faults(path: str, solid: dict, part: dict) -> list[str]:
    wrong = (
        []
        if solid["valid"] and solid["closed"]
        else [f"{path}: {part['part_no']} is not a valid closed solid"]
    )
    for name, meant in (("volume", part["volume_mm3"]), ("area", part["area_mm2"])):
        if not isclose(solid[name], meant, rel_tol=AGREES):
            wrong.append(f"{path}: {part['part_no']} has {name} {solid[name]:.9g}, the manifest {meant:.9g}")
    return wrong


def assembly_faults(path: str, found: dict, bill: list[dict], parts: dict[str, dict]) -> list[str]:
    """Counts, names and volumes against the bill of materials."""
    rows = [row for row in bill if row["has_solid"]]
    solids = found["solids"]
    wrong = []
    if len(solids) != sum(row["qty"] for row in rows):
        wrong.append(
            f"{path}: {len(solids)} solids, the bill of materials has {sum(row['qty'] for row in rows)}"
        )
    wrong += [
        f"{path}: an invalid solid of {s['volume']:.6g} mm3"
        for s in solids
        if not (s["valid"] and s["closed"])
    ]
    meant = sorted(parts[row["part_no"]]["volume_mm3"] for row in rows for _ in range(int(row["qty"])))
    for got, want in zip(sorted(s["volume"] for s in solids), meant):
        if not isclose(got, want, rel_tol=AGREES):
            wrong.append(f"{path}: a solid of {got:.9g} mm3 where the manifest has {want:.9g}")
            break
    return wrong + name_faults(path, found["names"], rows)


def name_faults(path: str, labels: list[str], rows: list[dict]) -> list[str]:
    """Every part is in FreeCAD's tree under its part number, in the bill's quantity.

    FreeCAD makes labels unique by a running number: macro-array-spacer, macro-array-spacer001, ...
    """
    stem = re.compile(r"\d+$")
    seen = Counter(stem.sub("", label) for label in labels)
    meant = Counter()
    for row in rows:
        meant[stem.sub("", row["part_no"])] += int(row["qty"])
    return [
        f"{path}: FreeCAD shows {seen[name]} of {name}, the bill of materials has {count}"
        for name, count in meant.items()
        if seen[name] != count
    ]


def cut_faults(path: str, found: dict, part: dict) -> list[str]:
    size = [part["box_mm"][1][i] - part["box_mm"][0][i] for i in (0, 1)]
    wrong = [] if found["closed"] else [f"{path}: an open contour"]
    for name, got, meant in (
        ("area", found["area"], part["section_area_mm2"]),
        ("cut length", found["length"], part["cut_length_mm"]),
        ("width", found["size"][0], size[0]),
        ("height", found["size"][1], size[1]),
    ):
        # a blank is wider than the part that is milled or ground from it; its area and length are its own
        left = name in ("width", "height") and part["process"] != "wire-cut" and got > meant
        if not left and not isclose(got, meant, rel_tol=AGREES):
            wrong.append(f"{path}: {name} {got:.9g}, the part has {meant:.9g}")
    return wrong


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
