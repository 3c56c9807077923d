# make report   build, install, design the built-in elevator loader under its digital controller
# make test     build, install, run the tests
# make validate  run all tests, the slow ones too: further aircraft, drives, widths and rates, long records, the wheel
# make lint     format and type checks
# make bench    speed against the peers
# make docs     validation table and the README's picture from the program itself
# make demo     the live loader's compiled model and laws, docs/demo/engine.js
# make site     the documentation as pages, in site/; PICTURES=0 where there is no Chromium
# make platforms  the library inside FMUs, and a wheel, for Linux (glibc 2.17), Windows x64, macOS x64 and arm64, cross-compiled
# make firmware-libraries  the libraries of exported firmware for Cortex-M4F, aarch64 and x86-64
# make audit    advisories on the dependencies, with a network, cargo-deny and pip-audit; the tests check licenses and sources
# make wheel    one wheel for every Python from 3.11 on, checked and tried in a clean environment

PYTHON ?= python3
PICTURES ?= 1
VENV := .venv
# Every program that a test starts would compile its imports anew.
unexport PYTHONDONTWRITEBYTECODE
BIN := $(VENV)/bin
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check
RUST := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock
PACKAGE := $(shell find python -name '*.py' -o -name '*.j2' -o -name '*.pyi' -o -name '*.toml' -o -name '*.txt' -o -name '*.csv' -o -name '*.html' -o -name '*.css' -o -name '*.js' -o -name '*.c' -o -name '*.h' -o -name '*.ld')

.PHONY: report test tested-crates fetched validate lint linted-rust linted-python bench docs demo site links platforms firmware-libraries audit wheel clean

report: report/report.html
	@echo "The report is $(CURDIR)/report/report.html"

report/report.html: $(VENV)/built $(PACKAGE)
	$(BIN)/forcefeel design elevator-2khz --out report --replace

# The crates as the extension has them: built once, and tested as they run. What is fetched for the tests comes meanwhile.
test: $(VENV)/equipped
	$(MAKE) --no-print-directory --jobs=2 tested-crates fetched
	$(BIN)/pytest

tested-crates:
	cargo test --release --workspace --locked --quiet

# The tests are compiled for the workers, once.
fetched: $(VENV)/equipped
	tests/browser/install
	tests/export/install
	$(BIN)/python tests/platforms/firmware_libraries.py thumbv7em-none-eabihf x86_64-unknown-linux-gnu
	$(BIN)/pytest --collect-only --quiet --numprocesses 0 > target/collected

# With the cases that pytest's marker `slow` names: they try in depth what a cheaper case of `make test` runs too.
validate: $(VENV)/equipped target/wheel/built firmware-libraries
	tests/browser/install
	FORCEFEEL_REQUIRE_WHEEL=1 HYPOTHESIS_PROFILE=validate $(BIN)/pytest -m ""

# Clippy in the release profile too: the macros of other crates are there already. --all-targets would check each library twice.
lint: $(VENV)/equipped
	$(MAKE) --no-print-directory --jobs=2 linted-rust linted-python

linted-rust:
	cargo fmt --all --check
	cargo clippy --release --locked --workspace --lib --tests --quiet -- --deny warnings

# The stubs are checked by themselves: beside the package all of it would be checked once more.
linted-python:
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/mypy
	mkdir -p target/stubs
	ln -sf $(CURDIR)/python/forcefeel/_core.* target/stubs/
	cd target/stubs && $(CURDIR)/$(BIN)/python -m mypy.stubtest _core

bench: $(VENV)/equipped
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

docs: $(VENV)/equipped
	$(BIN)/python docs/make.py
	$(BIN)/python docs/layers.py

# Committed, so that the page opens in a browser as it was cloned. Its tests hold it against the simulation, bit for bit.
demo: $(VENV)/equipped
	rustup target add wasm32-unknown-unknown
	cargo build --release --locked --package forcefeel-browser --target wasm32-unknown-unknown
	$(BIN)/python docs/live_loader.py

SPHINX = $(BIN)/python -m sphinx -W -n --keep-going --quiet

site: $(VENV)/equipped
	tests/browser/install
	PICTURES=$(PICTURES) $(SPHINX) docs site
	@echo "The site is $(CURDIR)/site/index.html"

# Links to other people's pages, which a machine without a network cannot follow.
links: $(VENV)/equipped
	$(SPHINX) -b linkcheck -D manual_runs=0 docs site/links

MATURIN = PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/maturin build --release --quiet --compatibility pypi --auditwheel check

# What others get runs on all vector instructions.
wheel: firmware-libraries
	rm -rf dist
	$(MATURIN) --features pyo3/extension-module,every-machine --out dist
	FORCEFEEL_WHEELS=dist $(BIN)/pytest -n 0 -m "" tests/wheel
	@echo "The wheel is $(CURDIR)/$$(ls dist/*.whl)"

# Zig links for glibc 2.17 and for macOS, mingw for Windows: 11 minutes of processor time each, library and wheel from the same crates.
# What is built here goes into every FMU that this checkout exports.
platforms: firmware-libraries
	tests/platforms/install
	tests/platforms/build
	FORCEFEEL_PLATFORMS=1 FORCEFEEL_WHEELS=dist/platforms $(BIN)/pytest -n 0 -m "" tests/platforms tests/wheel

# What an export to firmware needs no cargo with; a minute. Slow tests and wheels have all, the others those of two targets.
firmware-libraries: $(VENV)/equipped
	tests/export/install
	$(BIN)/python tests/platforms/firmware_libraries.py

audit:
	cargo deny check licenses sources advisories
	pip-audit --require-hashes --disable-pip --requirement requirements-dev.lock

# For the slow tests, from the crates that the extension was built from: nothing is compiled twice.
target/wheel/built: $(VENV)/equipped $(PACKAGE) LICENSE README.md
	rm -rf target/wheel
	$(MATURIN) --out target/wheel
	touch $@

clean:
	rm -rf $(VENV) target report dist site

# The extension is built while the other packages are fetched: each takes its time. It is built again only when Rust changes; the
# Python package is used from where it lies.
$(VENV)/built: $(VENV)/backend pyproject.toml $(RUST)
	$(MAKE) --no-print-directory --jobs=2 $(VENV)/extension $(VENV)/dependencies
	touch $@

# With all that tests, checks and documents it.
$(VENV)/equipped: $(VENV)/backend pyproject.toml $(RUST)
	$(MAKE) --no-print-directory --jobs=2 $(VENV)/extension $(VENV)/tools
	$(MAKE) --no-print-directory $(VENV)/built
	touch $@

$(VENV)/extension: $(VENV)/backend pyproject.toml $(RUST)
	PATH="$(CURDIR)/$(BIN):$$PATH" $(PIP) --no-build-isolation --no-deps --editable .
	cp target/release/deps/$(FMI) python/forcefeel/export/fmu/
	touch $@

# The library inside FMUs is built along with the extension, which names it among its crates.
FMI := libforcefeel_fmi.so

# The locked dependencies, once per lock file: uv takes a minute less than pip, and pip knows where else a machine has its packages.
# Python compiles what is imported when it is, and keeps that. What a report imports is compiled here, while there is a core to spare.
LOCKED = --quiet --require-hashes --no-deps -r
INSTALLED = $(BIN)/uv pip install --python $(BIN)/python $(LOCKED) $(1) || $(PIP) --no-compile $(LOCKED) $(1)
$(VENV)/dependencies: $(VENV)/backend requirements.lock
	$(call INSTALLED,requirements.lock)
	$(BIN)/python -c "import control, cyclopts, jinja2, pint, plotly.subplots, pydantic, rich.markdown, tomlkit, xarray"
	touch $@

$(VENV)/tools: $(VENV)/dependencies requirements-dev.lock
	$(call INSTALLED,requirements-dev.lock)
	touch $@

# What builds the extension and what installs, from the same lock file.
$(VENV)/backend: requirements-dev.lock
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "forcefeel needs Python 3.11 or newer; set PYTHON=")'
	$(PYTHON) -m venv $(VENV)
	sed -n '/^maturin==/,/[^\\]$$/p; /^uv==/,/[^\\]$$/p' requirements-dev.lock > $(VENV)/backend.lock
	$(PIP) --require-hashes --no-deps -r $(VENV)/backend.lock
	touch $@
