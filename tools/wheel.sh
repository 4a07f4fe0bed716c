#!/usr/bin/env bash
# Builds the wheel of the tracked files and the built pages into build/wheel, or the folder that is given.
# In a copy: setuptools leaves files beside what it builds, and would pack them the next time.

source "$(dirname "$0")/common.sh"

into="$(realpath -m "${1:-build/wheel}")"
[ -f frontend/dist/index.html ] || fail "there are no built pages: run \`make install\`"
copy="$(mktemp -d)"
trap 'rm -rf "$copy"' EXIT
git ls-files -z | xargs -0 cp --parents -t "$copy"
cp -r frontend/dist "$copy/frontend/"
rm -rf "$into"
mkdir -p "$into"
"$VENV/bin/python" -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir "$into" "$copy"
say "$(ls "$into"/*.whl)"
