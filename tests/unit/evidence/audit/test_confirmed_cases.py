"""A violation of a baseline is fixed only if the case was confirmed: a record that forges or lacks it is rejected."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results.regression import Standing
from tests.audited import audited, recorded
from tests.given.corrupted_records import since
from worker.engine.stages import baseline
from worker.engine.stages.parts import offered
from worker.evidence.audit.judge import audit, closing
from worker.evidence.audit.record import Record
from worker.running.runs.audited import known
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore


@pytest.fixture(scope="module")
def fixed() -> Iterator[tuple[Campaign, MemoryStore]]:
    """Cases that violated at a threshold of 0.9 m and pass here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(offered, "SPOT_CHECKS", 2)
        campaign, store = since(threshold=0.9, there=0.9, costs=(0.85, 0.89)), MemoryStore()
        execute(campaign, store, threads=1)
        yield campaign, store


def basins(record: Record) -> Any:
    return record.claims["results"][-1]["basins"]


def milder(record: Record) -> None:
    """At half the step it violates, and nothing says so."""
    basins(record)[0]["confirmed"]["half_step"]["cost"] = 0.4


def disagreeing(record: Record) -> None:
    """What the values show is stated otherwise."""
    basins(record)[0]["confirmed"]["agrees"] = False


def elsewhere(record: Record) -> None:
    """Of another evaluation."""
    basins(record)[0]["confirmed"]["cost"] += 0.01


def left_out(record: Record) -> None:
    del basins(record)[0]["confirmed"]


FORGED: list[Callable[[Record], None]] = [milder, disagreeing, elsewhere, left_out]


def follows(record: Record) -> bool:
    return closing(audit(record, known(record), offered.AT_MOST, offered.SPOT_CHECKS))[0]


def test_what_is_fixed_was_confirmed(fixed: tuple[Campaign, MemoryStore]) -> None:
    campaign, store = fixed
    assert store.verdict is not None
    assert store.verdict.regression is not None
    standings = {case.before: case.standing for case in store.verdict.regression.cases}
    assert (standings["F1"], standings["F2"], standings["F3"]) == (
        Standing.FIXED,
        Standing.FIXED,
        Standing.NOT_COMPARED,
    )
    record = recorded(store, campaign)
    assert [basin.get("confirmed", {}).get("name") for basin in basins(record)] == [
        "F1 of R-0042",
        "F2 of R-0042",
        None,
    ]
    assert "F1 of R-0042" in record.claims["results"][-1]["text"]
    audited(store, campaign)


@pytest.mark.parametrize("forge", FORGED)
def test_a_forged_confirmation_is_rejected(
    forge: Callable[[Record], None], fixed: tuple[Campaign, MemoryStore]
) -> None:
    campaign, store = fixed
    record = recorded(store, campaign)
    record = record._replace(claims=copy.deepcopy(record.claims))
    assert follows(record)
    forge(record)
    assert not follows(record)


@pytest.mark.parametrize(
    ("values", "compared"), [({}, False), ({"vehicle.J": 0.9}, False), ({"vehicle.J": 0.06}, True)]
)
def test_a_case_is_evaluated_at_all_values_of_the_baseline(
    values: dict[str, float], compared: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the baseline fixed is not assumed: a case that lacks it, or had another value, is not compared."""
    monkeypatch.setattr(offered, "SPOT_CHECKS", 2)
    document = since(threshold=0.9, there=0.9, costs=(0.85, 0.89)).document()
    del document["baseline"]["cases"][0]["parameters"]["vehicle.J"]
    document["baseline"]["fixed"] = values
    campaign, store, forged = load_document(document), MemoryStore(), MemoryStore()
    execute(campaign, store, threads=1)
    audited(store, campaign)
    again = store.stages[1].result.reevaluated[0]  # type: ignore[union-attr]
    assert (again.index is not None) is compared
    if not compared:
        monkeypatch.setattr(baseline, "_elsewhere", lambda *_: iter(()))
        execute(campaign, forged, threads=1)
        assert not follows(recorded(forged, campaign))
