# What a developer calls: `make` lists it. All of it is cargo underneath.

.DEFAULT_GOAL := help
.PHONY: help test test-slow bench docs bless tools

help: ## This list
	@sed -n 's/^\([a-z-]*\):[^#]*## \(.*\)/\1|\2/p' $(MAKEFILE_LIST) | \
		while IFS='|' read -r name what; do printf 'make %-10s %s\n' "$$name" "$$what"; done

test: tools ## Formatting, lints, documentation and all tests but the slow ones
	cargo fmt --all --check
	cargo clippy --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --workspace
	cargo test --workspace

test-slow: ## The tests that take minutes each
	cargo test --release --workspace --lib --bins --tests -- --ignored

bench: ## Milliseconds per stage of the renderer
	cargo bench -p taotie --bench stages

docs: ## Writes docs/help anew from the command line's definition
	cargo run -p xtask -- help-pages

bless: ## Takes the pictures and outputs of today for right; look at the difference before you commit it
	TAOTIE_BLESS=1 cargo test -p taotie --test golden
	SNAPSHOTS=overwrite cargo test -p taotie-cli --test cli

# The parts of the toolchain that `make test` needs, installed where missing.
tools:
	@cargo fmt --version >/dev/null 2>&1 || rustup component add rustfmt
	@cargo clippy --version >/dev/null 2>&1 || rustup component add clippy
