"""What validation alone saw and no stage stores bars "cleared" in a run that extends it, or it is not extended."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results import ValidateResult
from campaigns.results.validate import Beyond, Encounter, Later, SpotChecks
from campaigns.stored.records import Begun, Cited
from campaigns.versions import OtherCode
from tests.given.case_campaigns import searching
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.running.runs import identity
from worker.running.runs.continuation import Budget, WouldLose, carried, continued
from worker.running.runs.losses import unstored
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

METHOD = "worker.engine.search.methods.direct"
ELSEWHERE = "evaluation 3 of CMA-ES"
INTENDED = {"closest_approach": "the obstacle crosses the goal long after the vehicle has left it"}


def asked(**changes: Any) -> Campaign:
    document = searching(
        {"method": "direct", "evaluations": 60}, scenario__horizon=4.0, stages__certify={"samples": 60}
    ).document()
    document["criterion"] |= {"threshold": 0.1, "from_centre": True}
    return load_document(document | changes, "the test")


@pytest.fixture(scope="module")
def ended() -> MemoryStore:
    execute(asked(), store := MemoryStore())
    return store


def validated(store: MemoryStore) -> ValidateResult:
    result = store.stages[-1].result
    assert isinstance(result, ValidateResult)
    return result.model_copy(update={"ok": True, "encounter": encounter(result, met())})


def encounter(result: ValidateResult, beyond: Beyond) -> Encounter:
    assert result.encounter is not None
    return result.encounter.model_copy(update={"beyond": beyond})


def met(name: str = "", value: float = 0.05, unknown: str = "") -> Beyond:
    def later(name: str) -> Later | None:
        approach = Later(name=name, value=value, time=8.0, obstacle=0, distance=160.0, closing=20.0, simulated=True)
        return approach if name else None

    return Beyond(times=2, flights=1034, closer=int(bool(name)), lowest=later(name), unknown=later(unknown))


def bars(store: MemoryStore, campaign: Campaign, **seen: Any) -> bool:
    """Whether a run is not extended of which validation saw this, and nothing else that bars "cleared"."""
    result = validated(store).model_copy(update=seen)
    stages = [*store.stages[:-1], replace(store.stages[-1], result=result)]
    try:
        carried(campaign, continued(campaign, Budget(300, more=True)), replace(store, stages=stages, findings=[]))
    except WouldLose:
        return True
    return False


@pytest.mark.parametrize(
    ("beyond", "refused", "intended"),
    [
        (met(), False, False), (met(ELSEWHERE), True, True), (met("F1"), True, True),
        (met(unknown=ELSEWHERE), True, True),
        (met("nominal"), False, False), (met("evaluation 7 of the sample"), False, False),
        (met("nominal", unknown=ELSEWHERE), True, True), (met(ELSEWHERE, value=0.2), True, False),
    ],
)  # fmt: skip
def test_a_flight_that_comes_closer_beyond_the_horizon_is_not_forgotten(
    ended: MemoryStore, beyond: Beyond, refused: bool, intended: bool
) -> None:
    seen = {"encounter": encounter(validated(ended), beyond)}
    assert bars(ended, asked(), **seen) == refused
    assert bars(ended, asked(encounter={"intended": INTENDED}), **seen) == intended


def test_neither_is_one_of_a_sample_that_is_drawn_again(ended: MemoryStore) -> None:
    sampled = met("evaluation 7 of the sample")
    result = validated(ended).model_copy(update={"encounter": encounter(validated(ended), sampled)})
    assert not unstored(asked(), result, [], sampled=True)
    assert unstored(asked(), result, [], sampled=False)
    assert not unstored(asked(), validated(ended), [], sampled=False)


def test_what_was_not_confirmed_is_not_forgotten(ended: MemoryStore) -> None:
    spot = validated(ended).spot_checks
    assert spot is not None
    assert not bars(ended, asked())
    assert bars(ended, asked(), ok=False)
    others: list[dict[str, Any]] = [{"violating": 1}, {"compared": spot.checked - 1}, {"lowest_reference": 0.1}]
    for other in others:
        assert bars(ended, asked(), spot_checks=SpotChecks.model_validate(vars(spot) | other)), other


class Citing(MemoryStore):
    """The store of a run that continues another one, one of whose methods chose its points by other code."""

    before: Cited

    def cited(self) -> Cited:  # type: ignore[override]
        return self.before


def test_a_run_that_continues_another_one_waits_for_the_code_that_sees_it_again(ended: MemoryStore) -> None:
    modules = {name: digest for name, digest in identity.code(asked()).modules.items() if name != METHOD}
    result = validated(ended).model_copy(update={"encounter": encounter(validated(ended), met(ELSEWHERE))})
    stages = [*ended.stages[:-1], replace(ended.stages[-1], result=result)]
    evaluated = {at: columns for at in range(len(stages)) if (columns := ended.evaluations(at)) is not None}
    assert ended.versions is not None
    store = Citing(sample_seed=ended.sample_seed)
    store.before = Cited(Begun(ended.versions, modules), stages, evaluated, {})
    with pytest.raises(OtherCode, match="without it"):
        execute(asked(), store)


@pytest.mark.nightly
def test_what_the_name_of_a_flight_states_is_how_the_stage_names_it(ended: MemoryStore) -> None:
    """A flight of the sample is one by its name."""
    names: list[str] = []
    beyond = ClosedLoop.beyond

    def naming(self: ClosedLoop, called: Any, *others: Any) -> Any:
        names.extend(called)
        return beyond(self, called, *others)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ClosedLoop, "beyond", naming)
        execute(asked(), store := MemoryStore())
    sample = store.evaluations([s.plan.kind for s in store.stages].index("certify"))
    assert sample is not None
    assert sum(name.endswith(" of the sample") for name in names) == len(sample.status)
    assert "nominal" in names
