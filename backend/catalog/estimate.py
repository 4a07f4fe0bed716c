"""What a run of a campaign usually takes: evaluations and time, and where both are known from. Start at `estimate`."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import sqlalchemy as sa

from backend.catalog.schemas import Estimate, EstimatedStage
from backend.db import costs
from backend.db.tables import Run, Stage
from campaigns import Campaign, Catalogue
from campaigns.checked.expected import again as made_again
from campaigns.checked.expected import boundary, expected
from campaigns.runs import run_name
from campaigns.stages.found import declared

USUAL = (
    "An estimate: searches may end earlier by their own rule, the number of worst cases is not known in advance, and "
    "each that violates adds about {boundary} evaluations."
)
UNKNOWN = "The time is known after a first run of the same components."
SPEED = "The time is that of earlier runs with the same components."


class _Earlier(NamedTuple):
    run: str
    seconds: float
    stages: list[EstimatedStage]


def estimate(
    reader: sa.Connection, campaign: Campaign, catalogue: Catalogue, seconds: Callable[[int], float | None]
) -> Estimate:
    """As in the newest run of the same campaign, or else as such runs usually are.

    seconds: the working time of so many evaluations of a scenario; None if unknown.
    """
    earlier = _earlier(reader, campaign.digest)
    if earlier is not None:
        said = f"As in {earlier.run}, an earlier run of this campaign."
        return _estimate(earlier.stages, said, earlier.seconds, f"The time is that of {earlier.run}.", earlier.run)
    stages = [EstimatedStage(**stage._asdict()) for stage in expected(campaign)]
    total = sum(stage.evaluations for stage in stages)
    if campaign.simulator is None:
        time = seconds(total)
        time_said = UNKNOWN if time is None else SPEED
    else:
        time, time_said = _simulated(reader, campaign, catalogue, total)
    return _estimate(stages, USUAL.format(boundary=boundary(campaign)), time, time_said, None)


def _estimate(
    stages: list[EstimatedStage], said: str, seconds: float | None, time_said: str, run: str | None
) -> Estimate:
    total = sum(stage.evaluations for stage in stages)
    return Estimate(evaluations=total, stages=stages, said=said, seconds=seconds, time_said=time_said, run=run)


def _earlier(reader: sa.Connection, digest: str) -> _Earlier | None:
    """The newest finished run of exactly this campaign that began from nothing."""
    same = (Run.campaign_digest == digest, Run.state == "done", Run.removed.is_(None), Run.continues.is_(None))
    run_id = reader.scalar(sa.select(Run.id).where(*same, Run.purged.is_(None)).order_by(Run.id.desc()).limit(1))
    if run_id is None:
        return None
    columns = sa.select(Stage.kind, Stage.evaluations, Stage.seconds)
    found: dict[str, int] = {}
    seconds = 0.0
    for row in reader.execute(columns.where(Stage.run_id == run_id).order_by(Stage.position)):
        found[row.kind] = found.get(row.kind, 0) + row.evaluations
        seconds += row.seconds
    titles = {kind: stage.title for kind, stage in declared().items()}
    stages = [EstimatedStage(kind=k, title=titles.get(k, k.capitalize()), evaluations=n) for k, n in found.items()]
    return _Earlier(run_name(run_id), seconds, stages) if sum(found.values()) else None


def _simulated(
    reader: sa.Connection, campaign: Campaign, catalogue: Catalogue, evaluations: int
) -> tuple[float | None, str]:
    """The time on as many slots as the newest measurement of the simulator had, which the sentence names."""
    assert campaign.simulator is not None
    name, calls = campaign.simulator.name, campaign.simulator.calls
    entry = catalogue.simulator(name)
    cost = None if entry is None else costs.newest(reader, entry, catalogue.digests.get(name))[0]
    if cost is None:
        measure = f"`clearance check-simulator {name} --data DIR` measures an evaluation for the service of that folder"
        return None, f"The time is not known yet: {measure}, and so does the first stage of a run."
    again = made_again(campaign, cost.noisy, entry is not None and entry.step is not None)
    return cost.lasts(evaluations, calls, again)
