"""The announced range of evaluations holds what runs of all published campaigns really have.

`FLOWN` is what they had, by stage: a nightly test runs all of them again (`tests/golden/test_library_verdicts.py`). It
differs by a few percent from machine to machine, as searches depend on the last bits of every evaluation.
"""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from campaigns import Catalogue, library, load_file
from campaigns.asked.allowance import RAY, SLICE
from campaigns.asked.load import load_document
from campaigns.asked.proposal import RETRIED
from campaigns.checked.expected import (
    Expected,
    again,
    at_most,
    called,
    computing,
    expected,
    fewer,
    total,
)
from campaigns.stages.plan import bound, most, plan
from tests.given.case_campaigns import campaign, document
from tests.simulators import noisy, package
from tools.library_verdicts import FILE, evaluated
from worker.running.catalogue.installed import catalogue
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

ALL_CHECKS = True
FLOWN: dict[str, dict[str, int]] = {
    name: one["evaluations"] for name, one in json.loads(FILE.read_text(encoding="utf-8")).items()
}
HALVES = sorted(FLOWN)[::2], sorted(FLOWN)[1::2]
EFFORTS = {"direct": {"spread": (0.86, 1.18)}, "sqp": {"growth": 2.2}}
"""Of methods, as in the first half of the library alone, from which the constants of validation are, too."""
KNOWN = catalogue()


def measured() -> Catalogue:
    """The catalogue with the methods' efforts as in the first half."""
    methods = [
        m.model_copy(update={"effort": replace(m.effort, **EFFORTS[m.name])}) if m.effort and m.name in EFFORTS else m
        for m in KNOWN.methods
    ]
    return KNOWN.model_copy(update={"methods": methods})


def announced(name: str) -> dict[str, Expected]:
    return {stage.kind: stage for stage in expected(load_file(library()[name]), KNOWN)}


def test_every_published_campaign_was_measured() -> None:
    assert FLOWN.keys() == library().keys()


@pytest.mark.parametrize("name", FLOWN)
def test_what_is_evaluated_is_in_the_announced_range(name: str) -> None:
    told, flown = announced(name), FLOWN[name]
    assert told.keys() == flown.keys()
    for kind, stage in told.items():
        assert stage.least <= flown[kind] <= stage.most, kind
        assert stage.least <= stage.evaluations <= stage.most, kind
    for kind in ("nominal", "sensitivity", "certify"):
        assert told[kind].least == told[kind].evaluations == flown[kind]
    least, usual, most = total(list(told.values()))
    assert least <= sum(flown.values()) <= most
    assert least <= usual <= most
    assert most <= 5 * least, "a range that says something"


def test_the_usual_number_is_near_for_most() -> None:
    off = [sum(s.evaluations for s in announced(n).values()) / sum(FLOWN[n].values()) for n in FLOWN]
    assert sum(abs(ratio - 1) <= 0.2 for ratio in off) >= 27
    assert 0.6 < min(off) < max(off) < 1.4


def test_ranges_measured_on_half_of_the_library_hold_in_the_other() -> None:
    held = [total(expected(load_file(library()[name]), measured())) for name in HALVES[1]]
    flown = [sum(FLOWN[name].values()) for name in HALVES[1]]
    outside = [name for name, told, n in zip(HALVES[1], held, flown, strict=True) if not told.least <= n <= told.most]
    assert outside == ["uav_moving"], "the lowest and highest of 17 hold for all but one or two of 17 others"


def test_the_usual_number_and_the_bound_are_announced() -> None:
    assert at_most(campaign(), 12_034) == "At most 12,034 evaluations"
    several = noisy.campaign(1.0, 20, **noisy.REPEATS)
    assert at_most(several, 1_000).startswith("At most 1,000 evaluations, ")
    stages = [Expected("search", "", 15_000, 12_691, 22_234), Expected("nominal", "", 1, 1, 2)]
    assert total(stages) == (12_692, 15_001, 22_236)


def test_the_end_of_a_range_is_the_bound_of_the_run() -> None:
    for name in library():
        campaign = load_file(library()[name])
        assert total(expected(campaign, KNOWN)).most == most(campaign)


def test_a_ray_and_a_slice_take_what_the_allowance_counts() -> None:
    import math

    from worker.engine.stages.parts import boundary as around
    from worker.engine.stages.parts import slices

    assert slices.POINTS + 1 == SLICE
    assert around.SAMPLES + math.ceil(math.log2(1.0 / (around.SAMPLES * around.TOLERANCE))) + 1 == RAY


def test_a_method_that_may_end_by_its_own_rule_has_a_range() -> None:
    for method, options, whole in (
        ("genetic", {"as_published": True}, False), ("of_another_package", {}, False), ("genetic", {}, True),
        ("mlsl", {"as_published": True}, True), ("differential_evolution", {}, True), ("global_clustering", {}, True),
        *(("differential_evolution", given, False) for given in ({"restarts": 0}, {"as_published": True})),
        *(("global_clustering", given, False) for given in ({"minima": 1}, {"as_published": True})),
        ("differential_evolution", {"restarts": 1_000_000, "as_published": False}, True),
        ("nsga2", {"generations": 2}, False), ("nsga2", {}, True), ("nlopt_global", {}, False),
        ("cma_es", {}, True), ("monte_carlo", {}, True), ("monte_carlo", {"interval": 0.01}, False),
    ):  # fmt: skip
        search = {"method": method, "evaluations": 4000, "options": options}
        (told,) = [s for s in expected(load_document(document(stages__search=[search])), KNOWN) if s.kind == "search"]
        assert told.most == 4000
        assert (told.least == told.evaluations == 4000) is whole
        assert whole or told.least < 219


def test_no_search_is_announced_beyond_its_budget() -> None:
    for search in (
        {"method": "direct", "evaluations": 50, "options": {"iterations": 1000}},
        {"method": "direct", "evaluations": 50, "options": {"iterations": 10**12}},
        {"method": "direct", "evaluations": 50, "options": {"iterations": "x"}},
        {"method": "direct", "evaluations": 50},
        {"method": "sqp", "evaluations": 50, "options": {"starts": 10_000}},
        {"method": "sqp", "evaluations": 50, "options": {"starts": "x"}},
    ):
        (told,) = [s for s in expected(load_document(document(stages__search=[search])), KNOWN) if s.kind == "search"]
        assert told.least <= told.evaluations <= told.most == 50


@pytest.mark.parametrize(
    ("repeats", "noisy", "halved", "expected_again"),
    [(None, False, False, 202), (None, False, True, 204), (None, True, False, 200 + 40), (5, False, False, 200 + 8)],
)
def test_what_is_made_again_in_fresh_processes(
    repeats: int | None, noisy: bool, halved: bool, expected_again: int
) -> None:
    """Random evaluations, the nominal case and a worst case; with noise 10 calls of these and of two best."""
    given = package.campaign()
    given["stages"]["validate"] = {"evaluations": 5000}  # enough for all of them
    if repeats is not None:
        given["simulator"]["repeats"] = {"count": repeats, "combine": "worst"}
    campaign = load_document(given)
    assert (len(campaign.stages.search), len(campaign.uncertain)) == (2, 2)
    assert again(campaign, KNOWN, noisy, halved) == expected_again


@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("retries", [0, 1, 10])
def test_the_calls_of_evaluations_are_stated_with_every_retry(count: int, retries: int) -> None:
    given = package.campaign()
    given["simulator"] |= {"repeats": {"count": count, "combine": "worst"}, "retries": retries}
    stated, calls = called(load_document(given), 234), 234 * count * (1 + retries)
    assert (f", {calls:,} calls" in stated) == (calls > 234)
    assert bool(stated) == (calls > 234)
    assert stated.endswith(RETRIED) == (retries > 0)
    assert called(load_document(document()), 234) == ""


LOST = {"label": "F1", "parameters": {"vehicle.no_such": 6.0}, "cost": 0.94}
BASELINE = {"run": "R-0001", "digest": "0" * 64, "threshold": 0.5, "cases": [LOST]}
TARGET = {"samples": 20_000, "keep": "lowest", "until": "target"}
SHORTER: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "estimate": ({"estimate": {"evaluations": 1000}}, {"criterion__threshold": -5.0}),
    "certify": ({"certify": TARGET}, {"criterion__threshold": 5.0, "target_probability": 0.05}),
    "baseline": ({}, {"baseline": BASELINE}),
}
"""By kind of stage, stages and further changes of a campaign whose run has fewer evaluations of it than its budget."""


@pytest.mark.by_day(1)
@pytest.mark.parametrize("kind", SHORTER)
def test_a_stage_that_takes_nothing_or_ends_early_is_within_its_range(kind: str) -> None:
    stages, changes = SHORTER[kind]
    short = {"sensitivity": {"points": 3}, "search": [{"method": "monte_carlo", "evaluations": 20}], "certify": None}
    asked = campaign(stages=short | stages, **changes)
    execute(asked, store := MemoryStore())
    taken = evaluated(store)
    for position, blocks in store.counted.items():
        taken[store.stages[position].plan.kind] = sum(block.draws for block in blocks)
    told = {stage.kind: stage for stage in expected(asked, KNOWN)}
    assert told[kind].least <= taken[kind] < told[kind].evaluations <= told[kind].most
    shorter = fewer(asked, kind)
    assert shorter is not None
    assert shorter.least == told[kind].least


def test_every_other_stage_has_its_budget() -> None:
    others = {stage.kind for stage in plan(campaign())} - {"search", "validate"}
    assert others
    for kind in others:
        (told,) = [stage for stage in expected(campaign(), KNOWN) if stage.kind == kind]
        assert fewer(campaign(), kind) is None
        assert told.least == told.evaluations


def test_a_stage_computes_if_no_number_of_evaluations_bounds_its_time() -> None:
    assert computing(campaign()) == []
    asked = campaign(stages__attraction={})
    assert computing(asked) == [stage.kind for stage in bound(asked) if stage.evaluations == 0] == ["attraction"]
