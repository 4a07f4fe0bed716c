#!/usr/bin/env bash
# Runs every check and every test, on what tools/install.sh set up.

source "$(dirname "$0")/common.sh"
source tools/node.sh

step() {
    say "== $*"
    "$@"
}

step "$VENV/bin/ruff" check .
step "$VENV/bin/ruff" format --check .
step "$VENV/bin/mypy"
(cd frontend && step npm run --silent check && step npm run --silent test)
# A file's tests share services and browsers: tests/conftest.py keeps them together, and orders them.
workers="$(nproc)"
step "$VENV/bin/pytest" -n "$((workers < 4 ? workers : 4))" --dist loadfile --no-loadscope-reorder "$@"
