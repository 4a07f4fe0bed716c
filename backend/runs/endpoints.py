"""POST and GET /runs, one run, its stages, cancellation, removal."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import sqlalchemy as sa
from fastapi import APIRouter, Depends, Query, Request, Response, status
from fastapi.concurrency import run_in_threadpool

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly, Work
from backend.db.engine import read
from backend.http import bodies
from backend.http.deps import ROOM, Engine, Reader, account, capacities
from backend.http.errors import answers, located, problems
from backend.http.keys import Key
from backend.http.matches import TAGGED, IfMatch, require_match
from backend.http.root import at
from backend.http.schema import RunName
from backend.runs import edits, listing, onward, removal, reuse, service, submission, texts
from backend.runs.address import AddressParts, FromAddress
from backend.runs.code import changes
from backend.runs.components import components
from backend.runs.facets import facets
from backend.runs.filters import Listed
from backend.runs.requests import Reason, RunEdit, RunsNamed, RunsRemoved, RunSubmit
from backend.runs.schemas import (
    CodeChanges,
    HistoryEntry,
    RunComponents,
    RunDetail,
    RunFacets,
    RunPage,
    RunSubmitted,
    RunSummary,
    StageDetail,
)
from campaigns.runs import run_name

router = APIRouter(tags=["runs"])

LOCATION = located("The run that was queued, now or earlier with the same key, or the one that is reused.", "run")
CONTINUED = located("The new run.", "run")
CAMPAIGN_FILE = answers("The text as it was submitted, else YAML.", "application/yaml")


@router.post(
    "/runs",
    status_code=status.HTTP_201_CREATED,
    dependencies=ROOM,
    openapi_extra=bodies.of("RunSubmit"),
    responses=LOCATION | problems(*bodies.LAUNCH),
)
async def submit_run(
    request: Request, response: Response, engine: Engine, visitor: CurrentVisitor, parts: FromAddress, key: Key = None
) -> RunSubmitted:
    """Queue a run of a campaign, given as JSON or as YAML; labels, baseline and reuse in the address or in the JSON."""
    yaml = bodies.is_yaml(request)
    body = await request.body()
    submitted = await capacities(request).bodies.run(account(request), lambda: _submission(body, yaml, parts))
    if submitted.request.reuse:
        known = await reuse.compared(engine, submitted.campaign, submitted.request.baseline is not None)
        submitted = replace(submitted, request=submitted.request.model_copy(update={"reuse": known}))
    run = await run_in_threadpool(submission.submit, engine, submitted, visitor, key, request.app.state.quota)
    response.headers["Location"] = at(f"{request.url.path}/{run.id}")
    return run


def _submission(body: bytes, yaml: bool, parts: AddressParts) -> submission.Submission:
    if yaml:
        return submission.from_yaml(body, parts)
    return submission.from_json(body, bodies.described(body, RunSubmit), parts)


@router.get("/runs", responses=problems("bad-cursor"))
def list_runs(reader: Reader, listed: Annotated[Listed, Depends()]) -> RunPage:
    """The runs, in pages, pinned ones first; repeated filters are alternatives, of labels those of one key."""
    return listing.page(reader, listed, listed.sort, listed.cursor, listed.limit)


@router.get("/runs/facets")
def list_facets(reader: Reader) -> RunFacets:
    """The campaigns, tags, owners, methods and labels by which the list can be filtered."""
    return facets(reader)


@router.post("/runs/cancel", responses=problems("not-found", "purged"))
def cancel_runs(named: RunsNamed, engine: Engine, visitor: CurrentVisitor) -> list[RunSummary]:
    """Cancel several runs; those that have ended are unchanged."""
    return edits.cancel(engine, [service.number(run) for run in named.runs], visitor)


@router.post("/runs/remove", responses=problems("not-found", "not-removable", "purged"))
def remove_runs(named: RunsRemoved, engine: Engine, visitor: CurrentVisitor) -> list[RunSummary]:
    """Remove several runs from the lists, all or none; see the removal of one."""
    return removal.remove(engine, [service.number(run) for run in named.runs], named.reason, visitor)


@router.post("/runs/restore", responses=problems("not-found", "purged"))
def restore_runs(named: RunsNamed, engine: Engine, visitor: CurrentVisitor) -> list[RunSummary]:
    """Restore several removed runs to the lists; those that are listed are unchanged."""
    return removal.restore(engine, [service.number(run) for run in named.runs], visitor)


@router.patch(
    "/runs/{run}",
    responses=TAGGED
    | problems("not-found", "notes-changed", "removed", "other-version", "purged", "invalid", "changed"),
)
def edit_run(
    run: RunName, changes: RunEdit, response: Response, engine: Engine, visitor: CurrentVisitor, match: IfMatch = None
) -> RunDetail:
    """Change a run's name, tags, notes or pin; omitted fields stay unchanged."""
    with read(engine) as reader:
        service.detail(reader, service.number(run))  # what cannot be read is refused before anything is changed
    edits.edit(engine, service.number(run), changes, visitor, match)
    with read(engine) as reader:
        response.headers["ETag"] = edits.etag(reader, service.number(run))
        return service.detail(reader, service.number(run))


@router.get("/runs/{run}", responses=TAGGED | problems("not-found", "other-version", "purged"))
def get_run(run: RunName, response: Response, reader: Reader) -> RunDetail:
    """One run with its campaign, the state of its stages, and the parts of its verdict. Its ETag is that of its name,
    tags, notes and pin."""
    response.headers["ETag"] = edits.etag(reader, service.number(run))
    return service.detail(reader, service.number(run))


@router.get(
    "/runs/{run}/campaign.yaml", response_class=Response, responses=CAMPAIGN_FILE | problems("not-found", "purged")
)
def get_run_campaign(run: RunName, request: Request, reader: Reader) -> Response:
    """The campaign of a run as a file: the original text if it was submitted as text, else YAML.

    YAML begins with a comment that names the schema of this service, by which editors complete and check it.
    """
    headers = {"Content-Disposition": f'attachment; filename="{run_name(service.number(run))}-campaign.yaml"'}
    address = request.app.state.settings.public_url.rstrip("/") or str(request.base_url).rstrip("/")
    text = texts.with_schema(texts.text(reader, service.number(run)), address)
    return Response(text, headers=headers, media_type="application/yaml")


@router.post("/runs/{run}/cancel", responses=problems("not-found", "purged"))
def cancel_run(run: RunName, engine: Engine, visitor: CurrentVisitor) -> RunSummary:
    """Cancel a run: queued ones at once, running ones within a second; one that has ended is unchanged."""
    return edits.cancel(engine, [service.number(run)], visitor)[0]


@router.post(
    "/runs/{run}/retry",
    dependencies=ROOM,
    responses=problems("not-found", "not-failed", "removed", "quota-reached", "purged", *ONCE),
)
def retry_run(run: RunName, request: Request, once: OnceOnly, visitor: CurrentVisitor) -> RunSummary:
    """Queue a failed run again: it goes on from its stored evaluations; if none has a value, they are made again."""
    number, quota = service.number(run), request.app.state.quota
    return _once(once, lambda writer: onward.retry(writer, number, visitor, quota))


@router.post(
    "/runs/{run}/restart",
    dependencies=ROOM,
    responses=problems("not-found", "not-waiting", "not-continuable", "no-catalogue", "other-version", "purged", *ONCE),
)
def restart_run(run: RunName, once: OnceOnly, visitor: CurrentVisitor) -> RunSummary:
    """Begin a run again that waits for the code that began it; its evaluations are discarded."""
    return _once(once, lambda writer: onward.restart(writer, service.number(run), visitor))


@router.post(
    "/runs/{run}/continuation",
    status_code=status.HTTP_201_CREATED,
    dependencies=ROOM,
    responses=CONTINUED
    | problems(
        *("not-found", "not-waiting", "not-continuable", "no-catalogue", "other-version", "purged"),
        *("quota-reached", *ONCE),
    ),
)
def continue_run(
    run: RunName, request: Request, response: Response, once: OnceOnly, visitor: CurrentVisitor
) -> RunSummary:
    """Continue a run that waits for the code that began it as a new run, with the evaluations that are still valid."""
    quota = request.app.state.quota
    made = _once(once, lambda writer: onward.carry_on(writer, service.number(run), visitor, quota))
    response.headers["Location"] = at(request.url.path.replace(f"{run}/continuation", made.id))
    return made


@router.delete("/runs/{run}", responses=problems("not-found", "not-removable", "purged", "changed"))
def remove_run(
    run: RunName,
    engine: Engine,
    visitor: CurrentVisitor,
    reason: Annotated[Reason, Query(description="The reason; it is shown wherever the run is requested.")],
    match: IfMatch = None,
) -> RunSummary:
    """Remove a run that has ended from all lists; its address, results and history stay, and it can be restored.

    Refused (409) while it is active, and while it has a valid sign-off. Only `clearance purge`, on the command line,
    deletes removed runs.
    """
    run_id = service.number(run)

    def unchanged(writer: sa.Connection) -> None:
        require_match(match, edits.etag(writer, run_id), run)

    return removal.remove(engine, [run_id], reason, visitor, unchanged)[0]


@router.post("/runs/{run}/restore", responses=problems("not-found", "purged"))
def restore_run(run: RunName, engine: Engine, visitor: CurrentVisitor) -> RunSummary:
    """Restore a removed run to the lists; a run that is not removed is unchanged."""
    return removal.restore(engine, [service.number(run)], visitor)[0]


@router.get("/runs/{run}/stages", responses=problems("not-found", "other-version", "purged"))
def list_stages(run: RunName, reader: Reader) -> list[StageDetail]:
    """The stages of a run with their results."""
    return service.stages(reader, service.number(run))


@router.get("/runs/{run}/components", responses=problems("not-found", "other-version", "purged", "no-catalogue"))
def list_run_components(run: RunName, reader: Reader) -> RunComponents:
    """The description of a run's components and methods when it was submitted, and its differences from now."""
    return components(reader, service.number(run))


@router.get("/runs/{run}/code", responses=problems("not-found", "other-version", "purged"))
def compare_code(
    run: RunName, against: Annotated[str, Query(description="Another run, R-0001.", max_length=20)], reader: Reader
) -> CodeChanges:
    """The source files in which the code of a run differs from that of another one, where both were stored."""
    return changes(reader, service.number(run), service.number(against))


@router.get("/runs/{run}/history", responses=problems("not-found"))
def list_history(run: RunName, reader: Reader) -> list[HistoryEntry]:
    """The actions on a run and their users, newest first: submitted, edited, cancelled, signed off,
    removed, restored, purged."""
    return service.history(reader, service.number(run))


def _once(once: OnceOnly, work: Work[RunSummary]) -> RunSummary:
    return once.do(RunSummary, work, lambda made: made.id, onward.now)
