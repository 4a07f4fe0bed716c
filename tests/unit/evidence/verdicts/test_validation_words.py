"""The sentence of the validation: a case without a value is not one whose values differ."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns.results import ValidateResult
from campaigns.results.finding import HalfStep, ReferenceCost, Repeated
from campaigns.results.validate import LeftOut, Spent, Violations
from campaigns.results.verdicts import validated
from tests.given.case_campaigns import case1
from tests.given.verdict_evidence import WORST, case, changed, finding, validation
from worker.evidence.verdicts.validation import worded

NONE: dict[str, Any] = {"cost": None, "difference": None}
WITHOUT: dict[str, dict[str, Any]] = {
    "half the step": {"half_step": HalfStep(step=0.0025, **NONE)},
    "the reference integrator": {"integrator": ReferenceCost(name="DOP853", reason="it diverged", **NONE)},
    "the same again": {"again": Repeated(name="a fresh evaluation", reason="no licence", **NONE)},
    "the case itself": {"cost": None},
}
"""What has no value."""
OTHER = {"again": Repeated(name="a fresh evaluation", cost=WORST + 0.2, difference=0.2)}


def sentence(**changes: Any) -> str:
    """Of the nominal case, which agrees, and of F1, which does not."""
    found = finding(validation=changed(case(), **{"ok": False, "agrees": False, "violates": False} | changes))
    made = worded(case1(), validation(ok=False), [found])
    assert isinstance(made, ValidateResult)
    return made.text


@pytest.mark.parametrize("what", WITHOUT)
def test_what_has_no_value_does_not_disagree(what: str) -> None:
    text = sentence(**WITHOUT[what])
    assert "disagree" not in text
    assert text.startswith("F1 lacks a value")
    assert validated(changed(case(), agrees=False, violates=False, **WITHOUT[what])).startswith("not every")


@pytest.mark.parametrize("spent", [None, Spent(at_most=20, stored=8, left_out=LeftOut(violations=44))])
def test_violations_of_which_none_was_examined_are_not_counted_as_such(spent: Spent | None) -> None:
    none = Violations(stored=44, checked=0, confirmed=0, statement=())
    made = worded(case1(), validation(violations=none, spent=spent), [])
    assert isinstance(made, ValidateResult)
    assert made.violations is not None
    text = made.violations.text
    assert "; validation examined none" in text
    assert text.endswith(" limited to 20 evaluations") == (spent is not None)


def test_what_differs_disagrees() -> None:
    text = sentence(**OTHER)
    assert "disagrees by more" in text
    assert text.endswith(" for F1")


def test_both_have_a_clause() -> None:
    lost, found = case("nominal", ok=False, **WITHOUT["the same again"]), finding(validation=case(ok=False, **OTHER))
    made = worded(case1(), validation(ok=False, nominal=lost), [found])
    assert isinstance(made, ValidateResult)
    differs, lacks = made.text.split("; ")
    assert ("disagrees" in differs, differs.endswith(" for F1")) == (True, True)
    assert lacks.startswith("nominal lacks a")
