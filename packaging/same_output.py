"""Does this checkout write what another one writes? For a change of the code that is to change no output.

    .venv/bin/python packaging/same_output.py OTHER_TREE [WORD]...

Both trees, each with its .venv, work on the designs of hardware/ here and on three drawn by chance; with
WORDs only the runs whose name contains one. Archives are compared by their members, JSON by its values; a
difference that MUST_DIFFER explains is named, any other gives exit status 1. The other tree's output is kept
under its commit in .cache/same-output, and reused.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator, Sequence
from difflib import unified_diff
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[1]
KEPT = HERE / ".cache" / "same-output"
MUST_DIFFER = {
    r".*manifest\.json: /(inputs/sources/|inputs/libraries/|seal)": "digest of the source, and libraries "
    "named",
    r"(check|release|estimate) .*\.out: .*seconds": "time",
}
RUNS = """\
export {file} --guide --drawings --out exports/{name}
check {file} --json
golden {file}
release {file} --sample --json
estimate {file} --json
estimate {file} --model fem-plane --json
estimate {file} --accuracy 0.5% --json
size --stiffness 20 --load-arm 4 --design {file} --json
diff hardware/macro-array.toml {file} --json --html diff-{name}.html
new new-{name}.toml --from {file}
schema --json
validate --json --out validation
calibrate examples/calibration.csv --json --out calibration.csv
stiffness examples/grasp.csv --calibration calibration.csv --json"""


def prepare(folder: Path) -> None:
    sys.path.insert(0, str(HERE / "tests"))
    from random_designs import as_toml
    from sound_designs import as_table, sound_table

    shutil.copytree(HERE / "hardware", folder / "hardware")
    (folder / "hardware" / "examples").rename(folder / "examples")
    for seed, (rows, rigs) in enumerate((((3, 2), False), ((4,), False), ((2, 2), True))):
        table = as_table(sound_table(seed, rows, rigs))
        table["design"]["name"] = name = f"drawn-{seed}"
        (folder / "hardware" / f"{name}.toml").write_text(as_toml(table), "utf-8")


def produce(tree: Path, folder: Path, words: Sequence[str]) -> None:
    """Run the commands that `folder` has no result of yet; a refusal is a result too."""
    designs = [path.relative_to(folder) for path in sorted((folder / "hardware").glob("*.toml"))]
    runs = dict.fromkeys(run.format(file=d, name=d.stem) for d in designs for run in RUNS.splitlines())
    fixed = {"OMP_NUM_THREADS": "1", "SOURCE_DATE_EPOCH": "0", "TACTCAD_CACHE": str(folder / ".cache")}
    for run in runs:
        result = folder / f"{run.replace('/', ' ')}.out"
        if result.exists() or (words and not any(word in run for word in words)):
            continue
        print(f"{tree.name}: {run}", file=sys.stderr, flush=True)
        command = [tree / ".venv" / "bin" / "tactcad", *run.split()]
        environment = {**os.environ, **fixed}
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
        said = [line for line in done.stderr.splitlines() if not line.startswith("[")]  # no progress
        result.write_text(done.stdout if done.returncode == 0 else "\n".join([done.stdout, *said]))


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of a folder and of the archives in it, by path."""
    files = {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    files = {path: data for path, data in files.items() if not path.startswith(".cache")}
    for path in [path for path in files if path.endswith(".zip")]:
        with zipfile.ZipFile(folder / path) as archive:
            files |= {f"{path}/{name}": archive.read(name) for name in archive.namelist()}
    return files


def values(node: Any, path: str = "") -> dict[str, Any]:
    """The values of a JSON document by their paths."""
    if not isinstance(node, dict | list):
        return {path: node}
    pairs = node.items() if isinstance(node, dict) else enumerate(node)
    return {k: v for key, child in pairs for k, v in values(child, f"{path}/{key}").items()}


def differences(path: str, here: bytes, there: bytes) -> Iterator[str]:
    try:
        a, b = (values(json.loads(data)) for data in (here, there))
        changed = [k for k in a | b if a.get(k) != b.get(k)]
        yield from (f"{path}: {k}: {a.get(k)!r} here, {b.get(k)!r} there" for k in changed)
    except ValueError:
        a, b = (data.decode("latin-1").splitlines() for data in (here, there))
        lines = list(unified_diff(b, a, lineterm="", n=0))[2:8]
        yield "\n    ".join((f"{path}: there (-), here (+):", *lines))


def main(other: str, *words: str) -> int:
    tree, ours = Path(other).resolve(), KEPT / "here"
    theirs = KEPT / subprocess.check_output(["git", "-C", tree, "rev-parse", "HEAD"], text=True).strip()
    shutil.rmtree(ours, ignore_errors=True)
    if not theirs.exists():
        prepare(theirs)
    for inputs in ("hardware", "examples"):
        shutil.copytree(theirs / inputs, ours / inputs)
    produce(tree, theirs, words)
    produce(HERE, ours, words)
    a, b = contents(ours), contents(theirs)
    reasons, paths = [], [p for p in sorted(a if words else a | b) if a.get(p) != b.get(p)]
    for line in (line for p in paths for line in differences(p, a.get(p, b""), b.get(p, b""))):
        whys = [why for rule, why in MUST_DIFFER.items() if re.match(rule, line)]
        reasons += whys or ["unexplained"]
        print(f"{reasons[-1]}: {line}")
    print(f"{len(a)} files, {len(paths)} differ, {reasons.count('unexplained')} differences unexplained")
    return 1 if "unexplained" in reasons else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
