# The everyday commands; `make` alone lists them. Thin on purpose: what happens is in `python -m scenarios` and `python -m reports`.
# The first command that needs Python packages sets up .venv from requirements.lock (.setup/ holds how).

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help setup compare live test docs look headline fuzz hostile soak coverage wheel check bench study report lint lock prune clean FORCE

VENV_PYTHON := .venv/bin/python
READY := .venv/set-up-stamp

# Kernels are compiled once per version of the sources, in parallel and with progress shown; later this takes half a second.
COMPILED := $(VENV_PYTHON) -m avatarsim

# The run whose report a command adds to: the last comparison or, before the first one, the command's own run.
REPORTED = $$([ -e reports/out/latest ] && echo reports/out/latest || echo reports/out/latest-$@)

# Any Python that runs at all can start the set-up, which then looks for a supported one: shims can exist and fail.
SET_UP = @for python in "$$PYTHON" python3 python3.11 python3.12 python3.13 python; do \
	  if "$$python" -c '' 2>/dev/null; then exec "$$python" .setup/choose_python.py; fi; done; \
	echo 'Set-up stopped: no working python3 was found on PATH; Python 3.11, 3.12 or 3.13 is needed.' >&2; exit 1

help:  ## this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-9s %s\n", $$1, $$2 }' Makefile

setup:  ## set up .venv and compile the kernels now (PYTHON=... names the interpreter); the other commands do it by themselves
	$(SET_UP)
	@$(COMPILED)

$(READY): requirements.lock pyproject.toml .setup/choose_python.py .setup/install.py
	$(SET_UP)

# An interpreter asked for by name is compared with the one .venv has, even when the set-up is done.
ifneq ($(strip $(PYTHON)),)
$(READY): FORCE
endif

compare: $(READY)  ## every scene in every engine at its short length, the report, a summary (FULL=1: full lengths)
	@$(COMPILED)
	@$(VENV_PYTHON) -m scenarios compare $(if $(FULL),--full)

check: $(READY)  ## the gate: fails when a bound of a scene does not hold, or accuracy is behind the committed baseline
	@$(COMPILED)
	@code=0; $(VENV_PYTHON) -m scenarios check || code=$$?; \
	  if [ $$code -le 1 ]; then $(VENV_PYTHON) -m reports diff reports/baseline.csv reports/out/latest-check || code=1; fi; exit $$code

bench: $(READY)  ## times: frames, the paper's Table 2, up to 199 links and 100 avatars, single collision queries, 20,000 objects
	@$(COMPILED)
	@code=0; run=reports/out/latest-bench; $(VENV_PYTHON) -m scenarios bench || code=$$?; \
	  [ -e $$run ] || exit $$code; report=$(REPORTED); \
	  $(VENV_PYTHON) -m benchmarks table-2 --of $$run --run $$report || code=$$?; \
	  for name in growth narrow-phase broad-phase; do $(VENV_PYTHON) -m benchmarks $$name --run $$report || code=$$?; done; \
	  for page in $$run $$report; do $(VENV_PYTHON) -m reports write $$page || code=$$?; done; exit $$code

# A study goes on where it was stopped: finished runs are kept below reports/out until a source changes.
# NAME=settings: accuracy against time; hard_cases: other starts, steps, sizes, places; effects: their cost; contact_law: restitution, friction.
study: $(READY)  ## a study at length, into the last comparison's report (NAME=settings|hard_cases|effects|contact_law, FULL=1: every scene)
	@$(COMPILED)
	@code=0; $(VENV_PYTHON) -m scenarios study $(or $(NAME),settings hard_cases effects contact_law) $(if $(FULL),--full) $(ARGS) || code=$$?; \
	  [ ! -f reports/out/latest/results.json ] || $(VENV_PYTHON) -m reports write || code=$$?; exit $$code

report: $(READY)  ## the pages again, from the files of the last comparison
	@$(VENV_PYTHON) -m reports write

# Asserts run as they are written, for to rewrite them takes each worker half a minute: what fails is asked again, all values told.
# Of a slice only the files that name its mark are imported, since each worker would spend as long on the others.
ASK = $(VENV_PYTHON) -m pytest
ALL_AT_ONCE := -n 2 --dist loadfile --no-loadscope-reorder --assert=plain
AGAIN := --last-failed --last-failed-no-failures none
NOJIT := -q -m nojit $$(grep -rlw --include='test_*.py' nojit tests)
BOUNDSCHECK := -q -m boundscheck $$(grep -rlw --include='test_*.py' boundscheck tests)
# OpenBLAS rounds otherwise with each of its kernels: what runs here with those of a processor of 2004 must not hang on last bits.
# Every x86-64 has them; other processors and libraries ignore the variable.
ROUNDED := -q tests/live tests/ik tests/planner

test: $(READY)  ## every test; then a slice with the kernels as plain Python, one with index checks, one with another BLAS kernel
	@$(COMPILED)
	$(ASK) $(ALL_AT_ONCE) || { $(ASK) $(AGAIN); exit 1; }
	export NUMBA_DISABLE_JIT=1; $(ASK) $(ALL_AT_ONCE) $(NOJIT) || { $(ASK) $(AGAIN) $(NOJIT); exit 1; }
	@NUMBA_BOUNDSCHECK=1 $(COMPILED)
	export NUMBA_BOUNDSCHECK=1; $(ASK) $(ALL_AT_ONCE) $(BOUNDSCHECK) || { $(ASK) $(AGAIN) $(BOUNDSCHECK); exit 1; }
	export OPENBLAS_CORETYPE=Prescott; $(ASK) $(ALL_AT_ONCE) $(ROUNDED) || { $(ASK) $(AGAIN) $(ROUNDED); exit 1; }

coverage: $(READY)  ## lines of kernels that no frame and no test as plain Python runs: a few minutes
	export NUMBA_DISABLE_JIT=1; $(VENV_PYTHON) -m coverage run -m pytest $(NOJIT) && \
	  $(VENV_PYTHON) -m coverage run --append -m tests.jit.whole_frames > /dev/null && $(VENV_PYTHON) -m coverage report

# SCENE=house; ARGS: whatever else the command takes.
live: $(READY)  ## drive a hand or a human in the browser, other engines beside (SCENE=toys|hand|gallery|house, ARGS='--dark')
	@$(VENV_PYTHON) -m scenarios.live $(if $(SCENE),--scene $(SCENE)) $(ARGS)

# Pictures first, since they need a browser: without one the table stays too, and both go on telling of the same run.
headline: $(READY)  ## the README's table and pictures again, all of the last comparison, with its commit and date (needs a Chromium)
	@$(VENV_PYTHON) -m tests.look.pictures
	@$(VENV_PYTHON) -m reports headline

look: $(READY)  ## report, docs site and pages of clips in a headless Chromium: nothing on the console, no request, all drawn, replays play; screenshots
	$(VENV_PYTHON) -m pytest -q tests/look/look_pages.py tests/look/look_docs.py tests/look/look_clips.py tests/look/look_ports.py tests/look/look_live.py tests/look/look_shared.py

# Everything runs, whatever fails; the exit status is then 1.
fuzz: $(READY)  ## a million pairs of shapes, a million impacts, palms pushed, hostile and unseen motion, drawn crowds, scenery, 500 returns (PAIRS=, IMPACTS=, PUSHES=, FRAMES=, MOTIONS=, CROWDS=, SEED=)
	@$(COMPILED)
	@failed=0; \
	$(VENV_PYTHON) -m tests.collision.fuzz --pairs $(or $(PAIRS),1000000) --seed $(or $(SEED),1) || failed=1; \
	$(VENV_PYTHON) -m tests.rigid.random_impacts --impacts $(or $(IMPACTS),1000000) --seed $(or $(SEED),1) || failed=1; \
	$(VENV_PYTHON) -m tests.ik.test_pushed_through --pushes $(or $(PUSHES),1000) --seed $(or $(SEED),1) || failed=1; \
	for avatar in hinged humanoid two; do \
	  $(VENV_PYTHON) -m tests.stability.test_posture_fuzz --avatar $$avatar --frames $(or $(FRAMES),100000) \
	    --judge-every 4 --seeds $(or $(SEED),1) || failed=1; \
	  $(VENV_PYTHON) -m tests.stability.test_posture_fuzz --avatar $$avatar --returns --judge-every 4 || failed=1; \
	done; \
	$(VENV_PYTHON) -m scenarios drawn --filter 'unseen_*' --count $(or $(MOTIONS),100) $(if $(SEED),--seed $(SEED)) || failed=1; \
	$(VENV_PYTHON) -m scenarios drawn --filter 'crowd_*' --count $(or $(CROWDS),100) $(if $(SEED),--seed $(SEED)) || failed=1; \
	$(VENV_PYTHON) -m tests.stability.test_moving_fuzz --frames $(or $(FRAMES),100000) --seed $(or $(SEED),1) || failed=1; \
	exit $$failed

hostile: $(READY)  ## 100,000 damaged files, wrong values and command lines for every reader and constructor (CASES=, SEED=, ONLY=)
	@$(COMPILED)
	@$(VENV_PYTHON) -m tests.hostile --cases $(or $(CASES),100000) --seed $(or $(SEED),1) --only '$(or $(ONLY),*)'

soak: $(READY)  ## one engine through a million frames: memory flat, frames as fast as at first, nothing overlaps (FRAMES=)
	@$(COMPILED)
	@$(VENV_PYTHON) -m tests.stability.soak --frames $(or $(FRAMES),1000000)

wheel: $(READY)  ## the built wheel alone in each Python from 3.11 to 3.13 that runs: no checkout, no root, HOME read-only (KERNELS=1)
	@$(VENV_PYTHON) -m tests.house.wheel $(if $(KERNELS),--with-kernels)

docs: $(READY)  ## the docs site, build/docs/index.html: every warning is an error, nothing is fetched
	@$(VENV_PYTHON) -m sphinx -q -E -W --keep-going -b html -d build/doctrees -c docs . build/docs
	@echo "the docs site is build/docs/index.html"

lint: $(READY)  ## ruff, mypy --strict, and the order of imports
	$(VENV_PYTHON) -m ruff check --output-format concise .
	$(VENV_PYTHON) -m mypy
	$(VENV_PYTHON) -m mypy .setup
	.venv/bin/lint-imports

lock:  ## write requirements.lock anew from pyproject.toml (UPGRADE=1: newest versions)
	$(firstword $(wildcard $(VENV_PYTHON)) python3) .setup/lock.py $(if $(UPGRADE),--upgrade)

# Names of runs are time-command. Of each command the runs that are older than its last one go; a younger one has not ended yet.
prune:  ## remove the runs in reports/out that are older than the last one of their command: a comparison takes 280 MB
	@cd reports/out 2>/dev/null && kept=" $$(for link in latest latest-*; do readlink $$link; done | tr '\n' ' ')" && \
	  [ "$$kept" != " " ] || { echo "reports/out has no last run; nothing removed"; exit 0; }; \
	for run in [0-9]*-[0-9]*-*; do \
	  command=$${run#*-*-}; last=$$(readlink latest-$${command%%-*} || readlink latest) || continue; \
	  case "$$kept" in *" $$run "*) continue;; esac; \
	  [ "$$(printf '%s\n' "$$run" "$$last" | LC_ALL=C sort | head -n 1)" = "$$run" ] || continue; \
	  [ ! -d "$$run" ] || { rm -rf "$$run" && echo "removed reports/out/$$run"; }; \
	done

clean:  ## remove caches and build leftovers; .venv and reports/out stay
	rm -rf build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find avatarsim runfiles reference scenarios benchmarks reports tests .setup -name __pycache__ -type d -prune -exec rm -rf {} +
