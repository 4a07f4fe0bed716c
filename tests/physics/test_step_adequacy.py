"""Step halving of 200 random points for every library campaign; most of them only in the nightly tests.

Passes when none differs beyond the campaign's tolerance, or no more than its notes say ("Step adequacy: up to ...", see
`worker.running.reproduce.steps`).
"""

from __future__ import annotations

import pytest

from campaigns import library, load_file
from clearance.testing.problems import Problem
from worker.running.reproduce.steps import adequacy, sentence

PUBLISHED = ("unicycle_static", "pioneer_moving", "uav_static", "uav_moving", "uav_aca")
"""The five cases, and what is theirs; the variations of them by night."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in PUBLISHED else pytest.mark.nightly) for name in library()]
)
def test_the_step_of_every_campaign_is_small_enough(name: str) -> None:
    found = adequacy(name, Problem(load_file(library()[name])).system)
    assert found.ok, sentence(found)


@pytest.mark.nightly
@pytest.mark.parametrize("name", library())
def test_what_the_notes_declare_happens(name: str) -> None:
    system = Problem(load_file(library()[name])).system
    if adequacy(name, system).declared is None:
        pytest.skip("its notes declare nothing")
    many = adequacy(name, system, 10_000)
    assert many.ok, sentence(many)
    assert many.exceeding + many.differing > 0, "its notes allow for what no longer happens: correct them"
