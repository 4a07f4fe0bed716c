"""Records of a service that counts falsely, and is consistent in all that follows from it: the audit finds what the
stored flights contradict. What they do not contradict is found by flying blocks again."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.claims.stages import sample as sentences
from campaigns.results.base import FAILED, OK
from campaigns.results.draws import uniform
from campaigns.results.sample import FIRST
from campaigns.sample_seed import SampleSeed
from campaigns.stored import blocks as stored
from campaigns.stored.blocks import Block, Counted, Kept, Scale, size
from tests.audited import audited
from tests.given.at_night import nightly_but
from tests.given.corrupted_records import RUNS, Folder, copied, counting, made, ran
from tests.simulators import noisy
from tests.simulators.adversaries import adversary
from worker.engine.stages import certify
from worker.engine.stages.parts import claims
from worker.engine.stages.parts import counting as engine
from worker.evidence.audit import counted
from worker.evidence.audit.binomial import upper_bound
from worker.evidence.audit.judge import closing
from worker.evidence.audit.record import UnreadableError
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

LATER = 1400
"""The first draw of a block of which few flights are stored."""


def excluding(block: Block) -> Block:
    """More draws than there are."""
    bins = block.bins.copy()
    bins[900] += 10**9
    return replace(block, excluded=block.excluded - 10**9, bins=bins)


def high(block: Block) -> Block:
    """All costs at the end of the scale."""
    bins = np.zeros_like(block.bins)
    bins[1000] = block.bins.sum()
    return replace(block, bins=bins)


def higher(block: Block) -> Block:
    """The lower half of the costs two bins higher."""
    bins = block.bins.copy()
    return replace(block, bins=np.concatenate([[0, 0], bins[:-2]]))


FALSE: dict[str, Callable[[Block], Block]] = {
    "negative exclusions": lambda b: excluding(b) if b.first == LATER else b,
    "all costs in one bin": high,
    "costs in higher bins": higher,
    "a highest cost below a stored one": lambda b: replace(b, highest=b.lowest),
    "a higher lowest cost": lambda b: replace(b, lowest=None if b.lowest is None else b.lowest + 1e-3),
    "more failures than violations": lambda b: replace(b, failed=b.failed + 1) if b.first == LATER else b,
    "fewer exclusions than reasons": lambda b: replace(b, exclusions={"the start": 3}) if b.first == LATER else b,
    "negative repeats": lambda b: replace(b, flaky=-1) if b.first == LATER else b,
    "more timeouts than failures": lambda b: replace(b, timeouts=1) if b.first == LATER else b,
}


BY_DAY = ("costs in higher bins", "a higher lowest cost", "negative exclusions")


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", nightly_but(BY_DAY, FALSE))
def test_a_false_count_is_rejected(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def falsely(*given: Any, **named: Any) -> Block:
        return FALSE[name](stored.counted(*given, **named))

    monkeypatch.setattr(engine, "counted", falsely)
    campaign, store = RUNS["counted"](), MemoryStore(sample_seed=SampleSeed(1, stated=False))
    try:
        execute(campaign, store, threads=1)
        (tmp_path / "out").mkdir()
        copied(made(campaign, store), tmp_path / "out")
        assert not closing(Folder(tmp_path / "out").items())[0]
    except (UnreadableError, ValueError):
        return  # such a result cannot be read, or not be made


@pytest.mark.nightly
@pytest.mark.parametrize("failing", [pytest.param(0.0, marks=pytest.mark.nightly), 0.01])
def test_honest_blocks_fit_their_stored_flights_whatever_their_size(failing: float) -> None:
    """Those of more draws than are all stored of the first ones, too."""
    samples, random, threshold = 2_500_000, np.random.default_rng(5), -4.0
    scale, parts, known = Scale.over(np.array([-3.0, 3.0]), threshold), [], None
    for first in range(0, samples, size(samples)):
        costs = random.standard_normal((min(size(samples), samples - first), 1))
        if first == 0:  # its lowest is neither among the lowest of all nor among the first draws
            costs = np.maximum(costs, -1.0)
            costs[3000] = -1.5
        status = np.where(random.random(len(costs)) < failing, FAILED, OK).astype(np.uint8)
        part = stored.counted(first, costs, costs, status, {}, scale, threshold)
        known = part.kept if known is None else Kept.joined([known, part.kept])
        parts.append(part.without(known.last))
    found = Counted.of(parts, scale)
    document = json.loads(certify._blocks(found, threshold).model_dump_json())
    flights, kept = found.kept.indices, found.kept
    told = counted.fitting(counted.stored(document), samples, flights, kept.costs[:, 0], kept.status, threshold)
    assert told == (len(parts), len(parts))
    assert size(samples) > FIRST


def test_an_honest_sample_in_which_most_violate_is_accepted() -> None:
    assert upper_bound(132, 128, 0.95) == 1.0
    assert counting(3000, "target", target_probability=0.05).shared is False


@pytest.mark.nightly
def test_a_bound_names_whose_seed_its_sample_has_and_follows() -> None:
    """Stated at the launch, or of the campaign where the sample is that of a random search."""
    campaign, store = RUNS["counted"](), MemoryStore(sample_seed=SampleSeed(1))
    execute(campaign, store, threads=1)
    audited(store, campaign)
    _, searched = ran("violated")
    for of, seed in ((store, sentences.STATED_SEED), (searched, sentences.CAMPAIGN_SEED)):
        assert of.verdict is not None
        assert of.verdict.statistics is not None
        assert seed in of.verdict.statistics.text


def test_a_sample_that_has_too_many_violations_only_with_its_last_draw_follows() -> None:
    """It is whole, as are all whose draws are all made."""
    document, samples = noisy.campaign(7.6).document(), 100
    document["stages"]["certify"] = {"samples": samples, "keep": "lowest", "until": "target"}
    document["target_probability"] = 0.25
    allowed = claims.allowed(samples, 0.25, 0.95)
    for seed in itertools.count():
        a, b = uniform(seed, engine.STREAM, 0, samples, 2).T
        below = np.cumsum(10 - 3 * a - (b - 0.5) ** 2 <= 7.6)
        if below[-2] == allowed < below[-1]:
            break
    with adversary():
        campaign, store = load_document(document), MemoryStore(sample_seed=SampleSeed(seed, stated=False))
        verdict = execute(campaign, store, threads=1)
        assert verdict.statistics is not None
        assert verdict.statistics.bound_samples is None
        assert verdict.statistics.upper_bound == claims.bound(allowed + 1, samples, 0.95)
        audited(store, campaign)
