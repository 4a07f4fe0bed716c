"""`clearance run --continue`: the new run repeats no evaluation, equals one long run, and cites the old one."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

from backend.db import continuation as stored
from backend.db.engine import connect, default_url, read
from backend.db.queue import LostLease, Queue, submit
from backend.db.store import RunStore
from backend.db.tables import CatalogueSnapshot, Run
from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.refusals import RefusalCode
from campaigns.stages.plan import most, plan
from campaigns.stored.records import StagePlan
from clearance.cli import INTERRUPTED, WRONG_INPUT, invoke
from clearance.local.likelihood import likelihoods
from clearance.local.results import read_folder
from tests.audited import audited
from tests.given.case_campaigns import searching
from tests.given.newer_forms import in_form
from tests.given.refused_commands import refused
from tests.migrated import migrated
from worker.engine.problem.evaluate import InProcess
from worker.engine.systems.base import Floats
from worker.running.catalogue.installed import catalogue
from worker.running.runs.continuation import Budget, CannotContinue, carried, continued, preloaded, same_sample
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

SHORT: dict[str, Any] = {"scenario__horizon": 4.0, "stages__certify": {"samples": 60}}
"""The closest approach comes at 3.1 s."""
SEARCHES = (
    {"method": "direct", "evaluations": 150, "options": {"iterations": 12}},
    {"method": "sqp", "evaluations": 200, "starts": [{"vehicle.m": 4.5, "vehicle.J": 0.05}]},
    {"method": "monte_carlo", "evaluations": 100},
    {"method": "genetic", "evaluations": 120},
)


@pytest.fixture
def flown(monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """Every point that is actually simulated, by its bits."""
    points: list[bytes] = []
    fly = InProcess.__call__

    def counting(self: InProcess, asked: Floats) -> Any:
        points.extend(p.tobytes() for p in asked)
        return fly(self, asked)

    monkeypatch.setattr(InProcess, "__call__", counting)
    return points


def asked() -> Campaign:
    return searching(*SEARCHES, **SHORT)


def written(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    return found


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of a run, in a folder."""
    folder = tmp_path_factory.mktemp("first")
    file = folder / "asked.json"
    file.write_text(json.dumps(asked().document()), encoding="utf-8")
    assert invoke(["run", str(file), "--out", str(folder / "out")]) in (0, 2)
    return folder / "out"


def test_a_budget_is_more_or_a_total() -> None:
    assert Budget.read("+20000").after(1000) == 21_000
    assert Budget.read("20000").after(1000) == 20_000
    assert Budget.read("20000").after(30_000) == 30_000
    for wrong in ("", "+", "-5", "0", "+0", "1e4", "many"):
        with pytest.raises(CannotContinue, match=r"invalid budget .*: give"):
            Budget.read(wrong)


def test_searches_that_can_be_extended_get_more_and_retain_their_options() -> None:
    before, after = asked().stages.search, continued(asked(), Budget(300, more=True)).stages.search
    assert [s.evaluations for s in after] == [450, 200, 400, 420]
    assert after[0].options["iterations"] > 12
    assert after[1] == before[1]


def _sampled(**changes: object) -> Campaign:
    """A campaign with a sample that may end early, and an estimate; changes by the path of a field."""
    asked: dict[str, object] = {"certify": {"samples": 400, "keep": "lowest", "until": "target"}}
    stages = searching(*SEARCHES, **SHORT).document()["stages"] | asked | {"estimate": {"evaluations": 1000}}
    document = searching(*SEARCHES, **SHORT).document() | {"target_probability": 0.01, "stages": stages}
    for path, value in changes.items():
        *parents, last = path.split("__")
        at: Any = document
        for name in parents:
            at = at[name]
        at[last] = value
    return load_document(document, "the test")


@pytest.mark.parametrize(
    "changes",
    [
        {"stages__certify__samples": 500},
        {"stages__certify__quantile": 0.1},
        {"stages__certify__keep": "all", "stages__certify__until": "samples"},
        {"stages__certify__until": "samples"},
        {"stages__estimate__evaluations": 2000},
        {"target_probability": 0.02},
        {"confidence": 0.94},
    ],
)
def test_no_continuation_keeps_the_seed_of_another_sample(changes: dict[str, object]) -> None:
    assert same_sample(_sampled(), continued(_sampled(), Budget(300, more=True)))
    assert not same_sample(_sampled(), _sampled(**changes))


@pytest.mark.nightly
def test_an_estimate_begins_again_at_the_violations_of_the_larger_searches() -> None:
    document = searching({"method": "monte_carlo", "evaluations": 60}, **SHORT).document()
    document["stages"] |= {"certify": None, "estimate": {"evaluations": 1000}}
    document["criterion"] |= {"threshold": 0.95}
    campaign, before = load_document(document, "the test"), MemoryStore()
    execute(campaign, before)
    larger = continued(campaign, Budget(60, more=True))
    after = preloaded(larger, carried(campaign, larger, before), before.sample_seed)
    execute(larger, after)
    assert [s.plan.kind for s in after.stages if s.state == "done"][-1] == "validate"
    at = [s.plan.kind for s in before.stages].index("estimate")
    assert before.evaluations(at) is not None
    assert at not in carried(campaign, larger, before)


@pytest.mark.nightly
def test_a_folder_is_extended_without_repeating_an_evaluation(
    first: Path, tmp_path: Path, flown: list[bytes], capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert invoke(["run", "--continue", str(first), "--budget", "+300", "--out", str(out)]) in (0, 2)
    new, old = written(out), written(first)
    assert new["continues"] == {"run": str(first), "digest": old["digest"]}
    assert new["digest"] != old["digest"]
    assert f"Extends {first}" in capsys.readouterr().out
    stages, before = read_folder(out)[1], read_folder(first)[1]
    kept = fresh = 0
    for position, record in enumerate(stages.stages[:-1]):
        longer, shorter = stages.evaluations(position), before.evaluations(position)
        assert longer is not None
        assert shorter is not None
        count = len(shorter.status)
        assert np.array_equal(longer.points[:count], shorter.points)
        assert np.array_equal(longer.costs[:count], shorter.costs, equal_nan=True)
        kept, fresh = kept + count, fresh + len(longer.status) - count
        extended = record.plan.method in ("direct", "monte_carlo", "genetic")
        assert (len(longer.status) > count) == extended, record.plan
    assert kept > 300
    validated = stages.evaluations(len(stages.stages) - 1)
    assert validated is not None
    assert len(flown) == fresh + len(validated.status)


def test_it_equals_one_long_run(first: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    invoke(["run", "--continue", str(first), "--budget", "+300", "--out", str(out)])
    campaign, went_on = read_folder(out)
    at_once = MemoryStore(sample_seed=went_on.sample_seed)
    execute(campaign, at_once)
    for position in range(len(at_once.stages)):
        one, other = at_once.evaluations(position), went_on.evaluations(position)
        assert one is not None
        assert other is not None
        assert np.array_equal(one.points, other.points)
        assert np.array_equal(one.costs, other.costs, equal_nan=True)
    likely = likelihoods(campaign, at_once, "m")
    stated = [likely.stated(f).model_dump(mode="json") | {"granted": f.granted} for f in at_once.findings]
    assert stated == written(out)["findings"]


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["--continue", "nowhere", "--budget", "+10"], "it contains no campaign.json"),
        (["--continue", "nowhere"], "belong together"),
        (["unicycle_static", "--budget", "+10"], "belong together"),
        (["unicycle_static", "--continue", "R-0001", "--budget", "+10"], "not both"),
        ([], "give a campaign file"),
    ],
)
def test_an_impossible_extension_is_refused(arguments: list[str], why: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", *arguments]) == WRONG_INPUT
    assert why in capsys.readouterr().err


def test_extending_a_run_without_an_extendable_search_names_the_methods_that_can(
    capsys: pytest.CaptureFixture[str],
) -> None:
    only = searching(SEARCHES[1], **SHORT)
    with pytest.raises(CannotContinue, match=r"SQP multistart.*can be extended: .*DIRECT"):
        continued(only, Budget(10, more=True))


def test_another_plan_is_refused() -> None:
    store = MemoryStore()
    store.plan(plan(asked())[:-1])
    with pytest.raises(CannotContinue) as refusal:
        carried(asked(), continued(asked(), Budget(10, more=True)), store)
    assert refusal.value.code == RefusalCode.OTHER_PLAN


def test_a_run_that_ended_before_its_first_stage_has_nothing_to_continue() -> None:
    with pytest.raises(CannotContinue, match="first stage"):
        carried(asked(), continued(asked(), Budget(10, more=True)), MemoryStore())


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a database of one finished run."""
    folder = tmp_path_factory.mktemp("finished")
    engine = connect(migrated(folder))
    with engine.begin() as connection:
        submit(connection, asked(), name="nightly", tags=["a"], owner="ci", planned=most(asked()))
    claim = Queue(engine).claim("a worker")
    assert claim is not None
    store = RunStore(engine, claim)
    store.describe(asked(), catalogue())
    execute(asked(), store)
    audited(engine)
    engine.dispose()
    return folder


@pytest.fixture
def data(finished: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return shutil.copytree(finished, tmp_path / "data")


@pytest.mark.by_day(1)
@pytest.mark.parametrize("words", [["run", "--continue", "R-0001", "--budget", "+9"], ["replay", "R-0001"]])
def test_of_a_purged_run_it_is_said_that_it_was_purged(
    words: list[str], data: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    engine = connect(default_url(data))
    with engine.begin() as connection:
        connection.execute(sa.update(Run).values(removed=1.0, purged=2.0))
    engine.dispose()
    assert invoke([*words, "--data", str(data)]) == WRONG_INPUT
    assert "was purged" in capsys.readouterr().err


@pytest.mark.nightly
def test_a_stored_run_is_extended_as_a_new_stored_run(
    data: Path, flown: list[bytes], capsys: pytest.CaptureFixture[str]
) -> None:
    flown.clear()
    assert invoke(["run", "--continue", "R-0001", "--budget", "+300", "--data", str(data)]) in (0, 2)
    assert "R-0002 extends R-0001" in capsys.readouterr().out
    engine = connect(default_url(data))
    with read(engine) as connection:
        old, new = (stored.evaluations(connection, run_id) for run_id in (1, 2))
        row = connection.exec_driver_sql(
            "select state, continues, name, owner, evaluations, verdict from runs where id = 2"
        ).one()
    assert row[:4] == ("done", 1, "nightly", "ci")
    assert row.evaluations == sum(len(c.status) for c in new.values())
    assert row.verdict in ("cleared", "inconclusive")
    audited(engine, run_id=2)
    stages = len(plan(asked()))
    for position in range(stages - 1):
        count = len(old[position].status)
        assert np.array_equal(new[position].points[:count], old[position].points)
    added = sum(len(new[p].status) - len(old[p].status) for p in range(stages - 1))
    assert added > 300
    assert len(flown) == added + len(new[stages - 1].status)
    engine.dispose()


def test_no_run_is_stored_whose_results_have_no_place(
    first: Path, data: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = written(first)
    command = ("run", "--continue", "R-0001", "--budget", "+10", "--data", data, "--out", first)
    assert refused(capsys, *command) == RefusalCode.OTHER_CAMPAIGN
    assert written(first) == before
    engine = connect(default_url(data))
    with read(engine) as connection:
        assert connection.scalar(sa.select(sa.func.count()).select_from(Run)) == 1
    engine.dispose()


def test_an_interrupt_states_what_is_stored(
    first: Path, data: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fly, calls = InProcess.__call__, 0

    def interrupted(self: InProcess, asked: Floats) -> Any:
        nonlocal calls
        calls += 1
        if calls > 1:
            raise KeyboardInterrupt
        return fly(self, asked)

    monkeypatch.setattr(InProcess, "__call__", interrupted)
    assert invoke(["run", "--continue", str(first), "--budget", "+300"]) == INTERRUPTED
    told = capsys.readouterr().err
    done = int(told.partition("interrupted: ")[2].split()[0])
    assert 0 < done < 300, "those of the earlier run are in its folder"
    calls = 0
    assert invoke(["run", "--continue", "R-0001", "--budget", "+300", "--data", str(data)]) == INTERRUPTED
    assert "interrupted: R-0002 " in capsys.readouterr().err
    engine = connect(default_url(data))
    with read(engine) as connection:
        found = connection.execute(sa.select(Run.state, Run.evaluations).where(Run.id == 2)).one()
    engine.dispose()
    assert found.state == "queued"
    assert found.evaluations > 0


def test_a_run_of_other_code_is_not_extended(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    engine = connect(default_url(data))
    with read(engine) as connection:
        flown = connection.execute(sa.select(Run.flown)).scalar_one()
    assert flown["code"]
    for change, statement in (
        ({"loop": "f" * 16}, "it was begun by other code: the loop digest was ffffffffffff, here it is "),
        ({"code": "e" * 64}, f"the code digest was eeeeeeeeeeee, here it is {flown['code'][:12]}"),
        ({"packages": {"numpy": "1.0"}}, "numpy was 1.0, here it is "),
    ):
        with engine.begin() as connection:
            connection.execute(sa.update(Run).values(flown=flown | change))
        assert invoke(["run", "--continue", "R-0001", "--budget", "+10", "--data", str(data)]) == WRONG_INPUT
        assert statement in capsys.readouterr().err
    with read(engine) as connection:
        assert connection.scalar(sa.select(sa.func.count()).select_from(Run)) == 1
    engine.dispose()


def test_a_run_that_a_newer_version_describes_in_another_form_is_not_extended(
    data: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    engine = connect(default_url(data))
    newer = in_form(catalogue().model_dump(mode="json"), "one more field")
    with engine.begin() as connection:
        connection.execute(sa.insert(CatalogueSnapshot).values(digest="newer", document=newer, created=0.0))
        connection.execute(sa.update(Run).values(snapshot="newer"))
    engine.dispose()
    code = refused(capsys, "run", "--continue", "R-0001", "--budget", "+10", "--data", data)
    assert code == RefusalCode.OTHER_COMPONENTS


def test_a_folder_of_other_code_is_not_extended(
    first: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "flown"
    shutil.copytree(first, folder)
    result = written(folder)
    assert result["versions"]["code"]
    result["versions"]["code"] = "e" * 64
    (folder / "result.json").write_text(json.dumps(result), encoding="utf-8")
    assert extended(folder, capsys) == RefusalCode.OTHER_CODE


@pytest.fixture
def folder(first: Path, tmp_path: Path) -> Path:
    """A copy of the results, to be changed."""
    return shutil.copytree(first, tmp_path / "copy")


def extended(folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Why a folder is not extended."""
    return refused(capsys, "run", "--continue", folder, "--budget", "+10")


def bounds(campaign: dict[str, Any]) -> None:
    campaign["uncertain"]["vehicle.m"] = {"low": 2.0, "high": 8.0}


@pytest.mark.parametrize(
    "change",
    [
        bounds,
        lambda campaign: campaign["criterion"].update(threshold=0.6),
        lambda campaign: campaign["scenario"].update(horizon=14.0),
        lambda campaign: campaign.update(seed=7),
    ],
    ids=["bounds", "threshold", "horizon", "seed"],
)
def test_a_folder_whose_campaign_was_changed_is_not_extended(
    folder: Path, change: Callable[[dict[str, Any]], None], capsys: pytest.CaptureFixture[str]
) -> None:
    """Its evaluations would be points that were never simulated."""
    campaign = json.loads((folder / "campaign.json").read_text(encoding="utf-8"))
    change(campaign)
    (folder / "campaign.json").write_text(json.dumps(campaign), encoding="utf-8")
    assert extended(folder, capsys) == RefusalCode.OTHER_CAMPAIGN


def test_a_folder_of_other_components_is_not_extended(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    evidence = json.loads((folder / "evidence.json").read_text(encoding="utf-8"))
    vehicle = next(c for c in evidence["components"]["components"] if c["role"] == "vehicle")
    vehicle["parameters"][0]["unit"] = "t"
    (folder / "evidence.json").write_text(json.dumps(evidence), encoding="utf-8")
    assert extended(folder, capsys) == RefusalCode.OTHER_COMPONENTS


@pytest.mark.parametrize("file", ["result.json", "evidence.json"])
def test_a_folder_with_unreadable_results_is_not_extended(
    folder: Path, file: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / file).write_text("{", encoding="utf-8")
    assert extended(folder, capsys) == RefusalCode.UNREADABLE


def test_a_folder_without_results_is_not_extended(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "result.json").unlink()
    assert extended(folder, capsys) == RefusalCode.NO_RUN


def test_only_a_run_that_has_ended_can_be_extended(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    engine = connect(default_url(data))
    with engine.begin() as connection:
        submit(connection, asked(), name="waiting", tags=[], owner="", planned=1)
    engine.dispose()
    for run, why in (("R-0002", "it is queued"), ("R-0099", "there is no such run")):
        assert invoke(["run", "--continue", run, "--budget", "+10", "--data", str(data)]) == WRONG_INPUT
        assert why in capsys.readouterr().err


@pytest.mark.nightly
def test_any_worker_resumes_it_when_this_process_is_gone(data: Path) -> None:
    engine = connect(default_url(data))
    with read(engine) as connection:
        columns = stored.evaluations(connection, 1)
    onward = continued(asked(), Budget(50, more=True))
    planned = [StagePlan(*p) for p in plan(onward)]
    kept = {at: c for at, c in columns.items() if at < len(planned) - 1}
    with engine.begin() as connection:
        mine = stored.begin(connection, 1, onward, planned, kept, worker="gone", lease=-1.0)
    claim = Queue(engine).claim("another worker")
    assert claim is not None
    assert (claim.run_id, claim.fence) == (mine.run_id, mine.fence + 1)
    conclusion = execute(Campaign.model_validate(claim.document), RunStore(engine, claim))
    assert conclusion.verdict in ("cleared", "inconclusive")
    with pytest.raises(LostLease):
        RunStore(engine, mine).begin(0)
    engine.dispose()


def test_a_database_that_is_not_there_is_not_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nowhere = tmp_path / "nowhere"
    options = ("--budget", "+10", "--data", nowhere)
    assert refused(capsys, "run", "--continue", "R-0001", *options) == RefusalCode.NO_DATABASE
    assert not nowhere.exists()


@pytest.mark.nightly
def test_evaluations_that_are_not_what_the_search_asks_for_are_refused(
    first: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "changed"
    shutil.copytree(first, folder)
    with np.load(folder / "evaluations.npz") as held:
        arrays = dict(held)
    arrays["points_2"][5] += 0.01
    np.savez(folder / "evaluations.npz", **arrays)
    assert extended(folder, capsys) == RefusalCode.OTHER_POINTS
