"""A violation that only independent calls show violates in a comparison with a baseline, too, whichever run has it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.checked.snapshot import snapshot
from campaigns.codes import CheckCode
from campaigns.results.baselines import with_baseline
from campaigns.results.regression import FindingChange, Regression, Standing
from tests.audited import recorded
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts import offered
from worker.engine.stages.parts.repeated import of_values
from worker.engine.systems.simulators.declared.function import Declaration, Output, Parameter, Settings
from worker.evidence.audit import limits, record
from worker.evidence.audit.judge import audit
from worker.running.catalogue.files import PythonFunction
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened
from worker.running.runs.audited import known as beside
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

Gap = Callable[..., float]


def repeating(lowest: float) -> Gap:
    """A gap of this size at the upper bound of `a`."""
    return lambda a, b: 1.0 - (1.0 - lowest) * a + 0.02 * b


def called(lowest: float, again: float) -> Gap:
    """A gap that is `again` where the upper bound of `a` is evaluated twice in a row, with little noise elsewhere."""
    before: dict[str, Any] = {"at": None, "calls": 0}

    def gap(a: float, b: float) -> float:
        before["calls"] += 1
        twice, before["at"] = before["at"] == (a, b), (a, b)
        value = again + 0.02 * b if twice and a > 0.95 else repeating(lowest)(a, b)
        return value + 1e-6 * (before["calls"] % 7)

    return gap


def ran(
    gap: Gap, high: float = 1.0, baseline: tuple[Campaign, MemoryStore] | None = None
) -> tuple[Campaign, MemoryStore]:
    ranges = {name: Parameter(0.0, 1.0) for name in ("a", "b")}
    settings = Settings(vectorized=False, isolated=False)
    python = PythonFunction(
        Declaration("gap", "gap", "", ranges, {"gap": Output(unit="m", worse="low")}, settings), {}, gap
    )
    asked = load_document(
        {
            "name": "gap",
            "simulator": {"name": "gap", "parameters": {"a": 0.2, "b": 0.5}},
            "uncertain": {"simulator.a": {"low": 0.0, "high": high}, "simulator.b": {"low": 0.0, "high": 1.0}},
            "criterion": {"result": "gap", "threshold": 0.5},
            "stages": {
                "search": [{"method": "direct", "evaluations": 60}, {"method": "cma_es", "evaluations": 60}],
                "certify": {"samples": 60},
                "validate": {"evaluations": 2000},
            },
            "seed": 1,
        }
    )
    if baseline is not None:
        other, store = baseline
        asked = with_baseline(asked, "R-0001", other, store.findings)
    known = catalogue().model_copy(update={"simulators": [python.entry]})
    made = MemoryStore()
    execute(asked, made, threads=1, problem=Problem(asked, opened.simulated(asked, python, known)))
    own = recorded(made, asked)
    own.claims["components"] = snapshot(asked, known)
    items = audit(own, beside(own), offered.AT_MOST, offered.SPOT_CHECKS)
    assert not [item for item in items if item.agrees is False and item.name != "components"]
    return asked, made


def change(made: tuple[Campaign, MemoryStore]) -> tuple[Regression, FindingChange]:
    """The comparison, and the change of the first finding of the baseline."""
    verdict = made[1].verdict
    assert verdict is not None
    assert verdict.regression is not None
    return verdict.regression, next(case for case in verdict.regression.cases if case.before == "F1")


CALLED = (0.55, 0.44)
"""A finding of 0.55 of which independent calls have 0.44, at a threshold of 0.5."""


@pytest.mark.parametrize(
    ("gap", "expected"), [(called(*CALLED), 0.44), (called(0.55, 0.55), None), (repeating(0.47), None)]
)
def test_the_audit_finds_the_value_of_the_baseline_in_its_own_run(gap: Gap, expected: float | None) -> None:
    campaign, store = ran(gap)
    taken = with_baseline(campaign, "R-0001", campaign, store.findings).baseline
    assert taken is not None
    for case, finding in zip(taken.cases, store.findings, strict=True):
        stored = finding.model_dump(mode="json")
        assert case.called == record._called(stored, 0.5, limits.GRANTED)
        assert record._called(stored, 0.5, limits.GRANTED - 1) is None
    assert taken.cases[0].called == (expected and pytest.approx(expected, abs=1e-4))


def test_a_known_violation_is_not_hidden_by_narrower_bounds() -> None:
    compared, case = change(ran(repeating(0.55), high=0.9, baseline=ran(called(*CALLED))))
    assert case.standing is Standing.NOT_COMPARED
    assert case.margin_before == pytest.approx(-0.06, abs=1e-4)
    assert case.fails
    assert not compared.ok


@pytest.mark.parametrize("lowest", [0.47, 0.55])
def test_what_violates_in_calls_is_not_fixed(lowest: float) -> None:
    """One that violated in the search there is worse by its calls; one that did not violates newly."""
    compared, case = change(ran(called(*CALLED), baseline=ran(repeating(lowest))))
    assert case.standing is Standing.WORSE
    assert case.margin == pytest.approx(-0.06, abs=1e-4)
    assert case.newly_violating == case.fails == (lowest > 0.5)
    assert compared.ok == (lowest < 0.5)


def test_what_violates_in_calls_of_both_runs_is_the_same() -> None:
    _, case = change(ran(called(*CALLED), baseline=ran(called(*CALLED))))
    assert case.standing is Standing.SAME
    assert not case.newly_violating


@pytest.mark.parametrize("gap", [repeating(0.55), called(0.55, 0.55)])
def test_it_is_fixed_where_no_call_violates(gap: Gap) -> None:
    """Of a function that does not repeat, by independent calls of the case itself."""
    _, case = change(ran(gap, baseline=ran(called(*CALLED))))
    assert case.standing is Standing.FIXED


def against_few(violating: int) -> tuple[FindingChange, int]:
    """Against a baseline of which so many of 10 calls violated, and how many did by their own count."""
    campaign, store = ran(called(*CALLED))
    (first, *others) = store.findings
    assert first.validation is not None
    calls = first.validation.repeats
    assert calls is not None
    few = of_values([*calls.values[:violating], *[0.55] * (10 - violating)], [], 0.5, campaign.confidence)
    validation = first.validation.model_copy(update={"repeats": few})
    lower = {} if violating else {"cost": 0.44}
    rare = first.model_copy(update={"validation": validation, **lower})
    compared, case = change(ran(called(0.55, 0.55), baseline=(campaign, replace(store, findings=[rare, *others]))))
    assert (case.standing, case.fails, compared.ok) == (Standing.UNRESOLVED, True, False)
    return case, few.violating


def test_it_is_not_fixed_where_few_calls_violated_there() -> None:
    """Of 10 calls 3 did: 10 clear ones here may be chance, and the usual policy fails."""
    case, few = against_few(3)
    assert few in (2, 3)
    assert f"; {few} of 10 " in case.text
    assert "none of 10 here," in case.text
    assert "chance; a change" in case.text, "the change is a clause of its own"


def test_calls_do_not_show_that_what_no_call_showed_is_fixed() -> None:
    """Only the evaluation of the search violated there; the sentence says what to do."""
    case, few = against_few(0)
    assert few == 0
    assert "; 0 of 10 " in case.text
    assert "chance" not in case.text
    assert "validate.repeats" in case.text


def test_a_case_that_fails_twice_repeats() -> None:
    """A nominal case without a value does not make a function one that does not repeat."""

    def gap(a: float, b: float) -> float:
        if (a, b) == (0.2, 0.5):
            raise ValueError("nominal")
        return repeating(0.4)(a, b)

    verdict = ran(gap)[1].verdict
    assert verdict is not None
    [check] = [check for check in verdict.checks if check.code is CheckCode.CALLS]
    assert check.ok
