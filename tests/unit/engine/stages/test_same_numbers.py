"""One campaign with every kind of stage: bit-identical with 1 or 8 threads, alone or after any interruption."""

from __future__ import annotations

from typing import Any

import pytest

from campaigns import Campaign
from campaigns.stages.certify import CertifyResult
from campaigns.stored.records import join
from tests.audited import audited
from tests.given.case_campaigns import campaign
from tests.given.failing_stores import Interrupted, Unreliable, outcome
from tests.given.sampled_stages import DRAWN
from worker.engine.stages.parts import driver
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

MONTE_CARLO: tuple[dict[str, Any], ...] = (
    {}, {"sampling": "latin_hypercube"}, {"sampling": "sobol"}, {"interval": 0.1},
)  # fmt: skip

ASKED: Campaign = campaign(
    scenario__horizon=1.0,
    uncertain={
        "vehicle.m": {"plus_minus": "20%", "distribution": {"kind": "normal", "mean": 5.0, "deviation": 0.4}},
        "vehicle.J": {"plus_minus": "20%", "distribution": {"kind": "beta", "alpha": 2, "beta": 3}},
    },
    correlations=[{"between": ["vehicle.m", "vehicle.J"], "value": 0.5}],
    stages={
        "sensitivity": {"points": 5, "morris": {"trajectories": 4}, "sobol": {"samples": 8}},
        "search": [
            {"method": "direct", "evaluations": 60},
            {"method": "sqp", "evaluations": 40, "starts": [{"vehicle.m": 4.5}]},
            *({"method": "monte_carlo", "evaluations": 120, "options": options} for options in MONTE_CARLO),
        ],
        "certify": {"samples": 150, "grid": {"points": 7}},
        "validate": {"neighbours": 10, "evaluations": 20_000},
    },
)


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Evaluations are stored a few at a time."""
    monkeypatch.setattr(driver, "FLUSH_ROWS", 7)


def run(store: MemoryStore, threads: int) -> Any:
    conclusion = execute(ASKED, store, threads=threads)
    audited(store, ASKED)
    return outcome(store, conclusion)


@pytest.fixture(scope="module")
def alone() -> tuple[Any, int]:
    store = MemoryStore(sample_seed=DRAWN)
    found = run(store, 1)
    return found, sum(len(c.status) for chunks in store.chunks.values() for c in chunks)


def test_every_kind_of_stage_is_run(alone: tuple[Any, int]) -> None:
    store = MemoryStore(sample_seed=DRAWN)
    assert run(store, 1) == alone[0]
    kinds = [record.plan.kind for record in store.stages]
    assert list(dict.fromkeys(kinds)) == ["nominal", "sensitivity", "search", "certify", "validate"]
    certificate = store.stages[kinds.index("certify")].result
    assert isinstance(certificate, CertifyResult)
    assert certificate.sample.samples == 150
    assert certificate.sample.outside > 0


def test_eight_threads_give_the_same_bits(alone: tuple[Any, int]) -> None:
    assert run(MemoryStore(sample_seed=DRAWN), 8) == alone[0]


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    "share",
    # By day in a search, in the sample and in the validation.
    [pytest.param(s, marks=pytest.mark.nightly) for s in (0.01, 0.1, 0.2, 0.35, 0.5, 0.65, 0.85, 0.95, 0.999)]
    + [0.05, 0.4, 0.75],
)
def test_an_interruption_changes_nothing(share: float, alone: tuple[Any, int]) -> None:
    found, evaluations = alone
    store = Unreliable(max(1, int(share * evaluations)))
    with pytest.raises(Interrupted):
        execute(ASKED, store, threads=8)
    assert run(store, 3) == found


@pytest.mark.nightly
def test_another_seed_gives_other_random_stages_and_the_same_direct() -> None:
    stores = []
    for seed in (1, 2):
        store = MemoryStore()
        execute(ASKED.model_copy(update={"seed": seed}), store, threads=2)
        stores.append(store)
    for position, record in enumerate(stores[0].stages):
        one, other = (join(store.chunks[position]) for store in stores)
        assert one is not None
        assert other is not None
        same = one.points.tobytes() == other.points.tobytes()
        deterministic = record.plan.kind == "nominal" or record.plan.method in ("direct", "sqp")
        assert same == deterministic, record.plan
