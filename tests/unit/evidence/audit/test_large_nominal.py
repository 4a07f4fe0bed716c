"""What hides no change of the findings of a baseline: a nominal case of 1e6 m, where nothing is met, and a distance of
half the range within which the campaign counts minima as one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.asked.regression import BaselineCase
from campaigns.claims.wording import WORDING
from campaigns.results.regression import Regression
from tests.given.corrupted_records import Folder, copied, made
from tests.given.sampled_stages import DRAWN
from tests.simulators import adversaries, noisy
from tests.simulators.adversaries import Call, adversary
from worker.engine.stages.parts import between, confirm
from worker.evidence.audit.judge import EARLIER
from worker.evidence.audit.limits import WIDER
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

FAR = 1e6


def nothing_met(call: Call) -> float:
    return FAR if abs(call.a - 0.5) < 0.1 and abs(call.b - 0.5) < 0.1 else 0.0


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Iterator[Campaign]:
    """Its baseline has the worst case 0.25 m higher; the margin falls from 0.45 m to 0.2 m."""
    monkeypatch.setitem(adversaries.ADVERSARIES, "nothing met", nothing_met)
    document = noisy.campaign(6.55, certify=60).document()
    case = {"label": "F1", "parameters": {"simulator.a": 1.0, "simulator.b": 0.0}, "cost": 7.0}
    document["baseline"] = {"run": "R-0042", "digest": "0" * 64, "threshold": 6.55, "cases": [case]}
    document["baseline"]["repeats"] = {"count": 1}
    document["regression"] = {"fail_on": ["worse"]}
    with adversary("nothing met"):
        yield load_document(document)


@pytest.fixture
def wide(asked: Campaign) -> Campaign:
    """Its minima are one within half of every range, of which a run with a baseline takes no account."""
    document = asked.document()
    document["stages"]["findings"] |= {"distance": 0.5}
    return load_document(document | {"regression": {"fail_on": ["violation"]}})


def changes(campaign: Campaign, store: MemoryStore) -> Regression:
    found = execute(campaign, store, threads=1).regression
    assert found is not None
    return found


def disagreeing(folder: Path, version: int) -> dict[str, Any]:
    """The claims that do not follow from the record if it is of this version."""
    record = Folder(folder)
    record.result["versions"] |= {"wording": version}
    record.reseal()
    return {item.name: item.agrees for item in record.items() if not item.agrees}


def items(folder: Path, version: int) -> dict[str, Any]:
    """Those on the comparison."""
    return {name: agrees for name, agrees in disagreeing(folder, version).items() if "regression" in name}


def test_a_margin_that_falls_fails(asked: Campaign, tmp_path: Path) -> None:
    store = MemoryStore(sample_seed=DRAWN)
    found = changes(asked, store)
    worse = next(case for case in found.cases if case.before == "F1")
    assert (worse.standing, worse.fails, found.ok) == ("worse", True, False)
    assert worse.change == pytest.approx(-0.25, abs=1e-3)
    assert items(copied(made(asked, store), tmp_path), WORDING) == {}


def test_what_only_earlier_versions_allowed_holds_by_their_rules(asked: Campaign, tmp_path: Path) -> None:
    store = MemoryStore(sample_seed=DRAWN)
    with pytest.MonkeyPatch.context() as earlier:
        earlier.setattr(BaselineCase, "rounding", lambda *_: 1e-6 * (FAR + 8.5))
        found = changes(asked, store)
    assert ([case.standing for case in found.cases if case.before == "F1"], found.ok) == (["same"], True)
    folder = copied(made(asked, store), tmp_path)
    assert items(folder, WIDER - 1) == {f"{EARLIER}regression.ok": None}
    assert {"regression.cases.0.standing", "regression.ok"} <= items(folder, WIDER).keys()


def test_minima_far_apart_count_as_one_by_the_rules_of_earlier_versions_alone(wide: Campaign, tmp_path: Path) -> None:
    store = MemoryStore(sample_seed=DRAWN)
    assert changes(wide, store).ok
    assert items(copied(made(wide, store), tmp_path / "own"), WORDING) == {}
    store = MemoryStore(sample_seed=DRAWN)
    with pytest.MonkeyPatch.context() as earlier:
        earlier.setattr(between, "distance", lambda context: context.campaign.stages.findings.distance)
        assert changes(wide, store).ok
    folder = copied(made(wide, store), tmp_path / "earlier")
    assert f"{EARLIER}regression.ok" in items(folder, WIDER - 1)
    assert any(name.endswith("findings.distance") for name in disagreeing(folder, WIDER))


@pytest.mark.parametrize("cost", [0.9, 7.0, -0.2])
def test_a_large_nominal_value_lets_no_integrations_differ_by_more(cost: float) -> None:
    """The nominal cost stands for "no encounter"; a case agrees with itself by its own cost, or not at all."""
    stages = SimpleNamespace(validate_=SimpleNamespace(tolerance=1e-3))
    problem = SimpleNamespace(threshold=0.5)
    context: Any = SimpleNamespace(problem=problem, campaign=SimpleNamespace(stages=stages), nominal_cost=FAR)
    assert confirm._allowed(context, cost) <= 1e-3 * abs(cost)
