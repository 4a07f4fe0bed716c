# `make run` and `make test` set up what they need; a second call starts in seconds. See README.md.

SHELL := bash
.DEFAULT_GOAL := help
.PHONY: help install run check test chromium faults soak nightly screenshots lint types bench bench-pages certainty-bench search-bench scoreboard reproduce wheel sbom advisories frontend library-flights library-verdicts clean distclean

help: ## this list
	@awk -F ': ## ' '/^[a-z-]+:.* ## |^[a-z-]+: ## /{split($$0, part, ":"); sub(/.*## /, ""); printf "%-15s %s\n", part[1], $$0}' Makefile

install: ## create .venv from the lock file and build the pages
	@tools/install.sh

run: install ## start the service and one worker on ./data; Ctrl-C stops everything
	@exec .venv/bin/clearance serve --data ./data --workers 1

check: install ## ruff, types and the quick tests: less than a minute and a half from warm caches
	@tools/check.sh

test: ## run every check, and all tests but those of `make nightly`
	@$(MAKE) --no-print-directory -j 2 install chromium
	@tools/test.sh

chromium: ## install the browser of the browser tests, where there is none
	@tools/chromium.sh

faults: install ## hurt real processes while runs go on, on both databases; a table, build/faults.json
	@.venv/bin/python -m tests.storm

soak: install ## a service under load for a quarter of an hour; a table, build/soak.json
	@.venv/bin/python -m tests.storm.soak

nightly: install chromium ## run the tests that `make test` leaves out, for an hour and a half
	@source tools/common.sh; source tools/node.sh; cd frontend; export CLEARANCE_NIGHTLY=1; node_modules/.bin/eslint . && npm run --silent test
	@.venv/bin/pytest -m nightly --processes "$$(nproc)"

screenshots: install chromium ## pictures of the pages as the browser tests meet them, in build/screenshots
	@CLEARANCE_SCREENSHOTS=1 .venv/bin/pytest -m e2e

lint: install ## ruff: rules and format
	@.venv/bin/ruff check .
	@.venv/bin/ruff format --check .

types: install ## mypy
	@.venv/bin/mypy

bench: install ## measure the speed, print a table, write build/bench.json
	@.venv/bin/python -m tests.bench

bench-pages: install chromium ## measure the pages in a browser, print a table, write build/bench-pages.json
	@.venv/bin/python -m tests.bench.pages

certainty-bench: install ## samples of any size, estimates, regions of attraction, proofs; writes build/certainty.json
	@.venv/bin/python -m tests.bench.certainty
	@.venv/bin/python -m tests.bench.rare
	@.venv/bin/python -m tests.bench.attraction
	@.venv/bin/python -m tests.bench.proof
	@.venv/bin/python -m tests.bench.certainty --join

search-bench: install ## every search method on test functions, print a table, write build/search.json and search.md
	@.venv/bin/python -m tests.bench.search_bench

scoreboard: install build/peers ## all methods and their peers on the judging half, for hours; writes build/scoreboard.json and .md
	@.venv/bin/python -m tests.bench.scoreboard

build/peers: tests/bench/scoreboard/peers.txt
	@grep -v '^#' $< | xargs -n 1 .venv/bin/python -m pip install --quiet --upgrade --no-deps --target $@ || true
	@touch $@

reproduce: install ## compute the published tables and figures again, into build/reproduce
	@.venv/bin/clearance reproduce --out build/reproduce

wheel: install ## a wheel with its pages, in build/wheel: `pip install` it anywhere and `clearance serve`
	@tools/wheel.sh

sbom: install ## the bill of materials of a release, CycloneDX, into build/sbom
	@source tools/node.sh; .venv/bin/python -m tools.sbom

advisories: install ## ask PyPI and npm for advisories on what is locked, or say that they could not be asked
	@source tools/node.sh; .venv/bin/python -m tools.advisories

library-flights: install ## simulate the nominal flights on the cards of the library again
	@.venv/bin/python tools/library_flights.py

library-verdicts: install ## run the campaigns of the library again, into the table of their verdicts
	@.venv/bin/python -m tools.library_verdicts

frontend: ## build the pages
	@tools/install.sh

clean: ## remove what was built
	@rm -rf build frontend/dist frontend/src/client frontend/src/generated frontend/node_modules/.built
	@rm -rf .mypy_cache .ruff_cache .pytest_cache .hypothesis .coverage
	@find . -name __pycache__ -not -path './.venv/*' -not -path './frontend/node_modules/*' -prune -exec rm -rf {} +

distclean: clean ## remove what was installed, too; ./data stays
	@rm -rf .venv frontend/node_modules *.egg-info
