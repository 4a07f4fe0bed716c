"""Forged comparisons with a baseline, of which every digest was computed again: each is rejected, or documented."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.db import baselines
from backend.db.digest import EVIDENCE, current_digest
from backend.db.engine import connect, default_url
from backend.db.queue import submit
from backend.db.tables import Finding, Run, RunBaseline
from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.claims import wording
from campaigns.claims.spans import words
from campaigns.results.baselines import with_baseline
from campaigns.results.regression import Standing
from tests.audited import audited, recorded
from tests.given.at_night import nightly_but
from tests.given.corrupted_records import Folder, called, enter, ran, since, stored, written
from tests.given.forgeries import accepted, changed, leaves, trusted
from tests.migrated import migrated
from tests.simulators.adversaries import adversary
from worker.engine.stages.parts import offered
from worker.evidence.audit import limits, record
from worker.evidence.audit.judge import audit, closing
from worker.evidence.audit.record import UnreadableError, of_database
from worker.evidence.audit.sentences import SPANS
from worker.running.runs.audited import known
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

STAGE = 1
"""The position of the stage that evaluates the cases of the baseline."""
EVERY = 24
"""By day one of so many values is changed."""


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(written(tmp_path / "out", "since"))


@pytest.mark.nightly
@pytest.mark.parametrize("first", nightly_but((0,), range(EVERY)))
def test_no_value_of_the_comparison_is_free(first: int, tmp_path: Path) -> None:
    path = written(tmp_path / "out", "since")
    original = {file.name: file.read_bytes() for file in path.iterdir()}
    parts = [("result", at) for at in leaves(Folder(path).result) if at[0] == "regression"]
    parts += [("evidence", at) for at in leaves(Folder(path).evidence) if at[:2] == ("results", STAGE)]
    assert len(parts) > 100
    for part, at in parts[first::EVERY]:
        for file, content in original.items():
            (path / file).write_bytes(content)
        folder = Folder(path)
        place = changed(folder, part, at)
        assert not accepted(folder) or trusted(place), f"{place}: {at}"


def told(folder: Folder, old: str, new: str) -> None:
    """Other words in the sentence of the stage."""
    stage = folder.evidence["results"][STAGE]
    for span in stage["statement"]:
        if span["kind"] == "text":
            span["text"] = span["text"].replace(old, new)
    stage["text"] = words(SPANS.validate_python(stage["statement"]))


def row(folder: Folder, label: str) -> Any:
    return next(case for case in folder.result["regression"]["cases"] if case["before"] == label)


def repeat(folder: Folder) -> None:
    cases = folder.result["regression"]["cases"]
    cases.append(dict(cases[0]))


def spare(folder: Folder) -> None:
    """The case that is worse, as one that this campaign cannot have, with its evaluation taken out."""
    stage = folder.evidence["results"][STAGE]["cases"]
    index = stage[1]["index"]
    stage[1] |= {"index": None, "cost": None, "status": None, "point": [], "reason": "it is outside the bounds here"}
    row(folder, "F2").update(standing="not compared", evaluation=None, margin=None, margin_again=None)
    for name in ("points", "costs", "status", "seconds"):
        folder.shorten(STAGE) if name == "points" and index == 1 else None


def nowhere(folder: Folder) -> None:
    """A lowest cost of a basin that no evaluation has."""
    validated = folder.evidence["results"][-1]
    validated["since"][1] = None
    validated["basins"][1] = {"lowest": 0.9421, "parameters": {"vehicle.m": 5.0, "vehicle.J": 0.05}, "not_compared": 0}


def no_violation(folder: Folder) -> None:
    """A stored violation beyond no barrier that is none."""
    folder.evidence["results"][-1]["basins"][1]["violation"] = {"position": 0, "index": 0, "cost": 0.9}


def unnamed(folder: Folder) -> None:
    row(folder, "F2")["before"] = "F9"


FORGED: dict[str, Callable[[Folder], None]] = {
    "a row twice": repeat,
    "a case that was not evaluated although it can be": spare,
    "a lowest cost that nobody evaluated": nowhere,
    "a violation that is none": no_violation,
    "a case that the baseline does not have": unnamed,
    "another run in the sentence": lambda folder: told(folder, "R-0042", "R-0001"),
    "another run in the note": lambda folder: folder.result.update(baseline="Baseline: R-0007."),
}


@pytest.mark.parametrize("name", FORGED)
def test_a_forged_comparison_is_rejected(name: str, folder: Folder) -> None:
    FORGED[name](folder)
    assert not accepted(folder)


def elsewhere(path: str) -> Callable[[Folder], None]:
    """The evaluation of the second case as if it was made at another value, which its row states."""

    def change(folder: Folder) -> None:
        case, row = folder.evidence["results"][STAGE]["cases"][1], list(folder.campaign["uncertain"]).index(path)
        folder.arrays[f"points_{STAGE}"][case["index"], row] += 1e-6
        case["point"][row] += 1e-6

    return change


def withdrawn(folder: Folder) -> None:
    """The evaluation of the first case, which violates: its row names that of the second case."""
    for name in ("points", "costs", "status", "seconds"):
        folder.arrays[f"{name}_{STAGE}"] = folder.arrays[f"{name}_{STAGE}"][1:]
    first, second = folder.evidence["results"][STAGE]["cases"][:2]
    second["index"] = 0
    first.update({name: value for name, value in second.items() if name != "label"})


def no_longer_varied(folder: Folder) -> None:
    """A value of a case of which this campaign has another one and does not vary it."""
    folder.campaign["baseline"]["cases"][1]["parameters"]["avoider.d_0"] = 1.0


@pytest.mark.parametrize("forged", [elsewhere("vehicle.J"), withdrawn, no_longer_varied])
def test_a_case_is_evaluated_where_the_baseline_found_it(forged: Callable[[Folder], None], folder: Folder) -> None:
    forged(folder)
    folder.reseal()
    accepted, sentence = closing(folder.items())
    assert not accepted
    assert "points.stage 1" in sentence


def test_the_comparison_itself_is_accepted(folder: Folder) -> None:
    standings = {case["before"]: case["standing"] for case in folder.result["regression"]["cases"]}
    assert standings.keys() == {"F1", "F2", "F3"}
    assert standings["F3"] == Standing.NOT_COMPARED
    folder.result["baseline"] = "Baseline: R-0042, the newest run with the label branch=main."
    assert accepted(folder)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of that database, which the first test writes."""
    return tmp_path_factory.mktemp("compared") / "written"


@pytest.fixture
def compared(quick: None, kept: Path, tmp_path: Path) -> Iterator[sa.Engine]:
    """A database with a run, and one that was launched with it as its baseline."""
    if not kept.exists():
        kept.mkdir()
        engine = stored(kept, "violated")
        campaign, earlier = ran("violated")
        later, store = with_baseline(campaign, "R-0001", campaign, earlier.findings), MemoryStore()
        execute(later, store, threads=1)
        enter(engine, later, store, baseline=1)
        engine.dispose()
    engine = connect(default_url(shutil.copytree(kept, tmp_path / "copied")))
    yield engine
    engine.dispose()


def follows(database: sa.Engine) -> bool:
    with database.begin() as writer:
        summary = writer.scalar(sa.select(Run.summary).where(Run.id == 2))
        summary["provenance"][EVIDENCE] = current_digest(writer, 2)
        writer.execute(sa.update(Run).where(Run.id == 2).values(summary=summary))
    found = recorded(database, run_id=2)
    return closing(audit(found, known(found), offered.AT_MOST, offered.SPOT_CHECKS))[0]


CHANGES: dict[str, Callable[[sa.Connection], object]] = {
    "another cost of a finding": lambda w: w.execute(sa.update(Finding).where(Finding.run_id == 1).values(cost=0.9)),
    "another threshold": lambda w: w.execute(sa.update(Run).where(Run.id == 1).values(threshold=0.9)),
    "no baseline": lambda w: w.execute(sa.update(RunBaseline).values(baseline=2)),
}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", CHANGES)
def test_the_baseline_of_a_database_is_its_run(name: str, compared: sa.Engine) -> None:
    assert follows(compared)
    with compared.begin() as writer:
        CHANGES[name](writer)
    assert not follows(compared)


def test_a_baseline_whose_results_were_deleted_is_not_compared(compared: sa.Engine) -> None:
    with compared.begin() as writer:
        writer.execute(sa.delete(Finding).where(Finding.run_id == 1))
    assert follows(compared)


def test_a_state_that_no_run_has_is_refused(compared: sa.Engine) -> None:
    with compared.begin() as writer:
        writer.execute(sa.text("UPDATE runs SET state = 'asleep' WHERE id = 2"))
    with pytest.raises(UnreadableError, match="R-0002"), compared.connect() as reader:
        of_database(reader, 2)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("there", [0.9, 0.96])
def test_of_another_threshold_the_comparison_is_accepted(there: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also once later versions have other sentences."""
    campaign, store = since(there=there), MemoryStore()
    execute(campaign, store, threads=1)
    audited(store, campaign)
    monkeypatch.setattr(wording, "WORDING", wording.WORDING + 1)
    audited(store, campaign, lacks={"words"})


def of_a_simulator(folder: Path) -> tuple[sa.Engine, Campaign]:
    """A database with a run of a simulator that does not repeat, and one that was launched with it as its baseline."""
    engine, (campaign, earlier) = connect(migrated(folder)), called("violated")
    with adversary():
        enter(engine, campaign, earlier)
        later = with_baseline(campaign, "R-0001", campaign, earlier.findings)
        with engine.begin() as writer:
            baselines.store(writer, submit(writer, later, name="b", tags=[], owner="", planned=1), "R-0001", 1)
    return engine, later


def earlier_version(baseline: Any) -> None:
    baseline["repeats"] = None
    for case in baseline["cases"]:
        case["calls"] = None


def more_calls(baseline: Any) -> None:
    baseline["cases"][0]["calls"]["made"] += 1


STATED: dict[str, tuple[Callable[[Any], object], set[str]]] = {
    "as it is": (lambda baseline: None, set()),
    "of an earlier version": (earlier_version, set()),
    "fewer calls": (lambda baseline: baseline["repeats"].update(count=1), {"baseline.repeats"}),
    "otherwise combined": (
        lambda baseline: baseline["repeats"].update(combine="quantile", quantile=0.5),
        {"baseline.repeats"},
    ),
    "more independent calls": (more_calls, {"baseline.calls"}),
}


def test_the_calls_of_a_baseline_are_those_of_its_run(tmp_path: Path) -> None:
    """A baseline that an earlier version wrote states none: its findings are not compared."""
    engine, later = of_a_simulator(tmp_path)
    with engine.connect() as reader:
        tables = sa.MetaData()

        def rows(table: str, order: str, **of: Any) -> list[Any]:
            found = sa.select(sa.Table(table, tables, autoload_with=reader)).filter_by(**of).order_by(sa.column(order))
            return [dict(row) for row in reader.execute(found).mappings()]

        for name, (change, wrong) in STATED.items():
            document = later.document()
            change(document["baseline"])
            stated = record._launched(reader, rows, 2, load_document(document), limits.EACH)
            assert {key for key, (then, now) in stated.items() if then != now} == wrong, name
    engine.dispose()
