"""Whoever writes a record states its version: what today's rules reject follows in no version, nor without the evidence
digest; what they accept follows in every one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.claims.wording import WORDING
from campaigns.results.base import FAILED, OK
from campaigns.results.estimate import Estimation
from campaigns.results.verdict import VerdictWord
from tests.given.case_campaigns import CASE1, searching
from tests.given.corrupted_records import DIRECT, SQP, Folder, copied, made, since, write_called, written
from tests.given.record_versions import copies, follows
from tests.given.sampled_stages import DRAWN
from tests.simulators import noisy
from tests.simulators.adversaries import Call, adversary
from worker.engine.rare import estimate as rare
from worker.engine.rare import starts
from worker.engine.rare.evaluated import Evaluated
from worker.engine.stages import validate
from worker.engine.stages.parts import encounter as shown
from worker.evidence.audit import limits
from worker.evidence.audit.judge import EARLIER
from worker.evidence.verdicts import agreement
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

VERSIONS = (None, *range(WORDING + 1))
"""Of the sentences; None: before the evidence digest."""
BY_DAY = (None, 0, 4, 8, limits.RULES - 1, WORDING)
"""The first and the last ones and two between them."""
every_version = pytest.mark.parametrize(
    "versions", [pytest.param(BY_DAY, id="by day"), pytest.param(VERSIONS, id="all", marks=pytest.mark.nightly)]
)
THERE = SQP | {"starts": [{"vehicle.m": 6.0, "vehicle.J": 0.06}, *SQP["starts"]]}
LATE = {
    "component": "moving_circle",
    "parameters": {"position": {"x": 6.0, "y": 19.0}, "goal": {"x": 6.0, "y": -10.0}, "speed": 1.0, "radius": 0.3},
}


def started() -> Campaign:
    """One of its two searches starts at the worst case, which does not confirm it."""
    return searching(DIRECT, THERE, scenario__horizon=8.0, stages__certify={"samples": 60})


def late() -> Campaign:
    """All flights come closer after the horizon."""
    obstacles = [*CASE1["scenario"]["obstacles"], LATE]
    changes = {"scenario__obstacles": obstacles, "scenario__horizon": 10.5, "criterion__threshold": 0.8}
    return searching(DIRECT, SQP, stages__certify={"samples": 60}, **changes)


FORGERIES: dict[str, tuple[Callable[[], Campaign], Any, str, Any]] = {
    "agreement": (started, agreement, "_starts_at_finding", lambda *_: False),
    "closest approach": (late, shown, "_beyond", lambda *_: None),
}
"""By the check that holds in it: a campaign, and what of the engine its author replaces."""


@pytest.mark.by_day(1)
@every_version
@pytest.mark.parametrize("check", FORGERIES)
def test_what_is_cleared_against_the_rules_of_today_follows_in_no_version(
    check: str, versions: Sequence[int | None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, module, name, replaced = FORGERIES[check]
    campaign, store = asked(), MemoryStore(sample_seed=DRAWN)
    assert execute(campaign, store, threads=1).verdict is VerdictWord.INCONCLUSIVE
    monkeypatch.setattr(module, name, replaced)
    store = MemoryStore(sample_seed=DRAWN)
    assert execute(campaign, store, threads=1).verdict is VerdictWord.CLEARED
    folder = copied(made(campaign, store), tmp_path)
    monkeypatch.undo()
    for version, record in copies(folder, versions):
        assert not follows(record, version), version


@pytest.mark.nightly
@every_version
def test_a_case_without_its_basin_is_fixed_in_no_version(
    versions: Sequence[int | None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its descent ended nowhere, or violations were not compared: it is unresolved."""
    monkeypatch.setattr(validate, "_basins", lambda *_: [])
    campaign, store = since(threshold=0.9, there=0.9, costs=(0.85, 0.89)), MemoryStore(sample_seed=DRAWN)
    conclusion = execute(campaign, store, threads=1)
    assert conclusion.regression is not None
    assert "fixed" in [case.standing for case in conclusion.regression.cases]
    folder = copied(made(campaign, store), tmp_path)
    for version, record in copies(folder, versions):
        assert not follows(record, version), version


@every_version
def test_a_simulator_that_was_called_once_is_cleared_in_no_version(
    versions: Sequence[int | None], tmp_path: Path
) -> None:
    folder = Folder(write_called(tmp_path, "alone"))
    assert folder.result["verdict"] == "cleared"
    folder.shorten(0, len(folder.arrays["status_0"]) - 1)
    del folder.evidence["results"][0]["measured"]
    lost = [check for check in folder.result["checks"] if check["name"] == "noise of calls"]
    folder.result["checks"].remove(lost[0])
    folder.write()
    for version, record in copies(tmp_path, versions):
        assert not follows(record, version)
        wrong = {item.name.removeprefix(EARLIER) for item in record.items() if not item.agrees}
        assert "checks.noise of calls" in wrong, version


def partly(call: Call) -> int:
    """Half of the calls fail, and no other violates."""
    return FAILED if call.b > 0.5 else OK


@pytest.fixture
def of_failures() -> Iterator[Campaign]:
    """A campaign with an estimate, of which no violation is known, but failed evaluations."""
    document = noisy.campaign(1.0).document()
    document["stages"] |= {"certify": None, "estimate": {"evaluations": 1000}}
    with adversary(lost=partly):
        yield load_document(document)


def estimation(store: MemoryStore) -> Estimation:
    (stated,) = (s.result.estimation for s in store.stages if s.result is not None and s.result.estimation is not None)
    return stated


@pytest.mark.nightly
@every_version
def test_that_failed_evaluations_alone_are_no_violations_follows_in_every_version(
    of_failures: Campaign, versions: Sequence[int | None], tmp_path: Path
) -> None:
    store = MemoryStore(sample_seed=DRAWN)
    execute(of_failures, store, threads=1)
    refused = estimation(store).refused
    assert refused is not None
    assert refused.why == "no_violation"
    for version, record in copies(copied(made(of_failures, store), tmp_path), versions):
        assert follows(record, version), version


@pytest.mark.nightly
@every_version
def test_an_estimate_from_failed_evaluations_alone_follows_in_no_version(
    of_failures: Campaign, versions: Sequence[int | None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen, started = starts.chosen, rare._started

    def as_violations(*given: Any) -> Any:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(Evaluated, "violates", property(lambda own: (own.margins <= 0.0) | (own.status == FAILED)))
            patch.setattr(Evaluated, "failed", property(lambda own: np.zeros(len(own.status), dtype=bool)))
            return (yield from started(*given))

    monkeypatch.setattr(starts, "chosen", lambda of, n: chosen(replace(of, costs=np.minimum(of.costs, 1e300)), n))
    monkeypatch.setattr(rare, "_started", as_violations)
    store = MemoryStore(sample_seed=DRAWN)
    execute(of_failures, store, threads=1)
    assert estimation(store).probability == pytest.approx(0.5, abs=0.1)
    folder = copied(made(of_failures, store), tmp_path)
    monkeypatch.undo()
    for version, record in copies(folder, versions):
        assert not follows(record, version), version


@pytest.mark.nightly
@every_version
def test_flights_that_fail_after_the_horizon_without_being_counted_clear_in_no_version(
    versions: Sequence[int | None], tmp_path: Path
) -> None:
    """What they met until then may have been left out, which the closing sentence of earlier versions states."""
    folder = Folder(written(tmp_path / "out", "cleared"))
    del folder.evidence["results"][5]["encounter"]["beyond"]["cut_short"]
    folder.write()
    for version, record in copies(tmp_path / "out", versions):
        assert not follows(record, version), version
        earlier = [item for item in record.items() if item.name.startswith(EARLIER)]
        assert [item.name.removeprefix(EARLIER) for item in earlier] == (
            [] if (version or 0) >= limits.RULES else ["checks.closest approach"]
        )


UNKNOWN = {
    "extent": ("circle", "reach", None),
    "point": ("separation", "measured_to", ""),
    "unit": ("separation", "unit", "mm"),
}
"""Components of the record, and what their files did not declare, or with what no distance can be compared."""


@pytest.mark.by_day(1)
@every_version
@pytest.mark.parametrize("what", UNKNOWN)
def test_distances_of_which_it_is_not_known_what_they_show_clear_in_no_version(
    what: str, versions: Sequence[int | None], tmp_path: Path
) -> None:
    """A vehicle inside an obstacle could count as clear, and no approach beyond the horizon was looked for."""
    folder = Folder(written(tmp_path / "out", "cleared"))
    component, field, value = UNKNOWN[what]
    entry = next(c for c in folder.evidence["components"]["components"] if c["name"] == component)
    assert entry[field] != value
    entry[field] = value
    folder.write()
    for version, record in copies(tmp_path / "out", versions):
        assert not follows(record, version), version
        wrong = {item.name.removeprefix(EARLIER) for item in record.items() if not item.agrees}
        assert "checks.distances" in wrong, version


@pytest.mark.by_day(1)
@every_version
@pytest.mark.parametrize("name", ["cleared", "violated"])
def test_what_the_rules_of_today_accept_follows_in_every_version(
    name: str, versions: Sequence[int | None], tmp_path: Path
) -> None:
    for version, record in copies(written(tmp_path / "out", name), versions):
        assert follows(record, version), version
