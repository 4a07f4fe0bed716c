"""Disks that are full: that of the data folder, and that for temporary files."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.faults.processes import Started, kill, until
from tests.storm.faults.base import MIDDLE, Fault, Hurt
from tests.storm.faults.databases import AWAY
from tests.storm.site import Site

SIZE = 64_000_000
"""Of a small disk [bytes]; workers are told that a tenth of it is enough to begin a run."""


@contextmanager
def small(folder: Path) -> Iterator[None]:
    """A disk of its own for this folder; needs root."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "storm", str(folder)], check=True)
    os.environ["CLEARANCE_MIN_FREE"] = str(SIZE // 10)
    try:
        yield
    finally:
        del os.environ["CLEARANCE_MIN_FREE"]
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


def filled(then: Hurt) -> Hurt:
    """No byte is free for a while, in which something else happens."""

    def fill(site: Site, worker: Started) -> None:
        ballast = site.folder / "ballast"
        with ballast.open("wb", buffering=0) as file:
            try:
                while file.write(bytes(1 << 12)):
                    pass
            except OSError:
                pass
        then(site, worker)
        time.sleep(AWAY)
        ballast.unlink()

    return fill


def noticed(site: Site, worker: Started) -> None:
    """Worker and child, whose database and temporary files are there, go on or wait."""
    until(lambda: worker.process.poll() is None, "the worker is alive", 5)


FAULTS = {
    "disk full": Fault(filled(noticed), MIDDLE, "slots", disk=True),
    "disk full, child killed": Fault(filled(lambda site, worker: kill(worker.child())), MIDDLE, "slots", disk=True),
    "disk full, worker killed": Fault(filled(lambda site, worker: kill(*worker.family())), MIDDLE, "slots", disk=True),
}
