# Two commands do all the set-up on a fresh machine: `make demo` and `make test`.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt

.PHONY: demo test lint bench proofs clean

# The main job: the paper's tabular experiment, 30 seeds, all algorithms, with figures.
demo: $(VENV)/.core
	$(BIN)/bridge-rl reproduce fig2-starmdp fig2-gridworld --out demo

test: $(VENV)/.dev
	$(BIN)/python -m pytest -n auto

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(VENV)/.dev
	$(BIN)/python -m experiments.bench

# Check every theorem again by Coq's kernel; needs Debian's packages coq and libcoq-interval.
proofs: $(VENV)/.core
	$(BIN)/python -m proofs_checks.kernel.gate

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.core: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(INSTALL) --editable .
	touch $@

$(VENV)/.dev: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(INSTALL) --editable ".[dev]"
	touch $@ $(VENV)/.core

clean:
	rm -rf $(VENV) build dist
