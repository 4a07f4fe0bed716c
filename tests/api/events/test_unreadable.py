"""A run that this version cannot read, as one of a newer version, keeps nothing of the others from event streams."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.engine import now
from backend.db.tables import CampaignRow, CatalogueDocument, CatalogueSnapshot, Run, Stage, Worker
from backend.runs.service import number
from campaigns.runs import StageState
from tests.given.event_streams import streaming
from tests.given.newer_forms import in_form
from tests.given.service import Service
from tests.given.submissions import submit


def of_newer_version(writer: sa.Connection, run: int) -> None:
    """Its campaign has an unknown field, while its sample is drawn."""
    of = sa.select(Run.campaign_digest).where(Run.id == run).scalar_subquery()
    document: Any = writer.scalar(sa.select(CampaignRow.document).where(CampaignRow.digest == of))
    writer.execute(sa.update(CampaignRow).where(CampaignRow.digest == of).values(document=document | {"newer": 1}))
    sampling(writer, run)


def sampling(writer: sa.Connection, run: int) -> None:
    stage = {"position": 0, "kind": "certify", "planned": 100, "state": StageState.RUNNING, "counted": 10}
    writer.execute(sa.insert(Stage).values(run_id=run, **stage))


def of_newer_descriptions(writer: sa.Connection, run: int) -> None:
    """Its components are described in another form, while its sample is drawn."""
    mine = CatalogueSnapshot.digest == sa.select(Run.snapshot).where(Run.id == run).scalar_subquery()
    document: Any = writer.scalar(sa.select(CatalogueSnapshot.document).where(mine))
    changed = in_form(document, "one more field")
    writer.execute(sa.insert(CatalogueSnapshot).values(digest="newer", document=changed, created=0.0))
    writer.execute(sa.update(Run).where(Run.id == run).values(snapshot="newer"))
    sampling(writer, run)


def of_newer_workers(writer: sa.Connection, run: int) -> None:
    """It has no descriptions of its own, and the published ones are of another form."""
    document: Any = writer.scalar(sa.select(CatalogueDocument.document))
    writer.execute(sa.update(CatalogueDocument).values(document=in_form(document, "one more field")))
    writer.execute(sa.update(Run).where(Run.id == run).values(snapshot=None))
    sampling(writer, run)


def of_unknown_stage(writer: sa.Connection, run: int) -> None:
    stage = {"position": 0, "kind": "search", "planned": 100, "state": "astray", "counted": 0}
    writer.execute(sa.insert(Stage).values(run_id=run, **stage))


def of_unknown_state(writer: sa.Connection, run: int) -> None:
    writer.execute(sa.update(Run).where(Run.id == run).values(state="astray"))


def of_other_columns(writer: sa.Connection, run: int) -> None:
    """Its tags are no list."""
    writer.execute(sa.update(Run).where(Run.id == run).values(tags={"newer": 1}))


NORMAL = {"low": 4.0, "high": 6.0, "distribution": {"kind": "normal", "mean": 5.0, "deviation": 0.25}}
"""What the bound of a sample counts beyond the bounds, which the descriptions state."""


@pytest.mark.by_day(2)
@pytest.mark.parametrize(
    "stored",
    [
        *(of_newer_version, of_newer_descriptions, of_newer_workers),
        *(of_unknown_stage, of_unknown_state, of_other_columns),
    ],
)
def test_a_run_that_cannot_be_read_keeps_no_other_from_the_streams(
    service: Service, client: httpx.Client, stored: Any
) -> None:
    unreadable, other = submit(client, uncertain={"vehicle.m": NORMAL}), submit(client, seed=2)
    with service.engine.begin() as writer:
        stored(writer, number(unreadable))
    with streaming(client) as every, streaming(client, run=unreadable) as one, streaming(client, run=other) as its:
        assert its.next("run")["id"] == other
        one.next("stages")
        client.post(f"/api/v1/runs/{other}/cancel")
        assert its.next("run")["state"] == "cancelled"
        while (told := every.next("run"))["state"] != "cancelled":
            continue
        assert told["id"] == other


def test_a_worker_that_cannot_be_read_keeps_no_run_from_the_streams(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    with service.engine.begin() as writer:
        times = {"started": now(writer), "beat": now(writer)}
        writer.execute(sa.insert(Worker).values(name="w1", host="", pid=0, simulators=[5], **times))
    with streaming(client) as every:
        assert every.next("run")["id"] == run
        client.post(f"/api/v1/runs/{run}/cancel")
        assert every.next("run")["state"] == "cancelled"
