"""The address of an evaluator: `local:N`, or a Dask scheduler. Read without `dask.distributed`, which is an extra."""

from __future__ import annotations

import importlib.util
import os
from dataclasses import dataclass
from urllib.parse import SplitResult, parse_qsl, urlsplit

SETTING = "CLEARANCE_EVALUATOR"
"""The environment variable with the address; empty: slots of this process."""

PATIENCE = 60.0
"""Time to wait for a scheduler or for workers [s], unless the address states another."""

PROCESSES = 1024
"""Most processes of `local:N`, and most slots of an address."""

SCHEMES = {"dask": "tcp", "dask+tls": "tls"}


class BadEvaluator(ValueError):
    """The address cannot be used; the message names it and what is expected."""


class EvaluatorLost(RuntimeError):
    """No evaluation can be carried out any more, with the reason; nothing is known of those that had not ended."""


@dataclass(frozen=True)
class Evaluator:
    """Where simulators evaluate: processes of a cluster on this machine, or a scheduler.

    address: as given; scheduler: that of Dask, empty for `processes` on this machine; slots: evaluations side
    by side that searches assume, 0 for as many as the cluster has threads when the run begins; patience [s].
    """

    address: str
    scheduler: str = ""
    processes: int = 0
    slots: int = 0
    patience: float = PATIENCE


def chosen() -> Evaluator | None:
    """The evaluator of this process; None for slots of its own. Raises `BadEvaluator`."""
    address = os.environ.get(SETTING, "").strip()
    return evaluator(address) if address else None


def evaluator(address: str) -> Evaluator:
    """Read an address; raises `BadEvaluator`, also where `dask.distributed` is not installed."""
    found = _local(address) if address.startswith("local:") else _dask(address)
    if importlib.util.find_spec("distributed") is None:
        raise BadEvaluator(f"evaluator {address!r}: dask.distributed is not installed: install clearance[cluster]")
    return found


def _local(address: str) -> Evaluator:
    count = _whole(address.removeprefix("local:"))
    if not 1 <= count <= PROCESSES:
        raise _bad(address)
    return Evaluator(address, processes=count, slots=count)


def _dask(address: str) -> Evaluator:
    try:
        parts = urlsplit(address)
        port = parts.port
    except ValueError:  # an invalid port, unclosed brackets
        raise _bad(address) from None
    if parts.scheme not in SCHEMES or not parts.hostname or port is None or parts.path not in ("", "/"):
        raise _bad(address)
    if parts.username is not None or parts.fragment:
        raise _bad(address)
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    slots, patience = _options(address, parts)
    return Evaluator(address, f"{SCHEMES[parts.scheme]}://{host}:{port}", slots=slots, patience=patience)


def _options(address: str, parts: SplitResult) -> tuple[int, float]:
    slots, patience = 0, PATIENCE
    for name, value in parse_qsl(parts.query, keep_blank_values=True):
        number = _whole(value)
        if name == "slots" and 1 <= number <= PROCESSES:
            slots = number
        elif name == "patience" and 1 <= number <= 7 * 86_400:
            patience = float(number)
        else:
            raise BadEvaluator(
                f"evaluator {address!r}: invalid {name}={value}: allowed are slots=1 to slots={PROCESSES} "
                f"and patience=1 to patience={7 * 86_400} [s]"
            )
    return slots, patience


def _whole(text: str) -> int:
    """A whole number; -1 for anything else."""
    return int(text) if text.isascii() and text.isdigit() and len(text) < 10 else -1


def _bad(address: str) -> BadEvaluator:
    return BadEvaluator(
        f"invalid evaluator {address!r}: give local:N for N processes on this machine (N from 1 to {PROCESSES}), "
        "or dask://HOST:PORT for a Dask scheduler, such as dask://node1:8786 (dask+tls:// for one with TLS)"
    )
