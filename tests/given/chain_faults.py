"""The faults of an audit trail without their words, which tests/unit/backend/db/test_chain.py compares."""

from __future__ import annotations

import re


def rows_of(faults: list[str]) -> list[list[int]]:
    """The numbers in every fault."""
    return [[int(number) for number in re.findall(r"\d+", fault)] for fault in faults]
