"""What the processes that answer requests share: a line of JSON for each, and `stale` once the code has changed."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TextIO

from campaigns import CampaignError
from campaigns.results import TraceHead
from campaigns.results.trace import TraceColumn
from campaigns.stored.replies import FlightReply
from worker.engine.systems.base import CampaignUnusable, Floats
from worker.running.processes import memory
from worker.running.runs import sources


def private_output() -> TextIO:
    """The file to which answers are written; standard output is redirected, so that output of a simulation does not mix
    with them."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return answers


def send(answers: TextIO, message: Mapping[str, object]) -> None:
    answers.write(json.dumps(message, allow_nan=False) + "\n")
    answers.flush()


def serve(answers: TextIO, lines: Iterable[bytes], answer: Callable[[bytes], Mapping[str, object]]) -> None:
    """Answer requests until the input ends or the code has changed."""
    send(answers, {"ready": True})
    for line in lines:
        if sources.stale():
            send(answers, {"stale": True})
            return
        send(answers, answer(line))


def answered(
    line: str | bytes,
    respond: Callable[[Mapping[str, Any]], Mapping[str, object]],
    what: str,
    lost: Callable[[Exception], None],
) -> Mapping[str, object]:
    """The response to one request; an invalid request gets a response with an error message.

    what: is done for a request; lost: called where it ran out of memory or raised an unexpected error.
    """
    number = None
    try:
        request = json.loads(line)
        if not isinstance(request["id"], int | str):
            raise TypeError("id must be a whole number or text")
        number = request["id"]
        return {"id": number, **respond(request)}
    except (CampaignError, CampaignUnusable) as error:
        return {"id": number, "error": str(error)}
    except MemoryError as error:
        lost(error)
        return {"id": number, "error": memory.sentence()}
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return {"id": number, "error": f"invalid request: {type(error).__name__}: {error}"}
    except Exception as error:
        lost(error)
        return {"id": number, "error": f"{what} failed: {type(error).__name__}: {error}"}


def flight_reply(
    head: TraceHead, threshold: float | None, columns: Sequence[TraceColumn], data: Floats, identity: object
) -> FlightReply:
    """One evaluation, with the rows of its trace, if it has columns."""
    return {
        "status": head.status,
        "reason": head.reason,
        "cost": head.cost,
        "margin": None if head.cost is None or threshold is None else head.cost - threshold,
        "columns": [column.model_dump() for column in columns],
        "data": {column.name: finite(data[:, k].tolist()) for k, column in enumerate(columns)},
        "meta": finite(head.model_dump()),
        "identity": identity,
    }


def within(path: str, value: Any, low: float, high: float, unit: str) -> float:
    """The value of a parameter, which must be a number within these limits."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{path} must be a number, given {value!r}")
    if not low <= value <= high:
        raise ValueError(f"{path} must be within {low:g} to {high:g} {unit}, given {value!r}")
    return float(value)


def finite(value: Any) -> Any:
    """The value with null in place of non-finite numbers, which JSON cannot represent."""
    if isinstance(value, dict):
        return {k: finite(v) for k, v in value.items()}
    if isinstance(value, list):
        return [finite(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
