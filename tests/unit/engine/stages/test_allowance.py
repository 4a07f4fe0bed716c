"""No run takes more evaluations than its campaign states: every call of a system is counted, stored or not."""

from __future__ import annotations

import itertools
import shutil
from collections import Counter
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import clearance
from campaigns import Campaign, library, load_file
from campaigns.asked import allowance
from campaigns.asked.load import load_document
from campaigns.results.validate import ValidateResult
from campaigns.stages.plan import bound, most, onward
from tests.faults.processes import REPOSITORY
from tests.given.at_night import rows_nightly_but
from tests.given.case_campaigns import document
from tests.given.made_evaluations import flights, requests
from tests.simulators import noisy
from tests.simulators.adversaries import adversary
from worker.engine.problem.problem import Problem
from worker.engine.systems.simulators.declared.descriptor import read
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

DAILY = ["unicycle_static", "unicycle_noise"]
EXAMPLES = REPOSITORY / "docs" / "examples"


def within(campaign: Campaign, store: MemoryStore, made: int) -> ValidateResult:
    """Each stage stores no more than its bound, and the system made no more than that of the run."""
    stored = [0 if (c := store.evaluations(k)) is None else len(c.status) for k in range(len(store.stages))]
    assert [s.method for s in bound(campaign)] == [record.plan.method for record in store.stages]
    for stage, count in zip(bound(campaign), stored, strict=True):
        assert count <= stage.stored, stage
    assert sum(stored) <= made <= most(campaign)
    result = store.stages[-1].result
    assert isinstance(result, ValidateResult)
    assert result.spent is not None
    assert result.spent.stored == stored[-1]
    *before, last = bound(campaign)
    assert made - sum(stored[:-1]) <= last.evaluations + sum(stage.again for stage in before)
    assert result.spent.at_most <= last.evaluations
    return result


@pytest.fixture
def flown() -> Iterator[Counter[str]]:
    with flights() as made:
        yield made


def small(name: str, evaluations: int) -> Campaign:
    """A campaign of the library whose searches have few evaluations."""
    made = load_file(library()[name]).document()
    for search in made["stages"]["search"]:  # type: ignore[index, call-overload, union-attr]
        search["evaluations"] = evaluations
    stages: Any = made["stages"]
    stages["sensitivity"], stages["certify"] = {"points": 3}, {"samples": 20}
    stages["validate"].pop("evaluations", None)
    return load_document(made)


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("name", "evaluations"), rows_nightly_but([(DAILY[0], 1), (DAILY[-1], 60)], list(itertools.product(DAILY, (1, 60))))
)
def test_a_small_campaign_of_the_library_stays_within_its_bound(
    name: str, evaluations: int, flown: Counter[str]
) -> None:
    asked, store = small(name, evaluations), MemoryStore()
    verdict = execute(asked, store, threads=1)
    spent = within(asked, store, flown.total()).spent
    assert spent is not None
    assert spent.at_most == max(allowance.searches(asked), allowance.least(asked, noisy=False))
    assert verdict.verdict != "cleared", "too much was left out"


@pytest.mark.nightly
@pytest.mark.parametrize("name", library())
def test_every_campaign_of_the_library_stays_within_its_bound(name: str, flown: Counter[str]) -> None:
    asked, store = load_file(library()[name]), MemoryStore()
    execute(asked, store)
    result = within(asked, store, flown.total())
    assert result.spent is not None
    assert not any(result.spent.left_out.model_dump().values()), "nothing is left out of the library"
    assert result.findings is not None
    assert result.findings.complete


@pytest.mark.by_day(5)
@pytest.mark.parametrize(
    ("how", "simulator"),
    [("none", {}), ("noise", {}), ("none", noisy.REPEATS), ("noise", noisy.REPEATS)],
)
@pytest.mark.parametrize("threshold", [1.0, 7.5], ids=["clear", "violated"])
@pytest.mark.parametrize("evaluations", [5, 150])
def test_a_simulator_that_repeats_or_not_stays_within_its_bound(
    how: str, simulator: dict[str, Any], threshold: float, evaluations: int
) -> None:
    made = noisy.campaign(threshold, 20, **simulator).document()
    stages: Any = made["stages"]
    stages["validate"].pop("evaluations")
    for search in stages["search"]:
        search["evaluations"] = evaluations
    asked, store = load_document(made), MemoryStore()
    with adversary(how) as simulated:
        execute(asked, store, threads=1)
        calls = next(simulated.world.calls) - 1
    repeats = 1 if asked.simulator is None else asked.simulator.calls
    stored = sum(0 if (c := store.evaluations(k)) is None else len(c.status) for k in range(len(store.stages)))
    assert stored <= calls <= repeats * most(asked)
    if repeats == 1:
        within(asked, store, calls)


@pytest.mark.by_day(2)
@pytest.mark.parametrize("vectorized", [False, True])
@pytest.mark.parametrize("settings", [{}, {"validation": 0}, {"validation": 700}, {"budget": 300}])
def test_a_function_is_called_no_more_often_than_stated(vectorized: bool, settings: dict[str, int]) -> None:
    called = itertools.count()
    made = [0]

    def margin(a: Any, b: Any) -> Any:
        next(called)
        made[0] += np.size(a)
        return 10 - 3 * a - (b - 0.5) ** 2

    ranges = {"a": (0.0, 1.0), "b": (0.0, 1.0)}
    given: dict[str, Any] = {"budget": 40, "certify": 20} | settings
    found = clearance.search(margin, ranges, 1.0, vectorized=vectorized, **given)
    assert len(found.costs) < made[0] <= found.bound
    store = found.origin.store
    within(found.origin.campaign, store, made[0])
    searches, validated = 2 * given["budget"], int((found.stage == "validate").sum())
    assert validated <= given.get("validation", searches)


@pytest.mark.nightly  # by day the small campaigns of the library, and functions
@pytest.mark.parametrize("example", ["mass_spring", "jsbsim_intruder"])
def test_a_program_in_slots_is_called_no_more_often_than_stated(example: str, tmp_path: Path) -> None:
    if example.startswith("jsbsim") and find_spec("jsbsim") is None:
        pytest.skip("jsbsim is not installed")
    own = Path(shutil.copytree(EXAMPLES / example, tmp_path / example))
    file = own / "simulator.yaml"
    described = yaml.safe_load(file.read_text(encoding="utf-8")) | {"slots": 2}
    file.write_text(yaml.safe_dump(described, sort_keys=False), encoding="utf-8")
    simulator = read(own)
    made_of = load_file(EXAMPLES / "campaigns" / f"{example}.yaml").document()
    stages: Any = made_of["stages"]
    for search in stages["search"]:
        search["evaluations"] = min(search["evaluations"], 15)  # each is a process
    if "certify" in stages:
        stages["certify"]["samples"] = 20
    asked = load_document(made_of)
    known = catalogue().model_copy(update={"simulators": [simulator.entry]})
    system: Any = opened.simulated(asked, simulator, known)
    store = MemoryStore()
    with requests(system) as made:
        execute(asked, store, problem=Problem(asked, system))
    within(asked, store, made[0])


@pytest.mark.parametrize("budget", [1, 7, 50, 100, 333, 1000, 20_000, 10**6])
@pytest.mark.parametrize("stated", [{}, {"findings": {"evaluations": 5000}}, {"validate": {"evaluations": 750}}])
def test_validation_is_as_large_as_the_searches_unless_asked_for_more(budget: int, stated: dict[str, Any]) -> None:
    made = document()
    made["stages"] = {"search": [{"method": "direct", "evaluations": budget}]} | stated
    asked = load_document(made)
    allowed, least = allowance.validation(asked), allowance.least(asked, noisy=True)
    asks = stated.get("findings", {}).get("evaluations", 0)
    wanted = stated.get("validate", {}).get("evaluations", max(budget, asks))
    assert allowed.total <= max(wanted, least)
    assert 0 <= allowed.stored <= allowed.total - min(least, allowed.total)
    stages = bound(asked)
    assert sum(s.evaluations for s in stages if s.kind == "validate") == allowed.total + onward(stages, asked)
