"""Garbage collection while tests are collected and run. Start reading at `pytest_collection_finish`.

A process that has collected all tests holds 800,000 objects. Searching them for cycles again and again took a third of
the collection and a fifth of the tests' time; none of them ends before the process does.
"""

from __future__ import annotations

import gc


def pytest_configure() -> None:
    """Collecting makes hardly any garbage."""
    gc.disable()


def pytest_collection_finish() -> None:
    """From here on only what the tests make is searched."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(10_000, 10, 10)
    gc.enable()
