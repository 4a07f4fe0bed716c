"""The problems of an estimate of P(violation): it searches modes among the parameters, not in noise."""

from __future__ import annotations

from collections.abc import Iterator

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign

MOST_PARAMETERS = 20
"""With 40, an interval was measured not to hold (`tests.bench.rare`)."""
FIELD = "stages.estimate"


def estimated(campaign: Campaign, random: bool) -> Iterator[Problem]:
    """random: whether a component of the scenario is."""
    if campaign.stages.estimate is None:
        return
    if len(campaign.uncertain) > MOST_PARAMETERS:
        text = (
            f"P(violation) is estimated for at most {MOST_PARAMETERS} uncertain parameters; vary fewer or remove this"
        )
        yield Problem(FIELD, f"{len(campaign.uncertain)} parameters", text)
    if random:
        text = (
            "the scenario has noise, so P(violation) is also over its realisations, of which the estimate would miss "
            "the rare ones without a sign; remove this"
        )
        yield Problem(FIELD, "noise", text)
    if campaign.simulator is not None and campaign.simulator.calls > 1:
        text = (
            "an evaluation is several calls of a simulator with noise, of which the estimate would miss rare "
            "realisations without a sign; remove this"
        )
        yield Problem(FIELD, f"{campaign.simulator.calls} calls", text)
