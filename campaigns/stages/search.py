"""The search stages, one for each method that the campaign names."""

from __future__ import annotations

from campaigns.asked.spec import Campaign
from campaigns.results.search import SearchResult
from campaigns.stages.declared import Declared


def _planned(campaign: Campaign) -> list[tuple[str | None, int]]:
    return [(search.method, search.evaluations) for search in campaign.stages.search]


def _description(campaign: Campaign) -> str:
    number = len(campaign.stages.search)
    return f"{number} {'method' if number == 1 else 'methods'}"


stage = Declared("search", 2, "Search", SearchResult, _planned, _description, against=True)
