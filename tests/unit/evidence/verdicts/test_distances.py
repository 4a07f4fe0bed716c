"""What is not known of distances bars "cleared": to which point a criterion measures, how far an obstacle extends."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import Catalogue
from campaigns.catalogue import ComponentEntry
from campaigns.claims.spans import words
from tests.given.case_campaigns import campaign
from worker.evidence.scopes import closed_loop
from worker.evidence.scopes.base import Terms
from worker.running.catalogue.installed import catalogue


def known(component: str, **changes: Any) -> Catalogue:
    """The catalogue with a component that declares something else; None: a snapshot from before this declaration."""
    found = []
    for entry in catalogue().components:
        document = entry.model_dump(mode="json", exclude_unset=True)
        if entry.name == component:
            document = {k: v for k, v in document.items() if k not in changes}
            document |= {k: v for k, v in changes.items() if v != "older"}
        found.append(ComponentEntry.model_validate(document))
    return catalogue().model_copy(update={"components": found})


def terms(component: str, /, criterion: str = "separation", stated: bool = False, **changes: Any) -> Terms:
    asked = campaign(criterion={"component": criterion, "threshold": 0.6, "from_centre": stated})
    return closed_loop.described(asked, known(component, **changes), "DOP853")


def barred(found: Terms) -> str:
    return words(dict(found.bars).get("distances", ()))


def test_an_unknown_extent_bars_distances_to_centres() -> None:
    text = barred(terms("circle", reach=None))
    assert "obstacle 1 (Circle)" in text
    assert "declare its reach" in text
    assert not barred(terms("circle"))
    assert not barred(terms("circle", reach="older"))


def test_it_bars_neither_distances_to_surfaces_nor_distances_to_centres_that_are_meant() -> None:
    assert not barred(terms("circle", "surface_separation", reach=None))
    meant = terms("circle", stated=True, reach=None)
    assert not barred(meant)
    assert "inside obstacles.0" in words(meant.scope.distances)


@pytest.mark.parametrize("stated", [False, True])
def test_a_criterion_of_obstacles_that_does_not_state_to_what_it_measures_bars_cleared(stated: bool) -> None:
    text = barred(terms("separation", stated=stated, measured_to=""))
    assert "Separation from centres" in text
    assert not terms("separation", measured_to="").followed


def test_one_without_distances_or_of_the_whole_flight_or_of_an_earlier_version_does_not() -> None:
    none = terms("separation", measured_to="none")
    assert (barred(none), none.followed) == ("", False)
    assert not barred(terms("separation", measured_to="", of="flight"))
    older = terms("separation", measured_to="older")
    assert (barred(older), older.followed) == ("", True)
