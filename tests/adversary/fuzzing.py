"""Sends mutated campaign documents through the doors of the service, and measures each; a process of its own.

`python -m tests.adversary.fuzzing DATABASE FIRST COUNT` prints one JSON object. DATABASE is the address of one with the
catalogue as a worker publishes it: like the service, this process imports no physics, so its memory is that of the
service.
"""

from __future__ import annotations

import json
import resource
import signal
import sys
import time
import traceback
from collections import Counter
from pathlib import Path
from types import FrameType
from typing import Any

import sqlalchemy as sa

from backend.catalog import service
from backend.catalog.endpoints import _campaign
from backend.db.access import Visitor
from backend.db.engine import connect, read
from backend.db.roles import LOCAL
from backend.http.errors import RefusedError, invalid, respond
from backend.middleware.frame import LARGEST_BODY
from backend.runs import submission
from backend.runs.address import AddressParts
from backend.runs.endpoints import _submission
from backend.runs.quota import Quota
from campaigns import CampaignError
from tests.adversary.mutations import document

HANG = 10.0
"""Processor time after which a document is interrupted [s]."""

LARGEST_ANSWER = 100_000
QUOTA = Quota(10**9, 10**9, 10**15)
VISITOR = Visitor("local", "link", account=LOCAL, role="admin")


class HangError(BaseException):
    """No `Exception`, so that no reader takes it for a fault of the document."""


class Fault(AssertionError):
    """An answer that is none."""


def answered(answer: bytes) -> None:
    """An answer is JSON of a limited size."""
    if len(answer) > LARGEST_ANSWER:
        raise Fault(f"an answer of {len(answer)} bytes")
    json.loads(answer.decode())


def checked(engine: sa.Engine, content: bytes, yaml: bool) -> bool:
    """POST /campaigns/check: whether the campaign is valid."""
    with read(engine) as reader:
        found = service.checked(reader, _campaign(content, yaml))
    written = found.model_dump_json().encode()
    if found.ok:
        json.loads(written)  # as long as the campaign itself
    else:
        answered(json.dumps([problem.model_dump() for problem in found.problems]).encode())
        if not found.problems or not all(problem.message for problem in found.problems):
            raise Fault("refused without a reason")
    return found.ok


def submitted(engine: sa.Engine, content: bytes, yaml: bool) -> bool:
    """POST /runs: queued."""
    submission.submit(engine, _submission(content, yaml, AddressParts({})), VISITOR, None, QUOTA)
    return True


DOORS = {"check": checked, "submit": submitted}


def measured(engine: sa.Engine, first: int, count: int) -> dict[str, Any]:
    """Outcomes, faults and the largest cost of the documents `first` to `first + count - 1`."""
    outcomes: Counter[str] = Counter()
    faults: list[dict[str, Any]] = []
    slowest: list[tuple[float, str, int]] = []
    for seed in range(first, first + count):
        body = document(seed)
        if len(body.content) > LARGEST_BODY:  # refused with 413 before it is read
            outcomes["too large"] += 1
            continue
        accepted: dict[str, bool] = {}
        for name, door in DOORS.items():
            began = time.process_time()
            signal.setitimer(signal.ITIMER_PROF, HANG)
            try:
                accepted[name] = door(engine, *body)
            except (RefusedError, CampaignError) as error:
                accepted[name] = False
                refused = invalid(error) if isinstance(error, CampaignError) else error
                answered(bytes(respond(refused, "/").body))
            except (HangError, Exception) as error:
                statement = "".join(traceback.format_exception(error)[-3:])[-1500:]
                faults.append({"seed": seed, "door": name, "error": repr(error)[:300], "trace": statement})
                accepted[name] = False
            finally:
                signal.setitimer(signal.ITIMER_PROF, 0)
            slowest.append((time.process_time() - began, name, seed))
        slowest = sorted(slowest, reverse=True)[:10]
        if accepted["check"] and not accepted["submit"]:
            faults.append({"seed": seed, "door": "submit", "error": "refused what the check calls valid", "trace": ""})
        outcomes["accepted" if accepted["submit"] else "refused"] += 1
    return {
        "outcomes": dict(outcomes),
        "faults": faults,
        "slowest": slowest,
        "peak": peak(),
        "seconds": time.process_time(),
    }


def peak() -> int:
    """The largest resident memory of this process [bytes]. `ru_maxrss` would include that of the process before exec,
    which is the caller's: it survives fork and exec."""
    status = Path("/proc/self/status")
    if not status.is_file():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    (line,) = [line for line in status.read_text().splitlines() if line.startswith("VmHWM:")]
    return int(line.split()[1]) * 1024


def main(url: str, first: int, count: int) -> None:
    """Print the measurement."""

    def hang(number: int, frame: FrameType | None) -> None:
        raise HangError(f"more than {HANG} s of processor time")

    signal.signal(signal.SIGPROF, hang)
    engine = connect(url)
    json.dump(measured(engine, first, count), sys.stdout)
    engine.dispose()


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
