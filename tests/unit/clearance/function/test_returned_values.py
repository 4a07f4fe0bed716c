"""What a function returns that is no finite number is a failed evaluation, alone and in a batch alike."""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clearance
from campaigns.results.base import FLAKY
from clearance.cli import invoke

RANGES = {"a": (0.0, 1.0), "b": (0.0, 1.0)}
SHORT: dict[str, Any] = {"methods": {"direct": 30}, "certify": 20, "validation": 100}


def searched(fly: Callable[..., Any], **changes: Any) -> clearance.Result:
    return clearance.search(fly, RANGES, 0.0, **SHORT | changes)


ALONE: dict[str, Any] = {
    "a truth value": np.array(True),
    "a text": np.array("1.5"),
    "a text in an object": np.array("1.5", dtype=object),
    "a complex number": np.clongdouble(1),
    "a masked number": np.ma.masked,
    "a masked array": np.ma.array(1.0, mask=True),
    "nothing": None,
    "infinity": math.inf,
}


@pytest.mark.parametrize("name", ALONE)
def test_alone_it_fails(name: str) -> None:
    found = searched(lambda a, b: ALONE[name] if 0.2 < a < 0.4 else 1.0)
    assert (found.status[(found.points[:, 0] > 0.2) & (found.points[:, 0] < 0.4)] == "failed").all()
    assert (found.status == "failed").any()
    assert found.verdict != "cleared"


@pytest.mark.parametrize("value", [np.float32(1.0), np.array(1.0), np.int8(1), Decimal(1), 1])
def test_a_number_of_any_type_is_one(value: Any) -> None:
    assert (searched(lambda a, b: value).status == "ok").all()


def masked(a: Any, b: Any) -> Any:
    return np.ma.divide(1.0, np.where(a + b < 0.6, 0.0, 1.0)) + (a + b)


def objects(a: Any, b: Any) -> Any:
    return [None if x < 0.3 else 1.0 + x for x in a]


@pytest.mark.parametrize("fly", [masked, lambda a, b: np.ma.masked_where(a < 0.3, 1.0 + a), objects])
def test_in_a_batch_its_row_fails(fly: Callable[..., Any]) -> None:
    found = searched(fly, vectorized=True)
    assert (found.status == "failed").any()
    assert (found.status == "ok").any()
    assert found.verdict != "cleared"
    assert not any("nan" in why for why in found.reasons.values())


def raises_in_batches(a: Any, b: Any) -> Any:
    if len(a) > 1:
        raise RuntimeError("the solver diverged")
    return 1.0 + a + b


def test_a_batch_that_succeeds_only_row_by_row_is_counted_and_bars_cleared(tmp_path: Path) -> None:
    found = searched(raises_in_batches, vectorized=True)
    again = sum(why.startswith(FLAKY) for why in found.reasons.values())
    assert again > 20
    assert (found.status == "ok").all()
    assert found.verdict == "inconclusive"
    assert f"{again} of {len(found.costs)} evaluations" in found.verdict.sentence
    assert "failed, the first" not in str(found)
    assert invoke(["audit", str(found.save(tmp_path))]) == 0


OTHERS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "missing": lambda a: {},
    "no number": lambda a: {"y": np.full(len(a), np.nan)},
    "nothing": lambda a: {"y": None},
    "of another shape": lambda a: {"y": np.ones(len(a) + 1)},
}


@pytest.mark.parametrize("name", OTHERS)
def test_every_result_of_a_batch_counts(name: str) -> None:
    @clearance.simulator(
        parameters=RANGES, results={"x": clearance.Output(), "y": clearance.Output()}, isolated=False, vectorized=True
    )
    def fly(a: Any, b: Any) -> Any:
        return {"x": 1.0 + a} | (OTHERS[name](a) if (a < 0.4).any() else {"y": a})

    found = clearance.search(fly, threshold=0.0, result="x", **SHORT)
    assert (found.status == "failed").any()
    assert found.verdict != "cleared"


def constant(a: float, b: float) -> float:
    return math.cos(a) ** 2 + math.sin(a) ** 2


@pytest.mark.parametrize("fly", [constant, lambda a, b: 1e17])
def test_values_that_no_histogram_can_divide_end_no_search(fly: Callable[..., Any]) -> None:
    found = searched(fly, certify=60)
    assert found.verdict in ("cleared", "inconclusive")
    assert (found.stage == "certify").sum() == 60


def test_an_excluded_evaluation_is_not_said_to_have_failed() -> None:
    def fly(a: float, b: float) -> float:
        if a < 0.1:
            raise clearance.Excluded("starts inside")
        return 1.0 + a

    found = searched(fly)
    assert (found.status == "excluded").any()
    assert "failed, the" not in str(found)
    assert "; 0 failed, " in clearance.Evaluations.__repr__(found)
