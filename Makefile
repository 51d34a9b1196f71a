# The main commands. On a fresh Debian 12 each command first installs the packages that it needs.
MAKEFLAGS += --no-print-directory
SHELL := /bin/bash
TEST_JOBS ?= $(shell nproc)
# The prefix ci- selects the same presets with warnings as errors.
PRESETS_PREFIX ?=
STABILITY_OUT ?= stability.md
MUTANTS ?= 60
QUESTIONS ?= 20000
SIMULATION_SECONDS ?= 3600

TEST_PACKAGES := libgtest-dev libgmock-dev libbenchmark-dev python3-grpcio python3-numpy python3-pandas python3-pytest python3-tqdm python3-matplotlib \
  python3-setuptools python3-wheel python3-venv mypy
AARCH64_PACKAGES := g++-aarch64-linux-gnu qemu-user libabsl-dev:arm64 libhwy-dev:arm64 libgtest-dev:arm64 libgmock-dev:arm64
SLURM_PACKAGES := munge slurmctld slurmd slurm-client procps
DOCS_PACKAGES := doxygen furo python3-breathe python3-myst-parser python3-sphinx
NOTEBOOK_PACKAGES := python3-nbconvert python3-ipykernel
DEB_PACKAGES := $(DOCS_PACKAGES) build-essential debhelper dh-python help2man lintian
WEB_PACKAGES = chromium $(shell command -v npm >/dev/null || echo nodejs npm)
PROGRAMS := ballpiston ballpiston-web ballpistond ballpiston-worker conductivity method_comparison slow_pistons stability pages python_package

.DEFAULT_GOAL := build
.NOTPARALLEL:  # each step is parallel by itself, and two configure the same folder
.PHONY: build test check test-asan test-tsan test-long demo docs tutorials chart ladder bench conductivity stability stability-table torture test-slurm test-alerts test-web mutation questions deb oci aarch64 fuzz simulation thread-safety nightly format check-format tidy setup clean help

build: build/release/.$(PRESETS_PREFIX)programs ## Build the programs, optimised, in build/release/bin (the default)
	@cmake --build build/release --target $(PROGRAMS)

test: build/release/.$(PRESETS_PREFIX)tests ## Build, then run all tests
	@cmake --build build/release --target fast_tests slow_tests
	@rm -rf build/release/test-times  # reports of test programs that do not exist any more
	@ctest --preset release -j$(TEST_JOBS)

check: ## What every change has to pass: format, locks, test, and the fast tests under the sanitizers
	@for step in check-format thread-safety test test-asan; do \
	  printf '\n== [%d min %02d s] make %s\n' $$((SECONDS / 60)) $$((SECONDS % 60)) $$step; \
	  $(MAKE) $$step || exit 1; \
	done

test-asan: ## Run the fast tests under the address and undefined-behaviour sanitizers
test-tsan: ## Run the fast tests under the thread sanitizer
# gRPC is not instrumented: tests/sanitizer tells the thread sanitizer how gRPC orders accesses.
test-asan test-tsan: test-%: build/%/.$(PRESETS_PREFIX)tests
	@cmake --build build/$* --target fast_tests
	@ctest --preset $* -j$(TEST_JOBS)

test-long: build/release/.$(PRESETS_PREFIX)tests ## Run the tests of laws and bits at their full size (15 minutes)
	@cmake --build build/release --target statistical_test core_test conductivity_test server_test
	@BALLPISTON_NIGHTLY=1 ctest --preset release -R '^(statistical|core|conductivity|server)_test' -j$(TEST_JOBS)

demo: build ## Run the paper's sweep with a real server and client
	@scripts/demo.sh build/release/bin

docs: ## Build the site of all pages, tutorials and interfaces in build/docs/html, and check its links (1 minute)
	@scripts/setup.sh $(DOCS_PACKAGES)
	@docs/site/build_site.py build/docs

tutorials: build ## Run the notebooks of client/examples/python again and store their output in them (1 minute)
	@scripts/setup.sh $(NOTEBOOK_PACKAGES)
	@scripts/tutorials.sh build/release/bin build/release/python

chart: build ## Chart speed against accuracy for every method, on this machine (2 minutes)
	@scripts/chart.sh build/release/bin

ladder: build ## Compare planned and measured cost and error of a dozen specifications, on this machine (1 minute)
	@scripts/ladder.sh build/release/bin

bench: build/release/.$(PRESETS_PREFIX)benchmarks ## Build, then run the benchmarks on one core
	@cmake --build build/release --target benchmarks
	@scripts/bench.sh build/release/bin

stability: build/release/.$(PRESETS_PREFIX)programs ## Count the failures of all methods, measure the model errors; write STABILITY_OUT, by default stability.md (14 minutes)
	@cmake --build build/release --target stability
	@build/release/bin/stability >'$(STABILITY_OUT)'

stability-table: build/release/.$(PRESETS_PREFIX)programs ## Count the failures of all methods; write the tables into docs/stability.md (14 minutes)
	@cmake --build build/release --target stability
	@build/release/bin/stability >build/release/stability.md
	@sed -i -e '/stability:begin/r build/release/stability.md' -e '/stability:begin/,/stability:end/{//!d}' docs/stability.md

conductivity: build/release/.$(PRESETS_PREFIX)programs ## Compute the constants of the conductivity in the limit of rare collisions (1 minute)
	@cmake --build build/release --target conductivity
	@build/release/bin/conductivity

torture: build/release/.$(PRESETS_PREFIX)tests ## Kill the server a thousand times, crash it, stall its readers; print the counts (half an hour)
	@cmake --build build/release --target ballpistond torture_test
	@BALLPISTON_TORTURE=1 build/release/bin/torture_test --gtest_brief=1

test-slurm: ## Run jobs on a whole Slurm cluster that the tests start on this machine, and kill its parts
	@scripts/setup.sh $(SLURM_PACKAGES)
	@$(MAKE) build/release/.$(PRESETS_PREFIX)tests
	@cmake --build build/release --target ballpiston ballpistond slurm_test
	@build/release/bin/slurm_test --gtest_brief=1

test-alerts: ## Test the alert rules for Prometheus, with promtool
	@scripts/test-alerts.sh

test-web: build ## Test the page of ballpiston web in headless Chromium, with npm's playwright-core and axe-core (2 minutes)
	@scripts/setup.sh $(WEB_PACKAGES)
	@scripts/web-test.sh build/release/bin

questions: build/release/.$(PRESETS_PREFIX)tests ## Ask the engine and a server QUESTIONS random questions, by default 20,000, and check the answers (an hour)
	@cmake --build build/release --target questions_test
	@BALLPISTON_QUESTIONS=$(QUESTIONS) build/release/bin/questions_test --gtest_filter='Questions.*' --gtest_brief=1

mutation: ## Make MUTANTS small wrong changes, by default 60, and count those that the fast tests catch (two hours)
	@scripts/setup.sh $(TEST_PACKAGES)
	@tests/mutation/mutation.py --count $(MUTANTS)

aarch64: ## Compile the core for AArch64 and run its tests under an emulator: the results have the same bits as on x86 (15 minutes)
	@scripts/setup.sh $(AARCH64_PACKAGES)
	@$(MAKE) build/aarch64/.$(PRESETS_PREFIX)tests
	@cmake --build --preset aarch64
	@ctest --preset aarch64 -j$(TEST_JOBS)

fuzz: ## Run libFuzzer on every parser of requests, stored bytes and answers; FUZZ_RUNS runs or FUZZ_SECONDS seconds per target
	@scripts/setup.sh clang libclang-rt-14-dev
	@$(MAKE) build/fuzz/.$(PRESETS_PREFIX)tests
	@cmake --build --preset fuzz
	@scripts/fuzz.sh build/fuzz/bin

simulation: build/release/.$(PRESETS_PREFIX)tests ## Simulate the server in random worlds for SIMULATION_SECONDS, by default an hour
	@cmake --build build/release --target simulation_test
	@BALLPISTON_SIMULATION_SECONDS=$(SIMULATION_SECONDS) build/release/bin/simulation_test --gtest_filter='*EveryWorld'

deb: ## Build the Debian packages of the last commit in build/deb, and check them with lintian (5 minutes)
	@scripts/setup.sh $(DEB_PACKAGES)
	@scripts/deb.sh build/deb

oci: ## Make an image for containers of the packages that make deb built, in build/oci (2 minutes)
	@scripts/setup.sh mmdebstrap umoci
	@scripts/oci.sh build/deb build/oci

thread-safety: ## Check with Clang that the server holds the right mutexes, in their order (1 minute)
	@scripts/setup.sh clang
	@scripts/thread-safety.sh

nightly: ## Run the checks that take hours: test-tsan, test-long, aarch64, tidy, torture, test-slurm, test-alerts, test-web, docs, stability, mutation, questions, simulation, and ten minutes of each fuzz target
	@status=0; for task in test-tsan test-long aarch64 tidy torture test-slurm test-alerts test-web docs stability mutation questions simulation "fuzz FUZZ_SECONDS=600"; do \
	  printf '\n== make %s\n' "$$task"; $(MAKE) $$task || { status=1; failed+=" $${task%% *}"; }; \
	done; echo "nightly: failed:$${failed:- none}"; exit $$status

format: ## Format all C++ and proto files
	@scripts/format.sh

check-format: ## Print the lines that are not formatted
	@scripts/format.sh --check

tidy: ## Compile every file alone with Clang and warnings as errors, and run clang-tidy on all files
	@scripts/setup.sh clang clang-tidy
	@$(MAKE) build/single/.$(PRESETS_PREFIX)tests
	@cmake --build --preset single
	@run-clang-tidy -quiet -p build/single '$(CURDIR)/(core|server|client|tests|tools)/' \
	  >build/single/tidy.log 2>&1 || { cat build/single/tidy.log; exit 1; }

clean: ## Remove everything that was built, and the output of demo, chart and stability
	@rm -rf build demo chart '$(STABILITY_OUT)'

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / {printf "  make %-15s %s\n", $$1, $$2}' Makefile

setup: ## Install the Debian packages that are missing
	@scripts/setup.sh

# Stamps in build/PRESET: .programs if the preset is configured, perhaps without the tests; .tests if it
# is configured with the tests; .benchmarks if with tests and benchmarks. The prefix of the presets is
# part of a stamp's name: each prefix configures again. A failed attempt leaves no stamp.
configure = mkdir -p $(@D); \
  rm -f $(foreach prefix,'' ci-,$(foreach stamp,programs tests benchmarks,$(@D)/.$(prefix)$(stamp))); \
  cmake --preset $(PRESETS_PREFIX)$(*) $(1) >$(@D)/configure.log 2>&1 \
  || { cat $(@D)/configure.log; exit 1; }

build/%/.$(PRESETS_PREFIX)programs: CMakePresets.json | setup
	@$(call configure,-DBALLPISTON_TESTS=OFF)
	@touch $@

build/%/.$(PRESETS_PREFIX)tests: CMakePresets.json | setup
	@scripts/setup.sh $(TEST_PACKAGES)
	@$(call configure,-DBALLPISTON_TESTS=ON)
	@touch $(@D)/.$(PRESETS_PREFIX)programs $@

build/%/.$(PRESETS_PREFIX)benchmarks: CMakePresets.json | setup
	@scripts/setup.sh $(TEST_PACKAGES)
	@$(call configure,-DBALLPISTON_TESTS=ON -DBALLPISTON_BENCHMARKS=ON)
	@touch $(@D)/.$(PRESETS_PREFIX)programs $(@D)/.$(PRESETS_PREFIX)tests $@
