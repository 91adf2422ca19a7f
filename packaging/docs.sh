#!/bin/sh
# The documentation as a site, exports/docs: pages staged, formulas set, built with warnings as errors, every link followed.
set -eu
cd "$(dirname "$0")/.."
packaging/pinned.sh docs
.venv/bin/python packaging/docs.py stage .cache/docs
.cache/env/docs/bin/python packaging/formulas.py .cache/docs/pages
(cd .cache/docs && ../env/docs/bin/zensical build --strict) # its own cache is then below that folder
.venv/bin/python packaging/docs.py finish .cache/docs/site exports/docs
