# Everything happens in .venv and target; nothing has to be active or installed beforehand but
# Python 3.11 or newer and a Rust toolchain.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --no-compile

# What the wheel is made of.
SOURCES := Cargo.toml Cargo.lock pyproject.toml \
	$(shell find crates -type f \( -path '*/src/*' -o -path '*/scenes/*' -o -path '*/page/*' -o -name Cargo.toml -o -name build.rs -o -name third-party.txt \)) \
	$(shell find python -type f \( -name '*.py' -o -name '*.pyi' -o -name '*.css' -o -name py.typed \))

# As compilers of this system call the library that goes into functional mock-up units.
FMU_LIBRARY := $(if $(filter Windows_NT,$(OS)),chaindrive_fmu.dll,$(if $(filter Darwin,$(shell uname -s)),libchaindrive_fmu.dylib,libchaindrive_fmu.so))

# Every test that judges a validation case appends to it.
VERDICTS := $(abspath target/verdicts.jsonl)

# As maturin tells it to Cargo: whoever of the two compiles the bindings and PyO3, the other need not. One library serves every
# interpreter from 3.11 on, so no interpreter is asked.
export PYO3_CONFIG_FILE := $(abspath crates/python/interpreter.txt)
export PYO3_BUILD_EXTENSION_MODULE := 1

# What Python compiles is kept, whatever the shell says: tests begin many a Python of their own, and each would compile every library again.
export PYTHONDONTWRITEBYTECODE :=

# What is run and tested here has one code generation, the profile `quick`. What ships and what is measured has `release`: the same
# bits, optimised throughout.
QUICK := --profile quick

# All crates at once, the bindings included, so that libraries have the same features and no crate is compiled twice.
# nextest where it is installed, otherwise Cargo's own runner.
ifneq ($(shell command -v cargo-nextest 2>/dev/null),)
CARGO_TEST := cargo nextest run --cargo-profile quick --workspace --tests --status-level slow --final-status-level slow --no-fail-fast
else
CARGO_TEST := cargo test $(QUICK) --workspace --quiet --no-fail-fast --tests
endif

.DEFAULT_GOAL := help
.PHONY: help setup run test quick slowest licences check check-rust check-python test-rust test-python bench report estimates bicycle-losses how-real validation validation-report docs pages site lab wheels clean
# A build that failed leaves no stamp behind.
.DELETE_ON_ERROR:

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-18s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup: $(VENV)/installed ## Make .venv and build and install the package in it

run: setup ## Simulate one second of the marine engine drive; results go to results/
	$(BIN)/python examples/marine_engine.py

test: check test-rust test-python ## Run all checks, and every test that guards a change

quick: $(VENV)/test-ready ## Check format, lints and types, test what changed, and run one small drive
	$(BIN)/python tests/quick.py

slowest: setup $(VENV)/test-ready ## List the slowest tests of each language, and those above 3 CPU s without a reason
	$(BIN)/python tests/slowest.py

check: check-rust check-python ## Check format, lints and types

# In the profile of the tests, so that procedural macros and build scripts are built once. References of the documentation are held by `make pages`.
check-rust: $(VENV)/ready
	cargo fmt --all --check
	cargo clippy $(QUICK) --workspace --all-targets -- -D warnings

check-python: setup $(VENV)/test-ready
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest chaindrive._core --mypy-config-file pyproject.toml

test-rust: $(VENV)/ready
	$(CARGO_TEST)
	cargo test $(QUICK) --workspace --quiet --doc

test-python: setup $(VENV)/test-ready
	$(BIN)/pytest --numprocesses 2 --dist loadfile

licences: ## Write the licences of all libraries that ship into crates/couple/third-party.txt
	$(PYTHON) tests/licences.py

bench: ## Measure kernels and steps
	cargo bench

report: $(VENV)/shipped $(VENV)/test-ready ## Measure speed and error on this machine, and write docs/how-fast-how-accurate.md
	$(BIN)/python benchmarks/report

estimates: ## Hold what runs say of their error against a reference, and write docs/estimates.md
	cargo run --release --quiet -p chaindrive --example estimates > docs/estimates.md

bicycle-losses: $(VENV)/shipped $(VENV)/test-ready ## Find where the watts of a rider go, and write docs/bicycle-losses.md
	$(BIN)/python benchmarks/bicycle_losses

how-real: $(VENV)/shipped $(VENV)/test-ready ## Try the assumptions and models of presets, and write docs/how-real.md
	$(BIN)/python benchmarks/how_real

validation: setup $(VENV)/test-ready ## Run the slow studies as well
	cargo test $(QUICK) --workspace --tests -- --include-ignored
	$(BIN)/pytest -m 'slow or not slow'

validation-report: setup $(VENV)/test-ready ## Run the tests that judge validation cases, and write docs/validation.md
	rm -f $(VERDICTS)
	@# A test that fails has left its miss behind: the report comes before the failure.
	export CHAINDRIVE_VERDICTS=$(VERDICTS); failed=0; \
	cargo test $(QUICK) --workspace --tests --quiet --no-fail-fast -- --include-ignored validation || failed=1; \
	$(BIN)/pytest -m 'slow or not slow' -k 'measured or validation_report' || failed=1; \
	$(BIN)/python tests/validation/report.py $(VERDICTS) && exit $$failed

docs: ## Build the reference of the Rust crates in target/doc
	RUSTDOCFLAGS='-D warnings' cargo doc $(QUICK) --workspace --no-deps

pages: setup $(VENV)/site-ready docs ## Build the documentation in target/site; tutorials are run
	rm -rf target/site
	$(BIN)/sphinx-build -W --keep-going -q -j 2 -d target/site-trees docs target/site
	cp -r target/doc target/site/rust
	@test -f target/site/live-lab.html || echo "The site has no lab, and no links to it: this build has none; make lab pages"

site: browser pages ## Build the documentation, and test replays and reports in a browser
	$(BIN)/pytest tests/site

# The module, the package around it and the page of the lab. The tool that writes the glue has to have the version of the lock.
WASM := wasm32-unknown-unknown
BINDGEN_VERSION := $(shell awk '/^name = "wasm-bindgen"$$/ { getline; gsub(/"/, ""); print $$3 }' Cargo.lock)
BINDGEN := target/tools/wasm-bindgen-$(BINDGEN_VERSION)
MODULE := target/$(WASM)/release/chaindrive_wasm.wasm
# Lanes of two, which every browser in use has; a stack on which long chains settle, where the linker gives a megabyte; and no path of the machine that builds.
MODULE_FLAGS = -C target-feature=+simd128 -C link-arg=-zstack-size=8388608 $(REMAP)

lab: $(BINDGEN)/bin/wasm-bindgen ## Build the package for browsers and Node in target/lab/package, and the lab, a page that computes drives
	@rustc --print target-libdir --target $(WASM) | xargs test -d || { \
		echo "Rust cannot compile for browsers here; install the target: rustup target add $(WASM)" >&2; exit 1; }
	@# The tool reads in a section which instructions there are; a stripped module has none.
	RUSTFLAGS='$(MODULE_FLAGS)' CARGO_PROFILE_RELEASE_STRIP=none cargo build --release --quiet --target $(WASM) -p chaindrive-wasm
	rm -rf target/lab
	$< --target web --remove-name-section --out-name index --out-dir target/lab/package $(MODULE)
	cp crates/wasm/package/* target/lab/package/
	$< --target no-modules --no-typescript --remove-name-section --out-name chaindrive --out-dir target/lab/page $(MODULE)
	cargo run $(QUICK) --quiet -p chaindrive-lab -- target/lab/page/chaindrive.js target/lab/page/chaindrive_bg.wasm target/lab/lab.html
	mkdir -p python/chaindrive/library
	cp target/lab/lab.html python/chaindrive/library/

$(BINDGEN)/bin/wasm-bindgen:
	cargo install wasm-bindgen-cli --version $(BINDGEN_VERSION) --quiet --root $(BINDGEN)

# Both are linked against a C library that old machines have.
WHEEL_TARGET = $(shell rustc -vV | sed -n 's/^host: //p')

# No path of the machine that builds is in what ships.
CARGO_FOLDER = $(or $(CARGO_HOME),$(HOME)/.cargo)
REMAP = --remap-path-prefix=$(CURDIR)=chaindrive --remap-path-prefix=$(CARGO_FOLDER)=cargo
wheels: export RUSTFLAGS := $(REMAP)
wheels: export CFLAGS := -ffile-prefix-map=$(CARGO_FOLDER)=cargo

wheels: lab $(VENV)/wheels-ready ## Build a wheel for Linux and the source distribution in dist, and try them
	rm -rf dist
	@# By itself: in one call with the bindings it would have their stores.
	PATH="$(abspath $(BIN)):$$PATH" $(BIN)/cargo-zigbuild zigbuild --release --quiet -p chaindrive-fmu --target $(WHEEL_TARGET).2.17
	mkdir -p python/chaindrive/library
	cp target/$(WHEEL_TARGET)/release/libchaindrive_fmu.so python/chaindrive/library/
	@# Apart: a wheel that is made of the source distribution has no library of units.
	$(BIN)/maturin sdist --out dist
	PATH="$(abspath $(BIN)):$$PATH" $(BIN)/maturin build --release --zig --target $(WHEEL_TARGET) --compatibility manylinux2014 --out dist
	$(BIN)/python tests/wheels/fresh.py dist

.PHONY: browser
browser:
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null || { \
		echo "Chromium is missing, in which replays and reports are tested: install the package chromium (Debian: apt-get install chromium), or build without the test: make pages" >&2; exit 1; }

clean: ## Remove everything that was built
	rm -rf $(VENV) target results dist

# Virtual environment with what `make run` needs.
$(VENV)/ready: pyproject.toml
	@command -v cargo >/dev/null || { echo "cargo is missing: install a Rust toolchain, see https://rustup.rs" >&2; exit 1; }
	@command -v $(PYTHON) >/dev/null || { echo "$(PYTHON) is missing: install Python 3.11 or newer, or name one: make PYTHON=…" >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "$(PYTHON) is older than 3.11; name a newer one: make PYTHON=…" >&2; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { echo "$(PYTHON) cannot make virtual environments with pip: install its venv package (Debian, Ubuntu: python3-venv)" >&2; exit 1; }
	@echo "Making $(VENV) with maturin, numpy, xarray, matplotlib and zarr: some 20 seconds."
	$(PYTHON) -m venv $(VENV)
	$(PIP) --upgrade 'pip>=25.1'
	$(PIP) --group run
	@touch $@

# Beside them, what tests and checks need.
$(VENV)/test-ready: $(VENV)/ready
	@echo "Installing what the tests need: some 30 seconds."
	$(PIP) --group test
	@touch $@

# The tools of the documentation.
$(VENV)/site-ready: $(VENV)/test-ready
	$(PIP) --group site
	@touch $@

# What links a wheel for old machines.
$(VENV)/wheels-ready: $(VENV)/ready
	$(PIP) --group wheels
	@touch $@

# The package, in the profile of tests or in that which ships: one of them is installed. The stamp is as old as the start of the build:
# what changes meanwhile is built the next time.
define install # PROFILE, OTHER STAMP
	@touch $@.begun
	@rm -f $(2)
	rm -rf target/wheels/chaindrive-*.whl
	@# The library of functional mock-up units; with the bindings, so that both are of the same compiled crates.
	cargo build --profile $(1) --quiet -p chaindrive-python -p chaindrive-fmu
	mkdir -p python/chaindrive/library
	cp target/$(1)/$(FMU_LIBRARY) python/chaindrive/library/
	$(BIN)/maturin build --profile $(1) --quiet --out target/wheels
	$(PIP) --force-reinstall --no-deps target/wheels/chaindrive-*.whl
	@mv $@.begun $@
endef

$(VENV)/installed: $(VENV)/ready $(SOURCES)
	@echo "Building the core: some three minutes on two cores the first time, and what changed later on."
	$(call install,quick,$(VENV)/shipped)

$(VENV)/shipped: $(VENV)/ready $(SOURCES)
	@echo "Building the core as it ships: some six minutes on two cores the first time, and what changed later on."
	$(call install,release,$(VENV)/installed)
