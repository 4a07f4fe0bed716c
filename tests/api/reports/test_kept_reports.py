"""A report that is kept states what is stored now: every change of what it states makes another one."""

from __future__ import annotations

from collections.abc import Callable

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import CatalogueDocument, EvaluationChunk, Run, RunLabel, Stage
from backend.reports import cache
from backend.reports import service as reports
from backend.reports.cache import Kept, Page
from tests.given.at_night import nightly_but
from tests.given.databases import AT_NIGHT
from tests.given.finished_runs import Work
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.submissions import submit


def _stored(statement: sa.Executable) -> Callable[[httpx.Client, sa.Engine], object]:
    """A change behind the service's back."""

    def change(_: httpx.Client, engine: sa.Engine) -> None:
        with engine.begin() as writer:
            writer.execute(statement)

    return change


def _signed(client: httpx.Client, _: sa.Engine) -> None:
    digest = client.get("/api/v1/runs/R-0001/signoffs").json()["digest"]
    body = {"name": "Grace", "role": "Reviewer", "comment": "", "digest": digest}
    answer = client.post("/api/v1/runs/R-0001/signoffs", json=body)
    assert answer.status_code == 201, answer.text


def _turned(_: httpx.Client, engine: sa.Engine) -> None:
    """The last byte of the costs of a chunk."""
    with engine.begin() as writer:
        first = writer.execute(
            sa.select(EvaluationChunk.position, EvaluationChunk.first, EvaluationChunk.costs)
        ).first()
        assert first is not None
        mine = (EvaluationChunk.position == first.position, EvaluationChunk.first == first.first)
        turned = first.costs[:-1] + bytes([first.costs[-1] ^ 1])
        writer.execute(sa.update(EvaluationChunk).where(*mine).values(costs=turned))


def _installed(_: httpx.Client, engine: sa.Engine) -> None:
    """What a run does that opens a simulator with changed files: the catalogue has no new time."""
    with engine.begin() as writer:
        document = writer.execute(sa.select(CatalogueDocument.document)).scalar_one()
        changed = document | {"digests": {"another": "0" * 64}}
        writer.execute(sa.update(CatalogueDocument).values(document=changed))


CHANGES: dict[str, Callable[[httpx.Client, sa.Engine], object]] = {
    "name": lambda client, _: client.patch("/api/v1/runs/R-0001", json={"name": "Another name"}),
    "signoff": _signed,
    "again": lambda client, _: submit(client),
    "verdict": _stored(sa.update(Run).values(verdict="violated")),
    "stage": _stored(sa.update(Stage).values(seconds=77.0)),
    "evaluation": _turned,
    "label": _stored(sa.insert(RunLabel).values(run_id=1, key="@superseded", value="R-0009")),
    "catalogue": _installed,
    "purged": _stored(sa.update(Run).values(purged=1.0)),
}
BY_DAY = ("name", "signoff", "verdict", "evaluation", "catalogue")
"""Of a run, of what is written on it, of its results and of what it is compared with."""


@pytest.fixture
def run(service: Service, client: httpx.Client) -> str:
    """A finished run with a result of every kind."""
    run = submit(client)
    finish_fully(service)
    return run


@pytest.mark.by_day(2)
@AT_NIGHT
@pytest.mark.parametrize("change", nightly_but(BY_DAY, CHANGES))
def test_what_changes_a_report_changes_its_key(service: Service, client: httpx.Client, run: str, change: str) -> None:
    before = _key(service)
    assert before is not None
    assert _key(service) == before
    CHANGES[change](client, service.engine)
    assert _key(service) != before


def test_a_report_is_written_once_and_shows_a_change(
    service: Service, client: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = _counted(monkeypatch)
    first, again = (client.get(f"/api/v1/runs/{run}/report.html") for _ in range(2))
    assert len(written) == 1
    assert first.headers["content-security-policy"] == again.headers["content-security-policy"]
    client.patch(f"/api/v1/runs/{run}", json={"name": "Another name"})
    renamed = client.get(f"/api/v1/runs/{run}/report.html")
    assert len(written) == 2
    assert "Another name" in renamed.text
    assert "another-name" in renamed.headers["content-disposition"]


def test_a_kept_report_has_its_own_time(service: Service, client: httpx.Client, run: str) -> None:
    with service.engine.connect() as reader:
        texts = [_html(reader, service, at) for at in (1_000_000_000.0, 1_100_000_000.0)]
    for text, day, other in zip(texts, ("2001", "2004"), ("2004", "2001"), strict=True):
        assert f" {day}" in text
        assert f" {other}" not in text


def test_a_run_that_has_not_ended_is_written_anew(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    run, written = submit(client), _counted(monkeypatch)
    for evaluations in (300, 400):
        assert _key(service) is None
        client.get(f"/api/v1/runs/{run}/report.html")
        if evaluations == 300:
            Work(service).nominal()
    assert len(written) == 2


def test_the_reports_asked_for_last_are_kept() -> None:
    found = Kept()
    for number in range(cache.MOST):
        found.put(number, "one", Page(str(number), "", ""))
    assert found.get(0, "one") == Page("0", "", "")
    found.put(cache.MOST, "one", Page("new", "", ""))
    assert found.get(0, "one") is not None
    assert found.get(1, "one") is None
    found.put(0, "another", Page("changed", "", ""))
    assert (found.get(0, "one"), found.get(0, "another")) == (None, Page("changed", "", ""))
    assert found.get(2, "one") is not None, "a changed one takes the place of its own"
    found.put(3, None, Page("none", "", ""))
    assert found.get(3, None) is None


def _key(service: Service) -> str | None:
    with service.engine.connect() as reader:
        return cache.key(reader, 1, service.settings.pages)


def _html(reader: sa.Connection, given: Service, at: float) -> str:
    return reports.report_html(reader, 1, at, given.settings.pages).html


def _counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The runs whose reports are written from now on; the real writer."""
    written: list[int] = []
    real = reports.load

    def counted(reader: sa.Connection, run_id: int) -> object:
        written.append(run_id)
        return real(reader, run_id)

    monkeypatch.setattr(reports, "load", counted)
    monkeypatch.setattr(reports, "KEPT", Kept())
    return written
