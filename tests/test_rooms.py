"""A lower room never imports a higher one, and the CAD kernel is loaded only where solids are needed."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections import Counter
from functools import cache
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src"
ROOMS = (
    "design",
    "contour",
    "mechanics",
    "report",
    "fem",
    "contact",
    "parts",
    "scenes",
    "stacks",
    "circuit",
    "solids",
    "checks",
    "drawing",
    "export",
    "release",
    "lab",
    "robot",
    "paper",
    "costs",
    "synthesis",
    "review",
    "sweep",
    "families",
    "cli",
)
# Inner rooms, the lowest first: a folder or a module of the room each.
INNER_ROOMS = {
    "parts": ("language", "bought", "array", "rigs", "rules"),
    "drawing": ("engine", "guide", "circuit_sheets", "parts", "assemblies"),
}
KERNEL = {"build123d", "OCP", "cadquery", "bd_warehouse", "trimesh", "manifold3d", "vtkmodules", "vtk"}
# Modules above `solids` that work on solids themselves. Adding one here is a decision: whatever imports it
# at its top waits seconds for the kernel.
NEED_SOLIDS = {
    *(f"tactcad.checks.on_solids.{p.stem}" for p in (SOURCE / "tactcad/checks/on_solids").glob("[a-z]*.py")),
    "tactcad.checks.run",
    "tactcad.drawing.engine.picture",
    "tactcad.drawing.parts.solid_views",
    "tactcad.export.part_formats.usual",  # loads trimesh when it runs
    "tactcad.export.step_file",
    "tactcad.export.step_pmi",
    "tactcad.robot.robot_files",  # loads trimesh when it runs
}

# Scripts that other programs run, or that show what they do without tactcad: no module, never imported.
PEERS = "peers"

MODULES = sorted(p for p in (SOURCE / "tactcad").rglob("*.py") if p.parent.name != PEERS)


def dotted(path: Path) -> str:
    parts = path.relative_to(SOURCE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def room(module: str) -> str:
    """The room of a dotted name in tactcad, "" for the package itself and foreign modules."""
    parts = module.split(".")
    return parts[1] if parts[0] == "tactcad" and len(parts) > 1 and parts[1] in ROOMS else ""


def imports(tree: ast.AST, module: str, is_package: bool) -> set[str]:
    """Dotted names of everything imported anywhere in the module, inside functions too."""
    package = module.split(".") if is_package else module.split(".")[:-1]
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            name = ".".join(base + ([node.module] if node.module else []))
            found |= {name} | {f"{name}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            found |= {str(arg.value) for arg in node.args if isinstance(arg, ast.Constant)}
    return found


class _WithoutAnnotationImports(ast.NodeTransformer):
    """Drops what stands under `if TYPE_CHECKING`, which never runs."""

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt]:
        self.generic_visit(node)
        return node.orelse if ast.unparse(node.test) == "TYPE_CHECKING" else node


@cache
def imports_of(path: Path, annotations: bool = True) -> set[str]:
    tree = ast.parse(path.read_text())
    tree = tree if annotations else _WithoutAnnotationImports().visit(tree)
    return imports(tree, dotted(path), path.name == "__init__.py")


def test_every_folder_is_a_room():
    folders = {p.name for p in (SOURCE / "tactcad").iterdir() if p.is_dir() and p.name != "__pycache__"}
    assert folders == set(ROOMS)


def test_no_room_imports_a_higher_one():
    wrong = []
    for path in MODULES:
        here = room(dotted(path))
        # the package itself and __main__, which starts the command, know no other room than cli; what Python
        # users call, and its names, stand above all
        if dotted(path) in ("tactcad", "tactcad.face"):
            continue
        above = ROOMS[ROOMS.index(here) + 1 :] if here else ROOMS[:-1]
        wrong += [(dotted(path), name) for name in imports_of(path) if room(name) in above]
    assert wrong == []


def inner_room(module: str) -> str:
    """The inner room of a dotted name, "" for a room's own file and for rooms that have none."""
    parts = module.split(".")
    return parts[2] if len(parts) > 2 and parts[2] in INNER_ROOMS.get(room(module), ()) else ""


def test_a_room_with_inner_rooms_has_no_file_beside_them():
    for name, inner in INNER_ROOMS.items():
        assert {p.stem for p in (SOURCE / "tactcad" / name).glob("[!_]*")} == set(inner)


def test_no_inner_room_imports_a_higher_one():
    wrong = []
    for path in MODULES:
        here, inner = room(dotted(path)), inner_room(dotted(path))
        order = INNER_ROOMS[here] if inner else ()
        above = order[order.index(inner) + 1 :] if inner else ()
        wrong += [
            (dotted(path), name)
            for name in imports_of(path)
            if room(name) == here and inner_room(name) in above
        ]
    assert wrong == []


def test_kernel_is_imported_only_where_solids_are_made_or_needed():
    light = [p for p in MODULES if room(dotted(p)) != "solids" and dotted(p) not in NEED_SOLIDS]
    wrong = [
        (dotted(p), name)
        for p in light
        for name in imports_of(p, annotations=False)
        if name.split(".")[0] in KERNEL
    ]
    assert wrong == []


def test_the_listed_modules_exist_and_stand_above_solids():
    assert NEED_SOLIDS <= {dotted(p) for p in MODULES}
    assert {room(name) for name in NEED_SOLIDS} <= {"checks", "drawing", "export", "robot"}


# File names of different rooms that may stand twice, each with its reason; no class name may.
MAY_STAND_TWICE = {
    "calibration"  # a scene's file bears the scene's name, which is the experiment that `lab` evaluates
}


def test_no_file_name_stands_twice():
    """Beside a package's own file; a command's module bears the command's name."""
    names = Counter(p.stem for p in MODULES if p.stem != "__init__" and room(dotted(p)) != "cli")
    assert {name for name, count in names.items() if count > 1} <= MAY_STAND_TWICE


def test_no_class_name_stands_twice():
    classes = [
        n.name for p in MODULES for n in ast.walk(ast.parse(p.read_text())) if isinstance(n, ast.ClassDef)
    ]
    assert [name for name, count in Counter(classes).items() if count > 1] == []


def test_no_module_imports_a_peers_script():
    assert list(SOURCE.rglob(f"{PEERS}/*.py"))
    at = re.compile(rf"tactcad\.\w+\.{PEERS}\b")
    assert not [dotted(p) for p in MODULES if any(map(at.match, imports_of(p)))]


def test_importing_everything_else_loads_no_kernel():
    light = [dotted(p) for p in MODULES if room(dotted(p)) != "solids" and p.name != "__main__.py"]
    light = [name for name in light if name not in NEED_SOLIDS]
    script = (
        f"import importlib, sys\nfor name in {light!r}: importlib.import_module(name)\n"
        f"print(*sorted({{m.split('.')[0] for m in sys.modules}} & {KERNEL!r}))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == []


def test_the_import_reader_sees_all_forms():
    text = "import a.b\nfrom . import c\nfrom ..d import e\ndef f():\n    from tactcad.cli import g"
    found = imports(ast.parse(text), "tactcad.parts.x", is_package=False)
    assert {"a.b", "tactcad.parts.c", "tactcad.d", "tactcad.d.e", "tactcad.cli.g"} <= found
