"""What an evaluation of a simulator took in the newest run of it, and what to search with. Start at `proposal`."""

from __future__ import annotations

from dataclasses import asdict

import sqlalchemy as sa

from backend.catalog import costs
from backend.catalog.service import required
from backend.http.errors import not_found
from backend.proposals.schemas import MeasuredCost, Proposal, ProposedSearch
from campaigns.asked.proposal import Cost, lasting

UNKNOWN = "The time of an evaluation is not measured yet: the first stage of a run measures it"


def proposal(reader: sa.Connection, name: str, parameters: int, patience: float, calls: int) -> Proposal:
    """Methods and budgets for the simulator of that name, or 404."""
    catalogue = required(reader)
    entry = catalogue.simulator(name)
    if entry is None:
        raise not_found("simulator called", name)
    cost, others = costs.newest(reader, entry, catalogue.digests.get(name))
    if cost is None:
        known = f"{UNKNOWN}. Its files have changed since {_took(others)}" if others else UNKNOWN
        return Proposal(measured=None, known=f"{known}.", sentence="", searches=[], seconds=None)
    found = cost.proposed(parameters, patience, calls)
    return Proposal(
        measured=MeasuredCost(**asdict(cost)),
        known=f"{cost.sentence(calls)}.",
        sentence=f"{found.sentence}.",
        searches=[ProposedSearch(**asdict(search)) for search in found.searches],
        seconds=found.seconds if found.searches else None,
    )


def _took(cost: Cost) -> str:
    return f"{cost.run}, in which one call took {lasting(cost.seconds)}"
