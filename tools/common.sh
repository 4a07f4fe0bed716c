# Shared by the scripts of this folder: where things are, what to say, how to get a Debian package, which Node suits.
# Sourced, never run.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
HERE="$PWD"
VENV="$HERE/.venv"
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1

say() { printf '%s\n' "$*" >&2; }

fail() {
    say "error: $*"
    exit 1
}

# digest FILE... : one hash over the contents and names of files.
digest() { sha256sum "$@" | sha256sum | cut -d' ' -f1; }

# debian_install PACKAGE... : installs Debian packages where that is possible; false otherwise.
debian_install() {
    command -v apt-get >/dev/null || return 1
    local as_root=()
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null && sudo -n true 2>/dev/null || return 1
        as_root=(sudo -n)
    fi
    say "installing Debian packages: $*"
    (
        flock 9 # another of these scripts may be at it
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q >&2 || exit 1
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" >&2
    ) 9<Makefile
}

# system_node: whether the system's Node can build the pages: the build tools ask for 20.19 or later, 22.12 or later.
# Debian ships npm apart from Node, and both are needed.
system_node() {
    command -v npm >/dev/null && node -e 'const [a, b] = process.versions.node.split(".").map(Number);
        process.exit(a > 22 || (a === 22 && b >= 12) || (a === 20 && b >= 19) ? 0 : 1)' 2>/dev/null
}
