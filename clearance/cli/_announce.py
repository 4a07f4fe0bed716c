"""What a run takes at most, and what bars "cleared", announced by `clearance run`; of a measured simulator the expected
time as well."""

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
    """Print the bound of the run on standard error, and what bars "cleared" whatever the run finds.

    Of a simulator of which the database has a measurement as it is now, the time as well, and where it is known from.
    """
    from campaigns.checked.expected import at_most
    from campaigns.checked.foreseen import foreseen
    from campaigns.stages.plan import most
    from worker.running.catalogue.installed import catalogue

    bound, found = at_most(campaign, most(campaign)), _measured(campaign, data, database)
    time = "." if found is None else f"; {_time(campaign, *found)}"
    typer.echo(f"{bound}{time}", err=True)
    for each in foreseen(campaign, catalogue()):
        typer.echo(f"Warning: {each.statement}", err=True)


def _time(campaign: Campaign, cost: Cost, halved: bool, installed: Catalogue) -> str:
    from campaigns.asked.proposal import lasting
    from campaigns.checked.expected import again, expected, total

    assert campaign.simulator is not None
    evaluations = total(expected(campaign, installed))
    calls, retries = campaign.simulator.calls, campaign.simulator.retries
    more = again(campaign, installed, cost.noisy, halved)
    seconds, known = cost.lasts(evaluations.usual, calls, more, retries)
    longest = lasting(cost.bounds(evaluations.least, evaluations.most, calls, retries)[1])
    return f"about {lasting(seconds)}, about {longest} with all evaluations at this speed. {known}"


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
