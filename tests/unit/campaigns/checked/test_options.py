"""Options of searches with which a campaign has too many uncertain parameters: refused before the run."""

from __future__ import annotations

import re
from typing import Any

import pytest

from campaigns import Campaign, Catalogue, check
from campaigns.checked.check import parameters, simulation_problems
from tests.given.case_campaigns import campaign, searching
from worker.running.catalogue.installed import catalogue

LIMITS = [
    (entry.name, option, value, most)
    for entry in catalogue().methods
    for option, by_value in entry.most_parameters.items()
    for value, most in by_value.items()
]


def varied(number: int, method: str, **options: Any) -> Campaign:
    """Case 1 with so many uncertain parameters, and one search."""
    known = parameters(campaign(), catalogue())
    paths = [path for path, (_, nominal) in known.items() if path.startswith(("vehicle", "contr", "avoid")) and nominal]
    assert number <= len(paths)
    uncertain = {path: {"plus_minus": "1%"} for path in paths[:number]}
    return searching({"method": method, "evaluations": 100, "options": options}, uncertain=uncertain)


@pytest.mark.parametrize(("method", "option", "value", "most"), LIMITS)
def test_a_search_that_could_not_begin_is_refused(method: str, option: str, value: str, most: int) -> None:
    assert check(varied(most, method, **{option: value}), catalogue()) == []
    (problem,) = check(varied(most + 1, method, **{option: value}), catalogue())
    assert (problem.field, problem.given) == (f"stages.search.0.options.{option}", value)
    assert re.findall(r"\d+", problem.message) == [f"{most}", f"{most + 1}"]


def limited(name: str, most: dict[str, dict[str, int]]) -> Catalogue:
    """The catalogue with other limits of a method."""
    known = catalogue()
    methods = [m.model_copy(update={"most_parameters": most}) if m.name == name else m for m in known.methods]
    return known.model_copy(update={"methods": methods})


def test_a_default_counts_as_stated_and_another_value_does_not() -> None:
    known = limited("nlopt_global", {"algorithm": {"crs2_lm": 2}})
    (problem,) = check(varied(3, "nlopt_global"), known)
    assert (problem.field, problem.given) == ("stages.search.0.options.algorithm", "crs2_lm")
    assert check(varied(3, "nlopt_global", algorithm="esch"), known) == []


def test_stored_runs_of_earlier_versions_are_displayed() -> None:
    asked = varied(3, "nlopt_global")
    assert simulation_problems(asked, limited("nlopt_global", {"algorithm": {"crs2_lm": 2}})) == []
