"""Runs uv with the indexes and certificates of pip's configuration: `python tools/as_pip.py UV pip install ...`.

Settings of uv itself, by UV_... or SSL_CERT_FILE, stay.
"""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping

SECTIONS = ("global", "install", ":env:")
"""Of pip's settings, for an installation: a later one is stronger, in whatever order pip lists them."""
TRUE = {"y", "yes", "t", "true", "on", "1"}
INDEXES = {"UV_DEFAULT_INDEX", "UV_INDEX", "UV_INDEX_URL", "UV_EXTRA_INDEX_URL"}


def settings(listed: str) -> dict[str, str]:
    """The settings of an installation, from the output of `pip config list`."""
    found: dict[str, dict[str, str]] = {section: {} for section in SECTIONS}
    for line in listed.splitlines():
        name, _, value = line.partition("=")
        section, _, key = name.rpartition(".")
        if section in found:
            found[section][key] = str(ast.literal_eval(value))
    return {key: value for section in SECTIONS for key, value in found[section].items()}


def options(configured: Mapping[str, str], environment: Mapping[str, str]) -> Iterator[str]:
    """The options of uv with the same meaning."""
    if not INDEXES & environment.keys():
        if index := configured.get("index-url", "").strip():
            yield from ("--default-index", index)
        for index in configured.get("extra-index-url", "").split():
            yield from ("--index", index)
    if "UV_FIND_LINKS" not in environment:
        for place in configured.get("find-links", "").split():
            yield from ("--find-links", place)
    if configured.get("no-index", "").strip().lower() in TRUE:
        yield "--no-index"


def main(command: list[str]) -> None:
    listed = subprocess.run([sys.executable, "-m", "pip", "config", "list"], capture_output=True, text=True, check=True)
    configured, environment = settings(listed.stdout), dict(os.environ)
    if certificates := configured.get("cert", "").strip():
        environment.setdefault("SSL_CERT_FILE", certificates)
    os.execve(command[0], [*command, *options(configured, environment)], environment)


if __name__ == "__main__":
    main(sys.argv[1:])
