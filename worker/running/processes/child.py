"""The process that executes a worker's runs: a crash or hang affects no other process.

Its supervisor writes claims to its standard input and reads one answer each, as lines of JSON; output of the
physics goes to standard error. Run as `python -m worker.running.processes.child`.
"""

from __future__ import annotations

from worker.running.runs import sources  # first: it records the files before they are loaded

# isort: split
from worker.running.processes import blas as blas  # before numpy is loaded

# isort: split
from campaigns import heap  # next: loading is not interrupted

# isort: split
import hashlib
import importlib
import json
import logging
import math
import os
import platform
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, TextIO

import sqlalchemy as sa

from backend.db import workers
from backend.db.engine import connect, write
from backend.db.outages import DatabaseOutage, storable, worded
from backend.db.queue import Claim, LostLease, Queue
from backend.db.store import RunStore
from campaigns import Campaign, CampaignError, Catalogue, logs
from campaigns.runs import run_name
from campaigns.stored.records import Begun
from campaigns.versions import OTHER_POINTS, OtherCode
from worker.engine.stages.parts.store import Store
from worker.running.processes.answering import private_output, send
from worker.running.runs import pulse

Execute = Callable[[Campaign, Store], Any]

log = logging.getLogger("clearance.worker")

POLL = 0.5
"""Interval at which a worker that flies a share of another's run looks for one of its own [s]."""


def main() -> None:
    """Read database and runner from the input, publish the catalogue, then execute claims until the input ends.

    If the code changed while it was loaded, nothing is published: the supervisor starts another child.
    """
    requests, answers = _private_streams()
    pulse.opened(int(sys.argv[1]))
    setup = json.loads(requests.readline())
    logs.set_up(os.environ, "%(asctime)s %(levelname)s %(message)s")
    logs.present |= {"worker": setup["worker"], "stage": lambda: pulse.own.stage}
    engine = connect(setup["database"], create=False)
    execute = resolve(setup["runner"])
    from worker.running.catalogue.digests import with_digests
    from worker.running.catalogue.installed import catalogue
    from worker.running.processes import memory
    from worker.running.runs import identity

    document, code = catalogue(), identity.installation()
    published = with_digests(document)
    heap.loaded()
    memory.bound()
    fresh = not sources.stale()
    if fresh:
        published = published.model_copy(
            update={"own": sources.own(sources.own_modules()), "code": identity.code_parts()}
        )
        # Its supervisor ends it if that takes too long while the database answers.
        write(engine, lambda connection: workers.publish(connection, published, code, setup["worker"]), math.inf)
    here = installation(published)
    send(
        answers,
        {
            "ready": True,
            "fresh": fresh,
            "simulators": document.versions,
            "installation": here,
        },
    )
    serve(engine, execute, document, requests, answers, here)


def installation(published: Catalogue) -> str:
    """What identifies this process where a run is refused: all by which it may be. A run that waits for the earlier
    files of a simulator is claimed once they are back."""
    from worker.running.runs.provenance import machine

    here = machine().model_dump_json(exclude={"cpu": {"model"}})
    named = repr((sources.LOADED.digest, platform.python_version(), here, sorted(published.digests.items())))
    return hashlib.sha256(named.encode()).hexdigest()


def serve(
    engine: sa.Engine, execute: Execute, components: Catalogue, requests: TextIO, answers: TextIO, here: str
) -> None:
    """Execute one claim after another; each gets an answer with its outcome, never an exception.

    The request `{"fresh": true}` checks whether the loaded code still equals the files. If not, no claim is executed.
    `{"assist": claim}` flies a share of a run that another worker holds. here: see `installation`.
    """
    for line in requests:
        request = json.loads(line)
        if "fresh" in request:
            send(answers, {"fresh": not sources.stale()})
        elif sources.stale():
            send(answers, {"outcome": "stale", "text": ""})
        else:
            shared = request.get("assist")
            claim = Claim(**(shared or request))
            logs.present["run"] = run_name(claim.run_id)
            assisting = partial(assist, engine, components, claim, here)
            send(answers, assisting() if shared else perform(execute, engine, components, claim))


def assist(engine: sa.Engine, components: Catalogue, claim: Claim, here: str) -> dict[str, str]:
    """Fly a share of a run that another worker holds, until nothing is left of it or a run waits; outcomes as of
    `perform`, `cancelled` among them."""
    from worker.engine.stages.parts.context import Cancelled
    from worker.running.runs import runner

    waiting = Waiting(Queue(engine), claim, components.versions, here)

    def share(campaign: Campaign, store: Store) -> bool:
        with suppress(Cancelled):
            runner.assist(campaign, store, waiting)
        return True

    return perform(share, engine, components, claim)


@dataclass
class Waiting:
    """Whether a run waits that this worker could begin, or the shared one ends; asked for at most once in `POLL`."""

    queue: Queue
    claim: Claim
    simulators: Sequence[str]
    installation: str
    last_query: float = -math.inf

    def __call__(self) -> bool:
        if time.monotonic() < self.last_query + POLL:
            return False
        self.last_query = time.monotonic()
        ends = self.queue.cancel_requested(self.claim)
        return ends or self.queue.ready(self.simulators, self.installation)


def perform(execute: Execute, engine: sa.Engine, components: Catalogue, claim: Claim) -> dict[str, str]:
    """Execute a claim; its answer may be stored and logged, whatever a component has raised.

    What cannot be used while files change may be half of the earlier and half of the later ones.
    """
    answer = _performed(execute, engine, components, claim)
    if answer["outcome"] in ("unusable", "spent") and sources.stale():
        answer["outcome"] = "edited"
    return answer | {"text": storable(answer["text"])}


def _performed(execute: Execute, engine: sa.Engine, components: Catalogue, claim: Claim) -> dict[str, str]:
    """Execute a claim.

    Outcomes: `done`, `lost` (lease), `refused` (other code began it, or another kind of machine), `edited` (files have
    changed: a new process compares them with those that began it), `unusable` (cannot be retried), `spent` (as that,
    and this process is not used again), `failed` (this attempt; neither is it), `database` (which cannot be used: no
    fault of the run).
    """
    from worker.engine.kernels import durations
    from worker.engine.stages.parts.context import ReplayMismatch
    from worker.engine.systems.base import CampaignUnusable
    from worker.running.catalogue.own import blamed
    from worker.running.processes import memory
    from worker.running.runs import begun
    from worker.running.runs.file_check import FilesChanged

    then: Begun | None = None
    try:
        store = RunStore(engine, claim, pulse.own.beat)
        then, newer = store.begun(), partial(store.of_newer_version, components)
        campaign = begun.readable(claim.document, f"run {claim.run_id}", then, newer)
        store.describe(campaign, components)
        with durations.reported(partial(_report, engine, claim, "compiling"), partial(_report, engine, claim)):
            verdict = execute(campaign, store)
        if verdict is None:
            return {"outcome": "failed", "text": "the runner ended without a verdict"}
    except LostLease:
        return {"outcome": "lost", "text": ""}
    except DatabaseOutage as error:
        return {"outcome": "database", "text": str(error)}
    except OtherCode as error:
        return {"outcome": "refused", "text": str(error)}
    except FilesChanged as error:
        return {"outcome": "edited", "text": str(error)}
    except ReplayMismatch as error:
        if not (others := begun.elsewhere(then)):
            return {"outcome": "unusable", "text": str(error)}
        return {"outcome": "refused", "text": f"{OTHER_POINTS}: {'; '.join(others)}"}
    except (CampaignUnusable, CampaignError) as error:
        return {"outcome": "unusable", "text": str(error)}
    except MemoryError:  # the next attempt would need as much memory
        log.exception("run %d: out of memory", claim.run_id)
        return {"outcome": "spent", "text": memory.sentence()}
    except (Exception, SystemExit) as error:
        log.exception("run %d: the runner failed", claim.run_id)
        sentence = blamed(error)
        if sentence:  # the next attempt would execute the same component
            return {"outcome": "spent", "text": f"a component failed: {sentence}"}
        what = worded(error)
        return {
            "outcome": "failed",
            "text": f"the runner raised {type(error).__name__}" + (f": {what}" if what else ""),
        }
    return {"outcome": "done", "text": ""}


def _report(engine: sa.Engine, claim: Claim, what: str = "", seconds: float | None = None) -> None:
    """Tell people what this process does; a run never fails because that could not be stored."""
    pulse.own.beat()
    with suppress(sa.exc.SQLAlchemyError):
        write(engine, lambda c: workers.doing(c, claim.worker, claim.run_id, what, seconds), 0.0)


def resolve(name: str) -> Execute:
    """The function named as `module:function`."""
    module, _, function = name.partition(":")
    found: Execute = getattr(importlib.import_module(module), function)
    return found


def _private_streams() -> tuple[TextIO, TextIO]:
    """Streams to the supervisor; standard input and output are redirected, so that print and input() are harmless."""
    requests = os.fdopen(os.dup(0), "r", encoding="utf-8")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    return requests, private_output()


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(1)
