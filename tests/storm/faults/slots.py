"""What hurts the processes of a simulator in its slots, and the worker above them."""

from __future__ import annotations

import signal

from tests.faults.processes import Started, alive, command_of, descendants, kill, parents, until
from tests.storm.faults import processes
from tests.storm.faults.base import MIDDLE, Fault, Hurt
from tests.storm.site import SIMULATORS, Site

SLOW = str(SIMULATORS / "slow" / "slow.py")
HELPER = "sleep 86396.5"
"""What the slow simulator starts when it is told to."""


def programs(worker: Started) -> list[int]:
    """The simulators of its slots."""
    return [pid for pid in descendants(worker.pid) if command_of(pid).split(" ")[1:2] == [SLOW] and alive(pid)]


def one(number: signal.Signals) -> Hurt:
    return lambda site, worker: kill(programs(worker)[0], number=number)


def every(site: Site, worker: Started) -> None:
    kill(*programs(worker))


def guards(site: Site, worker: Started) -> None:
    """The processes between the child and its simulators."""
    tree = parents()
    kill(*{tree[pid] for pid in programs(worker) if pid in tree})


def helpers(worker: Started) -> list[int]:
    """What its simulators have started."""
    return [pid for pid in parents() if command_of(pid).startswith(HELPER) and alive(pid)]


def leaking(then: Hurt) -> Hurt:
    """Every simulator starts a helper in a session of its own; then something else happens."""

    def leak(site: Site, worker: Started) -> None:
        before = len(helpers(worker))
        told = programs(worker)
        kill(*told, number=signal.SIGUSR2)
        until(lambda: len(helpers(worker)) >= before + len(told), "helpers", 20)
        then(site, worker)

    return leak


def slotted(what: Hurt, costs: int = 0) -> Fault:
    return Fault(what, MIDDLE, "slots", costs)


FAULTS = {
    "slot killed": slotted(one(signal.SIGKILL), 1),
    "slot: segmentation fault": slotted(one(signal.SIGSEGV), 1),
    "slot stopped": slotted(one(signal.SIGSTOP), 1),
    "slot hangs and refuses to end": slotted(one(signal.SIGUSR1), 1),
    "all slots killed at once": slotted(every, 2),
    "guards of slots killed": slotted(guards, 2),
    "slots leak helpers": slotted(leaking(lambda site, worker: None)),
    "slots leak helpers and are killed": slotted(leaking(every), 2),
    "child killed while slots fly": slotted(processes.child(signal.SIGKILL)),
    "worker killed while slots fly": slotted(processes.supervisor(signal.SIGKILL)),
    "worker terminated while slots fly": slotted(processes.supervisor(signal.SIGTERM)),
    "all killed that is no slot, with helpers": slotted(
        leaking(lambda site, worker: kill(*[p for p in worker.family() if p not in programs(worker)]))
    ),
}
