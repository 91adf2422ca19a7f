"""The assembly of a scene made again from what leaves: its STEP file and guide/SCENE.json, by its own code.

Every part is moved along its path in steps of STEP mm, past what stands there by then; it may share with
another part no more than both share at their places, or a third more: a screw that passes its whole thread.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import manifold3d
import numpy as np
import pytest
from built import shapes_of
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.IFSelect import IFSelect_RetDone
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

from tactcad.export.step_file import scene_step
from tactcad.export.step_text import Header
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.moves import guide_json

pytestmark = pytest.mark.cad

STEP = 2.0  # mm
MOST = 0.1  # mm3: chords of curved faces
DESIGNS = (  # planar-array's steps are those of jaw-array, three times as many
    *("macro-array", "better-array", "double-sample", "smallest-bearing", "soft-tissue", "tissue-array"),
    "jaw-array",
)
STACK = Path(__file__).parents[2] / "docs" / "stack.md"


def exported(design, name: str, folder: Path) -> tuple[Path, dict]:
    scene = make_scene(design, name)
    path = folder / f"{name}.step"
    shapes = shapes_of(scene)
    path.write_bytes(scene_step(scene, shapes, Header(name, name, "A", "2026-01-01", "", "")))
    return path, json.loads(guide_json(scene))


def solids(path: Path) -> dict[str, manifold3d.Manifold]:
    """Every placed solid of a STEP file by the name of its instance."""
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    assert reader.ReadFile(str(path)) == IFSelect_RetDone and reader.Transfer(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    roots, found = TDF_LabelSequence(), {}
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
                shape = XCAFDoc_ShapeTool.GetShape_s(of)
                found[name.Get().ToExtString()] = closed(shape.Located(at))

    for i in range(1, roots.Length() + 1):
        walk(roots.Value(i), TopLoc_Location())
    return found


def closed(shape) -> manifold3d.Manifold:
    BRepMesh_IncrementalMesh(shape, 0.02, False, 0.1, False)
    points, corners, faces = [], [], TopExp_Explorer(shape, TopAbs_FACE)
    while faces.More():
        face, where = TopoDS.Face_s(faces.Current()), TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, where)
        turn, base = where.Transformation(), len(points)
        points += [mesh.Node(i).Transformed(turn).Coord() for i in range(1, mesh.NbNodes() + 1)]
        for i in range(1, mesh.NbTriangles() + 1):
            a, b, c = (base + k - 1 for k in mesh.Triangle(i).Get())
            corners.append((a, c, b) if face.Orientation() == TopAbs_REVERSED else (a, b, c))
        faces.Next()
    unique, index = np.unique(np.round(points, 7), axis=0, return_inverse=True)
    triangles = index.reshape(-1)[np.array(corners)]
    triangles = triangles[[len({*t}) == 3 for t in triangles.tolist()]]
    made = manifold3d.Manifold(manifold3d.Mesh64(unique, triangles.astype(np.uint64)))
    assert made.status() == manifold3d.Error.NoError
    return made


def tried(path: Path, told: dict) -> tuple[int, int, int, list[str]]:
    """Steps, moves, places looked at, freedoms that the steps name; and what met."""
    bodies = solids(path)
    boxes = {n: np.reshape(b.bounding_box(), (2, 3)) for n, b in bodies.items()}
    at: dict[str, np.ndarray] = {}
    bench: dict[str, bool] = {}
    places, moves, met = 0, 0, []
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
            moves += 1
            names = [m["designator"] for m in group]
            path_ = np.array([group[0]["from"], *group[0]["path"]], float)
            assert all(m["from"] == group[0]["from"] and m["path"] == group[0]["path"] for m in group)
            for name in names:
                assert name not in at or np.allclose(at[name], path_[0])
            others = [n for n in at if n not in names and (one["bench"] or not bench[n])]
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
                        places += 1
                        if (cut := shared(a, b, x, at[b])) > allowed(a, b):
                            met.append(f"{one['title']}: {a} cuts {cut:.2f} mm3 into {b} at {x}")
            at |= dict.fromkeys(names, path_[-1])
            bench |= dict.fromkeys(names, one["bench"])
    assert set(at) == set(bodies) and all(np.allclose(x, 0.0) for x in at.values())
    return len(told["steps"]), moves, places, met


def row(design: str, found: dict[str, tuple[int, int, int, list[str]]]) -> str:
    """The page's line of a design."""
    steps, moves, places = (sum(f[i] for f in found.values()) for i in range(3))
    return f"| {design}, {len(found)} scenes | {steps} | {moves} | {places} |"


def test_a_design_goes_together_from_its_files(tmp_path):
    assert tried(*exported(load("macro-array"), "setting", tmp_path))[-1] == []


def test_a_part_in_the_way_is_seen(tmp_path):
    """The stack let down 10 mm aside comes down on a pin of the fixture."""
    path, told = exported(load("macro-array"), "setting", tmp_path)
    for move in told["steps"][1]["moves"]:
        move["path"] = [[-1.5, 0.0, 0.0], *move["path"]]
    assert any("into FP1" in said for said in tried(path, told)[-1])


@pytest.mark.slow
@pytest.mark.parametrize("design", DESIGNS)
def test_every_scene_goes_together_from_its_files(design, tmp_path):
    known = re.findall(rf"^\| {design}, .*$", STACK.read_text("utf-8"), re.M)
    made = load(design)
    found = {name: tried(*exported(made, name, tmp_path)) for name in scene_names(made)}
    assert {name: f[-1] for name, f in found.items() if f[-1]} == {}
    assert known == [row(design, found)]


if __name__ == "__main__":
    import sys
    import tempfile

    for design in sys.argv[1:] or DESIGNS:
        made = load(design)
        found = {name: tried(*exported(made, name, Path(tempfile.mkdtemp()))) for name in scene_names(made)}
        print(row(design, found), *(m for f in found.values() for m in f[-1][:5]), sep="\n", flush=True)
