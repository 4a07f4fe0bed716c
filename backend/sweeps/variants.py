"""The campaigns of a sweep: the given one with each value of the parameter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from campaigns import Campaign, CampaignError, Catalogue, Problem, check
from campaigns.asked.load import load_document
from campaigns.catalogue import ParameterEntry
from campaigns.checked import texts
from campaigns.checked.check import parameters

SOURCE = "request"


def variants(campaign: Campaign, path: str, values: Sequence[float], catalogue: Catalogue) -> list[Campaign]:
    """One campaign for each value, in order; raises `CampaignError` with every problem of every one of them."""
    problems = check(campaign, catalogue) or list(_refused(campaign, path, catalogue))
    if problems:
        raise CampaignError(SOURCE, problems)
    made = []
    for i, value in enumerate(values):
        try:
            variant = load_document(_with(campaign, path, value), SOURCE)
            found = check(variant, catalogue)
        except CampaignError as error:
            found = error.problems
        else:
            made.append(variant)
        problems += [Problem(f"values.{i}", f"{value:.15g}", f"{p.field}: {p.message}") for p in found]
    if problems:
        raise CampaignError(SOURCE, problems)
    return made


def described(campaign: Campaign, path: str, catalogue: Catalogue) -> tuple[ParameterEntry, float]:
    """The entry of the parameter, and its value in the campaign."""
    return parameters(campaign, catalogue)[path]


def _refused(campaign: Campaign, path: str, catalogue: Catalogue) -> Iterator[Problem]:
    if campaign.baseline is not None:
        yield Problem("campaign.baseline", campaign.baseline.run, "a sweep has no baseline; leave it out")
    known = parameters(campaign, catalogue)
    fixed = [name for name in known if name not in campaign.uncertain]
    if path in campaign.uncertain:
        text = "this parameter is uncertain, so every run searches over it; sweep one that is fixed"
        yield Problem("path", path, f"{text} ({', '.join(fixed[:6])}, ...)")
    elif path not in known:
        yield Problem("path", path, f"the campaign has no such parameter; {texts.known(path, fixed)}")


def _with(campaign: Campaign, path: str, value: float) -> dict[str, Any]:
    document = campaign.document()
    first, _, rest = path.partition(".")
    place: Any = document if first in ("criterion", "objectives", "simulator") else document["scenario"]
    place = place[first]
    if isinstance(place, list):
        number, _, rest = rest.partition(".")
        place = place[int(number)]
    (place if first in ("start", "goal") else place["parameters"])[rest] = value
    return document
