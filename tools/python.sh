# find_python: the interpreter that the virtual environment is made of. Sourced after common.sh, never run.

system=(/usr/bin /usr/local/bin)

suits() { "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null; }

in_one_piece() { "$1" -c 'import ensurepip, sys, venv; sys.exit("libpython" in open("/proc/self/maps").read())' 2>/dev/null; }

# faster_of_its_version PYTHON: an interpreter in a shared library, as pyenv builds them, takes a tenth more time than one
# in one piece, if the system has that version so.
faster_of_its_version() {
    local found version folder
    found="$(command -v "$1")"
    version="$("$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])')"
    if ! in_one_piece "$found"; then
        for folder in "${system[@]}"; do
            if in_one_piece "$folder/python$version"; then
                printf '%s\n' "$folder/python$version"
                return
            fi
        done
    fi
    printf '%s\n' "$found"
}

find_python() {
    local candidate
    if [ -n "${PYTHON:-}" ]; then
        suits "$PYTHON" || fail "PYTHON=$PYTHON is not a Python 3.11 to 3.14"
        command -v "$PYTHON"
        return
    fi
    for candidate in python3 python3.14 python3.13 python3.12 python3.11; do
        if suits "$candidate"; then
            faster_of_its_version "$candidate"
            return
        fi
    done
    fail "Python 3.11 to 3.14 is needed and none was found (python3 is $(python3 --version 2>&1 || true));" \
        "install one, or name it: make install PYTHON=/path/to/python3.11"
}
