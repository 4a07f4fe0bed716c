"""Numbers as text, a column at a time."""

from __future__ import annotations

import numpy as np

from backend.http.written import cells

EDGES = [
    0.0,
    -0.0,
    1e-4,
    np.nextafter(1e-4, 0),
    1e-5,
    -1e-5,
    1e-7,
    1e16,
    np.nextafter(1e16, 0),
    1e22,
    123456789012345680.0,
]
EDGES += [5e-324, -2.2250738585072014e-308, 1.7976931348623157e308, np.nan, np.inf, -np.inf, 0.1 + 0.2, 100.0, 1 / 3]


def test_every_number_is_its_repr() -> None:
    bits = np.random.default_rng(6).integers(0, 2**64, 20_000, dtype=np.uint64).view(np.float64)
    usual = 10.0 ** np.random.default_rng(7).uniform(-6, 18, 20_000)
    for values in (np.array(EDGES), bits, usual, -usual, np.round(usual, 3)):
        assert cells(values) == [repr(value).encode() for value in values.tolist()]


def test_no_number_is_no_cell() -> None:
    assert cells(np.array([])) == []
