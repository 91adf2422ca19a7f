#!/bin/sh
# Creates or brings up to date the project's own environment, .venv: `make` calls it before everything else.
#
# Done means that .venv/complete holds the key of what was asked for: the digest of the requirement files, of both
# pyproject.toml, of this script, of Python's version and of the folder (a moved .venv does not work). That
# file goes first and comes last, so an interrupted install is never taken for a finished one.
set -eu
cd "$(dirname "$0")/.."
stamp=.venv/complete

key() { # $1: a Python
    {
        cat requirements/pins.txt pyproject.toml packaging/ocp-shim/pyproject.toml packaging/environment.sh
        "$1" -c 'import sys; print(sys.version)'
        pwd -P
    } | sha256sum | cut -d' ' -f1
}

is_complete() { [ -f "$stamp" ] && [ -x .venv/bin/python ] && [ "$(cat "$stamp")" = "$(key .venv/bin/python)" ]; }

find_python() { # the first that runs and is new enough; pyenv's shims exist without running
    for candidate in ${PYTHON:-python3.11 python3.12 python3.13 python3}; do
        if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            echo "$candidate"
            return
        fi
    done
}

missing= packages=
lacks() { # $1: what is missing, $2: Debian's package
    missing="$missing${missing:+, }$1"
    packages="$packages${packages:+ }$2"
}

say_what_is_missing() {
    [ -z "$missing" ] && return
    echo "make: missing on this machine: $missing" >&2
    echo "make: on Debian or Ubuntu: apt-get install $packages" >&2
    exit 1
}

if is_complete; then exit 0; fi

python=$(find_python)
if [ -z "$python" ]; then
    lacks "Python 3.11 or newer" "python3.11 python3.11-venv"
    say_what_is_missing
fi
version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
"$python" -c 'import ensurepip, venv' 2>/dev/null || lacks "Python's venv module" "python$version-venv"
for library in libGL.so.1:libgl1 libX11.so.6:libx11-6; do # the CAD kernel is linked against both
    "$python" -c "import ctypes; ctypes.CDLL('${library%:*}')" 2>/dev/null || lacks "${library%:*}" "${library#*:}"
done
say_what_is_missing

# Two makes in one folder: the second waits, then finds the work done.
exec 9>.venv.lock
if command -v flock >/dev/null; then flock 9; fi
if is_complete; then exit 0; fi

echo "make: creating .venv with Python $version: some 100 packages at their pinned versions, 1 to 5 minutes"
rm -f "$stamp"
rm -rf .venv
"$python" -m venv .venv
pip() { .venv/bin/python -m pip --disable-pip-version-check "$@"; }
install() { pip install -qq --no-deps "$@"; } # -qq: errors only
install ./packaging/ocp-shim
install -r requirements/pins.txt
install --editable .
broken=$(pip check) || { echo "make: $broken" >&2; exit 1; }
key .venv/bin/python >"$stamp.new"
mv "$stamp.new" "$stamp"
echo "make: .venv is complete"
