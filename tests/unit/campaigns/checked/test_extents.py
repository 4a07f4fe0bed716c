"""The extent of obstacles against the threshold of a criterion that measures to their centres."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from campaigns import Campaign, Catalogue, check, library, load_file
from campaigns.asked.load import load_document
from campaigns.asked.text import to_yaml
from campaigns.checked.check import simulation_problems
from campaigns.checked.distances import clause, overlooked
from campaigns.claims.spans import words
from clearance.cli import invoke
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign, document
from tests.given.stated_facts import facts
from worker.running.catalogue.installed import catalogue
from worker.running.runs.continuation import Budget, CannotContinue, continued

WALL = {"component": "box", "parameters": {"position": {"x": 9.0, "y": 3.5}, "length": 16.0, "width": 0.2}}


def described(problem: Problem) -> tuple[Campaign, Catalogue]:
    """What the statements need of a problem."""
    return problem.campaign, catalogue()


def refused(**changes: Any) -> list[str]:
    """The fields of the problems of case 1 with these changes."""
    return [p.field for p in check(campaign(**changes), catalogue())]


def circle(radius: float, **more: Any) -> dict[str, Any]:
    return {"component": "circle", "parameters": {"position.x": 4.0, "position.y": 4.0, "radius": radius}} | more


@pytest.mark.parametrize(
    ("obstacles", "threshold", "ok"),
    [
        ([circle(0.5)], 0.5, True),
        ([circle(0.5)], 0.499, False),
        ([circle(0.0)], 0.0, True),
        ([circle(0.5), circle(0.8)], 0.7, False),
        ([circle(0.5), circle(0.8)], 0.8, True),
        ([WALL], 0.5, False),
        ([WALL], 8.0, False),
        ([WALL], 8.000625, True),
    ],
)
def test_a_threshold_below_the_reach_is_refused(obstacles: list[Any], threshold: float, ok: bool) -> None:
    found = refused(scenario__obstacles=obstacles, criterion__threshold=threshold)
    assert found == ([] if ok else ["criterion.threshold"])


def test_the_sentence_proposes_a_value_and_that_value_is_accepted() -> None:
    (problem,) = check(campaign(scenario__obstacles=[circle(0.5), WALL]), catalogue())
    assert "obstacles.1 and 1 more" not in problem.message
    assert "the surface of obstacles.1 extends to 8.00063 m" in problem.message
    assert "surface_separation" in problem.message
    assert "from_centre: true" in problem.message
    assert refused(scenario__obstacles=[WALL], criterion__threshold=8.00063) == []


def test_of_an_uncertain_extent_the_largest_counts() -> None:
    search = {"stages__search": [{"method": "direct", "evaluations": 10}]}
    round_ = search | {"uncertain": {"obstacles.0.radius": {"low": 0.4, "high": 0.6}}}
    assert refused(**round_, criterion__threshold=0.59) == ["criterion.threshold"]
    assert refused(**round_, criterion__threshold=0.6) == []
    long = search | {"uncertain": {"obstacles.0.length": {"plus_minus": "10%"}}, "scenario__obstacles": [WALL]}
    assert refused(**long, criterion__threshold=8.1) == ["criterion.threshold"]
    assert refused(**long, criterion__threshold=8.81) == []


def test_a_centre_distance_may_be_stated() -> None:
    stated = {"scenario__obstacles": [WALL], "criterion__from_centre": True}
    assert refused(**stated) == []
    surface = stated | {"criterion__component": "surface_separation"}
    assert refused(**surface) == ["criterion.from_centre"]
    assert refused(**surface | {"criterion__from_centre": False}) == []


def test_clear_inside_an_obstacle_is_refused_of_a_surface_distance_too() -> None:
    assert refused(criterion__component="surface_separation", criterion__threshold=-0.1) == ["criterion.threshold"]


def test_an_obstacle_of_another_package_that_declares_no_reach_is_left_alone() -> None:
    known = catalogue()
    undeclared = [c.model_copy(update={"reach": None}) if c.role == "obstacle" else c for c in known.components]
    assert check(campaign(scenario__obstacles=[WALL]), Catalogue(**dict(known) | {"components": undeclared})) == []


@pytest.mark.parametrize("name", library())
def test_every_shipped_campaign_is_accepted_as_published(name: str) -> None:
    found = load_file(library()[name])
    assert check(found, catalogue()) == []
    assert set(found.document()["criterion"]) == {"component", "parameters", "threshold"}


FROZEN: dict[str, Any] = {
    "name": "frozen",
    "scenario": {
        "vehicle": {"component": "unicycle"},
        "controller": {"component": "pid_speed"},
        "avoider": {"component": "none"},
        "goal": {"x": 6.0, "y": 7.0},
        "obstacles": [{"component": "circle", "parameters": {"position.x": 4.0, "position.y": 4.0}}],
        "horizon": 1.0,
        "step": 0.01,
    },
    "uncertain": {"vehicle.m": {"low": 4.0, "high": 6.0}},
    "criterion": {"threshold": 0.5},
    "stages": {"search": [{"method": "direct", "evaluations": 10}], "certify": None},
}


def test_what_does_not_state_it_keeps_its_digest() -> None:
    frozen = load_document(FROZEN)
    assert frozen.digest == "61a5dba965fd3e587316396256c0be93779bfda194120e3dbda9aef51dc3febe"
    statement = load_document(FROZEN | {"criterion": {"threshold": 0.5, "from_centre": False}})
    assert statement.digest == frozen.digest
    assert "from_centre" not in json.dumps(statement.document()) + to_yaml(statement)


def test_what_states_it_has_a_digest_of_its_own_and_keeps_saying_so() -> None:
    stated = campaign(criterion__from_centre=True)
    assert stated.digest != campaign().digest
    assert load_document(stated.document()).digest == stated.digest
    assert "from_centre: true" in to_yaml(stated)


def test_stored_campaigns_that_are_refused_now_can_be_shown_but_not_asked_for_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    earlier = campaign(scenario__obstacles=[WALL], scenario__horizon=0.1)
    assert simulation_problems(earlier, catalogue()) == []
    batch, _ = (problem := Problem(earlier, compiled=False)).evaluate(problem.nominal_point[None])
    assert batch.status.tolist() == [0]
    with pytest.raises(CannotContinue, match="surface_separation"):
        continued(earlier, Budget(10_000, more=True))
    file = tmp_path / "wall.yaml"
    file.write_text(to_yaml(earlier), encoding="utf-8")
    for command in ("validate", "run"):
        assert invoke([command, str(file)]) == 3
        assert "surface_separation" in capsys.readouterr().err


def test_a_verdict_can_state_which_point_distances_end_at() -> None:
    def of(**changes: Any) -> Problem:
        return Problem(campaign(**changes), compiled=False)

    assert words(overlooked(*described(of()))) == ""
    wall = of(scenario__obstacles=[WALL])
    assert facts(overlooked(*described(wall))) == ["d_min", wall.threshold, 8.00062]
    assert words(overlooked(*described(of(scenario__obstacles=[WALL], criterion__from_centre=True)))) == ""
    surface = {"criterion__component": "surface_separation"}
    body = surface | {"criterion__parameters": {"body_radius": 0.2}}
    uncertain = document()["uncertain"] | {"criterion.body_radius": {"low": 0.0, "high": 0.2}}
    unknown = of(**surface, uncertain=uncertain)
    assert [words(clause(*described(p))) for p in (of(), wall, of(**surface), of(**body), unknown)] == [
        "distances measured to the obstacles' centres, not their surfaces",
        "distances measured to the obstacles' centres, not their surfaces; a vehicle inside obstacles.0 may count as "
        "clear",
        "distances measured to the obstacles' surfaces",
        "distances measured to the obstacles' surfaces, less the radius of the vehicle's body of 0.2 m",
        "distances measured to the obstacles' surfaces, less criterion.body_radius",
    ]
