"""An estimate with an alarm, whose record leaves the alarm out and is consistent in all else: the audit rejects it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from campaigns.claims.spans import words
from campaigns.claims.stages import estimate as templates
from tests.audited import audited, recorded
from tests.given.corrupted_records import Folder, copied, estimating, made, stored
from tests.given.forgeries import ESTIMATE
from tests.given.sampled_stages import DRAWN
from worker.engine.rare.mixture import Mixture
from worker.evidence.audit.judge import audit, closing
from worker.running.runs.audited import known
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore


@pytest.fixture
def alarmed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Folder:
    """A run whose density is far too narrow, so that few draws carry the estimate."""
    monkeypatch.setattr(Mixture, "adapted", lambda own, *_: replace(own, covariances=own.covariances * 1e-3))
    campaign, store = estimating(criterion__threshold=0.9418), MemoryStore(sample_seed=DRAWN)
    execute(campaign, store, threads=1)
    (tmp_path / "out").mkdir()
    return Folder(copied(made(campaign, store), tmp_path / "out"))


def test_an_alarm_that_is_removed_is_missed(alarmed: Folder) -> None:
    stated: Any = alarmed.evidence["results"][ESTIMATE]
    assert {alarm["why"] for alarm in stated["alarms"]} & {"few", "weight", "sample"}
    assert (stated["low"], stated["high"]) == (None, None)
    assert closing(alarmed.items())[0]
    stated["alarms"] = []
    p = stated["probability"]
    stated |= {"low": p / 2, "high": 2 * p}
    about = templates.estimated(p, (p / 2, 2 * p), 0.95, (stated["draws"], stated["effective"]), 0.0)
    told = templates.whole(about, templates.modes([mode["share"] for mode in stated["modes"]], 0, 0.0))
    stated |= {"statement": [span.model_dump(mode="json") for span in told], "text": words(told)}
    alarmed.reseal()
    items = alarmed.items()
    assert not closing(items)[0]
    wrong = {item.name for item in items if item.agrees is False}
    assert f"results.{ESTIMATE}.alarms.count" in wrong
    assert f"results.{ESTIMATE}.low" in wrong


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
