"""Every check broken once, in a copy of the source: does a test fail?

    python tests/mutation/mutants.py                   all of them, as a table; exit status 1 where one
                                                       survives
    python tests/mutation/mutants.py brep rules        those whose name holds one of these words
    python tests/mutation/mutants.py --list            what there is, and which tests it is tried on

What there is to break is read off the syntax tree, by name and never by line, so that a new check is in the
table by being written. Kinds of mutation:

finding   a module of checks says everything but findings of one name
rule      a rule between fields of a design finds nothing
gate      one statement of a gate that reads a written file back, or holds a file against its model, says
          nothing
call      a check or gate is not called where it should be, or a declared check does nothing
"""

from __future__ import annotations

import argparse
import ast
import copy
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCE, TESTS = ROOT / "src", ROOT / "tests"
SECONDS = 900  # for the tests of one mutant
MOST_FILES = (
    3  # of tests that a mutant is tried on: a check that only a fourth one misses has no test of its own
)

# Names of findings that no literal in the source spells out, by module and expression.
SPELT_OUT = {
    ("checks/on_solids/soundness.py", "f'tiny-{name}'"): ("tiny-edge", "tiny-face"),
    ("checks/on_solids/soundness.py", "f'step-{name}'"): ("step-volume", "step-area"),
}
# Functions that make findings under a name that they are given.
PASS_ON = {"Finding", "fail", "flag", "at_least", "at_most", "_finding", "_pressed", "_thin"}
GATE = re.compile(
    r"^_?check_|(?<!without_)faults?$|^_compare_box$|^_measured$|^_short_or_double$|^_differences$|^accept$|^read_document$|^assembly_in$|^scene_step$"
)
# Functions of export/ that raise CheckFailure and are no gates.
NO_GATES = {
    "_own_folder",  # another export takes too long
    "replacing",  # somebody wrote to the zips meanwhile
    "publish",  # somebody wrote to the earlier folder meanwhile
    "compared",  # a golden file that cannot be read
    "written",  # the kernel says itself that it failed
    "side_by_side",  # a process was killed
    "_faces",  # a feature that other features have cut away
    "part_plan",  # a part that has no sheet
}
# Modules of drawing/ that hold a written sheet against its model; the others refuse what cannot be
# laid out, before.
SHEET_GATES = ("part_sheet.py", "assembly_sheets.py")


@dataclass(frozen=True)
class Mutant:
    """One mutation: what it breaks, in which module, and how the module's tree changes."""

    kind: str
    module: str  # path below src/tactcad
    name: str
    change: Callable[[ast.Module], ast.Module]

    @property
    def label(self) -> str:
        return f"{self.kind} {self.module.removesuffix('.py')}: {self.name}"

    def source(self) -> str:
        """The module's text, mutated. Raises AssertionError where nothing changed."""
        before, tree = _module(self.module)
        after = ast.unparse(ast.fix_missing_locations(self.change(copy.deepcopy(tree))))
        assert after != before, f"{self.label}: nothing changed"
        compile(after, self.module, "exec")
        return after


@cache
def _module(name: str) -> tuple[str, ast.Module]:
    """A module's text in the form that the tree gives it, and the tree."""
    tree = ast.parse((SOURCE / "tactcad" / name).read_text(encoding="utf-8"))
    return ast.unparse(tree), tree


# --- findings by name ---

WITHOUT = """
def _without(function):
    import functools, inspect
    if inspect.isgeneratorfunction(function):
        @functools.wraps(function)
        def wrapped(*args, **kwargs):
            return (f for f in function(*args, **kwargs) if f.check != {name!r})
    else:
        @functools.wraps(function)
        def wrapped(*args, **kwargs):
            return [f for f in function(*args, **kwargs) if f.check != {name!r}]
    return wrapped
for _name, _function in list(globals().items()):
    returned = str(getattr(_function, "__annotations__", {{}}).get("return", ""))
    if callable(_function) and getattr(_function, "__module__", "") == __name__ and "[Finding]" in returned:
        globals()[_name] = _without(_function)
"""


def checking() -> list[Path]:
    """Modules of checks: of all designs, and of the families."""
    tactcad = SOURCE / "tactcad"
    return sorted([*(tactcad / "checks").rglob("*.py"), *tactcad.glob("families/*/checks.py")])


def findings() -> Iterator[Mutant]:
    for path in [
        *checking(),
        *sorted((SOURCE / "tactcad" / "scenes" / "rigs").glob("*.py")),  # rigs' own checks
        SOURCE / "tactcad" / "export" / "golden_file.py",
    ]:
        module = path.relative_to(SOURCE / "tactcad").as_posix()
        for name in sorted(names_of_findings(module, ast.parse(path.read_text(encoding="utf-8")))):
            yield Mutant(
                "finding", module, name, lambda tree, name=name: _appended(tree, WITHOUT.format(name=name))
            )


def _appended(tree: ast.Module, text: str) -> ast.Module:
    tree.body += ast.parse(text).body
    return tree


def names_of_findings(module: str, tree: ast.Module) -> set[str]:
    """Every name under which the module reports. Raises AssertionError where one cannot be told from the
    source."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in PASS_ON and node.args:
            names |= _spelt(module, node.args[0])
        elif isinstance(node, ast.For) and isinstance(node.iter, ast.Tuple):
            for row in node.iter.elts:  # rows of a table whose first column is the name
                if (
                    isinstance(row, ast.Tuple)
                    and isinstance(node.target, ast.Tuple)
                    and node.target.elts[0].id == "check"
                ):
                    names |= _spelt(module, row.elts[0])
    return names


def _spelt(module: str, node: ast.expr) -> set[str]:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return {node.value} - {"fail", "flag"}
    if isinstance(node, ast.Name | ast.Attribute):
        return set()  # handed on: it is spelt out where it is made
    expression = ast.unparse(node)
    assert (module, expression) in SPELT_OUT, (
        f"{module}: which findings does {expression} name? add it to SPELT_OUT"
    )
    return set(SPELT_OUT[module, expression])


# --- rules between fields ---


def rules() -> Iterator[Mutant]:
    """Functions with @rule or @fits above them."""
    for path in sorted((SOURCE / "tactcad").glob("*/**/*.py")):
        module, text = path.relative_to(SOURCE / "tactcad").as_posix(), path.read_text(encoding="utf-8")
        marked = re.search(r"^@(rule\(|fits$)", text, re.M)
        for function in _functions(ast.parse(text)) if marked else ():
            if any(re.match(r"rule\(|fits$", ast.unparse(d)) for d in function.decorator_list):
                name = function.name
                yield Mutant("rule", module, name, lambda tree, name=name: _silent(tree, name))


def _silent(tree: ast.Module, name: str) -> ast.Module:
    (function,) = [n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == name]
    function.body = ast.parse("return\nyield").body
    return tree


# --- gates, statement by statement ---


def gated() -> list[Path]:
    """Modules that hold what was written against what it was made from."""
    rooms = [
        path
        for room in ("drawing", "export", "release")
        for path in (SOURCE / "tactcad" / room).rglob("*.py")
    ]
    return sorted([*rooms, SOURCE / "tactcad" / "scenes" / "bom.py"])


def gates() -> Iterator[Mutant]:
    for path in gated():
        module = path.relative_to(SOURCE / "tactcad").as_posix()
        for function in _functions(ast.parse(path.read_text(encoding="utf-8"))):
            if not GATE.search(function.name):
                continue
            for n, statement in enumerate(_statements(function)):
                if _silenced(statement, function) is not None:
                    text = f"{function.name}: {_short(statement)}"
                    yield Mutant(
                        "gate",
                        module,
                        text,
                        lambda tree, f=function.name, n=n: _without_statement(tree, f, n),
                    )


def unknown_gates() -> list[str]:
    """Functions of export/ that refuse what they find, and that no mutation here would silence."""
    called = {name: re.compile(wanted) for name, wanted in CALLERS.items()}
    found = []
    for path in gated():
        module = path.relative_to(SOURCE / "tactcad").as_posix()
        for function in _functions(ast.parse(path.read_text(encoding="utf-8"))):
            raises = any(
                isinstance(n, ast.Raise) and n.exc and "CheckFailure" in ast.unparse(n.exc)
                for n in ast.walk(function)
            )
            known = GATE.search(function.name) or function.name in NO_GATES
            calls_one = module in called and any(
                _uncalled(s, called[module].pattern) for s in _statements(function)
            )
            lays_out = module.startswith("drawing/") and path.name not in SHEET_GATES
            if raises and not (known or calls_one or lays_out):
                found.append(f"{module}: {function.name}")
    return found


def _functions(tree: ast.Module) -> list[ast.FunctionDef]:
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def _statements(function: ast.FunctionDef) -> list[ast.stmt]:
    """Simple statements of the function, in the order of its text."""
    simple = (ast.Raise, ast.Expr, ast.AugAssign, ast.Assign, ast.Return)
    return sorted(
        (n for n in ast.walk(function) if isinstance(n, simple)), key=lambda n: (n.lineno, n.col_offset)
    )


def _silenced(statement: ast.stmt, function: ast.FunctionDef) -> list[ast.stmt] | None:
    """What the statement becomes when it says nothing; None where it says nothing as it is."""
    silence = '""' if function.returns and ast.unparse(function.returns) == "str" else "[]"
    if isinstance(statement, ast.Raise) and statement.exc is not None:
        return ast.parse("pass").body
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Yield | ast.YieldFrom):
        return ast.parse("yield from ()").body
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
        return (
            ast.parse("pass").body
            if re.search(r"^(wrong|found|faults)\.append$|^_?check_", ast.unparse(statement.value.func))
            else None
        )
    if (
        isinstance(statement, ast.AugAssign)
        and isinstance(statement.op, ast.Add)
        and ast.unparse(statement.target) == "wrong"
    ):
        return ast.parse("pass").body
    if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) in (
        "wrong",
        "short",
        "double",
    ):
        return (
            None
            if ast.unparse(statement.value) == "[]"
            else ast.parse(f"{ast.unparse(statement.targets[0])} = []").body
        )
    if (
        isinstance(statement, ast.Return)
        and function.returns
        and ast.unparse(function.returns) in ("str", "list[str]")
    ):
        text = ast.unparse(statement.value)
        if text in ("wrong", "''", "[]") or text.startswith("wrong + "):
            kept = "wrong" if text.startswith("wrong + ") else None
            return ast.parse(f"return {kept}").body if kept else None
        return ast.parse(f"return {'wrong' if 'wrong' in text else silence}").body
    return None


def _short(statement: ast.stmt) -> str:
    text = " ".join(ast.unparse(statement).split())
    return text if len(text) <= 90 else text[:87] + "..."


class _Replaced(ast.NodeTransformer):
    def __init__(self, old: ast.stmt, new: list[ast.stmt]) -> None:
        self.old, self.new = old, new

    def visit(self, node: ast.AST):
        return self.new if node is self.old else self.generic_visit(node)


def _without_statement(tree: ast.Module, name: str, n: int) -> ast.Module:
    (function,) = [f for f in _functions(tree) if f.name == name]
    statement = _statements(function)[n]
    return _Replaced(statement, _silenced(statement, function)).visit(tree)


# --- calls ---

CALLERS = {
    "checks/run.py": r"^(report\.run|run_each)$",
    "checks/check.py": r"^(report\.run|run_each)$",
    "cli/check.py": r"^report\.run$",
    "export/pipeline.py": r"^(manifests\.)?check_|^bom\.check_",
    "export/products.py": r"^_compare_box$",
    "export/shapes.py": r"^picture\.check_",
    "export/dxf.py": r"^check_dxf$",
    "export/step_file.py": r"^_?check_part$",
    "export/step_pmi.py": r"^_?check_(part|limits)$",
    "drawing/parts/part_sheet.py": r"_faults$",
    "drawing/assemblies/assembly_sheets.py": r"_faults$",
    "release/make.py": r"^(check_contents|check_packages|read_back)$|_faults$",
}


def calls() -> Iterator[Mutant]:
    for module, wanted in CALLERS.items():
        tree = ast.parse((SOURCE / "tactcad" / module).read_text(encoding="utf-8"))
        found = 0
        for function in _functions(tree):
            if GATE.search(function.name) and not function.name == "_measured":
                continue  # its statements are mutants already
            for n, statement in enumerate(_statements(function)):
                if _uncalled(statement, wanted) is not None:
                    found += 1
                    text = f"{function.name}: {_short(statement)}"
                    yield Mutant(
                        "call",
                        module,
                        text,
                        lambda tree, f=function.name, n=n, w=wanted: _without_call(tree, f, n, w),
                    )
        assert found, f"{module} calls no check: where have its calls gone?"


def idle_checks() -> Iterator[Mutant]:
    """Checks that are declared and do nothing."""
    for path in checking():
        module = path.relative_to(SOURCE / "tactcad").as_posix()
        for call in _declared(ast.parse(path.read_text(encoding="utf-8"))):
            name = call.args[0].value
            yield Mutant("call", module, f"CHECKS: {name}", lambda tree, name=name: _idle(tree, name))


def _declared(tree: ast.Module) -> list[ast.Call]:
    """The calls of Check in a module's CHECKS."""
    tables = [n for n in tree.body if isinstance(n, ast.Assign) and ast.unparse(n.targets[0]) == "CHECKS"]
    return [
        n for t in tables for n in ast.walk(t) if isinstance(n, ast.Call) and ast.unparse(n.func) == "Check"
    ]


def _idle(tree: ast.Module, name: str) -> ast.Module:
    (call,) = [call for call in _declared(tree) if call.args[0].value == name]
    call.args[2] = ast.parse("lambda *_: ()", mode="eval").body
    return tree


def _uncalled(statement: ast.stmt, wanted: str) -> list[ast.stmt] | None:
    value = getattr(statement, "value", None)
    if not isinstance(value, ast.Call) or not re.search(wanted, ast.unparse(value.func)):
        return None
    if isinstance(statement, ast.Expr):
        return ast.parse("pass").body
    if isinstance(statement, ast.Assign):
        return ast.parse(f"{ast.unparse(statement.targets[0])} = []").body
    return None


def _without_call(tree: ast.Module, name: str, n: int, wanted: str) -> ast.Module:
    (function,) = [f for f in _functions(tree) if f.name == name]
    statement = _statements(function)[n]
    return _Replaced(statement, _uncalled(statement, wanted)).visit(tree)


@cache
def every() -> list[Mutant]:
    """All mutants, those of one label numbered."""
    found, seen = [], {}
    for make in (findings, rules, gates, calls, idle_checks):
        for m in make():
            seen[m.label] = seen.get(m.label, 0) + 1
            found.append(
                m if seen[m.label] == 1 else Mutant(m.kind, m.module, f"{m.name} ({seen[m.label]})", m.change)
            )
    return found


# --- which tests ---

# Tests of what a module does that do not import it, because they go through the command or the whole export.
ALSO = {
    "checks/run.py": ("tests/checks/test_check_report.py", "tests/checks/test_checks_table.py"),
    "checks/check.py": ("tests/checks/test_check_report.py",),
    "cli/check.py": ("tests/export/test_golden.py", "tests/checks/test_check_report.py"),
    "export/pipeline.py": ("tests/export/test_pipeline.py", "tests/faults/test_machine.py"),
    "export/products.py": ("tests/export/test_pipeline.py",),
    "export/shapes.py": ("tests/export/test_pipeline.py",),
    "export/dxf.py": ("tests/export/test_pipeline.py",),
    "export/manifest.py": ("tests/export/test_manifest.py", "tests/faults/test_other_files.py"),
}


@cache
def _test_files() -> dict[str, str]:
    """The text of every test file but those of mutations, by its path."""
    paths = sorted(path for path in TESTS.rglob("test_*.py") if path.parent != Path(__file__).parent)
    return {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in paths}


@cache
def _importing(module: str) -> list[str]:
    """The test files that import it."""
    dotted = "tactcad." + module.removesuffix(".py").replace("/", ".")
    package, _, last = dotted.rpartition(".")
    imports = re.compile(
        rf"^\s*(from {re.escape(dotted)} import|import {re.escape(dotted)}\b"
        rf"|from {re.escape(package)} import .*\b{last}\b)",
        re.M,
    )
    return [path for path, text in _test_files().items() if imports.search(text)]


def tests_of(mutant: Mutant) -> list[str]:
    """The test files that concern it most, those that name it most first: of those that import its module,
    or, for a rule, name it, and before all others those of ALSO.
    """
    also, word, texts = ALSO.get(mutant.module, ()), mutant.name.split(":")[0], _test_files()
    if mutant.kind == "rule":
        concerned = [path for path, text in texts.items() if word in text]
    else:
        concerned = _importing(mutant.module)
    chosen = {path: texts[path].count(word) for path in dict.fromkeys((*also, *concerned))}
    few = sorted(chosen, key=lambda name: (name not in also, -chosen[name]))[:MOST_FILES]
    return sorted(few, key=lambda name: -chosen[name])


# --- running ---


@dataclass(frozen=True)
class Outcome:
    mutant: Mutant
    failed: str  # the first test that failed, "" where the mutant survived


# Loads the heavy libraries once, and runs pytest in a fork for every folder that it is told: all of tactcad
# is imported anew. Takes a line of JSON, folder and test files; gives one, pytest's exit status and what it
# said.
RUNNER = """
import json, os, signal, sys
import ezdxf, hypothesis, manifold3d, numpy, pypdf, pytest, reportlab, scipy.optimize, trimesh
import build123d, OCP.STEPCAFControl, OCP.BOPAlgo, OCP.BRepExtrema
assert not any(name.split(".")[0] == "tactcad" for name in sys.modules)
for line in sys.stdin:
    folder, files, seconds = json.loads(line)
    process = os.fork()
    if not process:
        signal.alarm(seconds)
        os.chdir(folder)
        os.dup2(os.open("said", os.O_CREAT | os.O_WRONLY), 1)
        os.dup2(1, 2)
        os.environ |= {"PYTHONPATH": folder + "/src", "TMPDIR": folder + "/tmp"}
        sys.path.insert(0, folder + "/src")
        options = ["-x", "-q", "-m", "not nightly", "-p", "no:cacheprovider", "--no-header"]
        status = pytest.main([*options, *files])
        sys.stdout.flush()
        os._exit(status)
    status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    print(json.dumps([status, open(folder + "/said").read()]), flush=True)
"""


_GREEN: set[tuple[str, ...]] = set()  # test files that pass where nothing is broken


class Runner:
    """A process that runs tests on copies of the source, one after the other."""

    def __init__(self) -> None:
        env = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"} | {"PYTHONDONTWRITEBYTECODE": "1"}
        self.process = subprocess.Popen(
            [sys.executable, "-c", RUNNER], env=env, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def run(self, mutant: Mutant) -> Outcome:
        """The tests that concern it on a copy of the source with the mutant in it.

        Raises AssertionError where one of them fails without the mutant: it would show nothing.
        """
        files = tests_of(mutant)
        if tuple(files) not in _GREEN:
            failed = self.failed_test(files, None)
            assert not failed, f"{failed} fails in a copy of the source with nothing broken"
            _GREEN.add(tuple(files))
        return Outcome(mutant, self.failed_test(files, mutant))

    def failed_test(self, files: list[str], mutant: Mutant | None) -> str:
        """The first of the tests that fails, "" where none does."""
        with tempfile.TemporaryDirectory(prefix="mutant-") as name:
            Path(name).chmod(0o755)  # a test goes on as nobody
            folder = Path(name)
            for part in ("src", "tests", "hardware", "exports/golden", "benchmarks", "packaging", "docs"):
                shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
            shutil.copy(ROOT / "pyproject.toml", folder)
            (folder / "tmp").mkdir()
            if mutant:
                (folder / "src" / "tactcad" / mutant.module).write_text(mutant.source(), encoding="utf-8")
            self.process.stdin.write(json.dumps([name, files, SECONDS]) + "\n")
            self.process.stdin.flush()
            status, said = json.loads(self.process.stdout.readline())
        failed = re.search(r"^(?:FAILED|ERROR) (.*?)(?: - .*)?$", said, re.MULTILINE)
        if status == 1 and failed:
            return failed.group(1).removeprefix("tests/")
        assert status == 0, f"the tests did not run, status {status}:\n{said[-2000:]}"
        return ""


def run_all(mutants: list[Mutant], workers: int, say: Callable[[Outcome], None]) -> list[Outcome]:
    """Every mutant's outcome; `say` hears each as it comes."""
    mine = threading.local()

    def run(mutant: Mutant) -> Outcome:
        if not hasattr(mine, "runner"):
            mine.runner = Runner()
            runners.append(mine.runner)
        return mine.runner.run(mutant)

    outcomes, runners = [], []
    with ThreadPoolExecutor(workers) as pool:
        for outcome in pool.map(run, mutants):
            say(outcome)
            outcomes.append(outcome)
    for runner in runners:
        runner.process.stdin.close()
        runner.process.wait()
    return outcomes


def line(outcome: Outcome) -> str:
    return f"{outcome.mutant.label}  |  {outcome.failed or 'SURVIVED: no test failed'}"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("words", nargs="*", help="only mutants whose label holds one of these")
    parser.add_argument("--list", action="store_true", help="print them and their tests, run nothing")
    parser.add_argument("--workers", type=int, default=2)
    args = parser.parse_args()
    mutants = [m for m in every() if not args.words or any(w in m.label for w in args.words)]
    if args.list:
        for m in mutants:
            print(f"{m.label}  |  {' '.join(tests_of(m))}")
        return 0
    outcomes = run_all(mutants, args.workers, lambda o: print(line(o), flush=True))
    survived = [o for o in outcomes if not o.failed]
    print(f"{len(outcomes)} checks broken, one at a time: a test failed for {len(outcomes) - len(survived)}")
    return 1 if survived else 0


if __name__ == "__main__":
    raise SystemExit(main())
