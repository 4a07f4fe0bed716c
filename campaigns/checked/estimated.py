"""The problems of an estimate of P(violation): its design points assume that a case violates or does not."""

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
        text = "the scenario has noise, and the estimate assumes that a case violates or does not; remove this"
        yield Problem(FIELD, "noise", text)
    if campaign.simulator is not None and campaign.simulator.calls > 1:
        text = "an evaluation is several calls, and the estimate assumes that a case violates or does not; remove this"
        yield Problem(FIELD, f"{campaign.simulator.calls} calls", text)
    normal = [path for path, uncertain in campaign.uncertain.items() if uncertain.distribution.kind == "normal"]
    mixed = {path for c in campaign.correlations if c.value != 0.0 for path in c.between}
    for path in sorted(mixed & set(normal)):
        text = "a correlated normal distribution is drawn again beyond the bounds, which the estimate cannot weigh"
        yield Problem(f"uncertain.{path}.distribution", "normal", f"{text}; make it truncated_normal")
