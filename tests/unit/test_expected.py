"""The announced number of evaluations is within 20 % of what runs of the published campaigns really have.

`FLOWN` is what they had, by stage; the nightly test measures one of them again. The others differ by a few percent from
machine to machine, as searches depend on the last bits of every evaluation.
"""

from __future__ import annotations

import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.checked.expected import SPOT_CHECKS, VIOLATIONS, again, boundary, expected
from tests.simulators import package
from tests.unit.cases import document

FLOWN: dict[str, dict[str, int]] = {
    "unicycle_static": {"nominal": 1, "sensitivity": 42, "search": 6377, "certify": 3000, "validate": 996},
    "unicycle_navigation": {"nominal": 1, "sensitivity": 105, "search": 13_925, "certify": 3000, "validate": 4904},
    "uav_moving": {"nominal": 1, "sensitivity": 63, "search": 12_138, "certify": 3000, "validate": 1136},
    "uav_moving_criteria": {"nominal": 1, "sensitivity": 33, "search": 4014, "certify": 2000, "validate": 1231},
    "uav_aca": {"nominal": 1, "sensitivity": 126, "search": 42_045, "certify": 3000, "validate": 8276},
    "pioneer_moving": {"nominal": 1, "sensitivity": 168, "search": 25_804, "certify": 3000, "validate": 12_532},
}


def announced(name: str) -> dict[str, int]:
    return {stage.kind: stage.evaluations for stage in expected(load_file(library()[name]))}


@pytest.mark.parametrize("name", FLOWN)
def test_what_is_announced_is_what_is_flown(name: str) -> None:
    told, flown = announced(name), FLOWN[name]
    assert told.keys() == flown.keys()
    assert abs(sum(told.values()) - sum(flown.values())) <= 0.2 * sum(flown.values())
    for kind in ("nominal", "sensitivity", "certify"):
        assert told[kind] == flown[kind]


def test_no_search_is_announced_beyond_its_budget() -> None:
    for search in (
        {"method": "direct", "evaluations": 50, "options": {"iterations": 1000}},
        {"method": "direct", "evaluations": 50, "options": {"iterations": 10**12}},
        {"method": "direct", "evaluations": 50, "options": {"iterations": "x"}},
        {"method": "direct", "evaluations": 50},
        {"method": "sqp", "evaluations": 50, "options": {"starts": 10_000}},
        {"method": "sqp", "evaluations": 50, "options": {"starts": "x"}},
        {"method": "of_another_package", "evaluations": 50},
    ):
        (told,) = [
            s.evaluations for s in expected(load_document(document(stages__search=[search]))) if s.kind == "search"
        ]
        assert told == 50


@pytest.mark.parametrize(
    ("repeats", "noisy", "halved", "expected_again"),
    [(None, False, False, 203), (None, False, True, 206), (None, True, False, 200 + 50), (5, False, False, 200 + 10)],
)
def test_what_is_made_again_in_fresh_processes(
    repeats: int | None, noisy: bool, halved: bool, expected_again: int
) -> None:
    """Random evaluations, the nominal case and two worst cases; with noise 10 calls of these and of two best."""
    given = package.campaign()
    if repeats is not None:
        given["simulator"]["repeats"] = {"count": repeats, "combine": "worst"}
    campaign = load_document(given)
    assert (len(campaign.stages.search), len(campaign.uncertain)) == (2, 2)
    assert again(campaign, noisy, halved) == expected_again


def test_as_many_are_made_again_as_the_stage_makes() -> None:
    from worker.stages.parts import offered

    assert (SPOT_CHECKS, VIOLATIONS) == (offered.SPOT_CHECKS, offered.AT_MOST)


def test_a_violation_adds_what_its_boundary_takes() -> None:
    """As `worker.stages.parts.boundary.most` counts, without the slices."""
    assert boundary(load_file(library()["unicycle_static"])) == 1 + 5 * (20 + 14)


@pytest.mark.nightly
def test_one_of_them_is_flown_again() -> None:
    from worker.runs.runner import execute
    from worker.runs.store import MemoryStore

    name, store = "unicycle_static", MemoryStore()
    execute(load_file(library()[name]), store)
    columns = [store.evaluations(position) for position in range(len(store.stages))]
    flown = sum(len(c.status) for c in columns if c is not None)
    assert abs(flown - sum(FLOWN[name].values())) <= 0.05 * flown
