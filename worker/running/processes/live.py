"""Live simulations for the service: a child process that answers requests on standard input, one line of JSON each.

Request  {"id", "campaign", "parameters": {path: value}, "rows"}; missing parameters are nominal.
         "seed" selects one noise realisation instead of the campaign's.
Response {"id", "status", "reason", "cost", "margin", "columns", "data", "meta"} or {"id", "error": sentence}.
Request  {"id", "kind": "field", "campaign", "parameters", "time", "places": [[x, y], ...]}, as in
`worker.engine.systems.closed_loop.field`.
Response {"id", "time", "place", "velocity", "kind", "memory", "unit", "own", "demand": [[x, y, z] or null, ...]}.
Response {"stale": true}: nothing was simulated because the code has changed; the process ends and must be restarted.
Run as `python -m worker.running.processes.live`; it ends when its input is closed.
"""

from __future__ import annotations

from worker.running.runs import sources  # first: it records the files before they are loaded

# isort: split
from worker.running.processes import blas as blas  # before numpy is loaded

# isort: split
from campaigns import heap  # next: loading is not interrupted

# isort: split
import json
import os
import sys
from collections import OrderedDict
from collections.abc import Mapping
from typing import Any, TextIO

import numpy as np

from campaigns import CampaignError
from campaigns.asked.load import load_document
from campaigns.asked.spec import MAX_SEED
from campaigns.stored.replies import FieldReply, FlightReply
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.closed_loop.field import MOST, UNITS, field
from worker.engine.systems.closed_loop.flights import Flights
from worker.engine.systems.closed_loop.trace import simulate, trace
from worker.running.opening import opened
from worker.running.processes import memory

heap.loaded()

PROBLEMS = 16
"""Number of problems in memory; the least recently used one is dropped."""

ROWS = 400


def main() -> None:
    """Answer requests until the input ends."""
    # Standard output is redirected, so that output of a component does not mix with the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    memory.bound()
    send(answers, {"ready": True})
    problems: OrderedDict[str, Flights] = OrderedDict()
    for line in sys.stdin.buffer:
        if sources.stale():
            send(answers, {"stale": True})
            return
        send(answers, answer(line, problems))


def answer(line: str | bytes, problems: OrderedDict[str, Flights]) -> dict[str, object]:
    """The response to one request; an invalid request gets a response with an error message."""
    number = None
    try:
        request = json.loads(line)
        if not isinstance(request["id"], int | str):
            raise TypeError("id must be a whole number or text")
        number = request["id"]
        flights = _realised(_flights(request["campaign"], problems), request)
        parameters = request.get("parameters", {})
        values = {path: _value(flights, path, value) for path, value in parameters.items()}
        kind = request.get("kind", "flight")
        if kind == "field":
            return {"id": number, **_field(flights, values, request["time"], request["places"])}
        if kind != "flight":
            raise ValueError(f"kind must be 'flight' or 'field', given {kind!r}")
        return {"id": number, **_flight(flights, values, request.get("rows", ROWS))}
    except (CampaignError, CampaignUnusable) as error:
        return {"id": number, "error": str(error)}
    except MemoryError:
        problems.clear()
        return {"id": number, "error": memory.sentence()}
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return {"id": number, "error": f"invalid request: {type(error).__name__}: {error}"}
    except Exception as error:
        return {"id": number, "error": f"the simulation failed: {type(error).__name__}: {error}"}


def _flights(document: Any, problems: OrderedDict[str, Flights]) -> Flights:
    campaign = load_document(document, "the campaign of a live simulation")
    flights = problems.pop(campaign.digest, None) or opened.flights(campaign)
    problems[campaign.digest] = flights
    if len(problems) > PROBLEMS:
        problems.popitem(last=False)
    return flights


def _realised(flights: Flights, request: Mapping[str, object]) -> Flights:
    """The flights under the requested noise realisation, by default under those of the campaign."""
    seed = request.get("seed")
    if seed is not None and (isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < MAX_SEED):
        raise ValueError(f"seed must be a whole number from 0 to {MAX_SEED - 1}, given {seed!r}")
    return flights.under(seed)


def _flight(flights: Flights, values: dict[str, float], rows: int) -> FlightReply:
    simulated = trace(flights, "live", values, rows)
    head = simulated.meta
    return {
        "status": head.status,
        "reason": head.reason,
        "cost": head.cost,
        "margin": None if head.cost is None or head.threshold is None else head.cost - head.threshold,
        "columns": [column.model_dump() for column in simulated.columns],
        "data": {column.name: plain(simulated.data[:, k]) for k, column in enumerate(simulated.columns)},
        "meta": finite(head.model_dump()),
    }


def _field(flights: Flights, values: dict[str, float], time: Any, places: Any) -> FieldReply:
    if isinstance(time, bool) or not isinstance(time, int | float) or not np.isfinite(time):
        raise TypeError(f"time must be a number of seconds, given {time!r}")
    wanted = np.asarray(places, dtype=np.float64)
    if wanted.ndim != 2 or wanted.shape[1] != 2 or not 0 < len(wanted) <= MOST or not np.isfinite(wanted).all():
        raise ValueError(f"places must be 1 to {MOST} pairs of finite numbers")
    found = field(flights, simulate(flights, values), float(time), wanted)
    return {
        "time": found.time,
        "place": found.place.tolist(),
        "velocity": plain(found.velocity),
        "kind": found.kind,
        "memory": found.memory,
        "unit": UNITS[found.kind],
        "own": found.own.tolist() if np.isfinite(found.own).all() else None,
        "demand": [row.tolist() if np.isfinite(row).all() else None for row in found.demand],
    }


def _value(flights: Flights, path: str, value: Any) -> float:
    """The value of a parameter, which must exist and be within its component's limits."""
    if path not in flights.paths:
        raise ValueError(f"the scenario has no parameter {path!r}")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{path} must be a number, given {value!r}")
    limits = next(p for s in flights.loop.sections for p in s.parameters if f"{s.prefix}.{p.name}" == path)
    if not limits.low <= value <= limits.high:
        raise ValueError(f"{path} must be within {limits.low:g} to {limits.high:g} {limits.unit}, given {value!r}")
    return float(value)


def plain(column: np.ndarray[Any, np.dtype[np.float64]]) -> list[float | None]:
    return [float(v) if np.isfinite(v) else None for v in column]


def finite(value: Any) -> Any:
    """The value with null in place of non-finite numbers, which JSON cannot represent."""
    if isinstance(value, dict):
        return {k: finite(v) for k, v in value.items()}
    if isinstance(value, list):
        return [finite(v) for v in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def send(answers: TextIO, message: Mapping[str, object]) -> None:
    answers.write(json.dumps(message, allow_nan=False) + "\n")
    answers.flush()


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(1)
