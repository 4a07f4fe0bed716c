"""Forged rows of a database, with the evidence digest computed again: the audit rejects each or documents its trust."""

from __future__ import annotations

import copy
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import sqlalchemy as sa

from backend.db.digest import EVIDENCE, _parts, current_digest
from backend.db.engine import connect, default_url
from backend.db.repeats import repeat_digest
from backend.db.tables import CampaignRow, EvaluationChunk, Finding, Run, Stage
from campaigns import CampaignError
from tests.audited import recorded
from tests.given.at_night import nightly_but
from tests.given.corrupted_records import CERTIFY, stored
from worker.engine.stages.parts import offered
from worker.evidence.audit.judge import audit, closing
from worker.evidence.audit.record import UnreadableError
from worker.evidence.audit.trusted import TRUSTED
from worker.running.runs.audited import known

SEARCH = 2
"""The position of the first search."""
VALIDATE = 5
"""That of validation."""
Change = Callable[[sa.Connection], object]


class Forgery(NamedTuple):
    """Changed rows; trusted: the path of what is taken as given, if it is accepted."""

    change: Change
    trusted: str = ""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of the database, which the first test writes."""
    return tmp_path_factory.mktemp("forged") / "written"


@pytest.fixture
def database(quick: None, folder: Path, tmp_path: Path) -> Iterator[sa.Engine]:
    if not folder.exists():
        folder.mkdir()
        stored(folder, "cleared").dispose()
    engine = connect(default_url(shutil.copytree(folder, tmp_path / "copied")))
    yield engine
    engine.dispose()


def of_run(**values: Any) -> Change:
    return lambda writer: writer.execute(sa.update(Run).values(**values))


def of_stage(**values: Any) -> Change:
    return lambda writer: writer.execute(sa.update(Stage).where(Stage.position == SEARCH).values(**values))


def documents(table: Any, column: str, edit: Callable[[Any], object], *of: Any) -> Change:
    """An edit of a JSON column."""

    def change(writer: sa.Connection) -> None:
        before = writer.scalars(sa.select(getattr(table, column)).where(*of)).one()
        after = copy.deepcopy(before)
        edit(after)
        assert after != before
        writer.execute(sa.update(table).where(*of).values({column: after}))

    return change


def result(position: int, edit: Callable[[Any], object]) -> Change:
    return documents(Stage, "result", edit, Stage.position == position)


def summary(edit: Callable[[Any], object]) -> Change:
    return documents(Run, "summary", edit)


def row(position: int, column: str, kind: str, edit: Callable[[Any], object]) -> Change:
    """An edit of the numbers of the first chunk of a stage."""

    def change(writer: sa.Connection) -> None:
        of = (EvaluationChunk.position == position, EvaluationChunk.first == 0)
        data = writer.scalars(sa.select(getattr(EvaluationChunk, column)).where(*of)).one()
        numbers = np.frombuffer(data, dtype=kind).copy()
        edit(numbers)
        writer.execute(sa.update(EvaluationChunk).where(*of).values({column: numbers.tobytes()}))

    return change


def each(*changes: Change) -> Change:
    return lambda writer: [change(writer) for change in changes]


FORGERIES: dict[str, Forgery] = {
    "another seed of the launch": Forgery(of_run(sample_seed=7)),
    "a seed that was stated": Forgery(of_run(sample_seed_stated=True)),
    "another seed of the sample": Forgery(result(CERTIFY, lambda r: r.update(seed=7))),
    "another seed of both": Forgery(each(of_run(sample_seed=7), result(CERTIFY, lambda r: r.update(seed=7)))),
    "a draw moved": Forgery(row(CERTIFY, "points", "<f8", lambda x: x.__setitem__(0, 0.5))),
    "a draw stored twice": Forgery(row(CERTIFY, "points", "<f8", lambda x: x.__setitem__(slice(0, 2), x[2:4]))),
    "a draw excluded": Forgery(row(CERTIFY, "status", "u1", lambda x: x.__setitem__(0, 3))),
    "the nominal case moved": Forgery(row(0, "points", "<f8", lambda x: x.__setitem__(0, 0.51))),
    "a violation stored": Forgery(row(SEARCH, "costs", "<f8", lambda x: x.__setitem__(3, 0.0))),
    "a cost that decides nothing": Forgery(
        row(SEARCH, "costs", "<f8", lambda x: x.__setitem__(int(np.argsort(x)[len(x) // 2]), np.median(x) + 1e-3)),
        "arrays.costs",
    ),
    "a smaller bound of the sample": Forgery(result(CERTIFY, lambda r: r["sample"].update(upper_bound=1e-4))),
    "more samples": Forgery(result(CERTIFY, lambda r: r["sample"].update(samples=3000))),
    "the code of another check": Forgery(summary(lambda s: s["checks"][0].update(code="agreement"))),
    "no quantity": Forgery(summary(lambda s: s.pop("quantity"))),
    "another worst cost": Forgery(of_run(worst_cost=2.0)),
    "another nominal cost": Forgery(of_run(nominal_cost=2.0)),
    "another bound": Forgery(of_run(upper_bound=1e-4)),
    "another count": Forgery(of_run(evaluations=10**6)),
    "another threshold of the run": Forgery(of_run(threshold=0.1)),
    "another verdict": Forgery(of_run(verdict="violated")),
    "a bolder sentence": Forgery(
        summary(lambda s: s["statement"].append({"kind": "text", "text": " No worse case exists."}))
    ),
    "a check left out": Forgery(summary(lambda s: s["checks"].pop())),
    "a check that holds": Forgery(summary(lambda s: s["checks"][0].update(ok=False))),
    "a wider scope": Forgery(summary(lambda s: s["holds_for"].append({"kind": "text", "text": " and all others"}))),
    "other code in the verdict": Forgery(summary(lambda s: s["provenance"].update(code="0" * 64))),
    "another unit": Forgery(summary(lambda s: s.update(unit="km"))),
    "a finding that costs more": Forgery(lambda writer: writer.execute(sa.update(Finding).values(cost=5.0))),
    "a finding elsewhere": Forgery(
        documents(Finding, "parameters", lambda p: p.update({"vehicle.m": 4.2}), Finding.label == "F1")
    ),
    "a stage that lost its result": Forgery(
        lambda writer: writer.execute(sa.update(Stage).where(Stage.position == CERTIFY).values(result=sa.null()))
    ),
    "wider bounds in the campaign": Forgery(
        documents(CampaignRow, "document", lambda d: d["uncertain"]["vehicle.m"].update(plus_minus="40%"))
    ),
    "another threshold in the campaign": Forgery(
        documents(CampaignRow, "document", lambda d: d["criterion"].update(threshold=0.1))
    ),
    "another bound of the run": Forgery(of_run(planned=1)),
    "another bound of a stage": Forgery(of_stage(planned=5)),
    "another best evaluation": Forgery(of_stage(best_index=5)),
    "a run that failed": Forgery(of_run(state="failed", error="it failed")),
    "no seed of the launch": Forgery(of_run(sample_seed=None)),
    "a larger allowance": Forgery(result(VALIDATE, lambda r: r["spent"].update(at_most=10**6))),
    "flights beyond the horizon": Forgery(result(VALIDATE, lambda r: r["encounter"]["beyond"].update(flights=10**6))),
    "no finding": Forgery(lambda writer: writer.execute(sa.delete(Finding))),
    "a shorter history": Forgery(of_run(best_so_far=[[1, 0.1]]), "run.best_so_far"),
    "other code of the run, too": Forgery(
        each(
            documents(Run, "flown", lambda v: v.update(code="0" * 64)),
            summary(lambda s: s["provenance"].update(code="0" * 64)),
        ),
        "versions",
    ),
    "a value of an unknown name": Forgery(summary(lambda s: s.update(proved=True)), "unknown name"),
    "another question": Forgery(of_run(question="0" * 64)),
}


UNCOVERED = {"run_id", "position", "seconds", "started", "finished"}
"""Which stage a row is, and times."""
NUMBERS = [c.name for c in Stage.__table__.c if c.type.python_type in (int, float) and c.name not in UNCOVERED]


@pytest.mark.by_day(3)
@pytest.mark.parametrize("name", NUMBERS)
def test_no_number_of_a_stage_is_free(name: str, database: sa.Engine) -> None:
    """A change of it changes the digests, and is rejected by the audit though they were computed again."""

    def digests() -> set[str]:
        return {current_digest(writer, 1), repeat_digest(writer, 1)}

    with database.begin() as writer:
        before = digests()
        of_stage(**{name: getattr(Stage, name) + 3})(writer)
        assert len(before | digests()) == 4 - (name == "planned"), "a plan is none of the results"
        seal(writer)
    assert not accepted(database)


def test_the_digest_of_a_counted_sample_covers_its_counts_and_is_as_before(database: sa.Engine) -> None:
    of = sa.update(Stage).where(Stage.position == CERTIFY)
    with database.begin() as writer:
        stage = writer.execute(sa.select(Stage.evaluations, Stage.result).where(Stage.position == CERTIFY)).one()
        blocks = {"draws": [stage.evaluations, 5], "violations": [0, 2]}
        writer.execute(of.values(result={**(stage.result or {}), "blocks": blocks}, counted=5, violations=2))
        assert "counted" not in _parts(writer, 1)
        before = current_digest(writer, 1)
        for name in ("counted", "violations"):
            writer.execute(of.values({name: getattr(Stage, name) + 1}))
            assert current_digest(writer, 1) != before
            writer.execute(of.values({name: getattr(Stage, name) - 1}))
        assert current_digest(writer, 1) == before


def seal(writer: sa.Connection) -> None:
    """Compute the evidence digest again, as whoever can write the database can."""
    verdict = copy.deepcopy(writer.scalars(sa.select(Run.summary)).one())
    verdict["provenance"][EVIDENCE] = current_digest(writer, 1)
    writer.execute(sa.update(Run).values(summary=verdict))


def accepted(engine: sa.Engine) -> bool:
    try:
        record = recorded(engine)
        return closing(audit(record, known(record), offered.AT_MOST, offered.SPOT_CHECKS))[0]
    except (UnreadableError, CampaignError, ValueError):
        return False


def test_what_is_not_forged_is_accepted(database: sa.Engine) -> None:
    with database.begin() as writer:
        seal(writer)
    assert accepted(database)


FURTHER = {
    *("another seed of the launch", "another seed of the sample", "a draw excluded", "the nominal case moved"),
    *("another nominal cost", "another count", "a check that holds", "another unit", "a finding elsewhere"),
    *("more samples", "another bound of a stage", "no seed of the launch", "no quantity", "flights beyond the horizon"),
}
"""Of a kind of which others are changed by day."""


@pytest.mark.by_day(10)
@pytest.mark.parametrize("forgery", nightly_but(FORGERIES.keys() - FURTHER, FORGERIES))
def test_a_forged_database_is_rejected_or_documented(forgery: str, database: sa.Engine) -> None:
    change, trusted = FORGERIES[forgery]
    with database.begin() as writer:
        change(writer)
        seal(writer)
    assert accepted(database) == bool(trusted)
    assert not trusted or any(re.search(pattern, trusted) for one in TRUSTED for pattern in one.paths)
