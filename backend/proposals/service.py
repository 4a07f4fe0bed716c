"""What an evaluation of a simulator took when it was last measured, and what to search with."""

from __future__ import annotations

from dataclasses import asdict

import sqlalchemy as sa

from backend.catalog.service import required
from backend.db import costs
from backend.http.errors import existing
from backend.proposals.schemas import MeasuredCost, Proposal, ProposedSearch
from campaigns.asked.proposal import Cost, lasting
from campaigns.checked.expected import confirmation

UNKNOWN = (
    "The time of an evaluation is not measured yet: the first stage of a run measures it, and so does "
    "`clearance check-simulator {name} --data DIR` for the service of that folder"
)


def proposal(reader: sa.Connection, name: str, parameters: int, patience: float, calls: int) -> Proposal:
    """Methods and budgets for the simulator of that name, or 404."""
    catalogue = required(reader)
    entry = existing(catalogue.simulator(name), "simulator called", name)
    cost, others = costs.newest(reader, entry, catalogue.digests.get(name))
    if cost is None:
        known = UNKNOWN.format(name=name) + (f". {_others(others)}" if others else "")
        return Proposal(measured=None, known=f"{known}.", sentence="", searches=[], seconds=None)
    found = cost.proposed(catalogue.methods, parameters, patience, calls)
    return Proposal(
        measured=_measured(cost),
        known=f"{cost.sentence(calls)}.",
        sentence=f"{found.sentence}." + (f" {confirmation(cost, calls)}" if found.searches else ""),
        searches=[ProposedSearch(**asdict(search)) for search in found.searches],
        seconds=found.seconds if found.searches else None,
    )


def _measured(cost: Cost) -> MeasuredCost:
    shown = {name: value for name, value in asdict(cost).items() if name in MeasuredCost.model_fields}
    return MeasuredCost(**shown, source=cost.source)


def _others(cost: Cost) -> str:
    took = f"{cost.source}, in which one call took {lasting(cost.seconds)}"
    if cost.run is not None:
        return f"Its files have changed since {took}"
    return f"Its files are not those of {took}; a worker publishes the digest of its files when it starts"
