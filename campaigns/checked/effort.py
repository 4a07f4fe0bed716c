"""The computing effort of a campaign: simulation steps, and numbers in memory; both are limited.

The limits are far above any realistic campaign. They prevent a mistyped one from occupying a machine for weeks or using
all of its memory.
"""

from __future__ import annotations

from collections.abc import Iterator

from campaigns.asked.problem import Problem
from campaigns.asked.spec import Campaign
from campaigns.stages.plan import bound, most

MOST_STEPS = 10**13
"""Simulation steps of a run; at 20 ns each (a vehicle in the plane) they take two days on one core. The largest
campaign of the library has 5e8."""

MOST_TRACED = 10**8
"""Numbers of one trace, 0.8 GB: its states, the observed columns and distances to every obstacle."""

MOST_STORED = 3 * 10**8
"""Numbers of all evaluations of a run, 2.4 GB: all are in memory when the verdict is computed."""

PREVIEW_STEPS = 2 * 10**7
PREVIEW_TRACED = 2 * 10**7
"""The same for a preview, for which a user waits: about two seconds, and 0.2 GB."""

STATES = 40
"""Numbers of one step without obstacles: states, held guidance, pose and commands. With one obstacle the library's
campaigns have at most 43, with three 51."""

OBSTACLE = 8
"""Numbers of one step for each obstacle: its state, its centre, its distances."""


def steps(campaign: Campaign) -> int:
    """Steps of one evaluation, over all its realisations; 0 (unknown) for a simulator."""
    return 0 if campaign.scenario is None else traced_steps(campaign) * len(campaign.scenario.realisations.seeds)


def traced_steps(campaign: Campaign) -> int:
    """Steps of one simulation."""
    return round(campaign.given_scenario.horizon / campaign.given_scenario.step)


def traced(campaign: Campaign) -> int:
    """The approximate number of values in the trace of one simulation."""
    channels = OBSTACLE + len(campaign.objectives)
    return traced_steps(campaign) * (STATES + channels * len(campaign.given_scenario.obstacles))


def excessive(campaign: Campaign) -> Iterator[Problem]:
    """Problems with a campaign that exceeds the limits, and what to lower."""
    evaluations = sum(stage.stored for stage in bound(campaign))
    if campaign.scenario is not None and (in_all := most(campaign) * steps(campaign)) > MOST_STEPS:
        seeds, each = len(campaign.scenario.realisations.seeds), traced_steps(campaign)
        value = f"{most(campaign):,} evaluations x {seeds} realisations x {each:,} steps = {in_all:.2g}"
        text = f"at most {MOST_STEPS:.0e} steps of simulation in all: lower the evaluations of the stages, "
        text += "the realisations, or horizon / step"
        yield Problem("stages", value, text)
    stored = evaluations * (len(campaign.uncertain) + len(campaign.objectives) + 3)
    if stored > MOST_STORED:
        value = f"{evaluations:,} evaluations of {len(campaign.uncertain)} parameters"
        text = f"about {stored * 8 / 1e9:.1f} GB of results, at most {MOST_STORED * 8 / 1e9:g} GB: "
        text += "lower the evaluations of the stages, or the number of uncertain parameters"
        yield Problem("stages", value, text)
    if campaign.scenario is not None and traced(campaign) > MOST_TRACED:
        value = f"{traced_steps(campaign):,} steps past {len(campaign.scenario.obstacles)} obstacles"
        text = f"the trace of one simulation would take about {traced(campaign) * 8 / 1e9:.1f} GB, at most "
        text += f"{MOST_TRACED * 8 / 1e9:g} GB: lengthen the step, shorten the horizon, or remove obstacles"
        yield Problem("scenario.step", value, text)


def unpreviewable(campaign: Campaign) -> Iterator[Problem]:
    """Problems with a nominal case that exceeds the limits of a preview, which are lower than those of a run."""
    if campaign.scenario is None:
        yield Problem("simulator", "", "a simulator has no preview; start the run")
        return
    seeds = len(campaign.scenario.realisations.seeds)
    if steps(campaign) > PREVIEW_STEPS:
        value = f"{seeds} realisations x {traced_steps(campaign):,} steps"
        text = f"a preview simulates at most {PREVIEW_STEPS:,} steps: lower the realisations or horizon / step"
        yield Problem("scenario", value, f"{text}, or start the run, which has higher limits")
    elif traced(campaign) > PREVIEW_TRACED:
        value = f"{traced_steps(campaign):,} steps past {len(campaign.scenario.obstacles)} obstacles"
        text = f"the trace of a preview has at most {PREVIEW_TRACED * 8 / 1e9:g} GB: lower horizon / step"
        yield Problem("scenario", value, f"{text}, or start the run, which has higher limits")
