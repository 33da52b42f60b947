# The four commands of this project. `make run` and `make test` create what they need.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready

.DEFAULT_GOAL := help
.PHONY: help run test lint bench

help:  ## this list
	@sed -n 's/^\([a-z]*\):.*## /  make \1\t/p' $(MAKEFILE_LIST)

run: $(READY)  ## serve the workbench and open it in the browser (ARGS='--port 5010 --no-browser')
	@$(BIN)/workbench serve $(ARGS)

test: $(READY)  ## the whole test suite (ARGS='-k scenario' for a part)
	@$(BIN)/python scripts/ensure_chromium.py
	@$(BIN)/pytest $(ARGS)

lint: $(READY)  ## style, types and the import rules
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/pyright
	@$(BIN)/lint-imports

bench: $(READY)  ## how fast the simulator, the learner and the pages are here
	@$(BIN)/workbench bench sim
	@$(BIN)/workbench bench learner
	@$(BIN)/workbench bench page

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "workbench needs Python 3.11 or newer, this is %s; pass another: make PYTHON=python3.11" % sys.version.split()[0])'
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "Installing into $(VENV) (once, a few minutes) ..."
	@$(BIN)/pip install --quiet --editable '.[test,export,cluster]' --constraint constraints.txt
	@touch $(READY)
