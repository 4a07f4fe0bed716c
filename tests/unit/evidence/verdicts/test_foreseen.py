"""What bars "cleared" before anything is evaluated: no run of such a campaign is cleared, and those checks fail.

A campaign that can be cleared is not warned of: all of the library, and one of each kind of change here.
"""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import library, load_file
from campaigns.catalogue import MethodEntry
from campaigns.checked.foreseen import foreseen
from campaigns.results import SearchResult
from campaigns.results.verdict import VerdictWord
from tests.given.at_night import nightly_but
from tests.given.case_campaigns import CASE1, searching
from tests.given.corrupted_records import DIRECT, NOISE, SAMPLE, SQP, TURNING, certifying
from tests.given.sampled_stages import DRAWN
from worker.running.catalogue.installed import catalogue
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

SAMPLED: dict[str, Any] = {"stages__certify": {"samples": 60}}
PORTFOLIO = {"method": "portfolio", "evaluations": 400}
FEW = {"method": "direct", "evaluations": 40}
MEAN = NOISE | {"scenario__realisations": {"seeds": [1, 2], "combine": "mean"}}
BARRED: dict[str, tuple[Any, set[str]]] = {
    "no sample": (lambda: searching(DIRECT, SQP, stages__certify=None), {"sample"}),
    "a small sample": (lambda: searching(DIRECT, SQP, stages__certify={"samples": 30}), {"sample", "probability"}),
    "one family": (lambda: searching(DIRECT, **SAMPLED), {"agreement"}),
    "a member of the portfolio": (lambda: searching(PORTFOLIO, DIRECT, **SAMPLED), {"agreement"}),
    "no global method": (lambda: searching(SQP, SAMPLE, **SAMPLED), {"agreement"}),
    "few evaluations": (lambda: searching(FEW, SQP, **SAMPLED), {"agreement"}),
    "a target out of reach": (lambda: searching(DIRECT, SQP, target_probability=1e-4, **SAMPLED), {"target"}),
    "an obstacle that turns in a step": (
        lambda: searching(DIRECT, SQP, scenario__obstacles=[*CASE1["scenario"]["obstacles"], TURNING], **SAMPLED),
        {"sampling"},
    ),
    "a mean of realisations": (lambda: certifying(60, **MEAN), {"noise"}),
}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", nightly_but(("a small sample", "one family", "a mean of realisations"), BARRED))
def test_what_is_foreseen_bars_cleared(name: str) -> None:
    made, expected = BARRED[name]
    campaign, store = made(), MemoryStore(sample_seed=DRAWN)
    assert {each.code.value for each in foreseen(campaign, catalogue())} == expected
    conclusion = execute(campaign, store, threads=1)
    assert conclusion.verdict is not VerdictWord.CLEARED
    assert expected <= {check.name for check in conclusion.checks if not check.ok}


@pytest.mark.parametrize("name", library())
def test_a_campaign_of_the_library_is_not_barred(name: str) -> None:
    assert foreseen(load_file(library()[name]), catalogue()) == []


def test_nothing_is_foreseen_of_a_campaign_that_is_cleared() -> None:
    campaign, store = searching(DIRECT, SQP, **SAMPLED), MemoryStore(sample_seed=DRAWN)
    assert execute(campaign, store, threads=1).verdict is VerdictWord.CLEARED
    assert foreseen(campaign, catalogue()) == []


@pytest.mark.parametrize(
    "entry", [m for m in catalogue().methods if m.together or m.apart], ids=lambda entry: entry.name
)
def test_members_of_a_run_are_those_that_their_method_declares(entry: MethodEntry) -> None:
    store = MemoryStore(sample_seed=DRAWN)
    execute(searching({"method": entry.name, "evaluations": 600}, DIRECT, **SAMPLED), store, threads=1)
    [members] = [s.result.members for s in store.stages if isinstance(s.result, SearchResult) and s.result.members]
    assert {m.member: m.family for m in members if m.apart}.items() <= entry.apart.items()
    assert {m.member: m.family for m in members if not m.apart}.items() <= entry.together.items()
    assert len(members) > 2
