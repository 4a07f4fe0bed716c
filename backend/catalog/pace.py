"""The time of a scenario's evaluations at the speed of earlier runs, and that of stages that compute without any.

A mean speed is an estimate and bounds no time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sqlalchemy as sa

from backend.db.tables import CampaignRow, Run, Stage
from campaigns import Campaign
from campaigns.asked.proposal import lasting
from campaigns.asked.scenario import Realisations
from campaigns.checked import effort
from campaigns.checked.expected import computing
from campaigns.runs import RunState, StageState, run_name
from campaigns.stages.found import declared

RECENT_RUNS = 300
"""Number of recent runs searched for the speed of the same components."""
COMPUTED = "{title}, which computes without evaluations, took {time} in {run}, which the time includes."
UNTIMED = "{title} computes without evaluations: its time comes on top."


@dataclass(frozen=True)
class Pace:
    """What one evaluation takes [s], None if unknown; and the stages that compute without evaluations: what those of
    known time take together [s], the titles of the others, and a sentence on each."""

    each: float | None
    computing: float
    untimed: list[str]
    sentences: list[str]

    @staticmethod
    def of(reader: sa.Connection, campaign: Campaign) -> Pace:
        """As earlier runs had it; of a simulator the time of an evaluation is not known from here."""
        seconds, untimed, sentences = 0.0, list[str](), list[str]()
        for kind in computing(campaign):
            found, title = _computed(reader, campaign, kind), declared()[kind].title
            if found is None:
                untimed.append(title)
                sentences.append(UNTIMED.format(title=title))
                continue
            seconds += found[1]
            sentences.append(COMPUTED.format(title=title, time=lasting(found[1]), run=run_name(found[0])))
        return Pace(_evaluation(reader, campaign), seconds, untimed, sentences)

    def about(self, evaluations: int) -> float | None:
        """The time of so many evaluations and of the computing stages of known time [s]."""
        return None if self.each is None else evaluations * self.each + self.computing

    def whole(self, evaluations: int) -> float | None:
        """The same [s]; None if the time of any stage is unknown."""
        return None if self.untimed else self.about(evaluations)


def _evaluation(reader: sa.Connection, campaign: Campaign) -> float | None:
    """Mean time of an evaluation of these components in earlier runs [s], scaled by its steps; None for simulators."""
    if campaign.scenario is None:
        return None
    stored = CampaignRow.document["scenario"]
    totals = (
        sa.select(Run.campaign_digest, sa.func.sum(Stage.evaluations + Stage.counted), sa.func.sum(Stage.seconds))
        .join(Stage, Stage.run_id == Run.id)
        .where(Run.id.in_(_recent()), Stage.state == StageState.DONE, Stage.evaluations > 0)
        .group_by(Run.campaign_digest)
        .subquery()
    )
    digest, evaluations, spent = totals.c
    timing = (stored["horizon"].as_float(), stored["step"].as_float(), stored["realisations"]["seeds"])
    rows = sa.select(evaluations, spent, *timing).join(CampaignRow, CampaignRow.digest == digest)
    steps = seconds = 0.0
    for count, time, horizon, step, seeds in reader.execute(rows.where(*_same_components(campaign))):
        steps += float(count) * effort.steps(_with_steps_of(campaign, horizon, step, seeds))
        seconds += time
    return effort.steps(campaign) * seconds / steps if steps and seconds else None


def _with_steps_of(campaign: Campaign, horizon: float, step: float, seeds: list[int] | None) -> Campaign:
    """The campaign with as many steps in an evaluation as a stored scenario, which may be of an earlier version."""
    realisations = Realisations() if seeds is None else Realisations.model_construct(seeds=seeds)
    steps = {"horizon": horizon, "step": step, "realisations": realisations}
    return campaign.model_copy(update={"scenario": campaign.given_scenario.model_copy(update=steps)})


def _computed(reader: sa.Connection, campaign: Campaign, kind: str) -> tuple[int, float] | None:
    """The newest run that had this stage with the same options on the same system, and what it took there [s]."""
    stored, own = CampaignRow.document, campaign.document()
    mine = [own.get("scenario"), own.get("simulator"), own["stages"].get(kind)]
    rows = (
        sa.select(Run.id, Stage.seconds, stored["scenario"], stored["simulator"], stored["stages"][kind])
        .join(Stage, Stage.run_id == Run.id)
        .join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
        .where(Run.id.in_(_recent()), Stage.kind == kind, Stage.state == StageState.DONE, Run.removed.is_(None))
        .where(*_same_components(campaign))
        .order_by(Run.id.desc())
    )
    for run_id, seconds, *computed_from in reader.execute(rows):
        if computed_from == mine:
            return run_id, float(seconds)
    return None


def _recent() -> sa.ScalarSelect[int]:
    recent = sa.select(Run.id).where(Run.state == RunState.DONE).order_by(Run.id.desc()).limit(RECENT_RUNS)
    return sa.select(recent.subquery().c.id).scalar_subquery()


def _same_components(campaign: Campaign) -> Sequence[sa.ColumnElement[bool]]:
    scenario, stored = campaign.scenario, CampaignRow.document["scenario"]
    if scenario is None:
        return []
    parts = {"vehicle": scenario.vehicle, "controller": scenario.controller, "avoider": scenario.avoider}
    return [stored[role]["component"].as_string() == part.component for role, part in parts.items()]
