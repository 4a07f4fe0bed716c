"""Estimates of a deep improbable region next to a shallow likely one, of a tail, and of a density at a bound."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.claims.stages import estimate as sentences
from campaigns.claims.wording import WORDING
from campaigns.results.estimate import Estimation
from tests.audited import audited
from tests.given.corrupted_records import Folder, copied, made, written
from tests.given.forgeries import ESTIMATE
from tests.given.record_versions import copies, follows
from tests.given.sampled_stages import DRAWN
from tests.simulators import noisy
from tests.simulators.adversaries import ADVERSARIES, Call, adversary
from worker.engine.rare import design, earlier, starts
from worker.engine.rare.alarms import NOTHING
from worker.engine.rare.estimate import estimated
from worker.engine.stages import estimate as stage
from worker.evidence.audit import limits
from worker.evidence.audit.judge import EARLIER
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

NORMAL = {"kind": "truncated_normal", "mean": 0.5, "deviation": 0.05}
PROBABILITY = float(np.prod(stats.norm.cdf([-1.38, -2.48]) - stats.norm.cdf([-1.62, -2.72])))


POSITION = 5
"""Of the estimate, after two searches and the sample."""


def deep_and_likely(call: Call) -> float:
    """Down to -5.75 beyond 5.5 deviations on both sides, and just below the threshold of 1 in a square with a
    probability of 1e-4."""
    likely = abs(call.a - 0.425) < 0.006 and abs(call.b - 0.37) < 0.006
    wanted = 0.999 if likely else min(3.0, 1.0 + 30.0 * (0.275 - abs(call.a - 0.5)))
    return wanted - (10.0 - 3.0 * call.a - (call.b - 0.5) ** 2)


def asked(first: dict[str, Any], stages: dict[str, Any], second: dict[str, Any] | None = None) -> Campaign:
    """A campaign of two parameters with these distributions, and an estimate."""
    document = noisy.campaign(1.0).document()
    document["uncertain"]["simulator.a"] |= {"distribution": first}
    document["uncertain"]["simulator.b"] |= {"distribution": second or first}
    document["stages"] |= stages
    return load_document(document)


def two_values(call: Call) -> float:
    """Half the threshold of 1 in a corner with a probability of about 7e-5, twice the threshold outside."""
    return (0.5 if min(call.a, call.b) > 0.62 else 2.0) - (10.0 - 3.0 * call.a - (call.b - 0.5) ** 2)


def test_an_estimate_of_a_criterion_of_two_values_follows(monkeypatch: pytest.MonkeyPatch) -> None:
    """No slope shows which coordinate decides: each is brought to where it violates no more, in the audit as well."""
    monkeypatch.setitem(ADVERSARIES, "two values", two_values)
    flat, one_by_one = list[int](), design._one_by_one

    def noted(points: Any, allowed: Any) -> Any:
        flat.append(len(points))
        return one_by_one(points, allowed)

    monkeypatch.setattr(design, "_one_by_one", noted)
    search = [{"method": name, "evaluations": 300} for name in ("direct", "differential_evolution")]
    with adversary("two values"):
        campaign = asked(NORMAL, {"search": search, "certify": None, "estimate": {"evaluations": 2000}})
        stated, store = ran(campaign)
        assert sum(flat) > 0
        assert (stated.low or 0.0) < stats.norm.sf(2.4) ** 2 < (stated.high or 0.0)
        audited(store, campaign)


@pytest.fixture
def hidden(monkeypatch: pytest.MonkeyPatch) -> Iterator[Campaign]:
    """The searches store violations of the deep region alone, the sample of the run those of the likely one."""
    monkeypatch.setitem(ADVERSARIES, "two regions", deep_and_likely)
    search = [{"method": name, "evaluations": 1000} for name in ("direct", "differential_evolution")]
    stages = {"search": search, "certify": {"samples": 100_000, "keep": "lowest"}, "estimate": {"evaluations": 1000}}
    monkeypatch.setattr(earlier, "EACH", 125)  # with 50, the deep region would need more evaluations to fill the starts
    with adversary("two regions"):
        yield asked(NORMAL, stages)


def ran(campaign: Campaign) -> tuple[Estimation, MemoryStore]:
    store = MemoryStore(sample_seed=DRAWN)
    execute(campaign, store, threads=1)
    (stated,) = (s.result.estimation for s in store.stages if s.result is not None and s.result.estimation is not None)
    return stated, store


def as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """The starts of earlier versions, which looked at no sample of the run."""
    monkeypatch.setattr(starts, "chosen", lambda known, budget: earlier.chosen(known.points, known.costs, budget))
    monkeypatch.setattr(starts, "normal", earlier.normal)
    monkeypatch.setattr(stage, "estimated", lambda *given: estimated(*given[:6]))


@pytest.mark.nightly
def test_the_likely_region_is_a_mode_of_the_estimate_and_no_interval_leaves_it_out(hidden: Campaign) -> None:
    stated, store = ran(hidden)
    audited(store, hidden)
    likely = [mode for mode in stated.modes if 0.4 < mode.parameters["simulator.a"] < 0.5]
    assert likely
    assert all(mode.origins for mode in likely)
    assert stated.alarms or (stated.low or 0.0) < PROBABILITY < (stated.high or 0.0)


@pytest.mark.nightly
def test_an_interval_without_the_likely_region_follows_in_no_version(
    hidden: Campaign, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        as_before(patch)
        stated, store = ran(hidden)
    assert not stated.alarms
    assert stated.high is not None
    assert stated.high < PROBABILITY / 1000.0
    for version, folder in copies(
        copied(made(hidden, store), tmp_path), (4, 8, limits.RULES - 1, limits.RULES, WORDING)
    ):
        assert not follows(folder, version), version
        wrong = {item.name for item in folder.items() if not item.agrees}
        expected = EARLIER if version is not None and version < limits.RULES else ""
        assert f"{expected}results.{POSITION}.low" in wrong, version


@pytest.mark.nightly
def test_the_sample_of_the_run_is_looked_at_where_no_violation_of_it_is_examined(
    hidden: Campaign, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the starts of earlier versions, and without: the alarm alone is missed."""
    with monkeypatch.context() as patch:
        patch.setattr(starts, "chosen", lambda known, budget: earlier.chosen(known.points, known.costs, budget))
        patch.setattr(stage, "estimated", lambda *given: estimated(*given[:6], certified=given[7]))
        stated, _ = ran(hidden)
        assert [alarm.why for alarm in stated.alarms] == ["sample"]
        assert stated.alarms[0].statement[1].model_dump()["value"] == stated.alarms[0].value > 3
        patch.setattr(stage, "_certified", lambda *_: NOTHING)
        without, store = ran(hidden)
    assert not without.alarms
    folder = Folder(copied(made(hidden, store), tmp_path))
    assert f"results.{POSITION}.alarms.count" in {item.name for item in folder.items() if item.agrees is False}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("count", [2, 90, 329, 400])
def test_an_estimate_from_a_part_of_its_draws_is_rejected(count: int, tmp_path: Path) -> None:
    """Also where the search is not repeated, if the part is smaller than any that is drawn."""
    folder = Folder(written(tmp_path / "out", "estimated"))
    stated: Any = folder.evidence["results"][ESTIMATE]
    last = stated["final"]["first"] + stated["final"]["count"]
    assert stated["final"]["count"] > 400
    stated |= {"draws": count, "final": {"first": last - count, "count": count}}
    folder.reseal()
    wrong = {item.name for item in folder.items() if item.agrees is False}
    assert {f"results.{ESTIMATE}.final.count", f"results.{ESTIMATE}.draws"} <= wrong
    folder.result["versions"]["code"] = "0" * 64
    folder.arrays[f"points_{ESTIMATE}"][0, 0] += 0.01
    folder.reseal()
    wrong = {item.name for item in folder.items() if item.agrees is False}
    assert (f"points.draws of stage {ESTIMATE}" in wrong) == (count < 330)


def of_a_tail(monkeypatch: pytest.MonkeyPatch, deviations: float) -> Campaign:
    """Violates from so many deviations of the first parameter on, of ten."""
    beyond = 0.5 + 0.05 * deviations
    monkeypatch.setitem(
        ADVERSARIES, "tail", lambda call: (call.b - 0.5) ** 2 - 20.0 * (call.a - beyond) - 9.0 + 3.0 * call.a
    )
    even = {"kind": "uniform"}
    return asked(NORMAL, {"certify": None, "estimate": {"evaluations": 1500}}, even)


def test_what_violates_seven_deviations_away_is_estimated(monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = of_a_tail(monkeypatch, 7.0)
    with adversary("tail"):
        stated, store = ran(campaign)
        audited(store, campaign)
    assert stated.probability == pytest.approx(stats.norm.sf(7.0), rel=0.2, abs=0.0)


def test_of_what_is_too_far_for_an_estimate_the_refusal_states_so(monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = of_a_tail(monkeypatch, 9.0)
    with adversary("tail"):
        stated, store = ran(campaign)
        audited(store, campaign)
    assert stated.refused is not None
    assert (stated.refused.why, stated.refused.statement) == ("too_far", sentences.TOO_FAR)


def test_an_estimate_with_draws_that_are_rounded_to_a_bound_is_audited(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of beta (1, 0.05) 16 % of all draws are at 1, from where no normal value can be had back."""
    sharp = {"kind": "beta", "alpha": 1.0, "beta": 0.05}
    monkeypatch.setitem(
        ADVERSARIES, "bound", lambda call: -9.0 + 3.0 * call.a + 5.0 * (call.a < 0.999999) + 20.0 * (0.65 - call.b)
    )
    campaign = asked(sharp, {"certify": None, "estimate": {"evaluations": 1500}}, NORMAL)
    with adversary("bound"):
        stated, store = ran(campaign)
        audited(store, campaign)
    assert stated.probability is not None
    (columns,) = (store.evaluations(k) for k, s in enumerate(store.stages) if s.plan.kind == "estimate")
    assert columns is not None
    assert np.count_nonzero(columns.points[-stated.draws :, 0] == 1.0) > 100
