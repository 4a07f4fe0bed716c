# packages: installs Python packages into the virtual environment. Sourced after common.sh, never run.

# as_pip: the indexes and the certificates that pip is told of, for uv.
as_pip() {
    local key value
    while IFS='=' read -r key value; do
        value="${value:1:-1}"
        value="${value//\\n/ }" # in a file of settings, each on a line of its own
        case "${key##*.}" in
            index-url) export UV_DEFAULT_INDEX="$value" ;;
            extra-index-url) export UV_INDEX="$value" ;;
            find-links) export UV_FIND_LINKS="${value// /,}" ;;
            cert) export SSL_CERT_FILE="$value" ;;
            no-index) export UV_NO_INDEX=1 ;;
        esac
    done < <("$VENV/bin/python" -m pip config list)
}

# packages ARGUMENT... : uv installs them, in a fifth of pip's time; what it cannot, pip does, or says why it cannot either.
packages() {
    if [ ! -x "$VENV/bin/uv" ]; then
        tools/locked.sh --only uv== >"$VENV/uv.lock"
        "$VENV/bin/python" -m pip install --quiet --require-hashes --only-binary :all: -r "$VENV/uv.lock" || true
    fi
    as_pip
    "$VENV/bin/uv" pip install --quiet --python "$VENV/bin/python" "$@" 2>"$VENV/uv.log" ||
        "$VENV/bin/python" -m pip install --quiet --no-compile "$@"
}
