"""What the result of a search is made from."""

from __future__ import annotations

from dataclasses import dataclass

from campaigns import Campaign, Catalogue
from clearance.local.citation import Cited
from worker.engine.problem.problem import Problem
from worker.running.runs.store import MemoryStore


@dataclass(frozen=True)
class Origin:
    """For its pictures, its report and its folder."""

    campaign: Campaign
    problem: Problem
    store: MemoryStore
    known: Catalogue
    names: tuple[str, ...]
    cites: Cited | None = None
    """The search that it extends."""
