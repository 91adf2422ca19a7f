"""The assembly of a scene made again from what leaves: its STEP file and guide/SCENE.json, by its own code.

Every part is moved along its path in steps of STEP mm, past what stands there by then; it may share with
another part no more than both share at their places, or a third more: a screw that passes its whole thread.

    python tests/scenes/test_simulated_assembly.py         prints the tables of docs/stack.md
"""

from __future__ import annotations

import json
import re
import time
from dataclasses import dataclass, field
from pathlib import Path

import manifold3d
import numpy as np
import pytest
from built import shapes_of
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.gp import gp_Trsf
from OCP.IFSelect import IFSelect_RetDone
from OCP.IMeshTools import IMeshTools_MeshAlgoType, IMeshTools_Parameters
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from tactcad.export.step_file import scene_document, written
from tactcad.export.step_text import Header
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.moves import guide_json

pytestmark = pytest.mark.cad

STEP = 2.0  # mm
MOST = 0.1  # mm3: chords of curved faces
FIRST = "soft-tissue"  # the quickest with a setting fixture
NAMED = "macro-array"  # its freedoms are shown one by one
DESIGNS = (
    FIRST,
    *("macro-array", "better-array", "double-sample", "smallest-bearing", "tissue-array"),
    *("jaw-array", "planar-array"),
)
STACK = Path(__file__).parents[2] / "docs" / "stack.md"


def exported(design, name: str, folder: Path) -> tuple[Path, dict]:
    scene = make_scene(design, name)
    path = folder / f"{name}.step"
    shapes = shapes_of(scene)
    document = scene_document(scene, shapes, name)  # read back by this file's own code alone
    path.write_bytes(written(document, Header(name, name, "A", "2026-01-01", "", "")))
    return path, json.loads(guide_json(scene))


def solids(path: Path) -> dict[str, manifold3d.Manifold]:
    """Every placed solid of a STEP file by the name of its instance."""
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    assert reader.ReadFile(str(path)) == IFSelect_RetDone and reader.Transfer(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    roots, found, meshes = TDF_LabelSequence(), {}, {}
    tool.GetFreeShapes(roots)

    def walk(label, where):
        parts = TDF_LabelSequence()
        XCAFDoc_ShapeTool.GetComponents_s(label, parts)
        for i in range(1, parts.Length() + 1):
            one, name, of = parts.Value(i), TDataStd_Name(), type(parts.Value(i))()
            at = where.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(one))
            XCAFDoc_ShapeTool.GetReferredShape_s(one, of)
            if XCAFDoc_ShapeTool.IsAssembly_s(of):
                walk(of, at)
            else:
                assert one.FindAttribute(TDataStd_Name.GetID_s(), name)
                if (entry := of.Tag()) not in meshes:
                    meshes[entry] = mesh(XCAFDoc_ShapeTool.GetShape_s(of))
                found[name.Get().ToExtString()] = closed(*meshes[entry], at.Transformation())

    for i in range(1, roots.Length() + 1):
        walk(roots.Value(i), TopLoc_Location())
    return found


def mesh(shape) -> tuple[np.ndarray, np.ndarray]:
    """Points in the part's own frame, and triangles."""
    asked = IMeshTools_Parameters()
    asked.Deflection, asked.Angle = 0.02, 0.1
    asked.MeshAlgo = IMeshTools_MeshAlgoType.IMeshTools_MeshAlgoType_Delabella
    BRepMesh_IncrementalMesh(shape, asked)
    points, corners, faces = [], [], TopExp_Explorer(shape, TopAbs_FACE)
    while faces.More():
        face, where = TopoDS.Face_s(faces.Current()), TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, where)
        turn, base = where.Transformation(), len(points)
        nodes = [mesh.Node(i) for i in range(1, mesh.NbNodes() + 1)]
        points += [(n if where.IsIdentity() else n.Transformed(turn)).Coord() for n in nodes]
        for i in range(1, mesh.NbTriangles() + 1):
            a, b, c = (base + k - 1 for k in mesh.Triangle(i).Get())
            corners.append((a, c, b) if face.Orientation() == TopAbs_REVERSED else (a, b, c))
        faces.Next()
    _, first, index = np.unique(np.round(points, 7), axis=0, return_index=True, return_inverse=True)
    triangles = index.reshape(-1)[np.array(corners)]
    return np.array(points)[first], triangles[[len({*t}) == 3 for t in triangles.tolist()]]


def closed(points: np.ndarray, triangles: np.ndarray, at: gp_Trsf) -> manifold3d.Manifold:
    matrix = np.array([[at.Value(r, c) for c in (1, 2, 3, 4)] for r in (1, 2, 3)])
    placed = np.round(points @ matrix[:, :3].T + matrix[:, 3], 7)
    made = manifold3d.Manifold(manifold3d.Mesh64(placed, triangles.astype(np.uint64)))
    assert made.status() == manifold3d.Error.NoError
    return made


@dataclass
class Tried:
    """Of a scene: steps, moves, places looked at, freedoms tried; and what met, or was free. `every`: those
    freedoms too that no step sets, for the table that shows them."""

    steps: int = 0
    moves: int = 0
    places: int = 0
    freedoms: int = 0
    every: bool = False
    met: list[str] = field(default_factory=list)
    named: dict[tuple[str, ...], list[str]] = field(default_factory=dict)  # by `named`'s last columns

    def __str__(self) -> str:
        return f"{self.steps}/{self.moves}/{self.places}/{self.freedoms}"


def tried(path: Path, told: dict, every: bool = False) -> Tried:
    found = Tried(len(told["steps"]), every=every)
    bodies = solids(path)
    aids = {a["designator"]: np.array(a["box"]) for a in told["aids"]}
    bodies |= {n: manifold3d.Manifold.cube(list(b[1] - b[0])).translate(list(b[0])) for n, b in aids.items()}
    boxes = {n: np.reshape(b.bounding_box(), (2, 3)) for n, b in bodies.items()}
    at: dict[str, np.ndarray] = {}
    bench: dict[str, bool] = {}
    off = set(aids)
    ends: dict[frozenset, float] = {}

    def shared(a: str, b: str, x: np.ndarray, y: np.ndarray) -> float:
        if np.any(boxes[a][0] + x >= boxes[b][1] + y) or np.any(boxes[b][0] + y >= boxes[a][1] + x):
            return 0.0
        return (bodies[a].translate(list(x - y)) ^ bodies[b]).volume()

    def allowed(a: str, b: str) -> float:
        pair = frozenset((a, b))
        if pair not in ends:
            ends[pair] = 1.34 * shared(a, b, np.zeros(3), np.zeros(3)) + MOST
        return ends[pair]

    for one in told["steps"]:
        together: dict[int, list[dict]] = {}
        for move in one["moves"]:
            together.setdefault(move["together"], []).append(move)
        for group in together.values():
            found.moves += 1
            names = [m["designator"] for m in group]
            path_ = np.array([group[0]["from"], *group[0]["path"]], float)
            assert all(m["from"] == group[0]["from"] and m["path"] == group[0]["path"] for m in group)
            for name in names:
                assert name not in at or np.allclose(at[name], path_[0])
            away = {n for n in aids if n in at and np.any(at[n])}
            others = [n for n in at if n not in names and n not in away and (one["bench"] or not bench[n])]
            for start, end in zip(path_, path_[1:]):
                low, high = np.minimum(start, end), np.maximum(start, end)
                near = [
                    (a, b)
                    for a in names
                    for b in others
                    if np.all(boxes[a][0] + low < boxes[b][1] + at[b])
                    and np.all(boxes[b][0] + at[b] < boxes[a][1] + high)
                ]
                for x in np.linspace(start, end, 1 + int(np.ceil(np.linalg.norm(end - start) / STEP))):
                    for a, b in near:
                        found.places += 1
                        if (cut := shared(a, b, x, at[b])) > allowed(a, b):
                            found.met.append(f"{one['title']}: {a} cuts {cut:.2f} mm3 into {b} at {x}")
            at |= dict.fromkeys(names, path_[-1])
            bench |= dict.fromkeys(names, one["bench"])
            (off.update if one["apart"] else off.difference_update)({*names} - {*aids})
        for said in one["sets"]:
            held(said, bodies, found)
    assert set(at) == set(bodies) and all(np.allclose(x, 0.0) for n, x in at.items() if n not in off)
    return found


FREEDOMS = ("x", "y", "z", "rx", "ry", "rz")
SHIFT = 0.12  # mm at a body's ends: more than any pin's play in a hole


def held(said: str, bodies: dict[str, manifold3d.Manifold], found: Tried) -> None:
    """A body that some parts hold, such as 'EP1 EP2 by FX1: along z, turn about x': shifted, or turned about
    its own middle or that of a part inside it, one way or the other, it cuts into them."""
    line = re.fullmatch(r"([A-Z0-9 ]+?)(, each)? (?:by|on|against) ([A-Z0-9 ]+): (.*)", said)
    if not line or line[4].startswith("all"):
        return
    names, by = line[1].split(), line[3].split()
    holding = manifold3d.Manifold.batch_boolean([bodies[n] for n in by], manifold3d.OpType.Add)
    along, _, about = line[4].partition("turn about")
    stated = {*re.findall(r"\b[xyz]\b", along), *("r" + axis for axis in re.findall(r"\b[xyz]\b", about))}
    for own in [[n] for n in names] if line[2] else [names]:
        body = manifold3d.Manifold.batch_boolean([bodies[n] for n in own], manifold3d.OpType.Add)
        box = np.reshape(body.bounding_box(), (2, 3))
        now, far = (body ^ holding).volume(), np.degrees(2 * SHIFT / np.linalg.norm(box[1] - box[0]))
        pivots = [np.reshape(b.bounding_box(), (2, 3)).mean(axis=0) for b in (body, *(bodies[n] for n in by))]
        free = []
        for freedom in FREEDOMS if found.every else sorted(stated):
            k = "xyz".index(freedom[-1])
            inside = [np.all(np.delete((box[0] < p) & (p < box[1]), k)) for p in pivots]
            cuts = []
            for pivot in [p for p, near in zip(pivots, inside) if near] if freedom[0] == "r" else pivots[:1]:
                moved = []
                for way in (-np.eye(3)[k], np.eye(3)[k]):
                    if freedom[0] == "r":
                        turned = body.translate(list(-pivot)).rotate(list(far * way))
                        moved.append(turned.translate(list(pivot)))
                    else:
                        moved.append(body.translate(list(SHIFT * way)))
                cuts.append(max((m ^ holding).volume() - now for m in moved))
            if min(cuts) < 1e-3:
                free.append(freedom)
        found.freedoms += len(stated)
        found.met += [f"{' '.join(own)} is free: {freedom}" for freedom in free if freedom in stated]
        row = (listed(by), ",".join(f for f in FREEDOMS if f in stated), ",".join(free))
        found.named.setdefault(row, []).append(listed(own))


def listed(names: list[str]) -> str:
    return "+".join(names) if len(names) < 4 else f"{names[0]}…{names[-1]}"


def named(found: dict[str, Tried]) -> str:
    """By scene: bodies, what holds them, the freedoms that it is to set, and those that it leaves."""
    lines = ["|scene|body|against|set|free|", "|---" * 5 + "|"]
    for name, of in found.items():
        for row, bodies in of.named.items():
            lines.append(f"|{name}|{listed(bodies)}{',each' * (len(bodies) > 1)}|{'|'.join(row)}|")
    return "\n".join(lines)


def table(found: dict[str, dict[str, Tried]]) -> str:
    """By scene and design, as the page shows it."""
    scenes = list(dict.fromkeys(name for of in found.values() for name in of))
    lines = [f"|scene|{'|'.join(found)}|", "|---" * (len(found) + 1) + "|"]
    lines += [f"|{name}|{'|'.join(str(of.get(name, '')) for of in found.values())}|" for name in scenes]
    return "\n".join(lines)


def printed(name: str) -> str:
    """The page's table of that name."""
    return re.search(rf"<!-- table {name} -->\n(.*?)\n<!-- end -->", STACK.read_text("utf-8"), re.S)[1]


def shown() -> dict[str, dict[str, str]]:
    """The page's table of what was tried, by design and scene."""
    head, _, *rows = (line[1:-1].split("|") for line in printed("assembly").splitlines())
    return {d: {row[0]: row[n] for row in rows if row[n]} for n, d in enumerate(head) if n}


def whole(design: str, folder: Path) -> dict[str, Tried]:
    made = load(design)
    return {name: tried(*exported(made, name, folder), design == NAMED) for name in scene_names(made)}


def test_a_part_in_the_way_is_seen(tmp_path):
    """The stack let down 10 mm aside comes down on a pin of the fixture; 0.2 over it nothing holds it."""
    path, told = exported(load("macro-array"), "setting", tmp_path)
    for move in told["steps"][1]["moves"]:
        move["path"] = [[-1.5, 0.0, 0.0], *move["path"]]
    assert any("into FP1" in said for said in tried(path, told).met)
    found, bodies = Tried(), solids(path)
    bodies["FX1"] = bodies["FX1"].translate([0.0, 0.0, -0.2])
    for said in told["steps"][1]["sets"]:
        held(said, bodies, found)
    assert any("EP1 EP2 is free: z" in m for m in found.met)
    assert any("E3 is free: ry" in m for m in found.met)


@pytest.mark.slow  # whole assemblies simulated
# slow: whole assemblies simulated
@pytest.mark.parametrize("design", [FIRST, *(pytest.param(d, marks=pytest.mark.slow) for d in DESIGNS[1:])])
def test_every_scene_goes_together_from_its_files(design, tmp_path):
    found = whole(design, tmp_path)
    assert {name: f.met for name, f in found.items() if f.met} == {}
    assert {name: str(f) for name, f in found.items()} == shown()[design]
    if design == NAMED:
        assert named(found) == printed("freedoms")


if __name__ == "__main__":
    import sys
    import tempfile

    made = {}
    for design in sys.argv[1:] or DESIGNS:
        start = time.process_time()
        made[design] = whole(design, Path(tempfile.mkdtemp()))
        told = [m for f in made[design].values() for m in f.met[:5]]
        print(design, f"{time.process_time() - start:.0f} s", *told, sep="\n", file=sys.stderr, flush=True)
    print(table(made), named(made[NAMED]) if NAMED in made else "", sep="\n\n")
