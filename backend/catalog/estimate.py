"""What a run of a campaign usually takes: evaluations and time, and where both are known from."""

from __future__ import annotations

from typing import NamedTuple

import sqlalchemy as sa

from backend.catalog.pace import Pace
from backend.catalog.schemas import Estimate, EstimatedStage
from backend.db import costs
from backend.db.tables import Run, Stage
from campaigns import Campaign, Catalogue
from campaigns.asked.allowance import least, validation
from campaigns.checked.expected import Expected, Total, called, computing, expected, fewer, total
from campaigns.checked.expected import again as made_again
from campaigns.runs import RunState, run_name
from campaigns.stages.found import declared
from campaigns.stages.plan import bound, most
from campaigns.stages.plan import onward as beyond

AFTERWARDS = (
    "How soon searches end by their own rule, how many worst cases there are and how long the descents to them take is "
    "known only afterwards."
)
PROMISE = (
    "No run takes more than {most} evaluations{called}, those made again to confirm results and to replace excluded "
    "samples included; validation takes at most {validation}."
)
FEW = ", which the nominal case and one finding need, whatever the budget"
LATER = ", and simulates {onward:,} more on beyond the horizon"
AS_BEFORE = "{run}, an earlier run of this campaign, took {evaluations} evaluations."
UNKNOWN = "The time is known after a first run of the same components."
SPEED = "The time is that of earlier runs with the same components, at their mean speed."
TIME_AS_BEFORE = "The time is that of {run}{scaled}."
SCALED = "; with all evaluations it is that at the same speed"


class _Time(NamedTuple):
    """Of the usual number of evaluations, of the least and of the most [s]; where it is known from; the titles of
    stages whose time is not part of it."""

    seconds: float | None
    seconds_least: float | None
    seconds_most: float | None
    time_statement: str
    untimed: list[str]


class _Earlier(NamedTuple):
    """The newest finished run of the same campaign: what it took [s], of which in stages that compute without
    evaluations, and what its stages had."""

    run: str
    seconds: float
    computing: float
    stages: list[EstimatedStage]


def estimate(reader: sa.Connection, campaign: Campaign, catalogue: Catalogue, pace: Pace) -> Estimate:
    """The numbers of the newest run of the same campaign, or else the range of such runs; the most of any run.

    pace: of a scenario, what its evaluations and its other stages take.
    """
    stages, earlier = expected(campaign, catalogue), _earlier(reader, campaign)
    evaluations, promise = total(stages), bounded(campaign, most(campaign))
    if campaign.simulator is None:
        time = _scaled(pace, evaluations)
    else:
        time = _simulated(reader, campaign, catalogue, evaluations)
    if earlier is not None:
        return _as_before(earlier, campaign, time, promise)
    return Estimate(
        evaluations=evaluations.usual,
        least=evaluations.least,
        most=evaluations.most,
        stages=[EstimatedStage(**stage._asdict()) for stage in stages],
        statement=" ".join([AFTERWARDS, *_fewer(campaign, stages), promise]),
        run=None,
        **time._asdict(),
    )


def bounded(campaign: Campaign, most: int) -> str:
    """What no run exceeds, and why validation takes more than the searches where they are few."""
    total, needed = validation(campaign).total, least(campaign, noisy=True)
    onward = beyond(bound(campaign), campaign)
    validated = f"{total:,}" + (FEW if total == needed else "") + (LATER.format(onward=onward) if onward else "")
    return PROMISE.format(most=f"{most:,}", called=called(campaign, most), validation=validated)


def _fewer(campaign: Campaign, stages: list[Expected]) -> list[str]:
    """When stages have fewer evaluations than the usual number, sentences."""
    found = [(stage.title, fewer(campaign, stage.kind)) for stage in stages]
    return [f"{title} takes {shorter.when}." for title, shorter in found if shorter is not None]


def _as_before(earlier: _Earlier, campaign: Campaign, time: _Time, promise: str) -> Estimate:
    """What an earlier run took, and what none exceeds. Of a scenario, the time with all evaluations is that at
    its speed; of a simulator as of any run of it, where it is known."""
    run, seconds, stages = earlier.run, earlier.seconds, earlier.stages
    had, end = sum(stage.evaluations for stage in stages), most(campaign)
    if campaign.simulator is None:
        longest: float | None = earlier.computing + (seconds - earlier.computing) * end / had
        statement = TIME_AS_BEFORE.format(run=run, scaled=SCALED)
    else:
        longest = None if time.seconds_most is None else max(seconds, time.seconds_most)
        known = "" if longest is None else f" {time.time_statement}"
        statement = TIME_AS_BEFORE.format(run=run, scaled="") + known
    return Estimate(
        evaluations=had,
        least=had,
        most=end,
        stages=stages,
        statement=f"{AS_BEFORE.format(run=run, evaluations=f'{had:,}')} {promise}",
        run=run,
        seconds=seconds,
        seconds_least=seconds,
        seconds_most=longest,
        time_statement=statement,
        untimed=[],
    )


def _scaled(pace: Pace, evaluations: Total) -> _Time:
    """A time at the speed of earlier runs; none with all evaluations where a stage is not part of it."""
    time = pace.about(evaluations.usual)
    if time is None:
        return _Time(None, None, None, UNKNOWN, pace.untimed)
    statement = " ".join([SPEED, *pace.sentences])
    return _Time(time, pace.about(evaluations.least), pace.whole(evaluations.most), statement, pace.untimed)


def _earlier(reader: sa.Connection, campaign: Campaign) -> _Earlier | None:
    """The newest finished run of exactly this campaign that began from nothing."""
    done = (Run.campaign_digest == campaign.digest, Run.state == RunState.DONE)
    same = (*done, Run.removed.is_(None), Run.continues.is_(None))
    run_id = reader.scalar(sa.select(Run.id).where(*same, Run.purged.is_(None)).order_by(Run.id.desc()).limit(1))
    if run_id is None:
        return None
    evaluations = (Stage.evaluations + Stage.counted).label("evaluations")
    columns = sa.select(Stage.kind, evaluations, Stage.seconds)
    found: dict[str, int] = {}
    seconds, computes, other = 0.0, 0.0, computing(campaign)
    for row in reader.execute(columns.where(Stage.run_id == run_id).order_by(Stage.position)):
        found[row.kind] = found.get(row.kind, 0) + row.evaluations
        seconds += row.seconds
        computes += row.seconds if row.kind in other else 0.0
    return _Earlier(run_name(run_id), seconds, computes, _stages(campaign, found)) if sum(found.values()) else None


def _stages(campaign: Campaign, found: dict[str, int]) -> list[EstimatedStage]:
    """The evaluations of an earlier run by kind, with what each takes at most."""
    titles = {kind: stage.title for kind, stage in declared().items()}
    limits: dict[str, int] = {}
    for stage in bound(campaign):
        limits[stage.kind] = limits.get(stage.kind, 0) + stage.evaluations
    return [
        EstimatedStage(kind=k, title=titles.get(k, k.capitalize()), evaluations=n, least=n, most=limits.get(k, n))
        for k, n in found.items()
    ]


def _simulated(reader: sa.Connection, campaign: Campaign, catalogue: Catalogue, evaluations: Total) -> _Time:
    """The time on as many slots as the newest measurement of the simulator had, which the sentence names."""
    assert campaign.simulator is not None
    name, calls, retries = campaign.simulator.name, campaign.simulator.calls, campaign.simulator.retries
    entry = catalogue.simulator(name)
    cost = None if entry is None else costs.newest(reader, entry, catalogue.digests.get(name))[0]
    if cost is None:
        measure = f"`clearance check-simulator {name} --data DIR` measures an evaluation for the service of that folder"
        statement = f"The time is not known yet: {measure}, and so does the first stage of a run."
        return _Time(None, None, None, statement, [])
    again = made_again(campaign, catalogue, cost.noisy, entry is not None and entry.step is not None)
    usual, statement = cost.lasts(evaluations.usual, calls, again, retries)
    return _Time(usual, *cost.bounds(evaluations.least, evaluations.most, calls, retries), statement, [])
