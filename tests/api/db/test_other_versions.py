"""Values stored by another version in an unreadable form: reported as such, never an internal error."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.engine import read
from backend.db.tables import CampaignRow, CatalogueDocument, CatalogueSnapshot, Finding, Run, Stage, Trace
from backend.scenes.recordings import recording
from campaigns import Campaign
from campaigns.version import VERSION
from tests.given.at_night import nightly_but
from tests.given.code_versions import VERSIONS
from tests.given.event_streams import streaming
from tests.given.finished_runs import finish
from tests.given.newer_forms import FORMS, NEWER, in_form
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

ODD = {"version": 99}
STORED = {
    "campaign": sa.update(CampaignRow).values(document=ODD),
    "summary": sa.update(Run).values(summary={"verdict": "cleared"} | ODD),
    "result": sa.update(Stage).values(result={"stage": "search"} | ODD),
    "kind": sa.update(Stage).where(Stage.position == 1).values(kind="corners", state="running"),
    "validation": sa.update(Finding).values(validation=ODD),
    "slices": sa.update(Finding).values(slices=ODD),
    "boundary": sa.update(Finding).values(boundary=ODD),
    "closest": sa.update(Finding).values(closest=ODD),
    "found": sa.update(Finding).values(found=[ODD]),
    "head": sa.update(Trace).values(meta=ODD | {"obstacles": 7}),
    "columns": sa.update(Trace).values(columns=[ODD] * 10),
}
SPANS = {
    "campaign": "",
    "summary": "",
    "result": "stages",
    "validation": "findings",
    "head": "traces/F1",
    "columns": "traces/F1",
}
"""What answers with it, and so has to say that it cannot."""
AT_NIGHT = ("slices", "boundary", "closest", "found", "columns")
"""Of a finding and read with it, as its validation is; of a trace and read with its head."""


CRITERION = {"component": "separation", "threshold": 0.5, "requirements": ["REQ-1"]}
DOCUMENT = Campaign.model_validate(campaign(criterion=CRITERION)).document()
CAMPAIGNS = {
    "a future version": {**DOCUMENT, "version": 99},
    "a future stage": {**DOCUMENT, "stages": DOCUMENT["stages"] | {"explore": {"points": 3}}},
    "a future seed": {**DOCUMENT, "seed": "entropy"},
    "no mapping": ["damaged"],
    "a mapping of another kind": {**DOCUMENT, "uncertain": ["damaged"], "criterion": None},
}
EVERY_RUN = (
    *("runs", "runs/facets", "reports", "requirements", "requirements/export/matrix.csv", "sweeps", "audit"),
    f"trends?name={DOCUMENT['name']}",
)
"""What reads many runs: one that is damaged hides none of the others."""


def of_a_run(client: httpx.Client) -> dict[str, set[str]]:
    """What reads a run, and the statuses that the description of the API lists for it."""
    paths = client.get("/api/v1/openapi.json").json()["paths"]
    found = {path: {*of["get"]["responses"]} for path, of in paths.items() if "/runs/{run}" in path and "get" in of}
    return {path: listed for path, listed in found.items() if not path.endswith(("events", "report.pdf"))}


@pytest.fixture(scope="module")
def run(still: Service, guest: httpx.Client) -> str:
    """A finished run."""
    run = submit(guest)
    finish(still)
    return run


@pytest.mark.by_day(2)
@pytest.mark.parametrize("what", nightly_but(STORED.keys() - set(AT_NIGHT), STORED))
def test_it_is_reported_as_of_another_version(
    what: str, still: Service, guest: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording, "RATE", 0.2)  # few frames: making one takes a second otherwise
    with changed(still.engine, STORED[what]):
        for path, listed in of_a_run(guest).items():
            answer = guest.get(re.sub(r"\{\w+\}", "F1", path.replace("{run}", run)), follow_redirects=False)
            assert answer.status_code < 500, (path, answer.text)
            assert str(answer.status_code) in listed, (path, answer.text)
        if what in SPANS:
            address = f"/api/v1/runs/{run}/{SPANS[what]}".rstrip("/")
            assert "another version" in str(problem(guest.get(address), 409)["detail"])
        assert guest.get("/api/v1/runs").status_code == 200


def test_a_change_that_cannot_be_answered_is_not_made(still: Service, guest: httpx.Client, run: str) -> None:
    address = f"/api/v1/runs/{run}"
    before = guest.get(address).json()["name"]
    with changed(still.engine, STORED["campaign"]):
        problem(guest.patch(address, json={"name": "renamed"}), 409)
    assert guest.get(address).json()["name"] == before


@pytest.fixture(scope="module")
def signed(still: Service, guest: httpx.Client) -> str:
    """A finished run with a requirement and a sign-off, and so read by all that reads a run."""
    run = submit(guest, criterion=CRITERION)
    finish_fully(still)
    address = f"/api/v1/runs/{run}/signoffs"
    signature = {"name": "Grace Hopper", "role": "Independent review", "comment": "Read."}
    guest.post(address, json=signature | {"digest": guest.get(address).json()["digest"]}).raise_for_status()
    return run


@pytest.mark.nightly
@pytest.mark.parametrize("kind", nightly_but(("a future version",), CAMPAIGNS))
def test_a_stored_campaign_that_cannot_be_read_is_no_error_of_the_request(
    kind: str, still: Service, guest: httpx.Client, signed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording, "RATE", 0.2)
    paths = [re.sub(r"\{\w+\}", "F1", path.replace("{run}", signed)) for path in of_a_run(guest)]
    files = [
        f"/api/v1/runs/{signed}/exports/{one['name']}" for one in guest.get(f"/api/v1/runs/{signed}/exports").json()
    ]
    paths += [path for path in files if not path.endswith(("pdf", "report.html"))]
    before = {path: guest.get(path, follow_redirects=False).status_code for path in paths}
    change = sa.update(CampaignRow).where(CampaignRow.digest == digest(guest, signed)).values(document=CAMPAIGNS[kind])
    flown = VERSIONS.model_copy(update={"clearance": "0.0.9"}).model_dump(mode="json")
    with changed(still.engine, change), changed(still.engine, sa.update(Run).values(flown=flown)):
        for path, status in before.items():
            answer = guest.get(path, follow_redirects=False)
            if answer.status_code != status:
                problem(answer, 409, "other-version")
        detail = str(problem(guest.get(f"/api/v1/runs/{signed}"), 409, "other-version")["detail"])
        assert {VERSION, "0.0.9"} <= set(re.findall(r"\d+\.\d+\.\d+", detail))
        for path in EVERY_RUN:
            assert guest.get(f"/api/v1/{path}").status_code == 200, path


@pytest.fixture(scope="module")
def queued(guest: httpx.Client, run: str, signed: str) -> str:
    """A run that waits, of which only the catalogue states quantity and unit."""
    return submit(guest, criterion=CRITERION, seed=2)


def newer(service: Service, table: type[CatalogueDocument] | type[CatalogueSnapshot], form: str) -> sa.Update:
    """What is stored there, as a newer version writes it."""
    with read(service.engine) as reader:
        document: Any = reader.scalar(sa.select(table.document).limit(1))
    return sa.update(table).values(document=in_form(document, form))


def read_all(client: httpx.Client, *runs: str) -> dict[str, int]:
    """The statuses of all that reads these runs, their files and many runs."""
    paths = [re.sub(r"\{\w+\}", "F1", path.replace("{run}", run)) for run in runs for path in of_a_run(client)]
    files = [(run, one["name"]) for run in runs for one in client.get(f"/api/v1/runs/{run}/exports").json()]
    paths += [f"/api/v1/runs/{run}/exports/{name}" for run, name in files if not name.endswith(("pdf", "report.html"))]
    paths += [f"/api/v1/{path}" for path in (*EVERY_RUN, "campaigns", f"campaigns/{LIBRARY}")]
    return {path: client.get(path, follow_redirects=False).status_code for path in paths}


@pytest.fixture(scope="module")
def answered(guest: httpx.Client, signed: str, queued: str) -> dict[str, int]:
    """The statuses of all that while everything can be read."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recording, "RATE", 0.2)
        return read_all(guest, signed, queued)


LIBRARY = "unicycle_static"
REQUIRING: dict[str, Callable[[httpx.Client], httpx.Response]] = {
    "components": lambda client: client.get("/api/v1/components"),
    "check": lambda client: client.post("/api/v1/campaigns/check", json={"campaign": DOCUMENT}),
    "preview": lambda client: client.post("/api/v1/campaigns/preview", json={"campaign": DOCUMENT}),
    "submit": lambda client: client.post("/api/v1/runs", json={"campaign": DOCUMENT}),
    "submit, reuse": lambda client: client.post("/api/v1/runs", json={"campaign": DOCUMENT, "reuse": True}),
    "sweep": lambda client: client.post(
        "/api/v1/sweeps", json={"campaign": DOCUMENT, "path": "avoider.d_0", "values": [1.0, 2.0], "name": "Range"}
    ),
    "proposal": lambda client: client.get("/api/v1/simulators/drop/proposal?parameters=2"),
}
"""What cannot be answered without the catalogue."""


@pytest.mark.nightly
@pytest.mark.parametrize("form", nightly_but(("one more field",), FORMS))
def test_what_a_newer_worker_publishes_hides_no_run(
    form: str,
    still: Service,
    guest: httpx.Client,
    signed: str,
    queued: str,
    answered: dict[str, int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(recording, "RATE", 0.2)
    with changed(still.engine, newer(still, CatalogueDocument, form)):
        assert read_all(guest, signed, queued) == answered
        assert guest.get(f"/api/v1/runs/{queued}").json()["quantity"] == "d_min", "its own descriptions have it"
        for path, request in REQUIRING.items():
            answer = request(guest)
            assert answer.headers["Retry-After"], path
            detail = str(problem(answer, 503, "no-catalogue")["detail"])
            assert {VERSION, NEWER} <= set(re.findall(r"\d+(?:\.\d+)+", detail)), path
            (stated,) = guest.get(f"/api/v1/campaigns/{LIBRARY}").json()["problems"]
            assert stated["message"] == detail
        with streaming(guest) as every, streaming(guest, run=queued) as one:
            assert every.next("run")["id"] == one.next("run")["id"] == queued


@pytest.mark.parametrize("text", ["{}", "[]", "{"])
def test_a_damaged_catalogue_hides_no_run(text: str, still: Service, guest: httpx.Client, queued: str) -> None:
    with changed(still.engine, sa.update(CatalogueDocument).values(document=sa.literal_column(f"'{text}'"))):
        assert guest.get("/api/v1/runs").status_code == guest.get(f"/api/v1/runs/{queued}").status_code == 200
        problem(guest.post("/api/v1/runs", json={"campaign": DOCUMENT}), 503, "no-catalogue")


@pytest.mark.nightly
@pytest.mark.parametrize("form", nightly_but(("an unknown value",), FORMS))
def test_a_run_that_a_newer_version_describes_is_no_error_of_the_request(
    form: str,
    still: Service,
    guest: httpx.Client,
    signed: str,
    queued: str,
    answered: dict[str, int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(recording, "RATE", 0.2)
    listed = of_a_run(guest)
    with changed(still.engine, newer(still, CatalogueSnapshot, form)):
        for path, status in answered.items():
            answer = guest.get(path, follow_redirects=False)
            if answer.status_code != status:
                assert path.startswith((f"/api/v1/runs/{signed}", f"/api/v1/runs/{queued}")), path
                problem(answer, 409, "other-version")
        assert all("409" in listed["/api/v1/runs/{run}" + end] for end in ("", "/components", "/findings"))
        for run in (signed, queued):
            assert VERSION in str(problem(guest.get(f"/api/v1/runs/{run}"), 409, "other-version")["detail"])
            problem(guest.get(f"/api/v1/runs/{run}/components"), 409, "other-version")
        given = {"campaign": DOCUMENT, "baseline": signed}
        errors: Any = problem(guest.post("/api/v1/runs", json=given), 422)["errors"]
        assert [error["field"] for error in errors] == ["baseline"]
        with streaming(guest) as every, streaming(guest, run=queued) as one:
            assert every.next("run")["id"] == one.next("run")["id"] == queued


def digest(client: httpx.Client, run: str) -> str:
    return str(client.get(f"/api/v1/runs/{run}").json()["campaign_digest"])
