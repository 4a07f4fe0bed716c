"""Correlated parameters that are not normal: no number is stated, and what earlier versions stated of them is judged by
their rules."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import clearance.local.likelihood as local
from campaigns import Campaign
from campaigns.claims.wording import WORDING
from tests.given.case_campaigns import searching
from tests.given.corrupted_records import DIRECT, PAIR, SAMPLE, SHORT, Folder, copied, made
from tests.given.sampled_stages import DRAWN
from worker.evidence.audit.limits import ALIKE
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

Run = tuple[Campaign, MemoryStore]
NUMBERS = ("density", "distance", "tail")


@cache
def skewed() -> Run:
    """Two correlated uniform parameters, and violations; one run for all tests."""
    changes: dict[str, Any] = {"correlations": PAIR, "criterion__threshold": 0.943, "stages__certify": None} | SHORT
    campaign, store = searching(DIRECT, SAMPLE, **changes), MemoryStore(sample_seed=DRAWN)
    execute(campaign, store, threads=1)
    return campaign, store


def by_scores(joint: Callable[..., Any]) -> Callable[..., Any]:
    """As versions before computed them."""
    return lambda *arguments: replace(joint(*arguments), by_scores=True)


def disagreeing(folder: Path, version: int) -> set[str]:
    record = Folder(folder)
    record.result["versions"] |= {"wording": version}
    record.reseal()
    return {item.name for item in record.items() if item.agrees is False}


def stated(record: Folder) -> list[Any]:
    found = [*record.result["findings"], record.result["most_likely_violation"]["case"]]
    return [[one["likelihood"][name] for name in NUMBERS] for one in found]


@pytest.mark.parametrize("version", [WORDING, ALIKE - 1])
def test_no_number_is_stated_nor_expected_of_a_run_that_an_earlier_version_stored(version: int, tmp_path: Path) -> None:
    folder = copied(made(*skewed()), tmp_path)
    assert {tuple(numbers) for numbers in stated(Folder(folder))} == {(None, None, None)}
    assert disagreeing(folder, version) == set()


def test_the_numbers_of_an_earlier_version_hold_by_its_rules_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(local, "joint", by_scores(local.joint))
    folder = copied(made(*skewed()), tmp_path)
    assert any(None not in numbers for numbers in stated(Folder(folder)))
    assert disagreeing(folder, ALIKE - 1) == set()
    assert any(name.startswith("most_likely_violation.case.") for name in disagreeing(folder, WORDING))


@pytest.mark.parametrize("version", [WORDING, ALIKE - 1])
def test_a_less_likely_violation_is_rejected(version: int, tmp_path: Path) -> None:
    record = Folder(copied(made(*skewed()), tmp_path))
    record.result["most_likely_violation"]["case"]["index"] += 1
    record.reseal()
    assert any(name.startswith("most_likely_violation.case") for name in disagreeing(tmp_path, version))
