"""Every search method as a parameter of tests."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import Any

import pytest

from worker.running.catalogue.installed import methods

EACH = pytest.mark.parametrize("method", methods().values(), ids=lambda m: m.name)


def with_each(names: Iterable[str], values: Sequence[int], share: int = 1) -> list[Any]:
    """(method, name, value) as parameters of a test: by day every method with one of `share` of
    the names, the next method with the next, and every pair of two where `share` is 1; at night all three."""
    return [
        pytest.param(method, name, value, id=f"{name}-{value}-{method.name}", marks=() if day else pytest.mark.nightly)
        for (i, method), (j, name), (k, value) in product(*map(enumerate, (methods().values(), names, values)))
        for day in [(i + j) % share == 0 and ((i + j) // share + k) % len(values) == 0]
    ]
