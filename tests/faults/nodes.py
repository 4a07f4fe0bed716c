"""A Dask scheduler and its workers as processes, for the fault tests of clusters."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from tests.faults.processes import Started, started, until

SETTINGS = {
    "DASK_DISTRIBUTED__SCHEDULER__WORKER_SATURATION": "1.0",
    "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0",
}
"""Those of docs/cluster.md."""


class Cluster:
    """A scheduler on a port of its own, and its workers."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.folder, self._stack = folder, stack
        self.port = 0
        self.scheduler = self.schedule()
        self.workers: list[Started] = []

    @property
    def address(self) -> str:
        return f"dask://127.0.0.1:{self.port}"

    def schedule(self) -> Started:
        """Start a scheduler, on the same port as the one before."""
        file = self.folder / "scheduler.json"
        file.unlink(missing_ok=True)
        self.scheduler = self._start("scheduler", "--port", str(self.port), "--scheduler-file", str(file))
        until(file.exists, "a scheduler")
        until(lambda: file.read_text().endswith("}"), "its address")
        self.port = int(json.loads(file.read_text())["address"].rpartition(":")[2])
        return self.scheduler

    def work(self, count: int = 1) -> None:
        """Start workers of one thread."""
        for _ in range(count):
            to = [f"tcp://127.0.0.1:{self.port}", "--nthreads", "1", "--no-nanny", "--death-timeout", "60"]
            self.workers.append(self._start("worker", *to, "--local-directory", str(self.folder)))

    def _start(self, what: str, *options: str) -> Started:
        here = ["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0", "--no-dashboard"]
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *here]
        name = f"{what}-{len(list(self.folder.glob('*.log')))}"
        return self._stack.enter_context(started([*command, *options], self.folder, name, **SETTINGS))


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[Cluster]:
    """A scheduler with workers while the block lasts."""
    with ExitStack() as stack:
        made = Cluster(folder, stack)
        made.work(workers)
        yield made
