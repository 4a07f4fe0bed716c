"""The modes of an estimate are named by findings: by evaluations on lines, which the audit reads again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.claims.spans import words
from campaigns.claims.stages import estimate as templates
from campaigns.results import ValidateResult
from campaigns.results.estimate import Estimation, NamedModes
from tests.audited import audited
from tests.given.corrupted_records import Folder, copied, made
from tests.given.sampled_stages import DRAWN
from tests.simulators import two_basins
from worker.evidence.audit.judge import closing
from worker.running.catalogue import installed
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore


@pytest.fixture(autouse=True)
def _installed() -> Iterator[None]:
    installed.simulators()["two_basins"] = two_basins.simulator
    installed.catalogue.cache_clear()
    yield
    del installed.simulators()["two_basins"]
    installed.catalogue.cache_clear()


def campaign(at_most: int = 4, **stages: Any) -> Campaign:
    """Both basins violate, in two regions of the square."""
    validating = {"findings": {"at_most": at_most}, "validate": {"neighbours": 20, "evaluations": 20_000}}
    search = [{"method": "direct", "evaluations": 600}]
    return load_document(
        {
            "name": "Two basins",
            "simulator": {"name": "two_basins"},
            "uncertain": {f"simulator.{name}": {"low": 0, "high": 0.97} for name in "xy"},
            "criterion": {"result": "separation", "threshold": 4.8},
            "stages": {"sensitivity": None, "search": search, "estimate": {"evaluations": 3000}} | validating | stages,
        }
    )


def ran(asked: Campaign) -> tuple[MemoryStore, Estimation, NamedModes]:
    store = MemoryStore(sample_seed=DRAWN)
    execute(asked, store, threads=1)
    audited(store, asked)
    (estimation,) = (s.result.estimation for s in store.stages if s.result and s.result.estimation is not None)
    last = store.stages[-1].result
    assert isinstance(last, ValidateResult)
    assert last.modes is not None
    return store, estimation, last.modes


def test_every_mode_is_named_by_its_finding_with_its_share() -> None:
    store, estimation, named = ran(campaign())
    assert sorted(named.findings) == [["F1"], ["F2"]]
    for mode, (label,) in zip(estimation.modes, named.findings, strict=True):
        (finding,) = (f for f in store.findings if f.label == label)
        assert all(abs(mode.parameters[path] - value) < 0.15 for path, value in finding.parameters.items())
    assert estimation.low is not None
    share = estimation.modes[named.findings.index(["F2"])].share
    assert f"{100 * share:.2g} % from F2" in named.text


def test_a_mode_that_is_no_finding_says_so() -> None:
    """One finding is listed, of two basins."""
    _, _, named = ran(campaign(at_most=1))
    assert sorted(named.findings) == [[], ["F1"]]
    assert all(labels == ["F1"] for labels in named.compared)
    assert templates.NO_FINDING in named.text


def test_what_was_not_compared_may_be_a_finding_and_equal_shares_are_all_stated() -> None:
    spans = templates.named([["F1", "F3"], [], []], [0.5, 0.25, 0.25], [False, False, True], {"F3"})
    assert words(spans) == (
        f"of P(violation) 50 % from F1 and F3 (not confirmed), 25 % from {templates.NO_FINDING} and 25 % from "
        f"{templates.MAY_BE}"
    )
    assert words(templates.modes([0.5, 0.25, 0.25], 0, 0.0)) == "its 3 modes carry 50 %, 25 % and 25 % of it"
    assert words(templates.named([["F2"]], None, [False], {})) == "mode 1 is F2"


def _exchanged(stated: Any) -> None:
    stated["modes"]["findings"].reverse()


def _removed(stated: Any) -> None:
    del stated["modes"]


def _another(stated: Any) -> None:
    stated["modes"]["findings"][0] = ["F1", "F2"]


@cache
def files() -> dict[str, bytes]:
    """Of a record that follows."""
    asked = campaign()
    found = made(asked, ran(asked)[0])
    with TemporaryDirectory() as folder:
        assert closing(Folder(copied(found, Path(folder))).items())[0]
    return found


@pytest.mark.by_day(1)
@pytest.mark.parametrize("change", [_exchanged, _removed, _another])
def test_other_names_are_rejected(change: Callable[[Any], None], tmp_path: Path) -> None:
    folder = Folder(copied(files(), tmp_path))
    change(folder.evidence["results"][-1])
    folder.reseal()
    assert not closing(folder.items())[0]
