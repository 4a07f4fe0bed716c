"""The published case studies: every row with a stated tolerance meets it.

What is not held is shown by `clearance reproduce` with its reason.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from campaigns import library
from tests.physics.scenes import AT_NIGHT, nightly
from worker.running.reproduce.compare import RESULTS, reproduce
from worker.running.reproduce.ours import Flights
from worker.running.reproduce.published import Result, Search

CAMPAIGNS = list(dict.fromkeys(result.campaign for result in RESULTS))

LONG = {"uav_moving": 8_100}
"""Evaluations of a search above which its rows are among the long ones, else 5,000."""
SAMPLE = 1_000
"""The same for Monte Carlo, whose values are shown, and held to nothing."""


def long(result: Result) -> bool:
    """Whether a row takes a long search."""
    how = result.how
    most = SAMPLE if isinstance(how, Search) and how.names == ("monte_carlo",) else LONG.get(result.campaign, 5_000)
    return isinstance(how, Search) and how.evaluations > most


@pytest.fixture(scope="module")
def flights() -> Iterator[Flights]:
    flights = Flights()
    yield flights
    flights.close()


def test_library_has_every_campaign() -> None:
    assert set(CAMPAIGNS) <= set(library())


def held(asked: list[Result], flights: Flights) -> None:
    """Every row can be computed, and those that must agree do."""
    made = reproduce(flights=flights, published=asked)
    assert all(row.available for row in made.rows), [row.note for row in made.rows if not row.available]
    must = [row for row in made.rows if row.must]
    assert must
    assert [(row.table, row.row, row.ours, row.model, row.note) for row in must if not row.agrees] == []


# Case 2 is at night: by day its golden costs and an independent program are.
@pytest.mark.by_day(1)
@pytest.mark.parametrize("campaign", nightly(CAMPAIGNS, AT_NIGHT | {"pioneer_moving"}))
def test_rows_that_must_agree_do(campaign: str, flights: Flights) -> None:
    held([r for r in RESULTS if r.campaign == campaign and not long(r)], flights)


@pytest.mark.nightly
@pytest.mark.parametrize("campaign", dict.fromkeys(r.campaign for r in RESULTS if long(r)))
def test_rows_of_long_searches_that_must_agree_do(campaign: str, flights: Flights) -> None:
    held([r for r in RESULTS if r.campaign == campaign], flights)


@pytest.mark.by_day(2)
@pytest.mark.parametrize("campaign", nightly(CAMPAIGNS))
def test_published_local_minima_are_none(campaign: str, flights: Flights) -> None:
    # Descents from the published starts end elsewhere and lower, or the row would have to say that it agrees.
    asked = [r for r in RESULTS if r.campaign == campaign and "no such local minimum" in r.note]
    for row in reproduce(flights=flights, published=asked).rows if asked else ():
        assert row.agrees is False
        assert isinstance(row.ours, float)
        assert row.note


def test_case_3_has_a_local_minimum_of_its_own(flights: Flights) -> None:
    # At the worst mass and elevator d_min does not rise steadily with thrust: the second published start ends there.
    loop = flights.open("uav_static").loop
    edge = {"vehicle.m": 2.28, "vehicle.C_mde": -1.017}
    for step in (loop.step, loop.step / 4):
        points = [loop.vector(edge | {"vehicle.C_dt": thrust}) for thrust in (10.971, 12.0, 12.918, 13.409)]
        corner, before, lowest, after = loop.simulate_vectors(np.array(points), step)[0].costs[:, 0]
        assert lowest == pytest.approx(27.5408, abs=2e-4)
        assert lowest < before - 0.015
        assert lowest < after - 0.008
        assert corner < lowest - 0.1
