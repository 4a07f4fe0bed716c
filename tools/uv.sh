# packages: installs Python packages into the virtual environment. Sourced after common.sh, never run.

# packages ARGUMENT... : uv installs them, in a fifth of pip's time; what it cannot, pip does, or says why it cannot either.
packages() {
    if [ ! -x "$VENV/bin/uv" ]; then
        tools/locked.sh --only uv== >"$VENV/uv.lock"
        "$VENV/bin/python" -m pip install --quiet --require-hashes --only-binary :all: -r "$VENV/uv.lock" || true
    fi
    local uv=("$VENV/bin/uv" pip install --quiet --python "$VENV/bin/python" "$@")
    "$VENV/bin/python" tools/as_pip.py "${uv[@]}" 2>"$VENV/uv.log" ||
        "$VENV/bin/python" -m pip install --quiet --no-compile "$@"
}
