"""What-if evaluations of simulators for the service: a child process that answers requests, one line of JSON each.

Request  {"id", "campaign", "simulator", "parameters": {path: value}, "rows"}; missing parameters are nominal;
         `simulator` is the version that the run needs, which this machine must have.
Response {"id", "status", "reason", "cost", "margin", "seconds", "untraced", "columns", "data", "meta", "identity"}
         or {"id", "error": sentence}.
Request  {"id", "kind": "installed", "campaign", "simulator"}
Response {"id", "missing": sentence}, empty if this machine has the simulator.
Response {"stale": true}: as of `worker.running.processes.live`.

The simulator evaluates in one slot, which ends when nothing was requested for a while. Run as
`python -m worker.running.processes.cases`; it ends when its input is closed.
"""

from __future__ import annotations

from worker.running.runs import sources as sources  # first: it records the files before they are loaded

# isort: split
from worker.running.processes import blas as blas  # before numpy is loaded

# isort: split
from campaigns import heap  # next: loading is not interrupted

# isort: split
import os
import select
import signal
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from campaigns import Campaign, thin
from campaigns.asked.load import load_document
from campaigns.asked.problem import Problem
from campaigns.results import TraceHead
from campaigns.results.base import OK, STATUS, Status
from campaigns.stored.replies import CaseReply, InstalledReply
from worker.engine.systems import optional
from worker.engine.systems.base import CampaignUnusable, NoResult, NoTrace, System, Trace, indices, slotted, with_values
from worker.engine.systems.simulators.called import Called
from worker.engine.systems.simulators.pooled import Pooled
from worker.engine.systems.simulators.simulated import Simulated
from worker.engine.systems.simulators.slots import places
from worker.engine.systems.simulators.slots.places import Place
from worker.running.catalogue import installed
from worker.running.opening import opened
from worker.running.processes import answering, memory
from worker.running.processes.answering import flight_reply, within
from worker.running.runs import provenance

heap.loaded()

IDLE = 60.0
"""Time without a request after which the processes of the simulators end [s]."""
QUICK = 2.0
"""If the first evaluation takes less, it is repeated: its time includes the start of the process [s]."""
LONGEST = 50.0
"""Time limit of an evaluation, shorter than that of the service [s]."""
MOST_ROWS = 2000


@dataclass
class Opened:
    """A simulator as one campaign asks for it; `evaluated`: whether its process has started."""

    system: System
    threshold: float
    identity: object
    """Of the code that evaluates, as JSON."""
    evaluated: bool = False


Systems = dict[str, Opened]
"""By the digest of the campaign; at most one."""


def main() -> None:
    """Answer requests until the input ends."""
    answers = answering.private_output()
    memory.bound()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that what the simulators started ends too
    places.remove_left()
    place = Place("cases")
    tempfile.tempdir = str(place.path)
    systems: Systems = {}
    try:
        answering.serve(answers, _lines(systems), lambda line: answer(line, systems))
    finally:
        # When this closes its output, the thread that started it may end, which sends another one.
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        close(systems)
        place.close()


def answer(line: str | bytes, systems: Systems) -> Mapping[str, object]:
    """The response to one request."""
    respond = partial(_response, systems=systems)
    return answering.answered(line, respond, "the evaluation", lambda error: close(systems))


def _response(request: Mapping[str, Any], systems: Systems) -> CaseReply | InstalledReply:
    campaign = load_document(request["campaign"], "the campaign of a case")
    if request.get("kind") == "installed":
        return {"missing": "" if campaign.digest in systems else missing(campaign, request["simulator"])}
    case = _opened(campaign, request["simulator"], systems)
    values = {path: _value(case.system, path, value) for path, value in request.get("parameters", {}).items()}
    return _evaluated(case, values, min(request.get("rows", 0), MOST_ROWS))


def close(systems: Systems) -> None:
    """End the processes of the simulators."""
    for one in systems.values():
        optional.close(one.system)
    systems.clear()


def _lines(systems: Systems) -> Iterator[bytes]:
    """The lines of the input; without one for a while, the processes of the simulators end."""
    reading, pending = sys.stdin.fileno(), b""
    while True:
        if not select.select([reading], [], [], IDLE if systems else None)[0]:
            close(systems)
            continue
        received = os.read(reading, 65536)
        if not received:
            return
        *lines, pending = (pending + received).split(b"\n")
        yield from lines


def _opened(campaign: Campaign, version: str, systems: Systems) -> Opened:
    """The simulator of a campaign, opened with one slot; raises CampaignUnusable and CampaignError."""
    known = systems.get(campaign.digest)
    if known is not None and not (isinstance(known.system, Simulated) and known.system.changed(now=True)):
        return known
    close(systems)
    if why := missing(campaign, version):
        raise CampaignUnusable([Problem("simulator.name", campaign.simulator.name if campaign.simulator else "", why)])
    system = slotted(opened.system(campaign)).single()
    inner = system.inner if isinstance(system, Called) else system
    if isinstance(inner, Pooled):
        inner.most_slots, inner.most_seconds = 1, LONGEST
    code = provenance.identified(campaign, simulator=system.digest)
    systems[campaign.digest] = Opened(system, campaign.criterion.threshold, code)
    return systems[campaign.digest]


def missing(campaign: Campaign, version: str) -> str:
    """Why this machine cannot evaluate the simulator of a campaign; empty if it has it."""
    installed.forget_simulators()
    name = campaign.simulator.name if campaign.simulator else ""
    entry = installed.catalogue().simulator(name)
    if entry is None:
        return (
            "the machine of the service has no such simulator; start the service with the same CLEARANCE_SIMULATORS "
            "and packages as the workers"
        )
    if version and version not in entry.versions:
        return "on the machine of the service it has other parameters or results than for this run"
    return ""


def _evaluated(case: Opened, values: Mapping[str, float], rows: int) -> CaseReply:
    """One call, whose time is that of a process that had been started before."""
    seconds, found = _timed(case.system, values)
    if not case.evaluated and seconds < QUICK:
        seconds, found = _timed(case.system, values)
    case.evaluated = True
    columns, data = ([], np.empty((0, 0))) if found.trace is None else (found.trace.columns, found.trace.data)
    data = data[thin.even(len(data), max(rows, 2))]
    reply = flight_reply(found.head, case.threshold, columns, data, case.identity)
    return {**reply, "seconds": seconds, "untraced": found.untraced}


@dataclass
class _Found:
    """One evaluation, with its trace or why there is none; empty if the simulator gives no traces."""

    head: TraceHead
    trace: Trace | None = None
    untraced: str = ""


def _timed(system: System, values: Mapping[str, float]) -> tuple[float, _Found]:
    """The evaluation with its trace, or without one if there is none, and how long it took [s]."""
    began, why = time.monotonic(), ""
    vector = with_values(system.nominal, indices(system.parameters), values)
    parameters = {p.path: float(v) for p, v in zip(system.parameters, vector, strict=False)}
    try:
        trace = system.trace("case", values)
        if trace is not None:
            return time.monotonic() - began, _Found(trace.meta, trace)
    except NoTrace as error:
        if isinstance(error, NoResult) and error.timeout:
            # A failure may be one of the trace alone, which is found out by evaluating without it.
            head = TraceHead(parameters=parameters, status=Status.TIMEOUT, reason=error.reason)
            return time.monotonic() - began, _Found(head)
        why = str(error)
    began = time.monotonic()
    batch, reasons = system.evaluate(vector[None])
    seconds = time.monotonic() - began
    good = int(batch.status[0]) == OK
    cost = float(batch.costs[0, 0]) if good else None
    result = system.results[0]
    own = {result.name: cost if cost is None or result.worse == "low" else 0.0 - cost}
    status = STATUS[int(batch.status[0])]
    head = TraceHead(parameters=parameters, status=status, reason=reasons.get(0, ""), cost=cost, values=own)
    return seconds, _Found(head, untraced=why if good else "")


def _value(system: System, path: str, value: Any) -> float:
    limits = next((p for p in system.parameters if p.path == path), None)
    if limits is None:
        raise ValueError(f"the simulator has no parameter {path!r}")
    return within(path, value, limits.low, limits.high, limits.unit)


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(1)
