"""Whoever writes a record states its version: what today's rules reject follows in no version, nor without the evidence
digest; what they accept follows in every one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.claims.wording import WORDING
from campaigns.results.verdict import VerdictWord
from tests.given.case_campaigns import CASE1, searching
from tests.given.corrupted_records import DIRECT, SQP, Folder, copied, made, since, write_called, written
from tests.given.sampled_stages import DRAWN
from worker.engine.stages import validate
from worker.engine.stages.parts import encounter as shown
from worker.evidence.audit.judge import EARLIER, closing
from worker.evidence.verdicts import agreement
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

VERSIONS = (None, *range(WORDING + 1))
"""Of the sentences; None: before the evidence digest."""
BY_DAY = (None, 0, 4, 8, WORDING - 1, WORDING)
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


def follows(folder: Folder, version: int | None) -> bool:
    """Whether the verdict follows from the record that states this version."""
    if version is None:
        folder.forget_seal()
    else:
        folder.result["versions"] |= {"wording": version}
        folder.reseal()
    return closing(folder.items())[0]


def copies(folder: Path, versions: Sequence[int | None]) -> Iterator[tuple[int | None, Folder]]:
    """The record for each of these versions."""
    original = {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}
    for version in versions:
        yield version, Folder(copied(original, folder))


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
            [] if version == WORDING else ["checks.closest approach"]
        )


@every_version
@pytest.mark.parametrize("name", ["cleared", "violated"])
def test_what_the_rules_of_today_accept_follows_in_every_version(
    name: str, versions: Sequence[int | None], tmp_path: Path
) -> None:
    for version, record in copies(written(tmp_path / "out", name), versions):
        assert follows(record, version), version
