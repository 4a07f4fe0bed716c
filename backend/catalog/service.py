"""The catalogue that the workers publish, and the check of campaigns against it."""

from __future__ import annotations

import functools
import hashlib
import json
import logging
import math

import sqlalchemy as sa
from pydantic import ValidationError

from backend.catalog.estimate import estimate
from backend.catalog.pace import Pace
from backend.catalog.schemas import Checked, CheckedParameter, Foreseen, LibraryCampaign, PredictedBound, ProblemOut
from backend.db import snapshots
from backend.db.engine import once
from backend.db.tables import CatalogueDocument
from backend.http.errors import RefusedError, not_found
from backend.http.versions import readable
from campaigns import Campaign, CampaignError, Catalogue, Problem, check, library, load_file
from campaigns.asked.text import readable_yaml
from campaigns.checked import prediction
from campaigns.checked.check import parameters
from campaigns.checked.foreseen import foreseen
from campaigns.results.drawn import library_flights
from campaigns.runs import run_name
from campaigns.stages.plan import most
from campaigns.version import VERSION

_log = logging.getLogger(__name__)

NO_CATALOGUE = (
    "no worker has published its components yet, so campaigns cannot be checked: start a worker with `clearance worker`"
    " and try again in a few seconds"
)


def published(reader: sa.Connection) -> Catalogue | None:
    """The catalogue of the newest worker; None if none has started, or if this version cannot read it."""
    found = _found(_stored(reader))
    return found if isinstance(found, Catalogue) else None


def published_digest(reader: sa.Connection) -> str:
    """The digest of the published catalogue, for what states it: a simulator's files change it without a new time."""
    return hashlib.sha256((_stored(reader) or "").encode()).hexdigest()


def _stored(reader: sa.Connection) -> str | None:
    of = sa.select(sa.cast(CatalogueDocument.document, sa.Text)).order_by(CatalogueDocument.published.desc()).limit(1)
    return once(reader, "published", lambda: reader.scalar(of))


@functools.lru_cache(maxsize=4)
def _found(text: str | None) -> Catalogue | str:
    """The catalogue, or the sentence that states why there is none.

    Cached: a live page needs it several times a second, and it is the largest document.
    """
    if text is None:
        return NO_CATALOGUE
    try:
        return Catalogue.model_validate_json(text)
    except ValidationError as error:
        sentence = _unreadable(text)
        _log.warning("%s (%s)", sentence, " ".join(str(error).split())[:500])
        return sentence


def _unreadable(text: str) -> str:
    try:
        document = json.loads(text)
    except ValueError:
        document = None
    stated = document.get("version") if isinstance(document, dict) else None
    known = isinstance(stated, str) and stated != VERSION
    who = f"a worker of version {stated} published them" if known else "another version published them"
    return (
        f"the published components cannot be read by this version of the service, {VERSION}: {who}, or they are "
        f"damaged. Upgrade the service to the version of its workers, or start a worker of version {VERSION}, which "
        "publishes its own"
    )


def snapshot_of(reader: sa.Connection, run_id: int) -> Catalogue | None:
    """The descriptions stored with a run; None without any, 409 if another version stored them in another form."""
    with readable(f"the description of the components of {run_name(run_id)}", reader, run_id):
        return snapshots.of_run(reader, run_id)


def described(reader: sa.Connection, run_id: int) -> Catalogue | None:
    """The descriptions of a run's components: those stored with it, or for earlier runs the current ones."""
    return snapshot_of(reader, run_id) or published(reader)


def required(reader: sa.Connection) -> Catalogue:
    """The catalogue, or 503 if there is none that this version can read."""
    found = _found(_stored(reader))
    if isinstance(found, str):
        raise RefusedError("no-catalogue", found, headers={"Retry-After": "2"})
    return found


def library_campaigns(reader: sa.Connection) -> list[LibraryCampaign]:
    """All shipped campaigns, with the problems that prevent this installation from running them."""
    return list(_library(_stored(reader)))


@functools.lru_cache(maxsize=4)
def _library(text: str | None) -> tuple[LibraryCampaign, ...]:
    """Cached: each is checked against the whole catalogue, and every form reads all of them."""
    found = _found(text)
    return tuple(_library_campaign(name, found) for name in library())


def library_campaign(reader: sa.Connection, name: str) -> LibraryCampaign:
    """One shipped campaign, or 404."""
    if name not in library():
        raise not_found("campaign in the library called", name)
    return _library_campaign(name, _found(_stored(reader)))


def _library_campaign(name: str, catalogue: Catalogue | str) -> LibraryCampaign:
    """catalogue: or the sentence that states why there is none."""
    campaign, text = _shipped(name)
    problems = [Problem("", "", catalogue)] if isinstance(catalogue, str) else check(campaign, catalogue)
    flight = library_flights().get(name)
    return LibraryCampaign(
        id=name,
        digest=campaign.digest,
        document=campaign.document(),
        yaml=text,
        problems=_out(problems),
        nominal=flight if flight is not None and flight.digest == campaign.digest else None,
    )


@functools.lru_cache(maxsize=64)
def _shipped(name: str) -> tuple[Campaign, str]:
    path = library()[name]
    return load_file(path), path.read_text(encoding="utf-8")


def checked(reader: sa.Connection, campaign: Campaign | CampaignError) -> Checked:
    """The parsed campaign, or all its errors; stores nothing."""
    if isinstance(campaign, CampaignError):
        return Checked(
            ok=False,
            problems=_out(campaign.problems),
            digest=None,
            document=None,
            yaml=None,
            parameters=[],
            evaluations=None,
            seconds=None,
            estimate=None,
        )
    catalogue = required(reader)
    problems, pace = check(campaign, catalogue), Pace.of(reader, campaign)
    evaluations = most(campaign)
    return Checked(
        ok=not problems,
        problems=_out(problems),
        digest=campaign.digest,
        document=campaign.document(),
        yaml=readable_yaml(campaign),
        parameters=_parameters(campaign, catalogue),
        evaluations=evaluations,
        seconds=pace.whole(evaluations),
        estimate=None if problems else estimate(reader, campaign, catalogue, pace),
        predicted_bound=None if problems else _predicted(campaign, catalogue),
        foreseen=[]
        if problems
        else [Foreseen(code=each.code, statement=each.statement) for each in foreseen(campaign, catalogue)],
    )


def _predicted(campaign: Campaign, catalogue: Catalogue) -> PredictedBound | None:
    found = prediction.predicted(campaign, catalogue)
    if found is None:
        return None
    warning = prediction.warning(found, campaign)
    return PredictedBound(
        source=found.source,
        samples=found.samples,
        outside=found.outside,
        upper_bound=found.upper_bound,
        statement=found.statement,
        warning=warning,
    )


def _out(problems: list[Problem]) -> list[ProblemOut]:
    return [ProblemOut(field=p.field, given=p.given, message=p.message) for p in problems]


def _parameters(campaign: Campaign, catalogue: Catalogue) -> list[CheckedParameter]:
    found = []
    for path, (entry, nominal) in parameters(campaign, catalogue).items():
        known = math.isfinite(nominal)
        low = high = None
        if path in campaign.uncertain and (known or campaign.uncertain[path].plus_minus is None):
            low, high = campaign.uncertain[path].interval(nominal)
        found.append(CheckedParameter(path=path, entry=entry, nominal=nominal if known else None, low=low, high=high))
    return found


def bounds(campaign: Campaign, catalogue: Catalogue | None) -> dict[str, tuple[float, float, float]]:
    """Nominal value, low and high of each uncertain parameter, in the campaign's order.

    Paths that are not in this catalogue are omitted.
    """
    known = {} if catalogue is None else parameters(campaign, catalogue)
    found = {}
    for path, uncertain in campaign.uncertain.items():
        if path in known:
            nominal = known[path][1]
            found[path] = (nominal, *uncertain.interval(nominal))
    return found
