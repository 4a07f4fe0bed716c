#!/usr/bin/env bash
# Runs every check and every test, on what tools/install.sh set up.

source "$(dirname "$0")/common.sh"
source tools/node.sh
source tools/beside.sh

# At the lowest priority they get what pytest leaves, which waits for other processes a third of its time.
checks() {
    local failed=0
    nice -n 19 "$VENV/bin/mypy" || failed=1
    cd frontend
    nice -n 19 node_modules/.bin/oxlint || failed=1
    nice -n 19 node_modules/.bin/vitest run || failed=1
    return "$failed"
}

say "== ruff"
"$VENV/bin/ruff" check .
"$VENV/bin/ruff" format --check .
# Some hundred processes load these modules, also where the environment forbids to write what was compiled.
"$VENV/bin/python" -m compileall -q -j 0 backend campaigns clearance worker
tools/frontend.sh # the types of the pages are checked before they are built
begin "mypy, oxlint and vitest" checks
say "== pytest; mypy, oxlint and vitest beside it"
# A file's tests share services and browsers: tests/conftest.py keeps them together, and orders them.
# Half of them begin with what mostly waits for other processes (tests/side_by_side.py); more take each other's caches.
processes="$(($(nproc) + 2))"
tested=0
"$VENV/bin/pytest" --processes "$((processes < 4 ? processes : 4))" "$@" || tested="$?"
ended
exit "$tested"
