#!/usr/bin/env bash
# The steps of the container image, one by one, so that they can be run without a container engine too:
#   image.sh system     installs Debian's packages: Chromium, which prints reports as PDF, and a font for what has none
#   image.sh packages   makes .venv from the lock file, with what the project and its extras need, without the tests' tools
#   image.sh app        installs this project into it, and writes what the pages are built with
#   image.sh pages      builds the pages in frontend/ (needs Node)
# `tools/image.sh check FOLDER` runs all but the first in FOLDER, on those files of the last commit that the Dockerfile copies,
# and starts what came out. tests/faults/test_image.py runs the Dockerfile itself on a Debian without an engine.

source "$(dirname "$0")/common.sh"

system() {
    debian_install $(cat tools/image-system.txt) || fail "the packages of tools/image-system.txt could not be installed"
    rm -rf /var/lib/apt/lists/*
}

packages() {
    python3 -m venv .venv
    tools/locked.sh --only $(sed 's/$/==/' tools/image-packages.txt) >.locked
    .venv/bin/python -m pip install --no-cache-dir --quiet --require-hashes --only-binary :all: -r .locked
    rm .locked
}

pages() {
    cd frontend
    npm ci --no-audit --no-fund --loglevel=error
    npm run --silent build
    rm -rf node_modules
}

app() {
    .venv/bin/python -m pip install --no-cache-dir --quiet --no-deps --no-build-isolation -e .
    .venv/bin/python -m compileall -q backend campaigns clearance worker
    .venv/bin/clearance --help >/dev/null
    .venv/bin/python -m tools.generated pages
}

check() {
    local folder="$1"
    [ ! -e "$folder" ] || fail "$folder exists already"
    mkdir -p "$folder"
    git archive HEAD backend campaigns clearance worker tools frontend docs pyproject.toml requirements.lock README.md |
        tar -x -C "$folder"
    for step in packages app pages; do
        say "== $step"
        "$folder/tools/image.sh" "$step"
    done
    say "== start"
    # As in the container: the backend on every address of it, by the setting that permits that, and a worker.
    export CLEARANCE_DATA="$folder/data" CLEARANCE_PORT="${CLEARANCE_PORT:-8099}"
    export CLEARANCE_HOST=0.0.0.0 CLEARANCE_ALLOW_ANY_HOST=true CLEARANCE_KERNEL_CACHE="$folder/data/kernels"
    cd /
    "$folder/.venv/bin/python" -m backend &
    local backend=$!
    "$folder/.venv/bin/clearance" worker &
    local worker=$!
    trap "kill $backend $worker 2>/dev/null; wait" EXIT
    for _ in $(seq 120); do
        if "$folder/.venv/bin/python" "$folder/tools/healthy.py" && "$folder/.venv/bin/clearance" worker --check; then
            say "healthy"
            return
        fi
        sleep 1
    done
    fail "not healthy after two minutes"
}

"$@"
