"""Fills a database with many runs."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa

from backend.db.engine import now
from backend.db.tables import CampaignRow, Run
from campaigns import Campaign
from tests.given.service import Service
from tests.given.small_catalogue import campaign


def fill(service: Service, count: int, pinned: tuple[int, ...] = (), **more: Any) -> None:
    """Many runs in every state, written straight into the table."""
    asked = Campaign.model_validate(campaign())
    with service.engine.begin() as connection:
        at = now(connection)
        row = {"digest": asked.digest, "name": asked.name, "document": asked.document(), "created": at}
        connection.execute(sa.insert(CampaignRow).values(**row))
        states = ("done", "failed", "cancelled", "done", "queued")
        verdicts = ("cleared", None, None, "violated", None)
        rows = [
            {
                "campaign_digest": asked.digest,
                "name": f"run {i % 7}",
                "tags": ["even" if i % 2 == 0 else "odd", "50%_"],
                "owner": "ada" if i % 3 else "bob",
                "state": states[i % 5],
                "verdict": verdicts[i % 5],
                "created": at + i,
                "started": at + i if states[i % 5] != "queued" else None,
                "threshold": 0.5,
                "finished": at + 2 * i if verdicts[i % 5] else None,
                "nominal_cost": 0.9,
                "worst_cost": None if verdicts[i % 5] is None else 0.1 * (i % 11) + 0.1 + 0.2,
                "worst_method": None if verdicts[i % 5] is None else ("direct", "sqp")[i % 2],
                "upper_bound": None if verdicts[i % 5] is None else 0.001 * (i % 3),
                "pinned": i in pinned,
                **more,
            }
            for i in range(count)
        ]
        connection.execute(sa.insert(Run), rows)
