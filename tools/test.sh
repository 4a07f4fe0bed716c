#!/usr/bin/env bash
# Runs every check and every test, on what tools/install.sh set up.

source "$(dirname "$0")/common.sh"
source tools/node.sh
source tools/beside.sh

step() {
    say "== $*"
    "$@"
}

pages() {
    cd frontend
    npm run --silent check
}

step "$VENV/bin/ruff" check .
step "$VENV/bin/ruff" format --check .
begin mypy "$VENV/bin/mypy"
begin pages pages
ended
# Alone: its tests have time limits.
(cd frontend && step npm run --silent test)
# A file's tests share services and browsers: tests/conftest.py keeps them together, and orders them.
workers="$(nproc)"
step "$VENV/bin/pytest" -n "$((workers < 4 ? workers : 4))" --dist loadfile --no-loadscope-reorder "$@"
