#!/bin/sh
# The documentation as a site, exports/docs: pages staged, built with warnings as errors, every link followed.
set -eu
cd "$(dirname "$0")/.."
packaging/pinned.sh docs
.venv/bin/python packaging/docs.py stage .cache/docs
rm -rf exports/docs
mkdir -p exports
.cache/env/docs/bin/zensical build --clean --strict
.venv/bin/python packaging/docs.py finish exports/docs
