# Commands for developers: `make` lists them. Nearly all of them run cargo.

.DEFAULT_GOAL := help
.PHONY: $(shell sed -n 's/^\([a-z-]*\):.*/\1/p' $(MAKEFILE_LIST))

help: ## List these commands
	@sed -n 's/^\([a-z-]*\):[^#]*## \(.*\)/\1|\2/p' $(MAKEFILE_LIST) | \
		while IFS='|' read -r name what; do printf 'make %-15s %s\n' "$$name" "$$what"; done

# Every test target of the workspace is in one of the two lists; `tests/architecture.rs` checks that.
QUICK = architecture comparison fuzz images io memory memory_of_documents options oracle pixel recorded render shaders translation turntable
SLOW = batch browser cli features jue laws models photographs python webgl workflow

test: tools ## Check formatting and run the quick tests
	cargo fmt --all --check
	cargo test --workspace --lib --bins $(addprefix --test ,$(QUICK))

test-slow: tools ## Check lints, documentation and features, and run the other tests: with `make test`, all that CI runs
	cargo clippy --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --workspace
	cargo test --workspace $(addprefix --test ,$(SLOW))
	cargo test --workspace --doc
	$(MAKE) features
	@if $(MAKE) --no-print-directory $(SITE)/venv/ready; then $(MAKE) --no-print-directory site-check; else \
	echo "Install Python 3.10 or later with venv: without Sphinx the pages are not checked." >&2; test "$$CI" != true; fi

# `campaign` also checks other combinations.
features: ## Check the library and the command without their cargo features
	cargo check -p taotie --no-default-features
	cargo check -p taotie-cli --no-default-features

campaign: tools ## Run the tests that take minutes each, in release builds; see also faults, fuzz, memory, brute-force and same-bytes
	cargo test -p taotie-io --no-default-features --config "profile.dev.package.taotie-io.opt-level=0" --test features
	cargo check -p taotie --no-default-features --features basis,exr,fbx
	cargo check -p taotie --no-default-features --features avif,draco,webp
	cargo test --release --workspace --lib --bins --tests -- --ignored

# TAOTIE=/path/to/taotie uses that program instead of building one; FAULTS contains options, such as `--rounds 10`.
faults: ## Kill commands at work, hundreds of times: files must be all old or all new
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	python3 benches/faults/faults.py $(if $(TAOTIE),--taotie $(TAOTIE)) $(FAULTS)

# The models are those of the tests, ../shared/data or TAOTIE_DATA, and generated ones. TAOTIE=/path/to/taotie uses that
# program instead of building one; MEMORY contains options, such as `--only ply`.
memory: ## Compare the estimated with the actual memory of commands, for docs/security.md
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	python3 benches/memory/memory.py $(if $(TAOTIE),--taotie $(TAOTIE)) $(MEMORY)

# The peers are installed into target/bench-*/venv; those that cannot be installed here are skipped with a message. Blender
# is a Python package for Python 3.11. TAOTIE_BIN=/folder/of/programs uses `taotie` and `frames` from there instead of
# building them; BENCH contains options: `make bench BENCH=--help` lists them, `make bench BENCH='--only bake -- --help'`
# those of a part.
BENCHED = $(or $(TAOTIE_BIN),target/release)
COMPARE = PYTHONPATH=benches/common python3 benches/bench.py --programs $(abspath $(BENCHED))
PYTHON = $(shell command -v python3.11 || echo python3)
bench: programs ## Compare with other programs, for docs/benchmarks.md; BENCH=--quick prints a few comparisons
	$(COMPARE) $(BENCH)

programs:
	$(if $(TAOTIE_BIN),,cargo build --release -p taotie-cli && cargo build --release -p taotie --example frames)

# TAOTIE=/path/to/taotie uses that program instead of building one.
BENCH_VENV = target/bench-bake/venv
bench-maps: $(BENCH_VENV)/ready ## Compare maps of Taotie with Blender's and with rays by Embree, for docs/benchmarks.md
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	PYTHONPATH=benches/common $(BENCH_VENV)/bin/python benches/bake/maps.py $(if $(TAOTIE),--taotie $(TAOTIE)) $(BENCH)

$(BENCH_VENV)/ready: benches/bake/requirements.txt
	$(PYTHON) -m venv $(BENCH_VENV)
	$(BENCH_VENV)/bin/pip install --quiet --requirement $< || \
	{ grep -v '^bpy' $< >$(BENCH_VENV)/others.txt && $(BENCH_VENV)/bin/pip install --quiet --requirement $(BENCH_VENV)/others.txt; }
	touch $@

target/bench-render/venv/ready: benches/render/requirements.txt benches/render/install.sh
	sh benches/render/install.sh $(PYTHON) $(@D)
	touch $@

target/bench-%/venv/ready: benches/%/requirements.txt
	$(PYTHON) -m venv $(@D)
	$(@D)/bin/pip install --quiet --requirement $<
	touch $@

# LLVM fuses products and sums wherever it finds them, which Rust itself never does.
FUSED = RUSTFLAGS="-C llvm-args=-fp-contract=fast" cargo build --release --target-dir target/fused
bench-fma: programs ## Measure the cost of reproducible bits: the same programs with fused multiply-add
	$(FUSED) -p taotie --example frames
	$(COMPARE) --only render -- --peer none --cold-rounds 0 --also $(abspath target/fused/release) $(BENCH)

bench-stages: ## Measure milliseconds per stage of the renderer, and the arithmetic and texel loads of a pixel
	cargo bench -p taotie --bench stages --bench floor

bench-gpu: ## Measure frames per second and bakes on the GPU and the CPU; BENCH=--quick: fewer
	cargo run --release -p taotie-gpu --example gpu_frames -- $(BENCH)
	cargo run --release -p taotie-gpu --example gpu_bakes -- $(BENCH)

# The baseline is in target/bench-check/base. BASE=REV builds a revision other than the latest tag; BASE_BIN and TAOTIE_BIN
# name folders with the old and the new `taotie` and `frames`; `make bench-check BENCH=--help` lists the options.
CHECK = target/bench-check
bench-check: programs target/bench-scaling/venv/ready ## Fail if a short set is slower than the baseline by more than 5 %
	PYTHONPATH=benches/common:benches/render:benches/bake target/bench-scaling/venv/bin/python benches/check/check.py \
		--programs $(BENCHED) $(if $(BASE_BIN),--base $(BASE_BIN)) $(BENCH)

BASE = $(shell git describe --tags --abbrev=0 2>/dev/null)
bench-store: ## Build the baseline of make bench-check: the latest tag, or BASE=REV
	@test -n "$(BASE)" || { echo "No tag found; specify a revision: make bench-store BASE=REV" >&2; exit 1; }
	test ! -e $(CHECK)/source || git worktree remove --force $(CHECK)/source
	git worktree add --force --detach $(CHECK)/source $(BASE)
	cd $(CHECK)/source && cargo build --release --target-dir ../build -p taotie-cli
	cd $(CHECK)/source && cargo build --release --target-dir ../build -p taotie --example frames
	mkdir -p $(CHECK)/base
	cp $(CHECK)/build/release/taotie $(CHECK)/build/release/examples/frames $(CHECK)/base
	git worktree remove --force $(CHECK)/source

brute-force: ## Compare the search for the smallest asset with a grid of all combinations, for SCANS="a.obj b.glb"; takes minutes
	SCANS="$(SCANS)" cargo test -p taotie --lib brute -- --ignored --nocapture

# PROGRAMS lists them; the others are compared with the first. BENCH="--models 300000" takes all models of up to 300,000 triangles:
# make same-bytes PROGRAMS="x86=target/release/taotie 'arm64=qemu-aarch64 -L /usr/aarch64-linux-gnu TAOTIE'"
same-bytes: ## Compare the files of programs for different processors and systems; takes minutes, an hour under emulation
	PYTHONPATH=benches/common python3 benches/machines/machines.py $(PROGRAMS) $(BENCH)

# The other tools come from npm. TAOTIE=/path/to/taotie uses that program instead of building one; the models are those of the
# tests, ../shared/data or TAOTIE_DATA. Takes hours, and resumes after an interruption; BENCH=--check takes minutes and fails
# if Taotie's assets are too large. `make bench-sizes BENCH=--help` lists the options.
SIZES = target/bench-sizes
bench-sizes: $(SIZES)/ready ## Compare bytes, degrees and ΔE of assets by Taotie, gltf-transform and gltfpack, for docs/sizes.md
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	PYTHONPATH=benches/common $(SIZES)/venv/bin/python benches/sizes/bench.py $(if $(TAOTIE),--taotie $(TAOTIE)) $(BENCH)

$(SIZES)/ready: $(addprefix benches/sizes/,requirements.txt package.json package-lock.json)
	$(PYTHON) -m venv $(SIZES)/venv
	$(SIZES)/venv/bin/pip install --quiet --requirement $<
	mkdir -p $(SIZES)/node && cp benches/sizes/package.json benches/sizes/package-lock.json $(SIZES)/node
	$(INSTALL) $(SIZES)/node
	touch $@

# Blender is a Python package for Python 3.11; without it, its rows report that it is absent. Assets and proofs are kept in
# target/proofs-table/made, so an interrupted run resumes. `make proofs-table BENCH=--help` lists the options.
proofs-table: $(SIZES)/ready $(BENCH_VENV)/ready ## Prove six scans reduced by Taotie and by other programs, for docs/proofs.md
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	PYTHONPATH=benches/common $(BENCH_VENV)/bin/python benches/proofs/bench.py $(if $(TAOTIE),--taotie $(TAOTIE)) $(BENCH)

# SCANS lists the scans: self-contained files. TAOTIE=/path/to/taotie uses that program instead of building one.
DISTANCES_VENV = target/bench-distances/venv
bench-distances: $(DISTANCES_VENV)/ready ## Compare distance bounds with two million points by Embree; SCANS="FILE ..."
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	$(DISTANCES_VENV)/bin/python benches/distances/check.py $(if $(TAOTIE),--taotie $(TAOTIE)) $(SCANS)

# TAOTIE=/path/to/taotie makes the pictures of the gallery and the viewer's page; by default a release build, if there is
# one. Each command runs once until it or the program changes. The newest wheel of `make wheel` runs the notebooks.
SITE = target/site
SPHINX = $(SITE)/venv/bin/sphinx-build --quiet --fail-on-warning --keep-going --fresh-env --write-all --jobs auto -c site
site: $(SITE)/venv/ready ## Build the docs site into target/site/html; it opens from disk
	for wheel in $$(ls -t target/wheels/taotie-*.whl 2>/dev/null | head -1); do \
		$(SITE)/venv/bin/pip install --quiet --force-reinstall --no-deps $$wheel; done
	$(SITE)/venv/bin/python site/stage.py $(addprefix --program ,$(or $(TAOTIE),$(wildcard target/release/taotie)))
	rm -rf $(SITE)/html
	$(SPHINX) -b html -d $(SITE)/trees $(SITE)/source $(SITE)/html

# Reads all pages without the program or the Python package: a broken link or anchor, and a page missing from the
# contents, is an error.
SPELLED = docs README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md SECURITY.md python viewer/src site
site-check: $(SITE)/venv/ready ## Check links, anchors and spelling of the pages
	$(SITE)/venv/bin/codespell --ignore-words site/spelling.txt $$(git ls-files $(SPELLED) | grep -vE '[.](png|svg)$$')
	$(SITE)/venv/bin/python site/stage.py --check $(SITE)/check/source
	$(SPHINX) -b dummy -t check -d $(SITE)/check/trees $(SITE)/check/source $(SITE)/check/out

# TAOTIE=/path/to/taotie uses that program instead of building one; the models are those of the tests.
site-tutorials: ## Run every command of the tutorials; takes minutes
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	python3 site/tutorials.py --program $(or $(TAOTIE),target/release/taotie)

site-links: $(SITE)/venv/ready ## Check links to other sites
	$(SITE)/venv/bin/python site/stage.py --check $(SITE)/check/source
	$(SPHINX) -b linkcheck -t check -d $(SITE)/check/trees $(SITE)/check/source $(SITE)/check/links

$(SITE)/venv/ready: site/requirements.txt
	$(PYTHON) -m venv $(SITE)/venv
	$(SITE)/venv/bin/pip install --quiet --requirement $<
	touch $@

docs: ## Regenerate docs/help, and the tables and images of docs/as-printed.md
	cargo run --release -p xtask -- help-pages
	cargo run --release -p xtask -- as-printed

errors: ## Measure every approximation again for docs/errors.md; ENVIRONMENTS=FOLDER also under its .hdr and .exr files
	cargo run --release -p xtask -- errors $(if $(ENVIRONMENTS),--environments $(ENVIRONMENTS))

# The tests need Blender, a Python package for Python 3.11 (docs/blender.md); with another version they are skipped.
# TAOTIE=/path/to/taotie is the program of the tests instead of a new one.
BLENDER = target/blender
blender: ## Pack the add-on for Blender into target/blender, and test it in Blender
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	$(PYTHON) blender/pack.py $(BLENDER)/taotie-blender.zip
	TAOTIE=$(or $(TAOTIE),$(CURDIR)/target/release/taotie) sh blender/test.sh $(PYTHON) $(BLENDER)/venv

blender-picture: blender ## Render the picture of docs/blender.md
	$(BLENDER)/venv/bin/python blender/picture.py $(or $(TAOTIE),target/release/taotie) $(BLENDER)/taotie-blender.zip docs/images/blender.png

# The models are those of the tests; MODELS lists other folders, TAOTIE another program.
MODELS = $(wildcard $(addprefix $(or $(TAOTIE_DATA),../shared/data)/,khronos-gltf-sample-assets polyhaven-models materialx gltf-asset-generator))
asset-table: ## Bake every shared glTF model, for docs/assets-table.md; MODELS="FOLDER ..." others
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	cargo run --release -p xtask -- asset-table --models $(MODELS) $(if $(TAOTIE),--program $(TAOTIE))

tables: ## Recompute the tables of directional albedos
	cargo run --release -p xtask -- tables

viewer: viewer/node_modules/esbuild ## Check the types of the viewer's script and rebuild it
	cd viewer && npm run --silent check && npm run --silent build

viewer/node_modules/esbuild: viewer/package-lock.json
	$(INSTALL) viewer

# These three need the command as WebAssembly: that of `make wasm`, or TAOTIE_WASM=/path/to/taotie.wasm.
npm: viewer/node_modules/esbuild npm/taotie-wasm/node_modules/esbuild ## Build the npm packages into target/npm
	mkdir -p target/npm
	cp dist/licences/three.txt viewer/LICENSE-three
	for folder in viewer npm/taotie-wasm npm/taotie; do cp LICENSE-* $$folder && (cd $$folder && npm pack --silent --pack-destination $(CURDIR)/target/npm) || exit; done

web: npm/taotie-wasm/node_modules/esbuild ## Build the page that bakes in the browser into target/web
	npm/taotie-wasm/node_modules/.bin/tsc --noEmit --project web
	node web/build.mjs

npm/taotie-wasm/node_modules/esbuild: npm/taotie-wasm/package-lock.json
	$(INSTALL) npm/taotie-wasm

# TAOTIE is a release build of the same sources; without it, it is built.
WASM = $(or $(TAOTIE_WASM),target/wasm/taotie.wasm)
test-web: ## Test the npm package in Node and the page in Chromium and Firefox against the native program
	@if test ! -f $(WASM); then echo "skipped: no $(WASM)"; else $(MAKE) --no-print-directory tested-web; fi

tested-web: export TAOTIE := $(or $(TAOTIE),$(CURDIR)/target/release/taotie)
tested-web: export FOLDER := $(CURDIR)/target/tmp/web
tested-web: npm web
	test -x $(TAOTIE) || cargo build --release -p taotie-cli
	mkdir -p $(FOLDER)
	node --test npm/taotie-wasm/test/package.test.mjs
	cd tests/browser && BROWSER=$${BROWSER:-$$(command -v $(BROWSERS) | head -1)} node --test try.test.mjs
	cd tests/browser && BROWSER=$$(command -v $(FIREFOX) | head -1) xvfb-run --auto-servernum node --test try.test.mjs

shaders: ## Regenerate the shaders in docs/shaders
	cargo run --release -p xtask -- shaders

schemas: ## Regenerate the JSON Schemas in docs/schemas
	cargo run --release -p xtask -- schemas

shader-errors: ## Measure shaders at random points, lavapipe and Chromium against f64, for docs/shaders.md
	cargo run --release -p xtask -- shader-errors

security: ## Regenerate the tables of docs/security.md
	cargo run --release -p xtask -- security

# Findings go to crates/taotie-fuzz/findings, counts to its totals.json; FUZZ contains options, `make fuzz FUZZ=--help` lists them.
TIME = 60
fuzz: ## Damage and read files for TIME seconds: docs/security.md; MODELS=FOLDER adds files
	cargo run --release -p taotie-fuzz -- run --time $(TIME) --totals crates/taotie-fuzz/totals.json \
		$(if $(MODELS),--models $(MODELS)) $(FUZZ)

# The extension is built with the profile of the tests. Its dependencies have fewer features, so the library is compiled again.
PYTHON_VENV = target/python
python: $(PYTHON_VENV)/ready ## Build the Python package into target/python, and run its tests and type checkers
	VIRTUAL_ENV=$(CURDIR)/$(PYTHON_VENV) $(PYTHON_VENV)/bin/maturin develop --profile dev --quiet
	$(PYTHON_VENV)/bin/python -m pytest
	$(PYTHON_VENV)/bin/python -m pytest tests/dist
	$(PYTHON_VENV)/bin/python -m pytest tests/benches
	$(PYTHON_VENV)/bin/mypy
	$(PYTHON_VENV)/bin/mypy python/tests/typed.py
	$(PYTHON_VENV)/bin/pyright --pythonpath $(PYTHON_VENV)/bin/python
	cd python && MYPYPATH=. ../$(PYTHON_VENV)/bin/stubtest taotie._taotie

$(PYTHON_VENV)/ready: python/requirements.txt python/tests/requirements.txt
	$(PYTHON) -m venv $(PYTHON_VENV)
	$(PYTHON_VENV)/bin/pip install --quiet --requirement $<
	touch $@

wheel: $(PYTHON_VENV)/ready ## Build a wheel for this machine into target/wheels
	$(PYTHON_VENV)/bin/maturin build --release

# TARGETS lists triples, or is `all`; targets that cannot be linked here are only checked. The date of all files is SOURCE_DATE_EPOCH
# or that of the commit.
DIST_VENV = target/dist-build/venv
dist: $(DIST_VENV)/ready ## Build programs and wheels for others into target/dist, for this machine or TARGETS: docs/install.md
	$(DIST_VENV)/bin/python dist/build.py $(TARGETS)

wasm: $(DIST_VENV)/ready npm/taotie-wasm/node_modules/esbuild ## Build the command for WebAssembly into target/wasm
	$(DIST_VENV)/bin/python dist/wasm.py

$(DIST_VENV)/ready: dist/requirements.txt
	$(PYTHON) -m venv $(DIST_VENV)
	$(DIST_VENV)/bin/pip install --quiet --requirement $<
	touch $@

# MODEL is a PLY scan. Each package gets a separate environment below target/bench-python, several gigabytes in total.
bench-python: wheel ## Time the first image of a scan by Taotie and other Python packages, for docs/python.md; MODEL=scan.ply
	PYTHONPATH=benches/common $(PYTHON_VENV)/bin/python benches/python/bench.py \
		--wheel "$$(ls -t target/wheels/taotie-*.whl | head -1)" --model $(MODEL) $(BENCH)

# MODEL is a GLB without packed geometry, BROWSER the browser.
bench-viewer: benches/viewer/node_modules/three ## Compare a page of taotie view with three.js and model-viewer, for docs/view.md; MODEL=asset.glb
	mkdir -p target/bench-viewer
	$(if $(TAOTIE),,cargo build --release -p taotie-cli)
	$(or $(TAOTIE),target/release/taotie) view $(MODEL) --samples 1 -o target/bench-viewer/page.html
	BROWSER=$${BROWSER:-$$(command -v chromium)} FOLDER=target/bench-viewer \
		node benches/viewer/bench.mjs $(MODEL) target/bench-viewer/page.html

benches/viewer/node_modules/three: benches/viewer/package-lock.json
	$(INSTALL) benches/viewer

bless: ## Accept the current images and outputs as correct; review the difference before committing
	TAOTIE_BLESS=1 cargo test -p taotie --test render golden::
	TAOTIE_BLESS=1 cargo test -p taotie --test architecture public_names
	SNAPSHOTS=overwrite cargo test -p taotie-cli --test cli

# Installs the requirements of the tests other than cargo: parts of the toolchain, browsers for pages and three.js,
# npm packages that drive them and that check glTF, a Vulkan driver (Mesa's needs no GPU), and the modules that the
# tests of the Python package import. `BROWSER=/path/to/chrome` specifies a browser elsewhere.
PACKAGES = tests/validator/node_modules/@gltf-transform/cli tests/browser/node_modules/@google/model-viewer viewer/node_modules/esbuild
INSTALL = npm ci --no-audit --no-fund --prefix
BROWSERS = chromium chromium-browser google-chrome google-chrome-stable
FIREFOX = firefox-esr firefox
DRIVERS = $(addsuffix /vulkan/icd.d/*.json,/usr/share /usr/local/share /etc /run/opengl-driver/share)
tools:
	@cargo fmt --version >/dev/null 2>&1 || rustup component add rustfmt
	@cargo clippy --version >/dev/null 2>&1 || rustup component add clippy
	@for name in $(BROWSERS); do command -v $$name >/dev/null && exit; done; \
	test -x "$$BROWSER" || $(MAKE) --no-print-directory browser
	@test "$$(uname)" != Linux || for name in $(FIREFOX); do command -v $$name >/dev/null && command -v xvfb-run >/dev/null && exit; done || \
	$(MAKE) --no-print-directory firefox
	@command -v jq >/dev/null || $(MAKE) --no-print-directory jq
	@for folder in $(PACKAGES); do test -d $$folder || exec $(MAKE) --no-print-directory packages; done
	@test "$$(uname)" != Linux || test -n "$(wildcard $(DRIVERS))$$VK_DRIVER_FILES$$VK_ICD_FILENAMES" || \
	$(MAKE) --no-print-directory vulkan
	@test target/python-tests/ready -nt python/tests/requirements.txt || $(MAKE) --no-print-directory python-tests

.PHONY: python-tests
python-tests:
	@as=$$(test "$$(id -u)" = 0 || echo sudo); venv="$(PYTHON) -m venv target/python-tests"; \
	{ $$venv || { $$as apt-get update && $$as apt-get install -y python3-venv && $$venv; }; } >/dev/null && \
	target/python-tests/bin/pip install --quiet --requirement python/tests/requirements.txt && \
	touch target/python-tests/ready || \
	echo "Install Python 3.10 or later with venv: without it the tests of the Python package are skipped." >&2

.PHONY: browser
browser:
	@as=$$(test "$$(id -u)" = 0 || echo sudo); \
	{ command -v apt-get && $$as apt-get update && $$as apt-get install -y chromium; } >/dev/null || \
	echo "Install Chromium or Chrome, or specify it in BROWSER: without it the tests of report pages and three.js are skipped." >&2

# Its WebGL needs Mesa and a screen, which Xvfb provides.
.PHONY: firefox
firefox:
	@as=$$(test "$$(id -u)" = 0 || echo sudo); packages="firefox-esr xvfb xauth libegl1 libgl1-mesa-dri libpci3"; \
	{ command -v apt-get && $$as apt-get update && $$as apt-get install -y $$packages; } >/dev/null || \
	echo "Install Firefox and xvfb-run: without them the tests of the viewer in Firefox are skipped." >&2

.PHONY: vulkan
jq:
	@as=$$(test "$$(id -u)" = 0 || echo sudo); \
	{ command -v apt-get && $$as apt-get update && $$as apt-get install -y jq; } >/dev/null || \
	echo "Install jq: without it the examples of docs/json.md are not tested." >&2

vulkan:
	@as=$$(test "$$(id -u)" = 0 || echo sudo); \
	{ command -v apt-get && $$as apt-get update && $$as apt-get install -y mesa-vulkan-drivers; } >/dev/null || \
	echo "Install a Vulkan driver, such as Mesa's: without one the tests of GPU rendering are skipped." >&2

.PHONY: packages
packages:
	@{ command -v npm && $(INSTALL) tests/validator && $(INSTALL) tests/browser && $(INSTALL) viewer; } >/dev/null || \
	echo "Install node and npm: without them the tests of the Khronos validator, report pages and three.js are skipped." >&2
