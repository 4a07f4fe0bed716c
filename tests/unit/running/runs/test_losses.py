"""A violation or a failure that a run has stored is never lost by extending it: it is replayed, or the run is not
extended."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

import clearance
from backend.db.engine import connect, read
from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from backend.db.tables import Run
from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.refusals import RefusalCode
from campaigns.results.base import EXCLUDED, FAILED, FLAKY, OK
from campaigns.results.validate import SpotChecks
from campaigns.stages.plan import most
from campaigns.stored.records import Ahead, Begun, Cited, Columns, StagePlan, StageRecord
from campaigns.versions import OtherCode
from clearance.cli import invoke
from tests.given.at_night import rows_nightly_but
from tests.given.case_campaigns import searching
from tests.given.refused_commands import refused
from tests.migrated import migrated
from worker.engine.systems.base import Floats, Seeds
from worker.engine.systems.simulators.functions import InProcess
from worker.running.catalogue.installed import catalogue, forget_simulators
from worker.running.runs import identity
from worker.running.runs.continuation import Budget, WouldLose, carried, continued
from worker.running.runs.losses import lost
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

RANGES = {"x": (0.0, 1.0), "y": (0.0, 1.0)}
METHODS = {"mlsl": 60, "direct": 60}
LARGER = {"mlsl": 120, "direct": 120}
SIMULATOR = """
import clearance


@clearance.simulator(
    parameters={"x": clearance.Parameter(0.0, 1.0), "y": clearance.Parameter(0.0, 1.0)},
    results={"value": clearance.Output(unit="m", worse="low")}, isolated=False,
)
def box(x, y):
    if abs(x - 0.2530591408457602) < 0.02 and abs(y - 0.16524209389081018) < 0.02:
        return 0.5
    return 1.5 + 2.0 * ((x - 0.31) ** 2 + (y - 0.37) ** 2)
"""
"""The box is where validation alone evaluates."""
BOX = {
    "name": "Box",
    "simulator": {"name": "box"},
    "uncertain": {f"simulator.{name}": {"low": 0.0, "high": 1.0} for name in RANGES},
    "criterion": {"result": "value", "threshold": 1.0},
    "seed": 3,
    "stages": {
        "sensitivity": None,
        "search": [{"method": method, "evaluations": number} for method, number in METHODS.items()],
        "certify": {"samples": 59},
        "validate": {"evaluations": 1500},
    },
}


def smooth(x: float, y: float) -> float:
    return float(1.5 + 2.0 * ((x - 0.31) ** 2 + (y - 0.37) ** 2))


def boxed(at: Any, width: float, fails: bool) -> Callable[[float, float], float]:
    """The smooth function but in a box, where it violates or raises."""
    middle = [float(value) for value in at]

    def fly(x: float, y: float) -> float:
        if abs(x - middle[0]) < width and abs(y - middle[1]) < width:
            if fails:
                raise RuntimeError("the solver diverged")
            return 0.5
        return float(1.5 + 2.0 * ((x - 0.31) ** 2 + (y - 0.37) ** 2))

    return fly


def searched(fly: Callable[[float, float], float], **changes: Any) -> clearance.Result:
    usual: dict[str, Any] = {"methods": METHODS, "certify": 59, "validation": 1500, "seed": 3}
    return clearance.search(fly, RANGES, 1.0, **usual | changes)


def barred(found: clearance.Result) -> int:
    """How many of its evaluations bar cleared."""
    return int(((found.costs <= 1.0) | (found.status == "failed")).sum())


@pytest.fixture(scope="module")
def places() -> dict[str, list[tuple[Any, float]]]:
    """By stage, points that it alone evaluates, the farthest from those of others first, and a width about each."""
    found = searched(smooth, sample_seed=1)
    alone = {}
    for kind in ("certify", "validate"):
        own, others = found.points[found.stage == kind], found.points[found.stage != kind]
        apart = np.abs(own[:, None] - others[None]).max(axis=-1).min(axis=1)
        alone[kind] = [(own[k], 0.4 * min(float(apart[k]), 0.05)) for k in np.argsort(-apart)[:3]]
    return alone


CHANGES: dict[str, dict[str, Any]] = {"larger": {"methods": LARGER}, "another sample": {"certify": 61}}


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("kind", "ends", "change"),
    rows_nightly_but(
        [("certify", "violates", "larger"), ("certify", "fails", "another sample"),
         ("validate", "fails", "larger"), ("validate", "violates", "another sample")],
        list(product(("certify", "validate"), ("violates", "fails"), CHANGES)),
    ),
)  # fmt: skip
def test_a_search_that_is_resumed_is_never_cleared_of_what_it_stored(
    places: dict[str, list[tuple[Any, float]]], kind: str, ends: str, change: str
) -> None:
    fails, changes = ends == "fails", CHANGES[change]
    refusals = 0
    for at, width in places[kind]:
        fly = boxed(at, width, fails)
        first = searched(fly, sample_seed=1)
        assert barred(first)
        try:
            resumed = searched(fly, resume=first, **changes)
        except ValueError:
            refusals += 1
            continue
        assert resumed.verdict != "cleared"
        assert barred(resumed)
    assert refusals or (kind, "methods" in changes) == ("certify", True), "its own sample is replayed"


def test_a_search_that_is_resumed_as_it_was_has_what_validation_found(
    places: dict[str, list[tuple[Any, float]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    at, width = places["validate"][0]
    fly, made, evaluate = boxed(at, width, fails=False), [0], InProcess.evaluate

    def counting(self: InProcess, vectors: Floats, seeds: Seeds | None = None) -> Any:
        made[0] += len(vectors)
        return evaluate(self, vectors, seeds)

    first = searched(fly, sample_seed=1)
    monkeypatch.setattr(InProcess, "evaluate", counting)
    again = searched(fly, resume=first)
    assert again.costs.tobytes() == first.costs.tobytes()
    assert made[0] < (first.stage == "validate").sum(), "only what confirms it is evaluated again"
    assert again.verdict == first.verdict == "violated"


@pytest.mark.nightly
def test_a_search_that_is_resumed_states_what_it_extends(tmp_path: Path) -> None:
    first = searched(smooth)
    digest = first.origin.campaign.digest
    assert first.continues is None
    resumed = searched(smooth, methods=LARGER, resume=first)
    assert resumed.continues == {"run": "an earlier search", "digest": digest}
    assert digest[:12] in str(resumed)
    assert digest[:12] in resumed._repr_html_()
    assert digest[:12] not in str(first)
    written = resumed.save(_folder(tmp_path, "resumed"))
    assert json.loads((written / "result.json").read_text(encoding="utf-8"))["continues"] == resumed.continues
    assert invoke(["audit", str(written)]) == 0
    page = resumed.report(tmp_path / "report.html").read_text(encoding="utf-8")
    assert f"(campaign {digest[:12]})" in page
    assert "no earlier run" not in page
    assert "no earlier run" in first.report(tmp_path / "first.html").read_text(encoding="utf-8")
    folder = first.save(_folder(tmp_path, "first"))
    assert searched(smooth, methods=LARGER, resume=folder).continues == {"run": str(folder), "digest": digest}


def _folder(parent: Path, name: str) -> Path:
    (parent / name).mkdir()
    return parent / name


def test_a_folder_with_a_violation_of_validation_alone_is_not_extended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    simulators = _folder(tmp_path, "simulators")
    (simulators / "box.py").write_text(SIMULATOR, encoding="utf-8")
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(simulators))
    file = tmp_path / "box.json"
    file.write_text(json.dumps(BOX), encoding="utf-8")
    forget_simulators()
    try:
        assert invoke(["run", str(file), "--sample-seed", "1", "--out", str(tmp_path / "first")]) == 1
        extending = ("run", "--continue", tmp_path / "first", "--budget", "120", "--out", tmp_path / "more")
        assert refused(capsys, *extending) == RefusalCode.WOULD_LOSE
        _raise_violations(tmp_path / "first" / "evaluations.npz")
        assert refused(capsys, *extending) == RefusalCode.WOULD_LOSE, "its verdict is known"
    finally:
        forget_simulators()


def _raise_violations(file: Path) -> None:
    """As if only calls that confirm results had violated, which are not stored."""
    with np.load(file) as stored:
        arrays: dict[str, Any] = {
            name: np.where(of <= 1.0, 1.5, of) if "costs" in name else of for name, of in stored.items()
        }
    np.savez(file, **arrays)


@dataclass(frozen=True)
class Ended:
    """A run of a closed loop of which validation alone stored violations."""

    campaign: Campaign
    store: MemoryStore

    def columns(self) -> dict[int, Columns]:
        stored = ((at, self.store.evaluations(at)) for at in range(len(self.store.stages)))
        return {at: columns for at, columns in stored if columns is not None}

    def at(self, kind: str) -> int:
        return [stage.plan.kind for stage in self.store.stages].index(kind)


@pytest.fixture(scope="module")
def polished() -> Ended:
    asked = searching({"method": "direct", "evaluations": 60}, scenario__horizon=4.0, stages__certify={"samples": 60})
    execute(asked, trial := MemoryStore())
    lowest = [float(c.ranked().min()) for at in range(len(trial.stages)) if (c := trial.evaluations(at)) is not None]
    assert lowest[-1] < min(lowest[:-1])
    threshold = 0.5 * (lowest[-1] + min(lowest[:-1]))
    document = asked.document()
    document["criterion"] |= {"threshold": threshold}
    campaign = load_document(document, "the test")
    execute(campaign, store := MemoryStore())
    found = Ended(campaign, store)
    violating = [at for at, columns in found.columns().items() if (columns.ranked() <= threshold).any()]
    assert violating == [found.at("validate")]
    return found


@pytest.mark.nightly
def test_a_stored_run_with_a_violation_of_validation_alone_is_not_extended(
    polished: Ended, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    engine = connect(migrated(tmp_path))
    with engine.begin() as connection:
        submit(connection, polished.campaign, name="", tags=[], owner="ci", planned=most(polished.campaign))
    claim = Queue(engine).claim("a worker")
    assert claim is not None
    store = RunStore(engine, claim)
    store.describe(polished.campaign, catalogue())
    assert execute(polished.campaign, store).verdict == "violated"
    extending = ("run", "--continue", "R-0001", "--budget", "+300", "--data", tmp_path)
    assert refused(capsys, *extending) == RefusalCode.WOULD_LOSE
    with read(engine) as connection:
        assert connection.scalar(sa.select(sa.func.count()).select_from(Run)) == 1
    engine.dispose()


def unchecked(found: Ended, spot: SpotChecks | None = None) -> list[StageRecord]:
    """Its stages, as if the random spot checks had been these, or none."""
    other = {"spot_checks": spot}
    return [replace(s, result=s.result and s.result.model_copy(update=other)) for s in found.store.stages]


def test_a_violation_that_was_found_when_a_result_was_confirmed_is_known(polished: Ended) -> None:
    """As of a simulator that does not repeat, by a call that is not stored."""
    higher = {at: [columns._replace(costs=columns.costs + 1.0)] for at, columns in polished.columns().items()}
    store = MemoryStore(stages=unchecked(polished), chunks=higher, findings=polished.store.findings)
    larger = continued(polished.campaign, Budget(300, more=True))
    with pytest.raises(WouldLose):
        carried(polished.campaign, larger, store)
    with pytest.raises(WouldLose):
        carried(polished.campaign, larger, replace(store, findings=[]), violated=True)
    assert carried(polished.campaign, larger, replace(store, findings=[]))
    spot = SpotChecks(
        checked=1, compared=1, largest=0.0, median=0.0, violating=0, at=None, statement=(),
        lowest_reference=polished.campaign.criterion.threshold,
    )  # fmt: skip
    with pytest.raises(WouldLose):
        carried(polished.campaign, larger, replace(store, findings=[], stages=unchecked(polished, spot)))
    assert carried(polished.campaign, polished.campaign, store)


class Citing(MemoryStore):
    """The store of a run that continues another one, as of a run that waited for its code."""

    def __init__(self, before: Ended, without: str) -> None:
        super().__init__(sample_seed=before.store.sample_seed)
        assert before.store.versions is not None
        known = identity.code(before.campaign).modules
        modules = {name: digest for name, digest in known.items() if name != without}
        self.before = Cited(Begun(before.store.versions, modules), before.store.stages, before.columns(), {})

    def cited(self) -> Cited:  # type: ignore[override]
        return self.before


METHOD = "worker.engine.search.methods.direct"


def test_a_run_that_continues_another_one_waits_for_the_code_that_replays_its_violations(polished: Ended) -> None:
    store = Citing(polished, METHOD)
    with pytest.raises(OtherCode):
        execute(polished.campaign, store)
    assert store.versions is None, "it has not begun"
    assert not store.chunks
    same = Citing(polished, "")
    assert execute(polished.campaign, same).verdict == "violated"
    assert (
        same.before.evaluations[polished.at("validate")].points == same.chunks[polished.at("validate")][0].points
    ).all()


def test_so_does_one_whose_violation_waited_for_an_earlier_evaluation(polished: Ended) -> None:
    at, columns = polished.at("validate"), polished.columns()
    lowest = _rows(columns.pop(at), [int(np.argmin(polished.columns()[at].ranked()))])
    for other, waits in ((METHOD, True), ("", False)):
        store = Citing(polished, other)
        store.before = store.before._replace(evaluations=columns, ahead={at: Ahead(np.array([7]), lowest)})
        if waits:
            with pytest.raises(OtherCode):
                execute(polished.campaign, store)
        else:  # the same code evaluates a closed loop again to the same bits
            assert execute(polished.campaign, store).verdict == "violated"


@pytest.mark.nightly
def test_without_a_violation_it_begins_with_what_is_valid(polished: Ended) -> None:
    document = polished.campaign.document()
    document["criterion"] |= {"threshold": 0.1}
    campaign = load_document(document, "the test")
    execute(campaign, before := MemoryStore())
    store = Citing(Ended(campaign, before), METHOD)
    execute(campaign, store)
    assert store.chunks[0][0].points.tobytes() == before.chunks[0][0].points.tobytes()


def test_what_waits_for_an_earlier_evaluation_counts(polished: Ended) -> None:
    """It is stored, and the new run begins without it, unless it is carried as well."""
    at, validate = polished.at("search"), polished.columns()[polished.at("validate")]
    row = int(np.argmin(validate.ranked()))
    chunks = {position: [columns] for position, columns in polished.columns().items() if position <= at}
    waiting = {at: [Ahead(np.array([1000]), _rows(validate, [row]))]}
    store = MemoryStore(stages=unchecked(polished), chunks=chunks, waiting=waiting)
    larger = continued(polished.campaign, Budget(300, more=True))
    with pytest.raises(WouldLose):
        carried(polished.campaign, larger, store)
    assert at in carried(polished.campaign, larger, store, ahead=True)
    assert at in carried(polished.campaign, larger, replace(store, waiting={}))


def _rows(columns: Columns, rows: list[int]) -> Columns:
    return Columns(columns.points[rows], columns.costs[rows], columns.status[rows], columns.seconds[rows], {})


def columns(*status: int, cost: float = 2.0, reasons: dict[int, str] | None = None) -> Columns:
    """Evaluations with this status, of this cost."""
    m = len(status)
    costs = np.where(np.array(status) == OK, cost, np.nan)[:, None]
    return Columns(np.zeros((m, 1)), costs, np.array(status, dtype=np.uint8), np.zeros(m), reasons or {})


STAGE = StagePlan("validate", None, 9)
FINE, VIOLATES, FAILS = columns(OK), columns(OK, cost=1.0), columns(OK, FAILED)
FLAKES = columns(OK, reasons={0: f"{FLAKY}it diverged"})


@pytest.mark.by_day(4)
@pytest.mark.parametrize(
    ("replayed", "other", "refuses"),
    [
        (FINE, FINE, False), (FINE, columns(EXCLUDED), False), (VIOLATES, FINE, False), (FAILS, FINE, False),
        (FINE, VIOLATES, True), (FAILS, VIOLATES, True), (FLAKES, VIOLATES, True), (VIOLATES, VIOLATES, False),
        (FINE, FAILS, True), (VIOLATES, FAILS, False), (FAILS, FLAKES, False), (FINE, FLAKES, True),
        (FLAKES, FAILS, False), (columns(EXCLUDED), FAILS, True),
    ],
)  # fmt: skip
def test_what_bars_cleared_is_lost_unless_its_like_is_replayed(
    replayed: Columns, other: Columns, refuses: bool
) -> None:
    assert bool(lost(1.0, [replayed], [(STAGE, other)])) == refuses
