#!/usr/bin/env bash
# Installs the packages of frontend/package-lock.json, unless they are there. Needs a Node on the path (tools/node.sh).

source "$(dirname "$0")/common.sh"

cd frontend
installed=node_modules/.installed
wanted="$(digest package.json package-lock.json) $(node --version) $HERE"
if [ "$(cat "$installed" 2>/dev/null || true)" != "$wanted" ]; then
    say "installing the packages of frontend/package-lock.json"
    npm ci --no-audit --no-fund --loglevel=error
    printf '%s' "$wanted" >"$installed"
fi
