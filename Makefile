# The front door. On a fresh Debian 12 each of these does its own set-up first.
MAKEFLAGS += --no-print-directory
SHELL := /bin/bash
TEST_JOBS ?= 2
STABILITY_OUT ?= stability.md

.DEFAULT_GOAL := build
.PHONY: build test demo chart ladder bench stability stability-table torture asan tsan fuzz format check-format tidy setup clean help

build: build-release ## Build everything, optimised, in build/release (the default)

test: build-release ## Build, then run all tests
	@ctest --preset release -j$(TEST_JOBS)

demo: build/release/.configured ## Run the paper's sweep with a real server and client (1 minute)
	@cmake --build build/release --target ballpiston ballpistond
	@scripts/demo.sh build/release/bin

chart: build/release/.configured ## Chart speed against accuracy for every method, on this machine (1 minute)
	@cmake --build build/release --target ballpiston ballpistond
	@scripts/chart.sh build/release/bin

ladder: build/release/.configured ## Ask a dozen questions: planned and measured cost and error, on this machine (1 minute)
	@cmake --build build/release --target ballpiston ballpistond
	@scripts/ladder.sh build/release/bin

bench: build-release ## Build, then run the benchmarks on one core
	@scripts/bench.sh build/release/bin

stability: build/release/.configured ## Count where methods fail, and which do; write STABILITY_OUT, by default stability.md (10 minutes)
	@cmake --build build/release --target stability
	@build/release/bin/stability --out '$(STABILITY_OUT)'

stability-table: build/release/.configured ## The same, written into core/README.md (10 minutes)
	@cmake --build build/release --target stability
	@build/release/bin/stability --into core/README.md

torture: build/release/.configured ## Cut the power, kill the server a thousand times, cut its watches, stall its readers; print what was counted (half an hour)
	@cmake --build build/release --target ballpistond store_fault_test torture_test
	@BALLPISTON_TORTURE=1 build/release/bin/store_fault_test --gtest_brief=1
	@BALLPISTON_TORTURE=1 build/release/bin/torture_test --gtest_brief=1

asan: build-asan ## Run the fast tests under the address and undefined-behaviour sanitizers
	@ctest --preset asan -j$(TEST_JOBS)

# gRPC is not instrumented: tests/sanitizer tells of what it orders.
tsan: build-tsan ## Run the fast tests under the thread sanitizer
	@ctest --preset tsan -j$(TEST_JOBS)

fuzz: ## Run libFuzzer over every reader of requests, stored bytes and answers; FUZZ_RUNS a target
	@scripts/setup.sh clang libclang-rt-14-dev
	@$(MAKE) build-fuzz
	@scripts/fuzz.sh build/fuzz/bin

format: ## Format all C++ and proto files
	@scripts/format.sh

check-format: ## Say which lines are not formatted
	@scripts/format.sh --check

tidy: build-release ## Run clang-tidy over the project's sources
	@scripts/setup.sh clang-tidy
	@run-clang-tidy -quiet -p build/release '$(CURDIR)/(core|server|client|tests|tools)/' 2>/dev/null

clean: ## Remove everything that was built, and the output of demo, chart and stability
	@rm -rf build demo chart stability.md

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-15s %s\n", $$1, $$2}' Makefile

setup: ## Install the Debian packages that are missing
	@scripts/setup.sh

# `make build-PRESET` builds a preset of CMakePresets.json.
PRESETS := release asan tsan fuzz
.PHONY: $(PRESETS:%=build-%)
$(PRESETS:%=build-%): build-%: build/%/.configured
	@cmake --build --preset $*

$(PRESETS:%=build/%/.configured): build/%/.configured: CMakePresets.json | setup
	@mkdir -p build/$*
	@cmake --preset $* >build/$*/configure.log 2>&1 || { cat build/$*/configure.log; exit 1; }
	@touch $@
