"""Data for `tests.bench.pages`: a real run with 100,000 evaluations, 10,000 stored runs, and active runs.

Everything goes through the store that workers write to, but the copies of a run in the list.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
import sqlalchemy as sa

from backend.db.engine import now
from backend.db.queue import Claim, Queue, submit
from backend.db.store import RunStore
from backend.db.tables import CatalogueDocument, Run
from campaigns import Campaign, library, load_file
from campaigns.stored.records import Columns, StagePlan
from tests import results
from worker.running.catalogue.installed import catalogue
from worker.running.runs.runner import execute

LARGE = "uav_aca"
"""Case 5: six uncertain parameters, five searches."""
BUDGETS = {"direct": 45_000, "sqp": 2_000, "monte_carlo": 30_000, "portfolio": 25_000, "genetic": 5_000}

GROWING = "unicycle_static"
PERIOD, CHUNK = 0.25, 2_000
"""Interval [s] and number of evaluations stored by each active run: together the rate of two cores."""
LEASE = 3600.0
"""Nobody beats for these runs [s]."""


def publish(engine: sa.Engine) -> None:
    """The catalogue, as a worker does when it starts."""
    with engine.begin() as connection:
        document = catalogue().model_dump(mode="json")
        connection.execute(sa.insert(CatalogueDocument).values(id=1, document=document, published=now(connection)))


def flown(engine: sa.Engine, budgets: Mapping[str, int] = BUDGETS) -> int:
    """A finished run of case 5 with these evaluations of every method; returns its number."""
    document = load_file(library()[LARGE]).document()
    for stage in document["stages"]["search"]:
        stage["evaluations"] = budgets[stage["method"]]
        if stage["method"] == "direct":
            stage["options"]["iterations"] = 1_000_000
    claim = claimed(engine, Campaign.model_validate(document), "A hundred thousand evaluations")
    execute(claim_campaign(claim), RunStore(engine, claim))
    with engine.connect() as connection:
        evaluations = connection.scalar(sa.select(Run.evaluations).where(Run.id == claim.run_id)) or 0
    least = 0.95 * sum(budgets.values())
    assert evaluations >= least, f"{evaluations} evaluations, not {least}: raise the budgets"
    return claim.run_id


def claim_campaign(claim: Claim) -> Campaign:
    """The campaign of a claim."""
    return Campaign.model_validate(claim.document)


def copies(engine: sa.Engine, run_id: int, count: int) -> None:
    """More runs like a finished one, with other names, tags, owners, verdicts and values."""
    names = [column.name for column in Run.__table__.columns if column.name != "id"]
    verdicts = ("cleared", "violated", "inconclusive")
    random = np.random.default_rng(1)
    with engine.begin() as writer:
        kept = writer.execute(sa.select(*(Run.__table__.c[name] for name in names)).where(Run.id == run_id)).one()
        row = dict(zip(names, kept, strict=True))
        varied = [
            {
                "name": f"Release {i // 100}.{i % 100}",
                "tags": [f"release-{i // 1000}", ("nightly", "baseline")[i % 2]],
                "owner": ("ada", "grace", "katherine")[i % 3],
                "verdict": verdicts[i % 7 % 3],
                "worst_cost": 45.0 + 20.0 * share,
                "created": row["created"] - 60.0 * (count - i),
                "pinned": i % 2000 == 0,
            }
            for i, share in enumerate(random.random(count).tolist())
        ]
        writer.execute(sa.insert(Run), [row | change for change in varied])


@contextmanager
def growing(engine: sa.Engine, count: int) -> Iterator[list[int]]:
    """So many runs in their search stage, whose stored evaluations grow for as long as the block lasts."""
    campaign = load_file(library()[GROWING])
    claims = [claimed(engine, campaign, f"Growing {i}") for i in range(count)]
    stores = [RunStore(engine, claim) for claim in claims]
    for store in stores:
        store.plan([StagePlan("nominal", None, 1), StagePlan("search", "direct", 10_000_000)])
        store.begin(0)
        store.finish(0, results.nominal(0.94), 0.01)
        store.begin(1)
    ended = threading.Event()
    writer = threading.Thread(target=_grow, args=(stores, len(campaign.uncertain), ended), daemon=True)
    writer.start()
    try:
        yield [claim.run_id for claim in claims]
    finally:
        ended.set()
        writer.join()
        for claim in claims:
            Queue(engine).fail(claim, "the measurement is over")


def _grow(stores: list[RunStore], dimension: int, ended: threading.Event) -> None:
    random = np.random.default_rng(2)
    for turn in range(1_000_000):
        for store in stores:
            costs = 0.9 + 0.05 * random.random((CHUNK, 1))
            seconds = PERIOD * (turn + (1 + np.arange(CHUNK)) / CHUNK)
            columns = Columns(random.random((CHUNK, dimension)), costs, np.zeros(CHUNK, np.uint8), seconds, {})
            store.append(1, turn * CHUNK, columns)
        if ended.wait(PERIOD):
            return


def claimed(engine: sa.Engine, campaign: Campaign, name: str) -> Claim:
    """The claim of a new run, whose lease outlasts the measurement."""
    with engine.begin() as connection:
        submit(connection, campaign, name=name, tags=[], owner="ada", planned=0)
    claim = Queue(engine, LEASE).claim("bench")
    assert claim is not None
    return claim
