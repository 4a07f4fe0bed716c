"""Replacements of the physics in a child process for fault tests: crashes, hangs, refusals. Each is a runner.

Campaigns choose by their name what happens.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns import Problem as Wrong
from campaigns.results import Verdict
from campaigns.stored.records import StagePlan
from tests import results
from tests.faults.cases import columns
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.store import Store
from worker.engine.systems import optional
from worker.engine.systems.base import CampaignUnusable
from worker.running.opening import opened
from worker.running.runs import provenance

SEARCH = 400
CHUNK = 20

LINGER = 1.0
"""How long `linger` takes to say that it has finished: longer than the time between two beats [s]."""


def execute(campaign: Campaign, store: Store) -> Verdict | None:
    """Two stages; halfway through the second, the fault given by the campaign's name: `crash ...`."""
    records = store.plan([StagePlan("nominal", None, 1), StagePlan("search", "direct", SEARCH)])
    if records[0].state != "done":
        store.begin(0)
        store.append(0, 0, columns(0, 1))
        store.finish(0, results.nominal(), 0.01)
    store.begin(1)
    held = store.evaluations(1)
    flown = 0 if held is None else len(held.status)
    for first in range(flown, SEARCH, CHUNK):
        if first >= SEARCH // 2:
            happen(campaign)
        store.append(1, first, columns(first, CHUNK))
    store.finish(1, results.searched(), 1.0)
    verdict = results.verdict()
    store.conclude(verdict)
    if campaign.name.startswith("linger"):
        threading.Event().wait(LINGER)
    return verdict


def flying(campaign: Campaign, store: Store) -> Verdict:
    """The nominal flight alone of the code that this process loaded; then the accident, if any.

    In plain Python, or compiled if the name of the campaign ends with that word.
    """
    compiled = campaign.name.endswith("compiled")
    problem = Problem(campaign, opened.closed_loop(campaign, compiled=compiled, lanes=1))
    if compiled:
        optional.warm(problem.system)
    records = store.plan([StagePlan("nominal", None, 1), StagePlan("search", "direct", SEARCH)])
    provenance.begin(store, problem.system, campaign, records)
    if records[0].state != "done":
        store.begin(0)
        batch, _ = problem.evaluate(problem.nominal_point[None, :])
        store.finish(0, results.nominal(float(batch.costs[0, 0])), 0.01)
    store.begin(1)
    happen(campaign)
    cost = float(problem.evaluate(problem.nominal_point[None, :])[0].costs[0, 0])
    verdict = results.verdict(nominal=cost, worst=None)
    store.conclude(verdict)
    return verdict


def happen(campaign: Campaign) -> None:
    """The fault of that name; the file `summary` marks that it has already occurred."""
    word, once = campaign.name.split()[0], Path(campaign.summary) if campaign.summary else None
    if once is not None:
        if once.exists():
            return
        once.touch()
        while word == "pause" and not once.read_text():
            threading.Event().wait(0.01)
    ACCIDENTS[word]()


def hang() -> None:
    """Wait for something that never comes."""
    threading.Event().wait()


def hold() -> None:
    """Wait for ever inside a C function that does not let go of the interpreter."""
    ctypes.PyDLL(None).pause()


def spawn_and_hang() -> None:
    """Start a process, as an external simulator is started, and hang."""
    child = subprocess.Popen([sys.executable, "-c", "import signal; signal.pause()"])
    print(f"started {child.pid}", flush=True)
    hang()


WINGS = "it has no wings; choose another one"


def refuse() -> None:
    """As the runner does with a campaign that cannot be run."""
    raise CampaignUnusable([Wrong("scenario.vehicle", "unicycle", WINGS)])


def unstorable() -> None:
    """An error of a component whose text no database can store."""
    raise CampaignUnusable([Wrong("scenario.vehicle", "unicycle", "\ud800\0")])


def fail() -> None:
    """An error that looks like one of the supervisor's own pipe."""
    raise BrokenPipeError(32, "no pipe")


def leave() -> None:
    """End the process from inside."""
    sys.exit("enough")


def devour() -> None:
    """Allocate 64 GiB without touching it: the address space is limited."""
    held = [np.empty(2**27) for _ in range(64)]
    print(f"took {len(held)} GiB", flush=True)


def talk() -> None:
    """Print what could be taken for an answer, and read what could be a claim."""
    print('{"outcome": "done", "text": ""}', flush=True)
    assert sys.stdin.read() == ""


ACCIDENTS: dict[str, Any] = {
    "none": lambda: None,
    "linger": lambda: None,
    "pause": lambda: None,  # until something is written to the file
    "segfault": lambda: os.kill(os.getpid(), signal.SIGSEGV),
    "kill": lambda: os.kill(os.getpid(), signal.SIGKILL),
    "exit": lambda: os._exit(7),
    "hang": hang,
    "hold": hold,
    "spawn": spawn_and_hang,
    "refuse": refuse,
    "unstorable": unstorable,
    "fail": fail,
    "leave": leave,
    "devour": devour,
    "talk": talk,
}
