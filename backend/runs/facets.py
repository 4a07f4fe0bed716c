"""The values by which the run list can be filtered: campaigns, tags, owners, methods and labels of runs."""

from __future__ import annotations

import json
from collections import Counter
from typing import Any

import sqlalchemy as sa

from backend.db import labels
from backend.db.tables import CampaignRow, Run, RunLabel
from backend.runs.filters import unindexed
from backend.runs.schemas import Facet, RunFacets

MOST = 200
"""Maximum number of values of each kind; those with the most runs are listed."""


def facets(reader: sa.Connection) -> RunFacets:
    digests = _counted(reader, Run.campaign_digest)
    names = {row.digest: row.name for row in reader.execute(sa.select(CampaignRow.digest, CampaignRow.name))}
    campaigns: Counter[str] = Counter()
    for digest, number in digests.items():
        campaigns[names[digest]] += number
    tags: Counter[str] = Counter()
    for text, number in _counted(reader, sa.cast(Run.tags, sa.Text)).items():
        tags.update(dict.fromkeys(json.loads(text), number))
    return RunFacets(
        campaigns=_listed(campaigns),
        tags=_listed(tags),
        owners=_listed(_counted(reader, Run.owner)),
        methods=_listed(_counted(reader, Run.worst_method)),
        labels=labels_of(reader),
    )


def _counted(reader: sa.Connection, column: Any) -> Counter[str]:
    column = unindexed(column)
    rows = reader.execute(sa.select(column, sa.func.count()).where(Run.removed.is_(None)).group_by(column))
    return Counter({value: number for value, number in rows if value})


def labels_of(reader: sa.Connection, *conditions: sa.ColumnElement[bool]) -> list[Facet]:
    of = sa.select(RunLabel.key, RunLabel.value, sa.func.count()).join(Run, Run.id == RunLabel.run_id)
    of = of.where(Run.removed.is_(None), labels.GIVEN, *conditions).group_by(RunLabel.key, RunLabel.value)
    return _listed(Counter({f"{key}={value}": number for key, value, number in reader.execute(of)}))


def _listed(found: Counter[str]) -> list[Facet]:
    most = sorted(found.items(), key=lambda item: (-item[1], item[0].lower()))[:MOST]
    return [Facet(value=value, runs=number) for value, number in most]
