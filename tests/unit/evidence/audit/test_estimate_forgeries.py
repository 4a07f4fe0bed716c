"""An estimate with an alarm, whose record leaves the alarm out and is consistent in all else: the audit rejects it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.checked.check import check
from campaigns.claims.spans import words
from campaigns.claims.stages import estimate as templates
from campaigns.claims.stages import sample as sentences
from campaigns.results.base import EXCLUDED, OK
from tests.audited import audited, recorded
from tests.given.corrupted_records import NORMAL, PAIR, Folder, copied, estimating, made, stored, written
from tests.given.forgeries import ESTIMATE
from tests.given.sampled_stages import DRAWN
from tests.simulators import noisy
from tests.simulators.adversaries import adversary
from worker.engine.rare import alarms, earlier, starts
from worker.engine.rare.mixture import Mixture
from worker.evidence.audit import alarms as of_audit
from worker.evidence.audit import estimate
from worker.evidence.audit.judge import audit, closing
from worker.running.catalogue.installed import catalogue
from worker.running.runs.audited import known
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore


def adversaries(threshold: float, **simulator: Any) -> Campaign:
    """A simulator of two parameters, with an estimate in place of its sample."""
    document = noisy.campaign(threshold, **simulator).document()
    document["stages"] |= {"certify": None, "estimate": {"evaluations": 1500}}
    return load_document(document)


def narrow(patch: pytest.MonkeyPatch) -> None:
    """A density that is far too narrow, so that few draws carry the estimate."""
    patch.setattr(Mixture, "adapted", lambda own, *_: replace(own, covariances=own.covariances * 1e-3))


def lowest(patch: pytest.MonkeyPatch) -> None:
    """The starts are the lowest alone, as before version 15."""
    patch.setattr(starts, "chosen", lambda known, budget: earlier.chosen(known.points, known.costs, budget))


def limits(**values: float) -> Callable[[pytest.MonkeyPatch], None]:
    """Other limits of the alarms, of the audit too where it has them."""

    def change(patch: pytest.MonkeyPatch) -> None:
        for name, value in values.items():
            patch.setattr(alarms, name, value)
            patch.setattr(of_audit, name, value, raising=False)

    return change


ALARMS = {
    "few": (0.9418, narrow),
    "unexplained": (0.945, lowest),
    "weight": (0.942, limits(LARGEST=1e-9)),
    "sample": (0.942, limits(CHANCE=3.0)),
    "unsaturated": (0.942, limits(SINGLE=0, SINGLE_PART=-1.0)),
}
"""A threshold and a change with which a run has the alarm: in most of the box a violation is left without a mode."""


@pytest.mark.by_day(1)
@pytest.mark.parametrize("why", ALARMS)
def test_an_alarm_that_is_removed_is_missed(why: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    threshold, change = ALARMS[why]
    change(monkeypatch)
    campaign, store = estimating(criterion__threshold=threshold), MemoryStore(sample_seed=DRAWN)
    execute(campaign, store, threads=1)
    folder = Folder(copied(made(campaign, store), tmp_path))
    stated: Any = folder.evidence["results"][ESTIMATE]
    assert [alarm["why"] for alarm in stated["alarms"]] == [why]
    assert (stated["low"], stated["high"]) == (None, None)
    assert closing(folder.items())[0]
    stated["alarms"] = []
    p = stated["probability"]
    stated |= {"low": p / 2, "high": min(1.0, 2 * p)}
    about = templates.estimated(p, (p / 2, stated["high"]), 0.95, templates.Draws(stated["draws"], stated["effective"]))
    told = templates.whole(about, templates.modes([mode["share"] for mode in stated["modes"]], 0, 0.0))
    stated |= {"statement": [span.model_dump(mode="json") for span in told], "text": words(told)}
    folder.reseal()
    items = folder.items()
    assert not closing(items)[0]
    wrong = {item.name for item in items if item.agrees is False}
    assert f"results.{ESTIMATE}.alarms.count" in wrong
    assert f"results.{ESTIMATE}.low" in wrong


@pytest.mark.nightly
def test_evaluations_that_the_search_does_not_request_are_rejected_unless_another_engine_made_them(
    tmp_path: Path,
) -> None:
    """Of another engine the audit states that it is not known whether they follow."""
    folder = Folder(written(tmp_path / "out", "estimated"))
    row = folder.evidence["results"][ESTIMATE]["independent"]["first"] - 1
    folder.arrays[f"points_{ESTIMATE}"][row, 0] += 0.01
    folder.reseal()
    wrong = {item.name: item.agrees for item in folder.items()}
    assert wrong[f"points.search of stage {ESTIMATE}"] is False
    folder.result["versions"]["code"] = "0" * 64
    folder.reseal()
    items = {item.name: item.agrees for item in folder.items()}
    assert items[f"points.search of stage {ESTIMATE}"] is None


def test_a_database_has_the_same_estimate(tmp_path: Path) -> None:
    engine = stored(tmp_path, "estimated")
    try:
        audited(engine)
        record = recorded(engine)
        stated: Any = record.claims["results"][ESTIMATE]
        stated["probability"] *= 2
        assert not closing(audit(record, known(record)))[0]
    finally:
        engine.dispose()


def test_a_run_without_a_violation_states_that_nothing_was_estimated() -> None:
    campaign, store = estimating(criterion__threshold=0.5), MemoryStore(sample_seed=DRAWN)
    execute(campaign, store, threads=1)
    (stated,) = (s.result.estimation for s in store.stages if s.result is not None and s.result.estimation is not None)
    assert stated.refused is not None
    assert stated.refused.why == "no_violation"
    audited(store, campaign)


@pytest.mark.nightly
def test_the_audit_follows_from_correlated_normals_whose_draws_may_be_beyond_the_bounds() -> None:
    campaign, store = estimating(uncertain=NORMAL, correlations=PAIR), MemoryStore(sample_seed=DRAWN)
    execute(campaign, store, threads=1)
    (stated,) = (s.result.estimation for s in store.stages if s.result is not None and s.result.estimation is not None)
    assert stated.low is not None
    assert stated.high is not None
    assert stated.outside > 0.0
    assert stated.high > stated.outside
    audited(store, campaign)


def test_of_a_simulator_that_repeats_an_estimate_is_made_and_audited() -> None:
    """d = 10 - 3 a - (b - 0.5)^2 at or below 7.02: 0.7 % of the square."""
    asked = adversaries(7.02)
    with adversary("none"):
        store = MemoryStore(sample_seed=DRAWN)
        execute(asked, store, threads=1)
        audited(store, asked)
    (stated,) = (s.result.estimation for s in store.stages if s.result is not None and s.result.estimation is not None)
    b = np.linspace(0.0, 1.0, 100_001)
    known = float(np.mean(np.maximum(0.0, 1.0 - (2.98 - (b - 0.5) ** 2) / 3.0)))
    assert stated.low is not None
    assert stated.high is not None
    assert stated.low <= known <= stated.high


def test_tails_and_exclusions_are_counted_over_one_population() -> None:
    """Two fifths of the square are excluded, of which none may lie in the tails."""
    document = adversaries(7.05).document()
    normal = {"kind": "normal", "mean": 0.5, "deviation": 0.2}
    document["uncertain"]["simulator.a"] |= {"distribution": normal}
    document["stages"] |= {"certify": {"samples": 120}}
    asked, store = load_document(document), MemoryStore(sample_seed=DRAWN)
    with adversary("none", lost=lambda call: EXCLUDED if call.b > 0.6 else OK):
        execute(asked, store, threads=1)
        audited(store, asked)
    (stated,) = (s.result.estimation for s in store.stages if s.result is not None and s.result.estimation is not None)
    assert stated.high is not None
    # As if all draws beyond the bounds violate, and as if none is excluded.
    outside = 2.0 * stats.norm.sf(2.5)
    kept = (1.0 - outside) * 0.6
    assert stated.high > outside / (kept + outside) > stated.outside
    (certificate,) = (s.result.certificate for s in store.stages if s.plan.kind == "certify" and s.result is not None)
    assert certificate is not None
    assert certificate.sample.excluded > 0
    assert certificate.sample.quantile is not None
    over = sentences._over(1, 0.1)
    assert over in words(certificate.sample.statement)
    assert over in words(certificate.sample.quantile.statement)


def test_of_earlier_versions_the_tails_are_relative_to_all_draws() -> None:
    def run(wording: int) -> Any:
        return SimpleNamespace(wording=wording, outside=lambda: 0.01)

    assert [estimate._tails(run(wording), 30, 60) for wording in (7, 8)] == [0.01, 0.02]
    assert estimate._tails(run(8), 0, 60) == 1.0


def test_of_a_simulator_with_noise_nothing_is_estimated() -> None:
    """Several calls are refused before the run."""
    asked = adversaries(7.02)
    with adversary("noise"):
        several = check(adversaries(7.02, repeats={"count": 3}), catalogue())
        store = MemoryStore(sample_seed=DRAWN)
        execute(asked, store, threads=1)
        audited(store, asked)
    (stated,) = (s.result.estimation for s in store.stages if s.result is not None and s.result.estimation is not None)
    assert stated.refused is not None
    assert (stated.refused.why, stated.refused.statement) == ("noise", templates.NOISE)
    assert "stages.estimate" in [problem.field for problem in several]
