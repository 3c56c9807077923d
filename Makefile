# make report   build, install, design the built-in elevator loader under its digital controller
# make test     build, install, run every test
# make lint     format and type checks
# make bench    speed against the peers
# make docs     validation table and the README's picture from the program itself
# make site     the documentation as pages, in site/; PICTURES=0 where there is no Chromium
# make wheel    one wheel for every Python from 3.11 on, checked and tried in a clean environment

PYTHON ?= python3
PICTURES ?= 1
VENV := .venv
BIN := $(VENV)/bin
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check
RUST := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock
PACKAGE := $(shell find python -name '*.py' -o -name '*.j2' -o -name '*.pyi' -o -name '*.toml' -o -name '*.txt' -o -name '*.csv' -o -name '*.html' -o -name '*.css' -o -name '*.js' -o -name '*.c' -o -name '*.ld')

.PHONY: report test lint bench docs site links wheel clean

report: report/report.html
	@echo "The report is $(CURDIR)/report/report.html"

report/report.html: $(VENV)/built $(PACKAGE)
	$(BIN)/forcefeel design elevator-2khz --out report --replace

# The crates as the extension has them: built once, and tested as they run.
test: $(VENV)/built dist/built
	tests/browser/install
	tests/export/install
	cargo test --release --workspace --locked --quiet
	$(BIN)/pytest

lint: $(VENV)/built
	cargo fmt --all --check
	cargo clippy --locked --workspace --all-targets --quiet -- --deny warnings
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest forcefeel._core

bench: $(VENV)/built
	$(BIN)/python benchmarks/schedule.py
	$(BIN)/python benchmarks/simulation.py
	$(BIN)/python benchmarks/linear.py
	$(BIN)/python benchmarks/stability.py
	$(BIN)/python benchmarks/envelope.py
	$(BIN)/python benchmarks/sampled_laws.py
	$(BIN)/python benchmarks/identification.py
	$(BIN)/python benchmarks/tolerances.py
	$(BIN)/python benchmarks/live.py
	tests/export/install
	$(BIN)/python benchmarks/export.py

docs: $(VENV)/built
	$(BIN)/python docs/make.py
	$(BIN)/python docs/house.py

SPHINX = $(BIN)/python -m sphinx -W -n --keep-going --quiet

site: $(VENV)/built
	tests/browser/install
	PICTURES=$(PICTURES) $(SPHINX) docs site
	@echo "The site is $(CURDIR)/site/index.html"

# Links to other people's pages, which a machine without a network cannot follow.
links: $(VENV)/built
	$(SPHINX) -b linkcheck -D manual_runs=0 docs site/links

wheel: dist/built
	$(BIN)/pytest -n 0 tests/wheel
	@echo "The wheel is $(CURDIR)/$$(ls dist/*.whl)"

# From the crates that the extension was built from: nothing is compiled twice.
dist/built: $(VENV)/built $(PACKAGE) LICENSE README.md
	rm -rf dist
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/maturin build --release --quiet --compatibility pypi --auditwheel check --out dist
	touch $@

clean:
	rm -rf $(VENV) target report dist site

# The extension is built while the other packages are fetched: each takes a minute. It is built again only when Rust changes; the
# Python package is used from where it lies.
$(VENV)/built: $(VENV)/backend pyproject.toml $(RUST)
	$(MAKE) --no-print-directory --jobs=2 $(VENV)/extension $(VENV)/dependencies
	touch $@

$(VENV)/extension: $(VENV)/backend pyproject.toml $(RUST)
	PATH="$(CURDIR)/$(BIN):$$PATH" $(PIP) --no-build-isolation --no-deps --editable .
	cp target/release/deps/$(FMI) python/forcefeel/export/fmu/
	touch $@

# The library inside FMUs is built along with the extension, which names it among its crates.
FMI := libforcefeel_fmi.so

# The locked dependencies, once per lock file. Python compiles what is imported when it is, and keeps that; where it may not, every command
# would compile all of it anew.
unexport PYTHONDONTWRITEBYTECODE
$(VENV)/dependencies: $(VENV)/backend
	$(PIP) --no-compile --require-hashes --no-deps -r requirements.lock
	touch $@

# What builds the extension, from the same lock file.
$(VENV)/backend: requirements.lock
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "forcefeel needs Python 3.11 or newer; set PYTHON=")'
	$(PYTHON) -m venv $(VENV)
	sed -n '/^maturin==/,/[^\\]$$/p' requirements.lock > $(VENV)/backend.lock
	$(PIP) --require-hashes --no-deps -r $(VENV)/backend.lock
	touch $@
