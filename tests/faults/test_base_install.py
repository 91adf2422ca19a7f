"""Every command with every option on a base install: it works, or one line says which packages are missing
and how to get them."""

from __future__ import annotations

import shutil
import subprocess
from importlib.metadata import packages_distributions

import pytest
from command_line import ROOT, environment, one_by_one, refused, tactcad_runs
from small_target import SMALL
from test_other_files import BATCH
from test_wheel import BASE, closure

from tactcad.cli.main import COMMANDS, parser_of
from tactcad.export.inspection import inspection_bytes
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load

# Python runs it as it starts, in every process: what other distributions bring is not there.
HIDE = """
import sys
from importlib.machinery import PathFinder
class Base(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name.partition(".")[0] in {hidden} else super().find_spec(name, path, target)
sys.meta_path[sys.meta_path.index(PathFinder)] = Base
"""
EXTRAS = {
    "cad": ("export", "check", "release", "review", "golden", "diff A.toml B.toml --freecad out.FCStd"),
    "cad,review": ("view", "diff A.toml B.toml --review out.html"),
    "sweep": ("sweep study.toml", "sweep plot out"),
}
NONE = COMMANDS.keys() - {line.split()[0] for lines in EXTRAS.values() for line in lines} | {"diff"}
WORK = """
new new.toml --from A.toml
build A.toml --count 20 --seed 1 --json
build A.toml --within 10% --in 60
diff A.toml B.toml --json --html out.html --markdown out.md --out other.html --full --fail-on checks
diff HEAD . A.toml --their-code
estimate A.toml --model plane --force 0.1 --json
estimate A.toml --accuracy 1% --in 60
estimate A.toml --within 1%
estimate A.toml --inspection sheet.csv
estimate --batch batch.csv --out stiffness.csv
size --stiffness 10 --load-arm 6 --solve length --design A.toml --hinge-thickness 0.3 --json
size --stiffness 10 --load-arm 6 --with poisson=0.3 --in 60 --json
size --stiffness 10 --load-arm 6 --within 1%
size --stiffness 10 --load-arm 6 --hinge-length 1 --fillet-radius 0.2 --arm-height 3 --sides two
size --stiffness 10 --load-arm 6 --width 3 --youngs-modulus 7e4 --poisson 0.3 --alloy 7075-T6 --force 0.1
size --stiffness 10 --load-arm 6 --tolerance 0.01 --model beam --body-height 5 --body-length 4
size --stiffness 10 --load-arm 6 --within 1% --in 1
readings grasp-log.csv --map grasp-map.toml --out readings.csv --json
calibrate calibration.csv --load-cell 57+-1 --run-scatter 0.01 --drop-outliers --out cal.csv
calibrate log.csv --map log.toml
calibrate calibration.csv --design macro-array --level 0.9 --within 1% --in 1 --json
stiffness grasp.csv --calibration cal.csv --reference 8 --level 0.9 --thickness 6 --json
stiffness grasp.csv --calibration cal.csv --design macro-array --coupling 1 --within 1% --in 1
stiffness grasp.csv --calibration cal.csv --thickness 5+-1 --nu 0.49
stiffness grasp-log.csv --map grasp-map.toml --calibration cal.csv --thickness 6
schema --target --json
grasp macro-array --object E=0.5,nu=0.49,thickness=6 --load 1 --angle 0.5,1 --rung layer --out p.svg
grasp --object E=0.5,nu=0.49,thickness=6 --within 2% --json
schema --study
schema element
completion bash
"""
LOG_MAP = """
log = { kind = "calibration", time = "t" }
channels = { V = 1 }
steps = { by = "marks", column = "step" }
element = { values = [1] }
run = { values = [1] }
displacement = { column = "x", unit = "um" }
force = { column = "F", unit = "mN" }
"""
LONG = """
design target.toml --out designed --best --within 10% --in 5 --json
validate --out report --keep --json --design macro-array --table1 table1.csv
validate --out report --discard --table2 table2.csv
"""
NEVER = {"--help", "--quiet", "--verbose"}


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """A folder with what the lines read, and the variables of a base install."""
    work = tmp_path_factory.mktemp("base")
    installed = closure(BASE) | {"tactcad"}
    brought = packages_distributions().items()
    hidden = {name for name, of in brought if not installed & {d.lower() for d in of}}
    hidden |= {"manifold3d"}  # which its distribution does not tell
    assert {"OCP", "trimesh", "ocp_viewer", "dask", "pyarrow"} <= hidden
    (work / "sitecustomize.py").write_text(HIDE.format(hidden=hidden))
    for name, arm in (("A", 4.0), ("B", 5.0)):
        (work / f"{name}.toml").write_text(one_by_one(arm, name))
    (work / "sheet.csv").write_bytes(inspection_bytes(Layout(load(work / "A.toml"))))
    (work / "batch.csv").write_text(BATCH)
    (work / "target.toml").write_text(SMALL)
    for folder in ("hardware/examples", "src/tactcad/paper/data"):
        shutil.copytree(ROOT / folder, work, dirs_exist_ok=True)
    log = [
        "t,F,x,V,step",
        *(f"{i},{i // 2},{i // 2},{i // 2 * 0.1 + i % 2 * 1e-3},{i // 2 + 1}" for i in range(12)),
    ]
    (work / "log.csv").write_text("\n".join(log) + "\n")
    (work / "log.toml").write_text(LOG_MAP)
    for words in ("init -q", "add A.toml", "-c user.name=a -c user.email=a@b commit -qm A"):
        subprocess.run(["git", *words.split()], cwd=work, check=True)
    env = environment(work)
    return work, env | {"PYTHONPATH": f"{work}:{env['PYTHONPATH']}"}


def options(command):
    return [a for a in parser_of(command)._actions if a.option_strings and a.option_strings[-1] not in NEVER]


@pytest.mark.parametrize("extras", EXTRAS)
def test_what_needs_extras_is_refused_with_every_option(base, extras):
    work, env = base
    commands = [line.split() for line in EXTRAS[extras]]
    for command in commands[:]:
        for action in options(command[0]) if command[0] not in NONE else ():
            value = [str((*(action.choices or ()), "1")[0])] * (action.nargs != 0)
            commands.append([*command, action.option_strings[-1], *value])
    before = sorted(work.rglob("*"))
    for command, done in zip(commands, tactcad_runs(commands, work, env)):
        assert refused(done).endswith(f"legal: pip install '.[{extras}]' in a checkout of tactcad"), command
    assert sorted(work.rglob("*")) == before


def test_every_option_of_what_needs_none_is_tried():
    for command in NONE:
        lines = [line.split() for line in (WORK + LONG).splitlines() if line.startswith(f"{command} ")]
        tried = {"--freecad", "--review", "--picture"}.union(*lines)
        assert {action.option_strings[-1] for action in options(command)} <= tried, command


# slow: the long commands in an installation of their own
@pytest.mark.parametrize("lines", [WORK, pytest.param(LONG, marks=pytest.mark.slow)], ids=["quick", "long"])
def test_what_needs_none_works_and_writes_nothing_at_home(base, lines):
    work, env = base
    commands = lines.strip().splitlines()
    for command, done in zip(commands, tactcad_runs([line.split() for line in commands], work, env)):
        assert done.returncode == 0 and b"Traceback" not in done.stderr, (command, done.stderr)
    assert not list((work / "home").iterdir())
