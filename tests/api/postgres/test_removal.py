"""Removing, restoring and purging on PostgreSQL; the tests are those of `tests.api.test_removal`, and two more."""

import threading

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Run
from tests.api.server import Service, until
from tests.api.test_removal import (
    WHY,
    run,
    sign,
    test_a_purged_run_leaves_a_tombstone,
    test_a_removed_run_is_in_no_list_and_keeps_its_address,
    test_a_run_in_work_and_a_signed_one_stay,
    test_several_are_removed_and_restored_together_or_none,
)
from worker.cli import invoke


def test_who_signs_while_the_run_is_being_removed_comes_too_late(
    service: Service, client: httpx.Client, run: str
) -> None:
    """SQLite has one writer at a time; here the row is what the two wait for."""
    answers: list[httpx.Response] = []
    thread = threading.Thread(target=lambda: answers.append(sign(client, run)))
    waiting = sa.text("select count(*) from pg_locks where not granted")
    with service.engine.begin() as writer:
        writer.execute(sa.select(Run.id).where(Run.id == 1).with_for_update())
        thread.start()
        with service.engine.execution_options(isolation_level="AUTOCOMMIT").connect() as beside:
            until(lambda: beside.scalar(waiting))
        writer.execute(sa.update(Run).values(removed=1.0, removed_by="ada", removed_reason="a trial"))
    thread.join(20)
    assert [answer.status_code for answer in answers] == [409]
    assert "is removed" in answers[0].text


def test_the_command_purges(
    service: Service, client: httpx.Client, run: str, capsys: pytest.CaptureFixture[str]
) -> None:
    client.delete(run, params=WHY)
    assert invoke(["purge", "--older-than", "0d", "--yes", "--database", service.settings.database]) == 0
    said = capsys.readouterr().out
    assert "1 run purged." in said
    assert "autovacuum" in said
    assert client.get(run).status_code == 410
    assert service.rows()["evaluation_chunks"] == 0
