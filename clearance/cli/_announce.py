"""What a run of a simulator is expected to take, announced by `clearance run` where an evaluation has been measured."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from clearance.cli._where import existing_url_of, reading

if TYPE_CHECKING:
    from campaigns import Campaign, Catalogue
    from campaigns.asked.proposal import Cost

PATIENCE = "2"
"""Time to wait for a database server [s]: the estimate is an aid, and a run needs no database."""


def announce(campaign: Campaign, data: Path, database: str) -> None:
    """Print the number of evaluations and their time on standard error, and where the time is known from.

    Nothing is printed of a scenario, or if the database has no measurement of the simulator as it is now.
    """
    from campaigns.asked.proposal import lasting
    from campaigns.checked.expected import again, called, expected, total

    found = _measured(campaign, data, database)
    if found is None or campaign.simulator is None:
        return
    cost, halved, installed = found
    evaluations = total(expected(campaign, installed))
    calls, retries = campaign.simulator.calls, campaign.simulator.retries
    more = again(campaign, installed, cost.noisy, halved)
    seconds, known = cost.lasts(evaluations.usual, calls, more, retries)
    longest = lasting(cost.bounds(evaluations.least, evaluations.most, calls, retries)[1])
    taken = f"about {lasting(seconds)}, about {longest} for the most evaluations"
    again_called = called(campaign, evaluations.most)
    typer.echo(f"{evaluations.text} evaluations{again_called}; {taken} at this speed. {known}", err=True)


def _measured(campaign: Campaign, data: Path, database: str) -> tuple[Cost, bool, Catalogue] | None:
    """What was measured of its simulator, whether that has a step, which is halved to confirm results, and what is
    installed."""
    import sqlalchemy as sa

    from backend.db import costs
    from clearance.cli import WrongInputError
    from worker.running.catalogue.digests import with_digests
    from worker.running.catalogue.installed import catalogue

    if campaign.simulator is None:
        return None
    name = campaign.simulator.name
    known = with_digests(catalogue())
    entry = known.simulator(name)
    if entry is None:
        return None
    try:
        with reading(_patient(existing_url_of(data, database))) as reader:
            cost = costs.newest(reader, entry, known.digests.get(name))[0]
            return None if cost is None else (cost, entry.step is not None, known)
    # There is no database, which a run does not need, or one of another version, which a run does not migrate.
    except (WrongInputError, sa.exc.SQLAlchemyError):
        return None


def _patient(url: str) -> str:
    import sqlalchemy as sa

    parsed = sa.make_url(url)
    if parsed.get_backend_name() == "sqlite":
        return url
    return parsed.update_query_dict({"connect_timeout": PATIENCE}).render_as_string(hide_password=False)
