"""Distribution functions as earlier versions stated them hold by their rules alone: a band that did not allow for
redrawn values, and equal values one by one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.claims.wording import WORDING
from campaigns.stages import certify
from campaigns.stored import blocks
from tests.given.corrupted_records import NORMAL, PAIR, Folder, certifying, copied, counting, made
from tests.given.sampled_stages import DRAWN
from tests.simulators import adversaries, noisy
from tests.simulators.adversaries import Call, adversary
from worker.engine.stages.parts import claims
from worker.engine.stages.parts.shape import STEPS, Binned, Ordered
from worker.evidence.audit import counted
from worker.evidence.audit.limits import ALIKE
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

Curve = tuple[list[float], list[int]]
CAMPAIGNS: dict[str, Callable[[], Campaign]] = {
    "all": lambda: certifying(60, uncertain=NORMAL, correlations=PAIR),
    "lowest": lambda: counting(400, uncertain=NORMAL, correlations=PAIR),
}
"""By what is stored of the sample; its values beyond the bounds are redrawn."""
STORED = {"KEPT": 150, "FIRST": 128}
"""Of a sample of which only the lowest flights are stored: how many of these, and its first draws."""


@pytest.fixture(autouse=True)
def few_stored(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sixth of what is stored otherwise, each flight of which is simulated on beyond the horizon."""
    for module in (certify, blocks, counted):
        for name, count in STORED.items():
            monkeypatch.setattr(module, name, count)


def stepped(call: Call) -> float:
    """So large that what it is added to is rounded away: many evaluations have one value."""
    return float(1e18 * (1.0 + np.round(call.a, 1)))


def folder_of(campaign: Campaign, at: Path) -> Path:
    store = MemoryStore(sample_seed=DRAWN)
    execute(campaign, store, threads=1)
    return copied(made(campaign, store), at)


def disagreeing(folder: Path, version: int) -> set[str]:
    """What does not follow from the record if it is of this version."""
    record = Folder(folder)
    record.result["versions"] |= {"wording": version}
    record.reseal()
    return {item.name for item in record.items() if item.agrees is False}


@pytest.mark.parametrize("stored", CAMPAIGNS)
def test_a_band_without_redrawn_values(stored: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert disagreeing(folder_of(CAMPAIGNS[stored](), tmp_path / "today"), WORDING) == set()
    band = claims.band
    monkeypatch.setattr(claims, "band", lambda samples, confidence, redrawn: band(samples, confidence))
    folder = folder_of(CAMPAIGNS[stored](), tmp_path / "earlier")
    assert disagreeing(folder, ALIKE - 1) == set()
    assert any(name.endswith("distribution.band") for name in disagreeing(folder, WORDING))


def one_by_one(of: Ordered) -> Curve:
    chosen = np.unique(np.linspace(0, len(of.costs) - 1, min(len(of.costs), STEPS)).astype(np.int64))
    return of.costs[chosen].tolist(), (chosen + 1).tolist()


def lowest_one_by_one(of: Binned) -> Curve:
    lowest = of._lowest[: STEPS // 4]
    places = np.flatnonzero((of.counted.bins > 0) & (of._through > len(lowest)))[:-1]
    values = [*lowest.tolist(), *of._edges[places].tolist()]
    return values, [*range(1, len(lowest) + 1), *of._through[places].tolist()]


@pytest.mark.parametrize("keep", ["all", "lowest"])
def test_equal_values_one_by_one(keep: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(adversaries.ADVERSARIES, "stepped", stepped)
    document = noisy.campaign().document()
    document["stages"]["certify"] = {"samples": 300 if keep == "lowest" else 60, "keep": keep}
    campaign = load_document(document)
    with adversary("stepped"):
        assert disagreeing(folder_of(campaign, tmp_path / "today"), WORDING) == set()
        monkeypatch.setattr(Ordered, "curve", one_by_one)
        monkeypatch.setattr(Binned, "curve", lowest_one_by_one)
        folder = folder_of(campaign, tmp_path / "earlier")
        assert disagreeing(folder, ALIKE - 1) == set()
        assert any("distribution" in name for name in disagreeing(folder, WORDING))
