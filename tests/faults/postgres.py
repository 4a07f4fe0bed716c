"""A temporary PostgreSQL server from Debian's binaries, on a socket in its own folder.

Without the binaries it reports so, and the tests that need it are skipped.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest


class Server:
    """A running server: its URL, and a method to stop it."""

    def __init__(self, url: str, control: list[str], options: str) -> None:
        self.url, self._control, self._options = url, control, options
        self._running = False

    def start(self) -> None:
        """Returns once it takes connections, as it may already."""
        if self._running:
            return
        self._running = True
        _run([*self._control, "-o", self._options, "start"])

    def stop(self) -> None:
        """Ends it as a crash would: connections are cut."""
        self._running = False
        _run([*self._control, "-m", "immediate", "stop"])


@contextmanager
def binaries() -> Iterator[tuple[Path, Path, list[str]]]:
    """Folder of the programs, a folder for a server, and what begins commands; skips without PostgreSQL."""
    binaries = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    found = shutil.which("initdb") or (str(binaries[-1]) if binaries else None)
    if found is None:
        pytest.skip("no PostgreSQL server is installed (Debian: apt-get install postgresql)")
    # The server refuses to run as root, and a socket's path is at most 107 bytes: hence a separate short folder.
    folder = Path(tempfile.mkdtemp(prefix="pg", dir="/tmp"))
    try:
        yield Path(found).parent, folder, _as_user(folder)
    finally:
        shutil.rmtree(folder)


@contextmanager
def server(within: Sequence[str] = (), address: str = "", network: str = "") -> Iterator[Server]:
    """A running, empty server; skips the test if PostgreSQL is not installed.

    within: what its commands begin with, as for another network namespace; address: where it listens besides its
    socket, for this network.
    """
    with binaries() as (programs, folder, as_user):
        data = folder / "data"
        _run([*within, *as_user, str(programs / "initdb"), "-D", str(data), "-U", "clearance", "-A", "trust", "-N"])
        if network:
            with (data / "pg_hba.conf").open("a") as rules:
                rules.write(f"host all all {network} trust\n")
        options = f"-c listen_addresses='{address}' -c unix_socket_directories='{folder}' -c fsync=off"
        control = [*within, *as_user, str(programs / "pg_ctl"), "-D", str(data), "-l", str(folder / "log"), "-w"]
        running = Server(f"postgresql://clearance@/postgres?host={folder}", control, options)
        running.start()
        try:
            yield running
        finally:
            running.stop()


def _as_user(folder: Path) -> list[str]:
    if os.geteuid() != 0:
        return []
    try:
        shutil.chown(folder, "postgres", "postgres")
    except LookupError:
        pytest.skip("PostgreSQL refuses to run as root, and there is no user postgres")
    return ["runuser", "-u", "postgres", "--"]


def _run(command: list[str]) -> None:
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd="/", check=False)
    assert done.returncode == 0, f"{command}: {done.stdout}"
