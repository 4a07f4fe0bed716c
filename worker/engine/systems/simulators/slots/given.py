"""The environment that a worker was given, for programs of others: without what is set for our own processes."""

from __future__ import annotations

from collections.abc import Mapping

THREADS = "OPENBLAS_NUM_THREADS"
"""Set by `worker.running.processes.blas`."""
BEFORE = f"GIVEN_{THREADS}"
"""What it was before; empty if it was not set. Names with CLEARANCE_ are settings."""


def original(environment: Mapping[str, str]) -> dict[str, str]:
    """The environment of a process of ours as it was before."""
    if BEFORE not in environment:
        return dict(environment)
    others = {name: value for name, value in environment.items() if name not in (THREADS, BEFORE)}
    return others | ({THREADS: environment[BEFORE]} if environment[BEFORE] else {})
