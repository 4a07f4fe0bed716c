"""The terms in the sentences of a run, for sentences that earlier versions stored as text."""

from __future__ import annotations

import functools
from collections.abc import Callable

import sqlalchemy as sa

from backend.catalog.service import described
from backend.db.engine import once
from backend.db.tables import CampaignRow, Run
from campaigns import Campaign
from campaigns.checked.check import parameters
from campaigns.claims import earlier
from campaigns.symbols import labels

Terms = Callable[[], earlier.Terms]
"""Computed once, when the first such sentence is read."""


def terms_of(reader: sa.Connection, run_id: int) -> Terms:
    """The value of the criterion and the uncertain parameters of a run, with their symbols and units."""
    return functools.cache(lambda: once(reader, ("terms", run_id), lambda: _terms(reader, run_id)))


def _terms(reader: sa.Connection, run_id: int) -> earlier.Terms:
    query = sa.select(CampaignRow.document).join(Run, Run.campaign_digest == CampaignRow.digest)
    campaign = Campaign.model_validate(reader.scalar(query.where(Run.id == run_id)))
    catalogue = described(reader, run_id)
    known = {} if catalogue is None else parameters(campaign, catalogue)
    criterion = None if catalogue is None else catalogue.component("criterion", campaign.criterion.component)
    symbols = labels(campaign.uncertain, {path: entry.symbol for path, (entry, _) in known.items()})
    units = {known[path][0].unit for path in campaign.uncertain if path in known} | {"s"}
    if criterion is None:
        return earlier.Terms(symbols, units)
    return earlier.Terms({criterion.quantity: criterion.quantity, **symbols}, units | {criterion.unit})
