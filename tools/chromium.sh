#!/usr/bin/env bash
# Sees to it that there is a browser for the tests in tests/e2e: Debian's chromium.

source "$(dirname "$0")/common.sh"

for browser in chromium chromium-browser google-chrome; do
    command -v "$browser" >/dev/null && exit 0
done
debian_install chromium fonts-liberation && command -v chromium >/dev/null && exit 0
fail "the browser tests need chromium and it could not be installed here: on Debian run, as root," \
    "apt-get install chromium; to leave these tests out: .venv/bin/pytest -m 'not e2e and not nightly'"
