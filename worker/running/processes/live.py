"""Live simulations for the service: a child process that answers requests on standard input, one line of JSON each.

Request  {"id", "campaign", "parameters": {path: value}, "rows"}; missing parameters are nominal.
         "seed" selects one noise realisation instead of the campaign's.
Response {"id", "status", "reason", "cost", "margin", "columns", "data", "meta", "identity"} or
         {"id", "error": sentence}.
Request  {"id", "kind": "field", "campaign", "parameters", "time", "places": [[x, y], ...]}, as in
`worker.engine.systems.closed_loop.field`.
Response {"id", "time", "place", "velocity", "kind", "memory", "unit", "own", "demand": [[x, y, z] or null, ...],
         "identity"}.
Response {"stale": true}: nothing was simulated because the code has changed; the process ends and must be restarted.
Run as `python -m worker.running.processes.live`; it ends when its input is closed.
"""

from __future__ import annotations

from worker.running.runs import sources as sources  # first: it records the files before they are loaded

# isort: split
from worker.running.processes import blas as blas  # before numpy is loaded

# isort: split
from campaigns import heap  # next: loading is not interrupted

# isort: split
import sys
from collections import OrderedDict
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from campaigns.asked.load import load_document
from campaigns.asked.scenario import MAX_REALISATION
from campaigns.stored.replies import FieldReply, FlightReply
from worker.engine.systems.closed_loop.field import MOST, UNITS, field
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.trace import simulate, trace
from worker.running.opening import opened
from worker.running.processes import answering, memory
from worker.running.processes.answering import finite, flight_reply, within
from worker.running.runs import provenance

heap.loaded()

PROBLEMS = 16
"""Number of problems in memory; the least recently used one is dropped."""

ROWS = 400


class Opened(NamedTuple):
    """The flights of a campaign, and the identity of the code that simulates them, as JSON."""

    flights: Flights
    identity: object


Problems = OrderedDict[str, Opened]
"""By the digest of the campaign."""


def main() -> None:
    """Answer requests until the input ends."""
    answers = answering.private_output()
    memory.bound()
    problems: Problems = OrderedDict()
    answering.serve(answers, sys.stdin.buffer, lambda line: answer(line, problems))


def answer(line: str | bytes, problems: Problems) -> Mapping[str, object]:
    """The response to one request."""

    def lost(error: Exception) -> None:
        if isinstance(error, MemoryError):
            problems.clear()

    return answering.answered(line, lambda request: _response(request, problems), "the simulation", lost)


def _response(request: Mapping[str, Any], problems: Problems) -> FieldReply | FlightReply:
    known = _opened(request["campaign"], problems)
    seed = request.get("seed")
    if seed is not None and (isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < MAX_REALISATION):
        raise ValueError(f"seed must be a whole number from 0 to {MAX_REALISATION - 1}, given {seed!r}")
    flights = known.flights.under(seed)
    values = {path: _value(flights, path, value) for path, value in request.get("parameters", {}).items()}
    kind = request.get("kind", "flight")
    if kind == "field":
        return _field(flights, values, request["time"], request["places"], known.identity)
    if kind != "flight":
        raise ValueError(f"kind must be 'flight' or 'field', given {kind!r}")
    return _flight(flights, values, request.get("rows", ROWS), known.identity)


def _opened(document: Any, problems: Problems) -> Opened:
    campaign = load_document(document, "the campaign of a live simulation")
    known = problems.pop(campaign.digest, None)
    if known is None:
        flights = opened.flights(campaign)
        known = Opened(flights, provenance.identified(campaign, loop=flights.loop.digest))
    problems[campaign.digest] = known
    if len(problems) > PROBLEMS:
        problems.popitem(last=False)
    return known


def _flight(flights: Flights, values: dict[str, float], rows: int, identity: object) -> FlightReply:
    simulated = trace(flights, "live", values, rows)
    head = simulated.meta
    return flight_reply(head, head.threshold, simulated.columns, simulated.data, identity)


def _field(flights: Flights, values: dict[str, float], time: Any, places: Any, identity: object) -> FieldReply:
    if isinstance(time, bool) or not isinstance(time, int | float) or not np.isfinite(time):
        raise TypeError(f"time must be a number of seconds, given {time!r}")
    wanted = np.asarray(places, dtype=np.float64)
    if wanted.ndim != 2 or wanted.shape[1] != 2 or not 0 < len(wanted) <= MOST or not np.isfinite(wanted).all():
        raise ValueError(f"places must be 1 to {MOST} pairs of finite numbers")
    found = field(flights, simulate(flights, values), float(time), wanted)
    return {
        "time": found.time,
        "place": found.place.tolist(),
        "velocity": finite(found.velocity.tolist()),
        "kind": found.kind,
        "memory": found.memory,
        "unit": UNITS[found.kind],
        "own": found.own.tolist() if np.isfinite(found.own).all() else None,
        "demand": [row.tolist() if np.isfinite(row).all() else None for row in found.demand],
        "identity": identity,
    }


def _value(flights: Flights, path: str, value: Any) -> float:
    if path not in flights.paths:
        raise ValueError(f"the scenario has no parameter {path!r}")
    limits = next(p for s in flights.loop.sections for p in s.parameters if f"{s.prefix}.{p.name}" == path)
    return within(path, value, limits.low, limits.high, limits.unit)


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(1)
