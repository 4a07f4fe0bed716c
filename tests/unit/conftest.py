"""The process of live simulations, shared by a module's tests. Start reading at `live`."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.unit.living import Live


@pytest.fixture(scope="module")
def live() -> Iterator[Live]:
    made = Live()
    assert made.hear() == {"ready": True}
    yield made
    assert made.end() == (0, b"")


"""[s]; the first flight may have to be compiled."""
