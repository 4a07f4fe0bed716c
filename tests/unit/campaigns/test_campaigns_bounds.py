"""Overall limits of a campaign: simulation steps, size of traces and of results."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import Campaign, check, library, load_file
from campaigns.checked import effort
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign
from worker.running.catalogue.installed import catalogue

SEARCH = {"method": "direct", "evaluations": 10_000_000}
NOISE = [{"component": "sensor_noise", "parameters": {"sigma": 0.05}}]
NOISY = {"scenario__faults": NOISE, "scenario__realisations": {"seeds": list(range(64))}}


def problems(asked: Campaign) -> list[tuple[str, str]]:
    return [(problem.field, problem.message) for problem in check(asked, catalogue())]


@pytest.mark.by_day(8)
@pytest.mark.parametrize("name", library())
def test_the_library_stays_far_below(name: str) -> None:
    asked = load_file(library()[name])
    assert problems(asked) == []
    problem = Problem(asked, compiled=False)
    numbers = problem.system.loop.n_state + problem.system.loop.n_held + len(problem.system.loop.signals)
    assert effort.traced_steps(asked) * numbers <= effort.traced(asked) <= 0.02 * effort.MOST_TRACED


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        (
            {"scenario__horizon": 200, "stages__search": [SEARCH], **NOISY},
            "stages",
            "at most 1e+13 steps of simulation in all: lower the evaluations of the stages, the realisations, or",
        ),
        ({"stages__search": [SEARCH] * 10}, "stages", "about 4.0 GB of results, at most 2.4 GB: lower the evaluations"),
        (
            {"scenario__horizon": 2000, "scenario__step": 0.001, "scenario__obstacles": [
                {"component": "circle", "parameters": {"position.x": 4 + i, "position.y": 4.0, "radius": 0.5}}
                for i in range(2)]},
            "scenario.step",
            "the trace of one simulation would take about 0.9 GB, at most 0.8 GB: lengthen the step, shorten the "
            "horizon",
        ),
    ],
    ids=["steps", "results", "trace"],
)  # fmt: skip
def test_what_no_machine_can_hold_is_refused_with_what_to_lower(
    changes: dict[str, Any], field: str, message: str
) -> None:
    ((found, statement),) = problems(campaign(**changes))
    assert found == field
    assert statement.startswith(message)


def test_a_large_campaign_is_none_of_these() -> None:
    assert problems(campaign(stages__search=[SEARCH], **NOISY)) == []
    assert problems(campaign(scenario__horizon=2000, scenario__step=0.001)) == []
