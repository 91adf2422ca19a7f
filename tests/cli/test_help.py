"""What the command says of itself, and how loudly it works."""

from __future__ import annotations

import io
import os
import shutil
import subprocess
import sys

import pytest

from tactcad.cli import streams
from tactcad.cli.completion import candidates
from tactcad.cli.main import COMMANDS, main, parser_of
from tactcad.cli.parser import UNLISTED

MOST_OPTIONS = 135  # 80 % of the 169 lines that the command had before


def listed(command: str) -> list[str]:
    return [
        a.option_strings[-1] for a in parser_of(command)._actions if a.option_strings and a.help != UNLISTED
    ]


@pytest.mark.parametrize("words", [[], ["help"], ["--help"], ["help", "help"], ["help", "--help"], ["-q"]])
def test_without_a_command_the_help_is_printed_by_task(words, capsys):
    assert main(words) == 0
    said = capsys.readouterr().out
    places = [said.index(f"\n{group}:\n") for group in ("make", "look", "know", "keep")]
    assert places == sorted(places)
    assert all(f"  {name} " in said for name in COMMANDS)
    for word in ("exit status: 0 done; 1 ", "NO_COLOR", "TACTCAD_CACHE", "--quiet", "--verbose"):
        assert word in said


def test_help_of_a_command_is_its_own(capsys):
    assert main(["help", "export"]) == 0
    said = capsys.readouterr().out
    with pytest.raises(SystemExit) as ended:
        main(["export", "-h"])
    assert ended.value.code == 0 and capsys.readouterr().out == said
    assert "-o DIR, --out DIR" in said and "tactcad help" in said


def test_options_are_few_and_one_word_says_where_output_goes():
    assert sum(len(listed(command)) for command in COMMANDS) + 4 <= MOST_OPTIONS
    for command in COMMANDS:
        options = parser_of(command)._option_string_actions
        assert ("--out" in options) == ("-o" in options), command
        assert not {"--report", "--html", "--freecad", "--accuracy"} & {*listed(command)}, command


def test_completion_offers_what_the_parser_takes():
    assert candidates(["ex"]) == ["export"]
    assert {"export", "help"} <= {*candidates([""])}
    assert candidates(["check", "--s"]) == ["--scene", "--shop", "--strict"]
    assert candidates(["estimate", "--model", "fem"]) == ["fem-plane", "fem-solid"]
    assert candidates(["diff", "HEAD", ".", "macro"]) == ["macro-array"]
    assert candidates(["calibrate", "x.csv", "--design", "soft"]) == ["soft-tissue"]
    assert candidates(["-q", "ex"]) == ["export"]  # as before the command
    assert candidates(["calibrate", "x.csv", "--out", ""]) == []  # a file: the shell's own completion


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_scripts_are_sound(shell, capsys):
    main(["completion", shell])
    script = capsys.readouterr().out
    assert "tactcad completion words" in script
    if not shutil.which(shell):
        pytest.skip(f"no {shell} here")
    done = subprocess.run([shell, "-n"], input=script, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


# What a shell makes of each line when Tab is pressed, a line each to the file `typed`.
TYPED = {
    "bash": """
while read -r line; do
    COMP_WORDS=($line); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); COMPREPLY=(); _tactcad
    last=${COMP_WORDS[COMP_CWORD]}
    echo "${line%$last}${COMPREPLY[*]:-$(compgen -f -- $last)}" >> typed
done <<< "$LINES_TYPED"
""",
    "fish": """
for line in (string split \\n $LINES_TYPED)
    set -l before (string replace -r '\\S+$' '' $line)
    echo $before(complete -C $line) >> typed
end""",
    "zsh": """
zmodload zsh/zpty
zpty typing zsh -f -i
zpty -w typing 'autoload -Uz compinit; compinit -u -D; source script; zle -N show; bindkey "^T" show'
zpty -w typing 'show() { zle complete-word; print -r -- ${BUFFER% } >> typed; BUFFER= }'
for line in ${(f)LINES_TYPED}; zpty -w -n typing $line$'\\x14'
zpty -w typing $'\\nexit'
while zpty -r typing; do :; done > /dev/null""",
}


@pytest.mark.parametrize("shell", TYPED)
def test_a_shell_completes_commands_options_values_and_files(shell, tmp_path, capsys):
    if not shutil.which(shell):
        pytest.skip(f"no {shell} here: its completion is not tried")
    main(["completion", shell])
    (tmp_path / "script").write_text(capsys.readouterr().out)
    (tmp_path / "here.csv").touch()
    (tmp_path / "tactcad").write_text(f'#!/bin/sh\nexec {sys.executable} -m tactcad "$@"\n')
    (tmp_path / "tactcad").chmod(0o755)
    whole = [
        "expo|rt",
        "export mac|ro-array",
        "estimate --model fem-s|olid",
        "golden --he|lp",
        "calibrate her|e.csv",
    ]
    lines = "\n".join(f"tactcad {line.partition('|')[0]}" for line in whole)
    start = "" if shell == "zsh" else "source script"  # zsh's own terminal reads it
    script, quiet = start + TYPED[shell], {"bash": "--norc", "fish": "--no-config", "zsh": "-f"}[shell]
    given = os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}", "LINES_TYPED": lines}
    subprocess.run([shell, quiet, "-c", script], cwd=tmp_path, env=given, check=True, timeout=120)
    typed = (tmp_path / "typed").read_text().splitlines()
    assert typed == [f"tactcad {line.replace('|', '')}" for line in whole]


class Screen(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_failures_are_coloured_on_a_terminal_only(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert streams.coloured("x", "fail", Screen()) == "\x1b[31mx\x1b[0m"
    assert streams.coloured("x", "fail", io.StringIO()) == "x"
    monkeypatch.setenv("NO_COLOR", "1")
    assert streams.coloured("x", "fail", Screen()) == "x"


@pytest.mark.parametrize(("option", "lines"), [(None, 2), ("--verbose", 30), ("--quiet", 0)])
def test_progress_in_a_pipe_is_a_line_a_stage(option, lines):
    streams.set_loudness(option)
    try:
        told = io.StringIO()
        progress = streams.progress(told)
        for total in (10, 20):  # two stages
            for done in range(total + 1):
                progress.step(done, total, f"part {done}")
        assert told.getvalue().count("\n") == lines
        progress.line("warning: scene left out")
        assert "warning" in told.getvalue()
    finally:
        streams.set_loudness(None)


@pytest.mark.parametrize("argv", [["-q", "size"], ["size", "-q"], ["--quiet", "size"]])
def test_loudness_may_stand_before_the_command(argv, capsys):
    try:
        assert main([*argv, "--stiffness", "10", "--load-arm", "6"]) == 0
        assert "hinge thickness" in capsys.readouterr().out
        assert isinstance(streams.progress(io.StringIO()), streams.Silence)
    finally:
        streams.set_loudness(None)
