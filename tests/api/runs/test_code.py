"""The code version of a run: stored at its start, compared when another worker resumes it, shown with the run."""

from __future__ import annotations

from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa
from alembic import command

from backend.db import workers
from backend.db.engine import connect, default_url, migrate, migration_lock, read
from backend.db.migrate import config
from backend.db.queue import Queue
from backend.db.store import RunStore
from backend.db.tables import CatalogueDocument, Run
from backend.reports.service import UNRECORDED
from campaigns import Catalogue
from campaigns.identity.identity import differences, identity_of
from campaigns.versions import UNDIGESTED, Code, OtherCode, Versions
from tests.given.code_versions import CODE, IDENTITY, OTHER, OTHER_IDENTITY, VERSIONS, edited
from tests.given.finished_runs import search
from tests.given.reported_runs import PLAN, finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE
from tests.given.submissions import altered, submit


def claimed(service: Service) -> RunStore:
    claim = Queue(service.engine).claim("w")
    assert claim is not None
    store = RunStore(service.engine, claim)
    store.plan(PLAN)
    return store


def taken_over(service: Service, store: RunStore) -> RunStore:
    Queue(service.engine).give_back(store.claim)
    return claimed(service)


def versions(service: Service) -> Versions:
    with read(service.engine) as reader:
        return Versions.of(reader.scalar(sa.select(Run.flown)))


OTHERWISE = [
    (
        {"code": OTHER.digest},
        f"the code digest was {CODE.digest[:12]}, here it is {OTHER.digest[:12]} "
        "(modules: worker.engine.components.vehicles.",
    ),
    ({"loop": "fedcba9876543210"}, "the loop digest was 0123456789ab, here it is fedcba987654"),
    ({"packages": {"numpy": "2.5.0", "scipy": "1.17.1"}}, "numpy was 2.4.6, here it is 2.5.0"),
    ({"python": "3.12.1"}, "Python was 3.11.7, here it is 3.12.1"),
]


@pytest.mark.parametrize(("change", "statement"), OTHERWISE)
def test_a_run_started_by_other_code_is_refused_with_the_differences(
    service: Service, client: httpx.Client, change: dict[str, object], statement: str
) -> None:
    submit(client)
    first = claimed(service)
    first.record_versions(VERSIONS, CODE)
    first.begin(0)
    second = taken_over(service, first)
    second.record_versions(VERSIONS, CODE)
    here = VERSIONS.model_copy(update=change)
    with pytest.raises(OtherCode) as refused:
        second.record_versions(here, OTHER if "code" in change else CODE)
    assert str(refused.value).startswith(statement)
    assert versions(service) == VERSIONS


def test_what_cannot_change_a_number_is_no_other_code() -> None:
    def found(then: Versions, now: Versions) -> list[str]:
        return differences(identity_of(then, ""), identity_of(now, ""))

    assert found(VERSIONS, VERSIONS.model_copy(update={"clearance": "9", "system": "other", "cpu": None})) == []
    assert found(Versions(), VERSIONS) == found(VERSIONS, Versions()) == []
    earlier = Versions.of({"loop": VERSIONS.loop, "packages": {"numpy": "2.4.6"}, "cpu": "a name", "seed": 1})
    assert found(earlier, VERSIONS) == []


def test_before_the_first_stage_other_code_may_begin(service: Service, client: httpx.Client) -> None:
    submit(client)
    first = claimed(service)
    first.record_versions(VERSIONS, CODE)
    here = VERSIONS.model_copy(update={"code": OTHER.digest})
    taken_over(service, first).record_versions(here, OTHER)
    assert versions(service) == here


def test_a_run_from_before_code_digests_resumes_and_stores_none(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    first = claimed(service)
    first.begin(2)
    first.append(2, 0, search(0, 10))
    taken_over(service, first).record_versions(VERSIONS, CODE)
    found = client.get(f"/api/v1/runs/{run}").json()
    assert (found["flown"], found["undigested"]) == (None, UNDIGESTED)
    report = client.get(f"/api/v1/runs/{run}/report.html").text
    assert UNDIGESTED in report
    assert client.get(f"/api/v1/runs/{run}/components").json()["code"] is None
    assert UNRECORDED in client.get(f"/api/v1/runs/{run}/report.html").text


def test_page_report_and_files_state_the_code_and_whether_it_is_installed(
    service: Service, client: httpx.Client
) -> None:
    run = f"/api/v1/runs/{submit(client)}"
    finish_fully(service)
    assert client.get(run).json()["flown"]["code"] == CODE.digest
    told = client.get(f"{run}/components").json()
    assert (told["code"], told["code_installed"], told["code_changes"]) == (IDENTITY.digest, IDENTITY.digest, [])
    with service.engine.begin() as writer:
        workers.publish(writer, Catalogue.model_validate(edited()), OTHER)
    told = client.get(f"{run}/components").json()
    assert (told["code"], told["code_installed"]) == (IDENTITY.digest, OTHER_IDENTITY.digest)
    assert (told["changes"], told["code_changes"]) == ([], ["worker.engine.components.vehicles.unicycle"])
    export = client.get(f"{run}/exports/run.json").json()
    assert export["run"]["identity"] == IDENTITY.model_dump(mode="json")
    assert export["components"]["code_installed"] == OTHER_IDENTITY.digest
    report = client.get(f"{run}/report.html").text
    assert f"sha256 {IDENTITY.digest}" in report
    assert f"sha256 {CODE.digest}" in report
    with service.engine.begin() as writer:
        workers.publish(writer, CATALOGUE)
        assert writer.scalar(sa.select(CatalogueDocument.code)) is None


def test_two_runs_of_one_campaign_name_the_files_of_their_code_that_differ(
    service: Service, client: httpx.Client
) -> None:
    runs = [submit(client) for _ in range(3)]
    finish_fully(service)
    store = claimed(service)
    other = Code(
        "feed" * 16,
        {
            "worker.engine.components.vehicles.unicycle": "9" * 16,
            "worker.engine.problem": "1" * 16,
            "worker.engine.problem.problem": "0" * 16,
            "worker.engine.problem.more": "0" * 16,
        },
    )
    store.record_versions(VERSIONS.model_copy(update={"code": other.digest}), other)

    def told(run: str, against: str) -> dict[str, object]:
        answer = client.get(f"/api/v1/runs/{run}/code", params={"against": against})
        assert answer.status_code == 200, answer.text
        return dict(answer.json())

    found = told(runs[1], runs[0])
    assert (found["same_model"], told(runs[0], runs[0])["same_model"]) == (False, True)
    then, now = IDENTITY, identity_of(VERSIONS.model_copy(update={"code": other.digest}), "")
    assert (found["code"], found["against"], found["unidentified"]) == (now.digest, then.digest, [])
    assert found["changes"] == [
        f"the code digest was {CODE.digest[:12]}, here it is feedfeedfeed (modules: "
        "worker.engine.components.vehicles.unicycle, worker.engine.problem, worker.engine.problem.more)"
    ]
    assert found["files"] == [
        {"file": "worker/engine/components/vehicles/unicycle.py", "change": "changed", "component": "unicycle"},
        {"file": "worker/engine/problem/__init__.py", "change": "added", "component": None},
        {"file": "worker/engine/problem/more.py", "change": "added", "component": None},
    ]
    assert [file["change"] for file in told(runs[0], runs[1])["files"]] == ["changed", "removed", "removed"]  # type: ignore[attr-defined]
    assert told(runs[0], runs[0])["files"] == []
    waiting = {"code": None, "against": IDENTITY.digest, "changes": [], "unidentified": ["engine"], "files": None}
    assert told(runs[2], runs[0]) == {**waiting, "same_model": True, "same_question": True}, "it has not started"
    assert client.get(f"/api/v1/runs/{runs[0]}/code", params={"against": "R-9999"}).status_code == 404
    assert client.get(f"/api/v1/runs/{runs[0]}/code", params={"against": "../x"}).status_code == 404
    assert client.get(f"/api/v1/runs/{runs[0]}/code").status_code == 422


def test_whether_two_runs_ask_the_same_is_stated_by_the_rule_of_what_speaks_against_a_run(
    service: Service, client: httpx.Client
) -> None:
    first = submit(client)

    def same(**changes: object) -> object:
        path = f"/api/v1/runs/{submit(client, **changes)}/code"
        return client.get(path, params={"against": first}).json()["same_question"]

    assert [same(), same(seed=9), same(criterion={"threshold": 0.6})] == [True] * 3
    assert same(**altered("scenario", "horizon", value=16)) is False
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 1).values(question=None))
    assert same() is None


def test_a_database_of_the_migration_before_keeps_its_runs(tmp_path: Path) -> None:
    url = default_url(tmp_path / "data")
    engine = connect(url)
    with migration_lock(engine) as connection:
        command.upgrade(config(connection), "0008")
    with engine.begin() as writer:
        writer.execute(sa.text("insert into catalogue (id, document, published) values (1, '{}', 0)"))
        writer.execute(sa.text("insert into campaigns (digest, name, document, created) values ('d', 'c', '{}', 0)"))
        columns = "campaign_digest, name, tags, owner, state, created, priority, attempts, max_attempts, not_before,"
        columns += "lease_until, fence, cancel, summary, evaluations, planned, failed_evaluations"
        values = "'d', 'old', '[]', '', 'done', 0, 0, 1, 3, 0, 0, 1, 0, '{}', 5, 5, 0"
        writer.execute(sa.text(f"insert into runs ({columns}) values ({values})"))
    migrate(url)
    with engine.begin() as connection:
        row = connection.execute(sa.select(Run.name, Run.evaluations, Run.flown)).one()
        assert tuple(row) == ("old", 5, None)
        assert connection.scalar(sa.select(CatalogueDocument.code)) is None
        workers.publish(connection, CATALOGUE, Code("a" * 64, {"m": "1"}))
    engine.dispose()
