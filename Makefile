# One word a job, the same by hand and in CI. Needs Python >= 3.11 and make; brings the rest itself, into .venv.

PYTHON ?= python3
HOST ?= 127.0.0.1
PORT ?= 8000
# `make serve ARGS="--no-demo"`, `make e2e ARGS="-k scope"`
ARGS ?=
# Processes that Python tests run in: both cores of a small machine. Browser tests run beside them, in one process that
# has a browser and a server behind it (0), or in so many.
WORKERS ?= 2
BROWSERS ?= 0
# The versions that this commit was tested with; `make CONSTRAINTS= run` takes the newest.
CONSTRAINTS ?= constraints.txt

# With ARGS one half of the tests may have none to run, which pytest ends with 5.
NONE_IS_WELL = $(if $(ARGS),|| [ $$? -eq 5 ])

BIN := .venv/bin
PY := $(BIN)/python
PIP := $(PY) -m pip --disable-pip-version-check
# Inside .venv, so that deleting it forgets them too.
STAMPS := .venv/.stamps

# Images set it to stay small. Here it would have every test process compile the program, and pytest its tests, anew.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: help run dev test test-all python-tests browser-tests test-fast lint lint-python lint-web format types conformance \
	report bench screenshots pictures install web help-site web-check chromium lock clean

help:  ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

run: $(STAMPS)/app web help-site  ## start stepscope with its demo bench and print the URL (HOST, PORT, ARGS)
	@exec $(BIN)/stepscope serve --host $(HOST) --port $(PORT) $(ARGS)

dev: $(STAMPS)/kernels $(STAMPS)/tools help-site  ## server and UI, both reload on a change; one Ctrl-C ends both
	@exec $(PY) scripts/dev.py --host $(HOST) --port $(PORT)

test:  ## everything that CI holds: linters, types, UI, Python and browser tests; says how long it took, and why
	@+$(PYTHON) scripts/spent.py $(MAKE) --no-print-directory test-all

# All at once as far as one does not need another: a core that waits for a page, or for pip, has other things to do.
test-all:
	@$(MAKE) --no-print-directory --jobs=3 HELP_BEHIND=$(STAMPS)/tools $(STAMPS)/kernels chromium help-site lint-python \
		web-check browser-tests python-tests

# Whole lines, for both halves print at the same time. One browser beside two processes of Python tests keeps both cores
# busy. A file of browser tests shares what it has set up: loadfile.
python-tests browser-tests: SHELL := bash
python-tests: $(STAMPS)/kernels $(STAMPS)/tools
	@set -o pipefail; ($(BIN)/pytest -n $(WORKERS) -m "not e2e" $(ARGS) $(NONE_IS_WELL)) 2>&1 | grep --line-buffered ''

browser-tests: $(STAMPS)/kernels $(STAMPS)/tools chromium help-site
	@set -o pipefail; ($(BIN)/pytest -n $(BROWSERS) --dist loadfile -m e2e tests/e2e $(ARGS) $(NONE_IS_WELL)) 2>&1 | grep --line-buffered ''

test-fast: $(STAMPS)/kernels $(STAMPS)/tools  ## Python tests that are quick: no browser, no server, nothing marked slow
	$(BIN)/pytest -n $(WORKERS) -m "not e2e and not slow" $(ARGS)

lint: lint-python lint-web  ## ruff, mypy --strict, import directions, biome, tsc, stale generated files

lint-python: $(STAMPS)/app $(STAMPS)/tools
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(BIN)/mypy

lint-web: $(STAMPS)/app $(STAMPS)/tools
	$(PY) scripts/web.py npm run --silent lint
	$(PY) scripts/web.py npm run --silent typecheck
	$(PY) scripts/generate_types.py --check

format: $(STAMPS)/tools  ## let the formatters have their way
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(PY) scripts/web.py npm run --silent format

types: $(STAMPS)/app $(STAMPS)/tools  ## all generated files: the OpenAPI schema, the UI's types and forms, the blocking client
	$(PY) scripts/generate_types.py

conformance: $(STAMPS)/app $(STAMPS)/tools  ## which sections of the data sheets the tests hold
	$(PY) -m tests.conformance

report: $(STAMPS)/kernels $(STAMPS)/tools  ## lines that the Python tests run, room by room, and the most complex functions
	$(BIN)/pytest -n $(WORKERS) -m "not e2e" --cov=app --cov-report= $(ARGS)
	@$(PY) scripts/report.py

bench: install $(STAMPS)/tools chromium  ## measured figures beside what is required (QUICK=1 for a short run)
	$(PY) -m tests.bench $(if $(QUICK),--quick) $(ARGS)

screenshots: install $(STAMPS)/tools chromium  ## every page, two sizes, light and dark, into test-results/
	$(PY) scripts/screenshots.py test-results/screenshots $(ARGS)

pictures: install $(STAMPS)/tools chromium  ## the pictures of the README and the tutorials, by doing what they say
	STEPSCOPE_PICTURES=1 $(BIN)/pytest -q tests/e2e/test_newcomer.py tests/e2e/test_tutorials.py

install: $(STAMPS)/kernels web help-site

web: $(STAMPS)/venv
	@$(PY) scripts/web.py build

# The site's generator is one of the tools, and comes alone where they are not wanted.
help-site: $(STAMPS)/app $(HELP_BEHIND)
	@$(PY) scripts/help_site.py build

# Behind lint-web: both bring the npm packages where they are missing.
web-check: web lint-web
	$(PY) scripts/web.py npm run --silent test

chromium: $(STAMPS)/tools
	@$(PY) scripts/ensure_chromium.py

lock: $(STAMPS)/app $(STAMPS)/tools  ## take the newest versions that pyproject.toml allows, and write them down
	$(PIP) install --quiet --upgrade --upgrade-strategy eager -e . --group test
	$(PY) scripts/lock.py

clean:  ## back to a fresh clone
	rm -rf .venv app/_web app/_web.new app/_web.old app/_help app/_help.new app/_help.old web/node_modules web/dist dist test-results .coverage htmlcov \
		.mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache .schemathesis
	find app tests scripts -name __pycache__ -type d -prune -exec rm -rf {} +

$(STAMPS)/venv:
	@$(PYTHON) scripts/check_python.py
	@echo "making .venv"
	@$(PYTHON) -m venv .venv
	@# --group, which installs the tools, came with pip 25.1
	@$(PIP) install -qq --upgrade "pip>=25.1"
	@mkdir -p $(STAMPS) && touch $@

# Each module is compiled when it is first imported, which of many never happens.
# The UI first, then the package: so that pip's build finds it done, and fetches no second Node.js for it.
$(STAMPS)/app: $(STAMPS)/venv pyproject.toml hatch_build.py $(CONSTRAINTS) | web
	@STEPSCOPE_NO_HELP=1 $(PY) scripts/pip_with_bar.py "installing stepscope into .venv" install --no-compile $(addprefix --constraint ,$(CONSTRAINTS)) --editable .
	@touch $@

# Part of the install, so that the first start takes seconds like every other (numba keeps the result on disk).
$(STAMPS)/kernels: $(STAMPS)/app
	@echo "compiling the emulators and calculators, once"
	@$(PY) -m app.preparation
	@touch $@

# Behind the package: two of pip at once in one environment overwrite each other's files.
$(STAMPS)/tools: $(STAMPS)/venv pyproject.toml $(CONSTRAINTS) | $(STAMPS)/app
	@$(PY) scripts/pip_with_bar.py "installing the development tools into .venv" install --no-compile $(addprefix --constraint ,$(CONSTRAINTS)) --group test
	@touch $@
