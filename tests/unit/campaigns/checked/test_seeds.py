"""Which parameters select a realisation, and when they vary: two programs with the same answer."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.checked.check import unvaried
from worker.evidence.audit.seeds import fixed

MANY: dict[str, Any] = {"low": 0.0, "high": 1000.0}


def asked(**uncertain: Any) -> Campaign:
    document = {
        "name": "a",
        "simulator": {"name": "a"},
        "uncertain": {"simulator.x": {"low": 0.0, "high": 1.0}}
        | {f"simulator.{name}": stated for name, stated in uncertain.items()},
        "criterion": {"result": "s", "threshold": 1.0},
        "stages": {"search": [{"method": "direct", "evaluations": 100}]},
    }
    return load_document(document, "the test")


def bars(path: str, stated: Any, nominal: float = 1.0) -> bool:
    campaign = asked(**({} if stated is None else {path.rpartition(".")[2]: stated}))
    found = unvaried(campaign, {path: nominal}) == [path]
    assert fixed(path, campaign.uncertain.get(path), nominal) == found
    return found


@pytest.mark.parametrize(
    ("name", "seed"),
    [
        ("seed", True), ("noise_seed", True), ("randomSeed2", True), ("seeds", True), ("Seed_1", True), ("rng", True),
        ("random_state", True), ("randomState", True), ("gust_rng", True), ("realisation", True),
        ("realization3", True), ("realisations", True), ("seeding", False), ("state", False), ("wrng", False),
    ],
)  # fmt: skip
def test_a_seed_has_the_name_of_one(name: str, seed: bool) -> None:
    assert bars(f"simulator.{name}", None) == seed
    assert not bars(f"simulator.{name}", MANY)


@pytest.mark.parametrize(
    ("stated", "varies"),
    [
        (MANY, True), ({"low": 1.0, "high": 100.0}, True), ({"low": 0.5, "high": 100.5}, True),
        ({"low": 1.0, "high": 99.9}, False),
        ({"low": 1.0, "high": 1.9}, False), ({"low": 0.2, "high": 0.8}, False), ({"plus_minus": 60.0}, True),
        ({"plus_minus": 3.0}, False), ({"low": -1e12, "high": 1e12}, True),
        (MANY | {"distribution": {"kind": "truncated_normal", "mean": 1.0, "deviation": 0.1}}, False),
        (MANY | {"distribution": {"kind": "beta", "alpha": 900.0, "beta": 900.0}}, False),
    ],
)  # fmt: skip
def test_a_seed_varies_over_many_whole_numbers_alike(stated: Any, varies: bool) -> None:
    assert bars("simulator.seed", stated, nominal=50.0) != varies


def test_what_realisations_vary_is_no_fixed_seed() -> None:
    assert not bars("environment.0.seed", None)
    assert bars("environment.0.random_state", None)
    assert bars("vehicle.seed", None)
