"""What hurts the processes of a worker that flies a closed loop, its compiled code and its temporary files."""

from __future__ import annotations

import shutil
import signal

from tests.faults.processes import Started, command_of, kill, parents, until
from tests.storm.faults.base import BEGUN, Fault, Hurt
from tests.storm.site import SAMPLE, Site


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


def two(site: Site, worker: Started) -> None:
    """Two workers of two runs, with all that they started, at once."""
    other, more = site.start(), site.begin(2)
    until(lambda: site.run(more).evaluations > 0, "both under way", 120)
    kill(*worker.family(), *other.family())
    site.staffed(2)


FAULTS = {
    "child killed": Fault(child(signal.SIGKILL)),
    "child killed before its first stage": Fault(child(signal.SIGKILL), BEGUN),
    "child killed twice": Fault(twice),
    "child: segmentation fault": Fault(child(signal.SIGSEGV)),
    "child terminated": Fault(child(signal.SIGTERM)),
    "child stopped": Fault(child(signal.SIGSTOP)),
    "guard killed": Fault(guard),
    "worker killed": Fault(supervisor(signal.SIGKILL)),
    "worker killed before its first stage": Fault(supervisor(signal.SIGKILL), BEGUN),
    "worker terminated": Fault(supervisor(signal.SIGTERM)),
    "worker interrupted": Fault(supervisor(signal.SIGINT)),
    "worker's terminal closed": Fault(supervisor(signal.SIGHUP)),
    "worker, guard and child killed": Fault(family),
    "worker and child stopped beyond the lease": Fault(frozen),
    "two workers killed at once": Fault(two),
    "killed near the end of the search": Fault(family, SAMPLE - 500),
    "killed in the independent sample": Fault(family, SAMPLE + 330),
    "compiled code damaged": Fault(cache),
    "temporary files deleted": Fault(temporary),
}
