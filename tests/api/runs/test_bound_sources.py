"""What a bound on P(violation) rests on and leaves out is the same wherever a run has its bound, and so is who drew a
case that no search found. `PLACES` are the places: a further one is a row.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Mapping
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.engine import read
from backend.db.tables import Stage, SweepRun
from backend.webhooks import body
from campaigns.claims.stages.sample import STATED_SEED
from campaigns.results.unsearched import unsearched
from campaigns.runs import run_number
from campaigns.stages.certify import CertifyResult
from campaigns.stored.records import StagePlan
from clearance import Client
from clearance.cli import _report
from tests import results
from tests.given.reported_runs import PARAMETERS, SEARCHED, finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import swept
from worker.running.runs.store import MemoryStore

SOURCES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "certify": ({}, {}),
    "certify_stated": ({"sample_seed": 5}, {}),
    "search": ({}, {"statistics": SEARCHED.model_copy(update={"excluded": 1000})}),
    "": ({"sample_seed": 6}, {"statistics": None}),
}
"""What is launched and how the run ends, by what its bound rests on; without a bound nothing."""
EXCLUDED = {"certify": 0.0, "certify_stated": 0.0, "search": 0.25, "": None}
"""The fraction of the draws that it leaves out."""

Stated = Mapping[str, tuple[str, float | None]]
Place = Callable[[Service, httpx.Client, list[str]], Stated]


def answered(client: httpx.Client, path: str, **query: str) -> Any:
    answer = client.get(f"/api/v1{path}", params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()


def sources(runs: list[dict[str, Any]]) -> Stated:
    return {run["id"]: (run["bound_source"] or "", run["excluded_fraction"]) for run in runs}


def columns(client: httpx.Client, path: str, source: str, excluded: str) -> Stated:
    rows = csv.DictReader(io.StringIO(client.get(f"/api/v1{path}").text))
    return {row["run"]: (row[source], float(row[excluded]) if row[excluded] else None) for row in rows}


def reported(service: Service, run: str) -> dict[str, Any]:
    with read(service.engine) as reader:
        found = json.loads(body.ended(reader, run_number(run) or 0, ""))["data"]
    return {**found, "id": run}


def related(client: httpx.Client, runs: list[str]) -> Stated:
    """A run is not related to itself."""
    return sources([run for of in runs[:2] for run in answered(client, f"/runs/{of}/related")["runs"]])


def read_by_client(service: Service, runs: list[str]) -> Stated:
    with Client(service.url, token=service.token()) as library:
        found = [library.run(run) for run in runs]
    return {run.id: (run.bound_source or "", run.excluded_fraction) for run in found}


PLACES: dict[str, Place] = {
    "list": lambda service, client, runs: sources(answered(client, "/runs")["items"]),
    "run": lambda service, client, runs: sources([answered(client, f"/runs/{run}") for run in runs]),
    "related": lambda service, client, runs: related(client, runs),
    "trend": lambda service, client, runs: sources(
        answered(client, "/trends", name=answered(client, f"/runs/{runs[0]}")["campaign_name"])["runs"]
    ),
    "matrix": lambda service, client, runs: sources(answered(client, "/requirements")["items"][0]["runs"]),
    "matrix.csv": lambda service, client, runs: columns(
        client, "/requirements/export/matrix.csv", "p_violation_bound_source", "excluded_fraction"
    ),
    "webhook": lambda service, client, runs: sources([reported(service, run) for run in runs]),
    "client": lambda service, client, runs: read_by_client(service, runs),
}
SWEEPS: dict[str, Place] = {
    "sweep": lambda service, client, runs: sources(
        [point["outcome"] for point in answered(client, "/sweeps/S-0001")["points"]]
    ),
    "sweep.csv": lambda service, client, runs: columns(
        client, "/sweeps/S-0001/table.csv", "P(violation) bound source", "excluded fraction"
    ),
}
"""The runs of a sweep are in no trend."""


def test_every_place_states_what_a_bound_rests_on(service: Service, client: httpx.Client) -> None:
    runs = []
    asked = campaign(criterion={"threshold": 0.5, "requirements": [{"id": "REQ-1", "text": "Keep 0.5 m."}]})
    for launched, ended in SOURCES.values():
        answer = client.post("/api/v1/runs", json={"campaign": asked, **launched})
        assert answer.status_code == 201, answer.text
        runs.append(str(answer.json()["id"]))
        finish_fully(service, **ended)
    stated = {run: (source, EXCLUDED[source]) for run, source in zip(runs, SOURCES, strict=True)}

    def compare(places: Mapping[str, Place]) -> None:
        for name, place in places.items():
            found = {run: words for run, words in place(service, client, runs).items() if run in stated}
            assert (name, found) == (name, stated)

    compare(PLACES)
    swept(client, [float(k) for k in range(len(runs))])
    with service.engine.begin() as writer:
        for k, run in enumerate(runs):
            writer.execute(sa.update(SweepRun).where(SweepRun.value == float(k)).values(run_id=run_number(run)))
    compare(SWEEPS)


DRAWN = results.validation("F1", realisation=7)
CASE = results.finding("F1", 1.3, 0.8, PARAMETERS, validation=DRAWN, methods=[])
"""A finding that the sample drew."""


def certified(drawn: bool) -> CertifyResult:
    return CertifyResult.model_validate(results.certified().model_dump() | {"seed": 7, "drawn_at_launch": drawn})


def printed(certificate: CertifyResult) -> str:
    store = MemoryStore()
    store.plan([StagePlan("certify", None, 3), StagePlan("validate", None, 300)])
    for position in range(2):
        store.begin(position)
    store.finish(0, certificate, 0.1)
    store.finish(1, results.validated(), 0.1, findings=[CASE])
    return "\n".join(_report._how_found(store))


@pytest.mark.by_day(1)
@pytest.mark.parametrize("drawn", [True, False])
def test_every_place_states_whether_the_sample_that_drew_a_case_has_a_stated_seed(
    service: Service, client: httpx.Client, drawn: bool
) -> None:
    assert client.post("/api/v1/runs", json={"campaign": campaign()}).status_code == 201
    finish_fully(service, found=[CASE])
    with service.engine.begin() as writer:
        of = Stage.kind == "certify"
        result = writer.execute(sa.select(Stage.result).where(of)).scalar_one() or {}
        writer.execute(sa.update(Stage).where(of).values(result=result | {"seed": 7, "drawn_at_launch": drawn}))
    (files,) = [f for f in answered(client, "/runs/R-0001/exports") if f["name"].endswith("findings.csv")]
    named, stated = (unsearched(DRAWN, certified(seed)) for seed in (drawn, False))
    assert (STATED_SEED in named) != drawn
    texts = {path: client.get(path).text for path in (files["href"], "/api/v1/runs/R-0001/report.html")}
    for place, text in (texts | {"command line": printed(certified(drawn))}).items():
        assert (place, named in text, stated in text) == (place, True, not drawn)
