#!/bin/sh
# Creates or brings up to date an environment beside .venv: packaging/pinned.sh NAME makes .cache/env/NAME of
# requirements/NAME.txt, whole or not at all. It holds what is listed and nothing else.
set -eu
cd "$(dirname "$0")/.."
name=$1
pins=requirements/$name.txt
folder=.cache/env/$name
key=$({ cat "$pins"; .venv/bin/python -c 'import sys; print(sys.version)'; pwd -P; } | sha256sum | cut -d' ' -f1)
[ "$(cat "$folder/complete" 2>/dev/null)" = "$key" ] && exit 0

echo "make: creating $folder of $pins, once"
rm -rf "$folder"
.venv/bin/python -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install -qq --no-deps -r "$pins"
broken=$("$folder/bin/python" -m pip --disable-pip-version-check check) || { echo "make: $broken" >&2; exit 1; }
echo "$key" >"$folder/complete"
