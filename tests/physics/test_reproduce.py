"""The published case studies: every row that the reconstruction states a tolerance for keeps it.

What is not held is shown by `clearance reproduce` with its reason. Start reading at `test_rows_that_must_agree_do`.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from campaigns import library
from worker.catalog import methods
from worker.reproduce.compare import RESULTS, reproduce
from worker.reproduce.ours import Flights
from worker.reproduce.published import Result, Search

CAMPAIGNS = list(dict.fromkeys(result.campaign for result in RESULTS))


@pytest.fixture(scope="module")
def flights() -> Iterator[Flights]:
    flights = Flights()
    yield flights
    flights.close()


def computable(result: Result) -> bool:
    return not isinstance(result.how, Search) or any(name in methods() for name in result.how.names)


def test_library_has_every_campaign() -> None:
    assert set(CAMPAIGNS) <= set(library())


@pytest.mark.parametrize("campaign", CAMPAIGNS)
def test_rows_that_must_agree_do(campaign: str, flights: Flights) -> None:
    asked = [r for r in RESULTS if r.campaign == campaign and computable(r)]
    made = reproduce(flights=flights, published=asked)
    assert all(row.available for row in made.rows), [row.note for row in made.rows if not row.available]
    held = [row for row in made.rows if row.must]
    assert held
    assert [(row.table, row.row, row.ours, row.model, row.note) for row in held if not row.agrees] == []


@pytest.mark.parametrize("campaign", CAMPAIGNS)
def test_published_local_minima_are_none(campaign: str, flights: Flights) -> None:
    # Descents from the published starts end elsewhere and lower, or the row would have to say that it agrees.
    asked = [r for r in RESULTS if r.campaign == campaign and "no such local minimum" in r.note]
    for row in reproduce(flights=flights, published=asked).rows if asked else ():
        assert row.agrees is False
        assert isinstance(row.ours, float)
        assert row.note
