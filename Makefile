# Entry points of the project. Works with GNU make 3.81 or later on Linux and macOS (for Windows see CONTRIBUTING.md).
#
#   make demo                      the paper's tests and figures, from nothing
#   make test PYTHON=python3.12    with another interpreter (delete .venv first if it was made with a different one)

PYTHON ?= python3
VENV   ?= .venv

ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
else
BIN := $(VENV)/bin
endif
STAMP := $(VENV)/.mckibben-installed

.DEFAULT_GOAL := help
.PHONY: help setup demo test lint types docs examples bench pictures tables notebook page lock clean

help:
	@echo "make setup      the virtual environment $(VENV), from requirements.lock"
	@echo "make demo       the paper's tests and figures, into out/demo"
	@echo "make test       the tests"
	@echo "make lint       style;  make types  static types;  make docs  the documentation, into docs/_build/html"
	@echo "make examples   every script of examples/;  make bench  the benchmarks, into out"
	@echo "make pictures   the pictures of the README and the documentation, into docs/pictures"
	@echo "make tables     the tables of docs/effects.md;  make notebook  the tutorial as a notebook, run, into out"
	@echo "make page       the JavaScript of mckibben serve, bundled anew; it takes Node.js and npm"
	@echo "make lock       renew requirements.lock from pyproject.toml;  make clean  delete what was built"

setup: $(STAMP)

# The stamp is older than the lock or pyproject.toml after either changes: then everything is installed again.
# Dependencies come from the lock only, so the package itself is installed without them. Bytecode is made here because
# pip leaves it out where PYTHONDONTWRITEBYTECODE is set, and every start would then compile some 2,000 files.
$(STAMP): requirements.lock pyproject.toml
	@$(PYTHON) -c "import sys; v = sys.version_info; sys.exit(0 if v >= (3, 11) else 'mckibben needs Python 3.11 or later and $(PYTHON) is %d.%d: make PYTHON=/path/to/python3.11' % v[:2])"
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --disable-pip-version-check --quiet -r requirements.lock
	$(BIN)/python -m pip install --disable-pip-version-check --quiet --no-deps -e .
	$(BIN)/python -m compileall -q -j 0 $(VENV)
	@touch $@

demo: setup
	$(BIN)/mckibben reproduce -o out/demo --force

test: setup
	$(BIN)/python -m pytest -n 2 --dist loadfile --durations=25

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: setup
	$(BIN)/mypy

docs: setup
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs docs/_build/html
	@echo "docs/_build/html/index.html"

# Two at a time, each told whole. Agg: an example never waits for a window to be closed.
examples: setup
	@ls examples/*.py | MPLBACKEND=Agg xargs -P 2 -n 1 sh -c \
		'said=$$($(BIN)/python "$$0" 2>&1); code=$$?; printf "== %s\n%s\n" "$$0" "$$said"; exit $$code'

bench: setup # with nothing compiled yet, so that cold is cold
	rm -rf out/compiled
	JAX_COMPILATION_CACHE_DIR=$(CURDIR)/out/compiled $(BIN)/python benchmarks/run.py

pictures: setup
	$(BIN)/python docs/pictures.py

notebook: setup
	@mkdir -p out
	sed -E 's#\]\((pictures|theory|howto)#](../docs/\1#' docs/tutorial.md | $(BIN)/jupytext --quiet --from md --to ipynb --output out/tutorial.ipynb
	cd out && ../$(BIN)/jupyter execute --inplace tutorial.ipynb
	@echo "out/tutorial.ipynb"

tables: setup
	$(BIN)/python docs/effects.py

# What is bundled is committed, so that nobody else needs Node.js. The lock names no addresses of a registry.
page:
	cd page && npm ci --ignore-scripts --no-audit --no-fund && node build.mjs
	@echo "src/mckibben/page/assets"

# Pins stay as they are unless pyproject.toml rules them out; UPGRADE=--upgrade takes the newest of everything.
lock: setup
	$(BIN)/uv pip compile $(UPGRADE) --universal --python-version 3.11 --extra dev --no-header --no-emit-index-url pyproject.toml -o requirements.lock

clean:
	rm -rf $(VENV) build dist out docs/_build docs/reference/spec.md .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find src tests examples benchmarks docs -name __pycache__ -type d -prune -exec rm -rf {} +
