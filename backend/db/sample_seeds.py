"""The seed of a run's independent sample where other runs have it, too: whether it still counts as drawn.

Whoever knows the points of a sample may write code that passes them. A seed is therefore new only to the code for which
it was drawn; to run that code once more with it repeats a run. Read `settle`.
"""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import CampaignRow, Run
from campaigns.identity.identity import identity_of, simulator_of, unsound
from campaigns.runs import RunState
from campaigns.sample_seed import SampleSeed
from campaigns.versions import Versions


def requested(reader: sa.Connection, campaign_digest: str, seed: int) -> SampleSeed:
    """The seed that a launch states; it counts as drawn if an earlier run of the campaign with a verdict drew it."""
    drawn = sa.select(Run.id).where(
        Run.campaign_digest == campaign_digest,
        Run.sample_seed == seed,
        Run.sample_seed_stated.is_(False),
        Run.state == RunState.DONE,
        Run.verdict.is_not(None),
    )
    return SampleSeed(seed, stated=reader.scalar(drawn.limit(1)) is None)


def settle(reader: sa.Connection, run_id: int, here: Versions) -> SampleSeed | None:
    """The seed for a run that begins with this code, if not the one that it has.

    A run that continues another gets a new one; where the launch had requested it, it counts as stated.
    """
    own = sa.select(Run.sample_seed, Run.sample_seed_stated, Run.continues).where(Run.id == run_id)
    seed, stated, continues = reader.execute(own).one()
    if seed is None or stated or not _of_other_code(reader, run_id, seed, here):
        return None
    return SampleSeed(seed) if continues is None else SampleSeed.drawn()


def again(reader: sa.Connection, run_id: int) -> SampleSeed | None:
    """The seed for a run that begins again, whose points may be known by now; None if it was requested or is that of an
    earlier run, which `settle` judges, or if none was stored."""
    seed, stated = reader.execute(sa.select(Run.sample_seed, Run.sample_seed_stated).where(Run.id == run_id)).one()
    repeats = seed is not None and reader.scalar(_drawn_before(run_id, seed)) is not None
    return None if seed is None or stated or repeats else SampleSeed.drawn()


def _of_other_code(reader: sa.Connection, run_id: int, seed: int, here: Versions) -> bool:
    """Whether the run for which the seed was drawn did not evaluate as this code does, or may not have."""
    first = sa.select(Run.flown, CampaignRow.document).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    found = reader.execute(first.where(Run.id.in_(_drawn_before(run_id, seed)))).first()
    if found is None:
        return False
    then, simulator = Versions.of(found.flown), simulator_of(found.document)
    return bool(then.command or unsound(identity_of(then, simulator), identity_of(here, simulator)))


def _drawn_before(run_id: int, seed: int) -> sa.Select[int]:
    """The first run for which the seed was drawn, if it has begun and is an earlier one: a later one only names it."""
    drawn = (Run.sample_seed == seed, Run.sample_seed_stated.is_(False), Run.id < run_id, Run.flown.is_not(None))
    return sa.select(Run.id).where(*drawn).order_by(Run.id).limit(1)
