#!/usr/bin/env bash
# Sees to it that there is a browser for the tests in tests/e2e: Debian's chromium, without its windows where that is packaged.

source "$(dirname "$0")/common.sh"

found() { command -v "$1" >/dev/null; }

found chromium-headless-shell && exit 0
apt-cache show chromium-headless-shell >/dev/null 2>&1 && debian_install chromium-headless-shell fonts-liberation &&
    found chromium-headless-shell && exit 0
found chromium || found chromium-browser || found google-chrome && exit 0
debian_install chromium-headless-shell fonts-liberation || debian_install chromium fonts-liberation &&
    { found chromium-headless-shell || found chromium; } && exit 0
fail "the browser tests need chromium and it could not be installed here: on Debian run, as root," \
    "apt-get install chromium; to leave these tests out: .venv/bin/pytest -m 'not e2e and not nightly'"
