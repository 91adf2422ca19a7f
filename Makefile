# `make help` lists what there is. Every target first sees to it that .venv is there and up to date.
.DEFAULT_GOAL := help
.PHONY: help environment export test slow check golden review release bench docs reference nightly clean

BIN := .venv/bin
DESIGNS := $(sort $(wildcard hardware/*.toml))
WORKERS ?= 2

# one thread a process: the tests run side by side, and results do not depend on the number of cores
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
# what is compiled once is kept, wherever the machine is set not to: tests start hundreds of processes
export PYTHONDONTWRITEBYTECODE :=

help: ## this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

environment: ## create .venv and install everything at pinned versions: about 3 GB, a few minutes
	@packaging/environment.sh

export: environment ## write the files of every design in hardware/ to exports/<design>/
	$(BIN)/tactcad export $(DESIGNS) --guide --drawings

test: environment ## every test but the slow and the nightly ones
	$(BIN)/python -m pytest -m "not slow and not nightly" -n $(WORKERS) --dist worksteal

slow: environment ## tests that start browsers, clusters and installs, search long, or make whole releases and exports
	$(BIN)/python -m pytest -m "slow and not nightly" -n $(WORKERS) --dist worksteal

check: environment ## style, types, and every check of every design: all failures are printed, then it fails
	@status=0; \
	$(BIN)/ruff check || status=1; \
	$(BIN)/ruff format --check src tests benchmarks packaging || status=1; \
	$(BIN)/mypy || status=1; \
	echo $(DESIGNS) | xargs -n 1 -P $(WORKERS) sh -c 'said=$$($(BIN)/tactcad check $$0 --out exports/check/$$(basename $$0 .toml)); \
		failed=$$?; echo "$$said"; exit $$failed' || status=1; \
	exit $$status

golden: environment ## print what changed in each design's geometry and record it in exports/golden/; refused if a check fails
	$(BIN)/tactcad golden $(DESIGNS)

EXPORTS = $(DESIGNS:hardware/%.toml=exports/%)

review: export ## open every exported STEP and DXF file in ezdxf and FreeCAD; write exports/NAME-review.html
	@status=0; \
	echo $(EXPORTS) | xargs -n 1 -P $(WORKERS) sh -c '$(BIN)/tactcad review $$0 --out $$0-review.html' || status=1; \
	$(BIN)/python packaging/review/in_ezdxf.py $(EXPORTS) || status=1; \
	echo $(EXPORTS) | xargs -n 1 -P $(WORKERS) $(BIN)/python packaging/review/review.py || status=1; \
	exit $$status

release: environment ## release zips of every design that passes all checks, as samples: exports/releases
	$(BIN)/tactcad release --sample $(DESIGNS)

bench: environment ## speed against accuracy on this machine, in short: tables, plots and JSON in exports/bench
	$(BIN)/python benchmarks/bench.py --out exports/bench

docs: environment ## the documentation as a site that opens offline: exports/docs/index.html; warnings are errors
	packaging/docs.sh

reference: environment ## the published benchmarks again, in full, on a quiet machine: docs, benchmarks/results
	$(BIN)/python benchmarks/bench.py --full --out exports/bench
	$(BIN)/python benchmarks/publish.py exports/bench
	$(BIN)/python benchmarks/interval_tables.py benchmarks/results/intervals.md
	$(BIN)/python benchmarks/read_outs.py docs/circuit.md

nightly: environment ## the long tests, a night of random tests, and the kernel's tests on the next kernel
	@status=0; \
	$(BIN)/python tests/night.py exports/night --workers $(WORKERS) || status=1; \
	$(BIN)/python -m pytest -m "nightly and not night" || status=1; \
	packaging/ocp8.sh || status=1; \
	exit $$status

clean: ## remove the environment, caches and exports; exports/golden stays
	rm -rf .venv .venv.lock .cache .pytest_cache .ruff_cache .hypothesis build
	find src tests benchmarks packaging -name __pycache__ -prune -exec rm -rf {} +
	find exports -mindepth 1 -maxdepth 1 ! -name golden ! -name README.md -exec rm -rf {} +
