"""Writes a result: the folder of `clearance run --out`, and the report of the service."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path

import sqlalchemy as sa

from backend.db import queue
from backend.db.engine import connected, migrate, now, read, write
from backend.db.store import PATIENCE, RunStore
from campaigns.stages.found import declared
from campaigns.stages.plan import most
from clearance.function.origin import Origin
from clearance.local import RESULT
from clearance.local.citation import named
from clearance.local.results import of_others, write_results
from clearance.local.summary import summary
from worker.running.runs import identity


def save(origin: Origin, folder: Path) -> Path:
    """Write everything into the folder, which is made if there is none; raises OSError if it cannot be written, or has
    files of others that would be replaced."""
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / RESULT).exists() and (others := of_others(folder)):
        raise FileExistsError(
            f"{', '.join(others)} in {folder} would be replaced, and no {RESULT} shows that an earlier result wrote "
            "that; give another folder, or delete what may be replaced"
        )
    assert origin.store.verdict is not None
    result = summary(origin.campaign, origin.store, origin.store.verdict)
    if origin.cites is not None:
        result["continues"] = origin.cites
    write_results(folder, origin.campaign, origin.store, result, origin.problem, origin.known)
    return folder


def report(origin: Origin, file: Path) -> Path:
    """Write the report; the run is stored in a temporary database, from which the service makes it."""
    with tempfile.TemporaryDirectory(prefix="clearance-report-", ignore_cleanup_errors=True) as folder:
        url = f"sqlite:///{Path(folder) / 'run.db'}"
        migrate(url)
        with connected(url) as engine:
            page = _page(engine, origin)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(page, encoding="utf-8")
    return file


def _page(engine: sa.Engine, origin: Origin) -> str:
    from backend.reports.service import report_html

    campaign, store = origin.campaign, origin.store
    submitted = partial(
        queue.submit, campaign=campaign, name=campaign.name, tags=campaign.tags, owner="clearance.search",
        planned=most(campaign), catalogue=origin.known, seed=store.sample_seed,
    )  # fmt: skip
    run = write(engine, submitted, PATIENCE)
    claim = queue.Queue(engine).claim("clearance.search", origin.known.versions)
    assert claim is not None
    stored = RunStore(engine, claim)
    stored.plan([record.plan for record in store.stages])
    assert store.versions is not None
    assert store.verdict is not None
    stored.record_versions(store.versions, identity.code(campaign))
    if store.sources is not None:
        stored.record_sources(*store.sources)
    for position, record in enumerate(store.stages):
        stored.begin(position)
        columns = store.evaluations(position)
        if columns is not None:
            stored.append(position, 0, columns)
        assert record.result is not None
        findings = store.findings if declared()[record.plan.kind].of_findings else ()
        stored.finish(position, record.result, record.seconds, findings)
    stored.conclude(store.verdict)
    extends = None if origin.cites is None else named(origin.cites)
    with read(engine) as reader:
        return report_html(reader, run, now(reader), Path("no fonts"), extends).html
