# Runs checks beside each other and shows what each says once all have ended. Sourced by tools/check.sh, install.sh and test.sh.

logs="$(mktemp -d)"
names=()
running=()
trap 'kill "${running[@]}" 2>/dev/null || true; rm -rf "$logs"' EXIT

# begin NAME COMMAND... : runs it beside the others.
begin() {
    names+=("$1")
    "${@:2}" >"$logs/$1" 2>&1 &
    running+=("$!")
}

# ended: waits for all that have begun, shows what they said, and fails if one of them has.
ended() {
    local failed=() i
    for i in "${!names[@]}"; do
        wait "${running[$i]}" || failed+=("${names[$i]}")
        say "== ${names[$i]}"
        cat "$logs/${names[$i]}" >&2
    done
    names=()
    running=()
    [ "${#failed[@]}" = 0 ] || fail "failed: ${failed[*]}"
}
