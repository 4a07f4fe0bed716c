"""The announced number of evaluations is within 20 % of what runs of the published campaigns really have.

`FLOWN` is what they had, by stage, measured with `worker.runs.runner.execute`; the nightly test measures one again.
"""

from __future__ import annotations

import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.checked.expected import boundary, expected
from tests.unit.cases import document

FLOWN: dict[str, dict[str, int]] = {
    "unicycle_static": {"nominal": 1, "sensitivity": 42, "search": 6377, "certify": 3000, "validate": 996},
    "unicycle_navigation": {"nominal": 1, "sensitivity": 105, "search": 13_925, "certify": 3000, "validate": 4904},
    "uav_moving": {"nominal": 1, "sensitivity": 63, "search": 12_138, "certify": 3000, "validate": 1136},
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


def test_a_violation_adds_what_its_boundary_takes() -> None:
    """As `worker.stages.parts.boundary.most` counts, without the slices."""
    assert boundary(load_file(library()["unicycle_static"])) == 1 + 5 * (20 + 14)
