"""Single faults: each hits a run at a stated moment; then it has to end with every bit, by itself."""

from __future__ import annotations

import os
import shutil
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import sqlalchemy as sa

from tests.faults import postgres
from tests.faults.processes import Started, command_of, kill, parents, until
from tests.storm.site import SAMPLE, Site

AWAY = 4.0
"""How long the database is away [s]: twice the lease."""
PATIENCE = 180.0


@dataclass(frozen=True)
class Row:
    """What a fault did: what was seen of it, evaluations lost and repeated, processes and folders left behind, and how
    long it took until the next result [s]; given_up: runs that did not end as done."""

    database: str
    name: str
    seen: str
    lost: int
    repeated: int
    left_behind: int
    given_up: int
    recovery_s: float


Hurt = Callable[[Site, Started], None]


def child(number: signal.Signals) -> Hurt:
    return lambda site, worker: kill(worker.child(), number=number)


def supervisor(number: signal.Signals) -> Hurt:
    return lambda site, worker: kill(worker.pid, number=number)


def guard(site: Site, worker: Started) -> None:
    kill(*[pid for pid, parent in parents().items() if parent == worker.pid and "guard.py" in command_of(pid)])


def family(site: Site, worker: Started) -> None:
    kill(*worker.family())


def frozen(site: Site, worker: Started) -> None:
    """Worker and child are stopped until the lease is over, and go on when another has the run."""
    stopped = worker.family()
    kill(*stopped, number=signal.SIGSTOP)
    site.start()
    until(lambda: site.run(1).worker == "w2", "another worker has the run", 60)
    kill(*stopped, number=signal.SIGCONT)


def locked(site: Site, worker: Started) -> None:
    """Another program holds the write lock."""
    with site.engine.begin() as connection:
        if site.engine.dialect.name == "postgresql":
            connection.execute(sa.text("lock table runs in access exclusive mode"))
        time.sleep(AWAY)


def twice(site: Site, worker: Started) -> None:
    """Child and, once another has begun, that one too."""
    first = worker.child()
    kill(first)
    until(lambda: _next(worker, first), "another child", 60)
    kill(worker.child())


def _next(worker: Started, first: int) -> bool:
    try:
        return worker.child() != first
    except ValueError:  # it is being started
        return False


def cache(site: Site, worker: Started) -> None:
    """The files of compiled code are cut off, then the child is killed."""
    for file in (site.folder / "kernels").rglob("*.nb?"):
        file.write_bytes(file.read_bytes()[:1000])
    kill(worker.child())


def temporary(site: Site, worker: Started) -> None:
    """The folder for temporary files is emptied, then the child is killed."""
    shutil.rmtree(site.temporary)
    site.temporary.mkdir()
    kill(worker.child())


def connections(site: Site, worker: Started) -> None:
    """The server ends all connections; SQLite has none, its file is moved away and back while the worker is stopped."""
    if site.engine.dialect.name == "postgresql":
        with site.engine.begin() as connection:
            ended = "select pg_terminate_backend(pid) from pg_stat_activity where pid <> pg_backend_pid()"
            connection.execute(sa.text(ended + " and datname = current_database()"))
        return
    kill(*worker.family(), number=signal.SIGSTOP)
    file = Path(str(site.engine.url.database))
    site.engine.dispose()
    file.rename(file.with_suffix(".away"))
    file.with_suffix(".away").rename(file)
    kill(*worker.family(), number=signal.SIGCONT)


FAULTS: dict[str, tuple[int, Hurt]] = {
    "child killed": (SAMPLE // 3, child(signal.SIGKILL)),
    "child killed before its first stage": (-1, child(signal.SIGKILL)),
    "child killed twice": (SAMPLE // 3, twice),
    "child: segmentation fault": (SAMPLE // 3, child(signal.SIGSEGV)),
    "child terminated": (SAMPLE // 3, child(signal.SIGTERM)),
    "child stopped": (SAMPLE // 3, child(signal.SIGSTOP)),
    "guard killed": (SAMPLE // 3, guard),
    "worker killed": (SAMPLE // 3, supervisor(signal.SIGKILL)),
    "worker killed before its first stage": (-1, supervisor(signal.SIGKILL)),
    "worker terminated": (SAMPLE // 3, supervisor(signal.SIGTERM)),
    "worker interrupted": (SAMPLE // 3, supervisor(signal.SIGINT)),
    "worker's terminal closed": (SAMPLE // 3, supervisor(signal.SIGHUP)),
    "worker, guard and child killed": (SAMPLE // 3, family),
    "worker and child stopped beyond the lease": (SAMPLE // 3, frozen),
    "killed near the end of the search": (SAMPLE - 500, family),
    "killed in the independent sample": (SAMPLE + 330, family),
    "database locked": (SAMPLE // 3, locked),
    "connections cut": (SAMPLE // 3, connections),
    "compiled code damaged": (SAMPLE // 3, cache),
    "temporary files deleted": (SAMPLE // 3, temporary),
}
"""By name: when, in stored evaluations (-1: as soon as a worker has the run), and what."""
SERVER_ONLY = ("server stopped at once", "server stopped at once, before the first stage")


def hurt(site: Site, database: str, name: str, server: postgres.Server | None = None) -> Row:
    """One run with one fault."""
    if name in SERVER_ONLY:
        assert server is not None
        at, what = (-1 if name.endswith("stage") else SAMPLE // 3), _stopped(server)
    else:
        at, what = FAULTS[name]
    run_id, worker = site.begin(), site.start()
    until(lambda: site.run(run_id).state == "running" and site.run(run_id).evaluations > at, f"{name}: under way", 120)
    what(site, worker)
    stored, began = site.run(run_id).evaluations, time.monotonic()
    until(lambda: _restaffed(site, run_id) > stored or site.run(run_id).state == "done", f"{name}: goes on", PATIENCE)
    recovery = time.monotonic() - began
    seen = site.run(run_id).error or _last(worker)
    until(lambda: _restaffed(site, run_id) and site.run(run_id).state in ("done", "failed"), f"{name}: ends", PATIENCE)
    given_up = int(site.run(run_id).state != "done")
    lost, repeated = site.compared(run_id)
    site.stop()
    return Row(database, name, seen, lost, repeated, site.left_behind(), given_up, round(recovery, 1))


def _restaffed(site: Site, run_id: int) -> int:
    site.staffed()
    found: int = site.run(run_id).evaluations
    return found


def _last(worker: Started) -> str:
    lines = worker.text().strip().splitlines() or [""]
    return lines[-1].split(" clearance", 1)[-1][-110:]


def _stopped(server: postgres.Server) -> Hurt:
    def stop(site: Site, worker: Started) -> None:
        site.engine.dispose()
        server.stop()
        time.sleep(AWAY)
        server.start()

    return stop


@contextmanager
def kernels(folder: Path) -> Iterator[None]:
    """The workers compile into a folder of their own, which a fault may damage."""
    before = os.environ.get("CLEARANCE_KERNEL_CACHE")
    os.environ["CLEARANCE_KERNEL_CACHE"] = str(folder)
    try:
        yield
    finally:
        if before is None:
            del os.environ["CLEARANCE_KERNEL_CACHE"]
        else:
            os.environ["CLEARANCE_KERNEL_CACHE"] = before
