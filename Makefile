# One command each, on a fresh machine with Python 3.11 or newer: the set-up happens by itself.
.DEFAULT_GOAL := help
.PHONY: help demo test browser-test check docs tree picture bench bench-quick bench-search bench-fly fly-betaflight weights hypotheses evidence bench-radio \
    bench-real bench-crowds bench-batch toolchain soak wheel-check release-check first-picture as-typed link-peers viewers clean

BIN := .venv/bin
PACKAGE := .venv/package
READY := .venv/ready
PEERS := .bench/ready
CROWDS := .bench/crowds-ready
VISP := .bench/visp
BETAFLIGHT := .bench/betaflight/betaflight
SITE_TOOLS := .venv/site-tools
PYTORCH := .venv/pytorch
TOOLCHAIN := .venv/toolchain
BROWSER := .venv/browser
RTSP := .venv/rtsp
ARGS ?=

# The programs that tests start by the hundred would compile every source again.
unexport PYTHONDONTWRITEBYTECODE

# Tests and figures must not depend on how many cores the machine has.
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1 NUMBA_NUM_THREADS=1 \
    OPENCV_FOR_THREADS_NUM=1

help:  ## say what can be made
	@grep -E '^[a-z-]+:.*  ## ' Makefile | sed -E 's/^([a-z-]+):[^#]*## /make \1\t/' | expand -t 20

demo: $(PACKAGE)  ## render a clip, track the ball in it, compare with the truth; no camera needed
	$(BIN)/matchset demo $(or $(ARGS),--frames 150)

test: $(READY) $(TOOLCHAIN) $(RTSP)  ## run the tests (ARGS="-k video" for some of them)
	$(ONE_THREAD) $(BIN)/python -m pytest -n 2 --dist worksteal --ignore tests/browser $(ARGS)

browser-test: $(READY) $(BROWSER)  ## click through the live page in Chromium, one test after the other (five minutes)
	$(ONE_THREAD) $(BIN)/python -m pytest tests/browser $(ARGS)

check: $(READY) wheel-check  ## lint, format, types, and the wheel
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(SITE_TOOLS)  ## build the documentation site in site/: guides, API, decisions, results
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	@echo "look at it: $(BIN)/python -m http.server -d site"

tree: $(READY)  ## print every file with its purpose (ARGS="src/matchset/tracking" for one folder)
	@$(BIN)/python .ci/tree.py $(ARGS)

picture: $(READY)  ## fly the chain of three and draw the animated picture of docs/flight.md (some minutes)
	$(BIN)/python docs/pictures/chain.py

viewers: .viewers/ready  ## packages of Foxglove and Rerun, which read back what --mcap and --rerun write (750 MB)

link-peers: .mavlink/ready .tello/ready  ## programs of others that the links are tested against: pymavlink, MAVSDK, djitellopy

bench: $(PEERS) $(VISP) $(BROWSER)  ## the evidence: matchset and what people use, on the same frames (30 to 45 minutes)
	$(ONE_THREAD) .bench/bin/python -m benchmarks $(ARGS)

bench-quick: $(PEERS)  ## has a change made it slower or less exact? (three minutes, four with real footage)
	$(ONE_THREAD) .bench/bin/python -m benchmarks.guard $(ARGS)

bench-real: $(PEERS)  ## real footage and times, as a user has them, against what is kept (20 minutes; ARGS="--only time --store")
	.bench/bin/python -m benchmarks.regression $(ARGS)

bench-search: $(PEERS) $(VISP)  ## search the peers' best parameters (an hour)
	$(ONE_THREAD) .bench/bin/python -m benchmarks.contest.search $(ARGS)

bench-crowds: $(CROWDS)  ## who keeps which name in a crowd of equal balls, beside the usual recipe, trackpy, norfair, ByteTrack, SORT (hours; stop it, it goes on)
	$(ONE_THREAD) .bench/bin/python -m benchmarks.crowds $(or $(ARGS),--bars -o benchmarks/CROWDS.md)

bench-batch: $(READY)  ## one and two workers of matchset batch, killed ones, many simulated (half an hour and 3 GB; ARGS="FOLDER --only speed")
	$(ONE_THREAD) $(BIN)/python -m benchmarks.batch $(or $(ARGS),.bench/batch -o benchmarks/BATCH.md)

weights: $(PYTORCH)  ## make weights of the network of discs from nothing, with PyTorch (half an hour; ARGS="FOLDER of photographs")
	$(ONE_THREAD) $(BIN)/python -m training $(or $(ARGS),../photographs)

hypotheses: $(READY)  ## fit the weights of hypotheses and of first sight again (ten minutes)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.hypotheses $(ARGS)

evidence: $(READY)  ## fit the weights of the evidence for a detection again (some minutes; ARGS="--data DIR")
	$(ONE_THREAD) $(BIN)/python -m benchmarks.evidence $(ARGS)

bench-fly: $(READY)  ## fly all rows of simulated flights in pictures (ten hours on two cores; stop it, it goes on)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.flight.fly $(ARGS)

fly-betaflight: $(READY) $(BETAFLIGHT)  ## build Betaflight and fly a follower on it, pictures and all (an hour; ARGS="--only crsf --seeds 110")
	$(ONE_THREAD) $(BIN)/python -m benchmarks.flight.betaflight.fly $(ARGS)

bench-radio: $(READY) $(TOOLCHAIN)  ## the radio's tests at full length, with their figures (2 min)
	MATCHSET_NOISE_BYTES=1000000 MATCHSET_CABLE_SECONDS=60 MATCHSET_REAL_SECONDS=60 MATCHSET_HOVER_SECONDS=30 $(ONE_THREAD) \
	    $(BIN)/python -m pytest tests/emu -rP $(ARGS)

fuzz: $(READY) $(TOOLCHAIN)  ## a thousand million bytes of noise through the firmware (2 min; ARGS="SEEDS BYTES MODE")
	nice -n 19 $$(PYTHONPATH=tests/emu $(BIN)/python -c "import toolchain; print(toolchain.host_fuzz())") \
	    $(or $(ARGS),1-300 1120000 3)
	MATCHSET_WALK_EVENTS=5 $(ONE_THREAD) nice -n 19 $(BIN)/python -m pytest -q tests/emu/test_emu_walk.py

soak: $(READY)  ## fly an hour of simulated time under random faults, check every step (an hour; ARGS="--seed 1")
	$(ONE_THREAD) $(BIN)/python -m benchmarks.soak $(ARGS)

mutants: $(READY) $(TOOLCHAIN)  ## would the tests notice? break a line at a time, write docs/mutants.md (an hour; ARGS="--jobs 2")
	$(ONE_THREAD) $(BIN)/python -m benchmarks.mutants $(ARGS)

mutants-quick: $(READY) $(TOOLCHAIN)  ## the same for twenty of them: all must be noticed (two minutes)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.mutants --quick --jobs 2 $(ARGS)

toolchain: $(READY)  ## install the compiler and the emulators that the radio's tests need (Debian, as root)
	.ci/toolchain

wheel-check: $(READY)  ## the wheel is pure Python, and all it needs has wheels for a Raspberry Pi
	$(BIN)/python .ci/wheels.py

release-check: $(READY)  ## build sdist and wheel, install each in a new virtual environment, try it there
	$(BIN)/python .ci/smoke.py

first-picture: $(PACKAGE)  ## the README's commands from `git clone` on, in an empty folder: at most 45 s of computing
	$(BIN)/python .ci/first_picture.py

as-typed: $(PACKAGE)  ## every command of the README, typed in a fresh clone (some minutes)
	$(BIN)/python .ci/as_typed.py

# Machine code of kernels is kept for all copies of the package, in the user's folder for caches: `matchset warm` says where.
clean:  ## remove everything that was made, the virtual environment included
	rm -rf .venv .bench .mavlink .tello .viewers build dist site .mypy_cache .ruff_cache .pytest_cache .hypothesis src/*.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(PACKAGE): pyproject.toml .ci/setup .ci/package.lock
	.ci/setup

$(READY): $(PACKAGE) .ci/tools .ci/requirements.lock
	.ci/tools

$(SITE_TOOLS): pyproject.toml | $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --group docs
	touch $@

$(PYTORCH): pyproject.toml | $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --group training
	touch $@

.mavlink/ready .tello/ready .viewers/ready: .%/ready: .ci/setup-% | $(READY)
	$<

$(PEERS): pyproject.toml .ci/setup-bench | $(READY)
	.ci/setup-bench

$(CROWDS): .ci/setup-crowds $(PEERS)
	.ci/setup-crowds

$(VISP): benchmarks/peers/visp_driver.cpp .ci/setup-visp $(PEERS)
	.ci/setup-visp
	touch $@

$(BETAFLIGHT): .ci/setup-betaflight benchmarks/flight/betaflight/clock.c | $(READY)
	.ci/setup-betaflight

# Made only where everything is there; otherwise looked at again next time.
$(TOOLCHAIN): $(READY) .ci/toolchain tests/emu/avr8js/package-lock.json
	.ci/toolchain

$(BROWSER): $(READY) .ci/browser
	.ci/browser

$(RTSP): $(READY) .ci/rtsp
	.ci/rtsp
