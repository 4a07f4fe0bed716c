"""What a run of a campaign usually takes: evaluations and time, and where both are known from."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import sqlalchemy as sa

from backend.catalog.schemas import Estimate, EstimatedStage
from backend.db import costs
from backend.db.tables import Run, Stage
from campaigns import Campaign, Catalogue
from campaigns.asked.allowance import least, validation
from campaigns.checked.expected import Total, called, expected, total
from campaigns.checked.expected import again as made_again
from campaigns.runs import RunState, run_name
from campaigns.stages.found import declared
from campaigns.stages.plan import bound, most

USUAL = (
    "How soon searches end by their own rule, how many worst cases there are and how long the descents to them take is "
    "known only afterwards. No run takes more than {most} evaluations{called}, those made again to confirm results and "
    "to replace excluded samples included; validation takes at most {validation}."
)
FEW = ", which the nominal case and one finding need, whatever the budget"
UNKNOWN = "The time is known after a first run of the same components."
SPEED = "The time is that of earlier runs with the same components."


class _Time(NamedTuple):
    """Of the usual number of evaluations, of the least and of the most [s], and where it is known from."""

    seconds: float | None
    seconds_least: float | None
    seconds_most: float | None
    time_statement: str


def estimate(
    reader: sa.Connection, campaign: Campaign, catalogue: Catalogue, seconds: Callable[[int], float | None]
) -> Estimate:
    """The numbers of the newest run of the same campaign, or else the range of such runs.

    seconds: the working time of so many evaluations of a scenario; None if unknown.
    """
    earlier = _earlier(reader, campaign)
    if earlier is not None:
        run, seconds_had, stages = earlier
        had = sum(stage.evaluations for stage in stages)
        time = _Time(seconds_had, seconds_had, None, f"The time is that of {run}.")
        return Estimate(
            evaluations=had,
            least=had,
            most=most(campaign),
            stages=stages,
            statement=f"As in {run}, an earlier run of this campaign.",
            run=run,
            **time._asdict(),
        )
    found = expected(campaign, catalogue)
    stages, evaluations = [EstimatedStage(**stage._asdict()) for stage in found], total(found)
    if campaign.simulator is None:
        time = _scaled(seconds, evaluations)
    else:
        time = _simulated(reader, campaign, catalogue, evaluations)
    return Estimate(
        evaluations=evaluations.usual,
        least=evaluations.least,
        most=evaluations.most,
        stages=stages,
        statement=bounded(campaign, evaluations.most),
        run=None,
        **time._asdict(),
    )


def bounded(campaign: Campaign, most: int) -> str:
    """What no run exceeds, and why validation takes more than the searches where they are few."""
    total, needed = validation(campaign).total, least(campaign, noisy=True)
    validated = f"{total:,}" + (FEW if total == needed else "")
    return USUAL.format(most=f"{most:,}", called=called(campaign, most), validation=validated)


def _scaled(seconds: Callable[[int], float | None], evaluations: Total) -> _Time:
    """A time at the speed of earlier runs, which is that of the usual number of evaluations."""
    time = seconds(evaluations.usual)
    if time is None:
        return _Time(None, None, None, UNKNOWN)
    each = time / evaluations.usual
    return _Time(time, each * evaluations.least, each * evaluations.most, SPEED)


def _earlier(reader: sa.Connection, campaign: Campaign) -> tuple[str, float, list[EstimatedStage]] | None:
    """The newest finished run of exactly this campaign that began from nothing: its name, time [s] and stages."""
    done = (Run.campaign_digest == campaign.digest, Run.state == RunState.DONE)
    same = (*done, Run.removed.is_(None), Run.continues.is_(None))
    run_id = reader.scalar(sa.select(Run.id).where(*same, Run.purged.is_(None)).order_by(Run.id.desc()).limit(1))
    if run_id is None:
        return None
    evaluations = (Stage.evaluations + Stage.counted).label("evaluations")
    columns = sa.select(Stage.kind, evaluations, Stage.seconds)
    found: dict[str, int] = {}
    seconds = 0.0
    for row in reader.execute(columns.where(Stage.run_id == run_id).order_by(Stage.position)):
        found[row.kind] = found.get(row.kind, 0) + row.evaluations
        seconds += row.seconds
    titles = {kind: stage.title for kind, stage in declared().items()}
    limits: dict[str, int] = {}
    for stage in bound(campaign):
        limits[stage.kind] = limits.get(stage.kind, 0) + stage.evaluations
    stages = [
        EstimatedStage(kind=k, title=titles.get(k, k.capitalize()), evaluations=n, least=n, most=limits.get(k, n))
        for k, n in found.items()
    ]
    return (run_name(run_id), seconds, stages) if sum(found.values()) else None


def _simulated(reader: sa.Connection, campaign: Campaign, catalogue: Catalogue, evaluations: Total) -> _Time:
    """The time on as many slots as the newest measurement of the simulator had, which the sentence names."""
    assert campaign.simulator is not None
    name, calls = campaign.simulator.name, campaign.simulator.calls
    entry = catalogue.simulator(name)
    cost = None if entry is None else costs.newest(reader, entry, catalogue.digests.get(name))[0]
    if cost is None:
        measure = f"`clearance check-simulator {name} --data DIR` measures an evaluation for the service of that folder"
        return _Time(None, None, None, f"The time is not known yet: {measure}, and so does the first stage of a run.")
    again = made_again(campaign, catalogue, cost.noisy, entry is not None and entry.step is not None)
    usual, statement = cost.lasts(evaluations.usual, calls, again)
    return _Time(usual, *cost.bounds(evaluations.least, evaluations.most, calls), statement)
