"""Export files of a run: names, all evaluations, streaming of a large run, flights as CSV and MAT, entity tags."""

from __future__ import annotations

import csv
import io
import json
import tracemalloc
from collections.abc import Iterator
from urllib.parse import unquote

import httpx
import numpy as np
import pytest
import sqlalchemy as sa
from scipy.io import loadmat

from backend.db.engine import read
from backend.db.tables import CatalogueDocument, EvaluationChunk, Run
from backend.exports.formats.evaluations_csv import evaluations_csv
from backend.exports.sheet import sheet
from backend.http.naming import disposition, named
from backend.http.written import finite_all, lines
from backend.runs.service import campaign
from backend.scenes.recordings import recording
from campaigns.results.base import STATUS
from campaigns.results.finding import ReferenceCost
from campaigns.stored.records import Columns, StagePlan, Trace
from clearance.client import Client
from tests import results
from tests.api.conftest import running
from tests.given.databases import AT_NIGHT, KINDS, Fresh
from tests.given.finished_runs import Work, finish, flight, search
from tests.given.problem_documents import problem
from tests.given.reported_runs import finding, finish_fully
from tests.given.service import Service
from tests.given.submissions import submit

Stored = tuple[httpx.Client, str]


@pytest.fixture
def run(service: Service, client: httpx.Client) -> str:
    """A finished run."""
    run = submit(client)
    finish(service)
    return run


def table(answer: httpx.Response) -> list[list[str]]:
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    return list(csv.reader(io.StringIO(answer.text, newline="")))


def test_a_finding_has_one_margin_wherever_it_is_stated(service: Service, client: httpx.Client) -> None:
    """Of a violation whose values differ, that of the mildest."""
    run = submit(client)
    case = results.validation("F1", 0.2, violates=True, agrees=False)
    case = case.model_copy(update={"integrator": ReferenceCost(name="DOP853", cost=0.3, difference=0.1)})
    one = finding().model_copy(update={"cost": 0.2, "margin": 0.2 - 0.5, "validation": case})
    finish_fully(service, "violated", found=[one])
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).values(worst_cost=one.granted))
    (listed,) = client.get("/api/v1/runs").json()["items"]
    (shown,) = client.get(f"/api/v1/runs/{run}/findings").json()
    rows = client.get(f"/api/v1/runs/{run}/exports/findings.csv").text.splitlines()
    table = {row["flight"]: row for row in csv.DictReader(rows)}
    with Client(service.url, service.token("reader")) as reading:
        known = reading.findings(run)
    assert one.granted == 0.3
    assert {listed["margin"], shown["margin"], float(table["F1"]["margin"]), known[0].margin} == {0.3 - 0.5}
    assert known.to_dataframe()["margin"].tolist() == [0.3 - 0.5]


@pytest.mark.nightly
def test_the_files_are_listed_with_good_names(client: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recording, "RATE", 0.2)  # few frames: what is in a recording is tested in test_recordings
    listed = client.get(f"/api/v1/runs/{run}/exports").json()
    kinds = (
        "safety-case-report.html",
        "safety-case-report.pdf",
        "run.json",
        "record.sqlite3",
        "evaluations.csv",
        "evaluations.parquet",
        "findings.csv",
        "traces.csv",
        "traces.mat",
        "traces.mcap",
        "worst-case.svg",
        "capsule-F1.zip",
        "flight-F1.html",
    )
    assert [file["name"] for file in listed] == [f"R-0001-unicycle-past-a-pillar-{file}" for file in kinds]
    for file in listed:
        assert file["unavailable"] is None or "Chromium" in file["unavailable"]
        if file["media_type"] == "application/pdf":  # tested in test_reports
            continue
        answer = client.get(file["href"])
        assert answer.status_code == 200
        how = "inline" if "report" in file["name"] else "attachment"
        assert answer.headers["content-disposition"] == f'{how}; filename="{file["name"]}"'
        assert answer.headers["content-type"].partition(";")[0] == file["media_type"]


def test_no_name_of_a_run_leaves_the_header() -> None:
    assert named("R-0001", '../a"; x\r\nSet-Cookie: y', "run.json") == "R-0001-a-x-set-cookie-y-run.json"
    assert named("R-0001", "a\u202e\u2028b", "run.json") == "R-0001-a-b-run.json"
    assert len(named("R-0001", "long " * 40, "run.json")) < 70
    assert disposition("inline", 'x"\r\ny') == "inline; filename=\"xy\"; filename*=UTF-8''x%22%0D%0Ay"


@pytest.mark.parametrize(
    ("name", "plain", "whole"),
    [
        ("\u00dcn\u00efc\u00f6de 1", "unicode-1-", "\u00fcn\u00efc\u00f6de-1-"),
        ("\u6a5f \u65e5\u672c", "", "\u6a5f-\u65e5\u672c-"),
        ("Plain", "plain-", None),
    ],
)
def test_letters_of_every_script_stay_in_the_name_of_a_file(name: str, plain: str, whole: str | None) -> None:
    header = disposition("attachment", named("R-0001", name, "run.json"))
    given, _, extended = header.partition("; filename*=UTF-8''")
    assert header.isascii()
    assert given == f'attachment; filename="R-0001-{plain}run.json"'
    assert unquote(extended) == ("" if whole is None else f"R-0001-{whole}run.json")


@pytest.fixture(scope="module", params=[KINDS[0], pytest.param(KINDS[1], marks=pytest.mark.nightly)])
def stored(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stored]:
    """A client, and a finished run that the tests only read, on both databases."""
    fresh: Fresh = request.getfixturevalue(f"fresh_{request.param}")
    with running(fresh, tmp_path_factory.mktemp("stored")) as service:
        service.publish()
        with service.signed_in() as client:
            run = submit(client)
            finish(service)
            yield client, run


def test_every_evaluation_is_a_row_with_all_its_digits(stored: Stored) -> None:
    client, run = stored
    head, *rows = table(client.get(f"/api/v1/runs/{run}/exports/evaluations.csv"))
    assert head == [
        *("stage", "kind", "method", "index", "status", "reason", "seconds [s]"),
        *("d_min [m]", "vehicle.m [kg]", "vehicle.J [kg m2]"),
    ]
    flown = search(0, 1000)
    assert len(rows) == 1000
    assert [row[:4] for row in rows[:2]] == [["2", "search", "direct", "0"], ["2", "search", "direct", "1"]]
    assert rows[9][4:6] == ["failed", "the speed exceeds 1000 m/s at 9 s"]
    assert rows[9][7] == ""
    assert [float(row[7]) if row[7] else None for row in rows] == [
        None if np.isnan(cost) else cost for cost in flown.costs[:, 0].tolist()
    ]
    assert [float(row[8]) for row in rows] == (4.0 + (6.0 - 4.0) * flown.points[:, 0]).tolist()


def test_without_a_catalogue_parameters_are_fractions(service: Service, client: httpx.Client, run: str) -> None:
    with service.engine.begin() as connection:
        connection.execute(sa.delete(CatalogueDocument))
        connection.execute(sa.update(Run).values(snapshot=None))
    head, first, *_ = table(client.get(f"/api/v1/runs/{run}/exports/evaluations.csv"))
    assert head[-2:] == ["vehicle.m [share of range]", "vehicle.J [share of range]"]
    assert [float(value) for value in first[-2:]] == search(0, 1).points[0].tolist()


def test_the_file_is_that_of_a_writer_of_rows(service: Service, client: httpx.Client) -> None:
    submit(client)
    work = Work(service, [StagePlan("nominal", None, 1), StagePlan("search", "@odd", 9)])
    reasons = {1: "=1+1", 2: 'a "quoted", long\r\ntext', 3: "", 5: "-1"}
    numbers = np.array([1e-5, 1e-300, 0.0, 1.0, 1 / 3, 1e17, np.inf, np.nan, -0.0])
    status = np.array([0, 1, 2, 3, 0, 1, 0, 0, 0], np.uint8)
    for position, first, last in ((0, 0, 1), (1, 0, 4), (1, 4, 9)):
        some = {i: reason for i, reason in reasons.items() if first <= i < last and position}
        points = np.column_stack([numbers, numbers[::-1]])[first:last]
        columns = Columns(points, numbers[first:last, None], status[first:last], 0.001 * np.arange(first, last), some)
        work.store.append(position, first, columns)
    with read(service.engine) as reader:
        found = sheet(reader, 1, campaign(reader, 1))
    rows: list[list[object]] = [["stage", "kind", "method", *found.columns]]
    for stage in found.stages:
        place = [stage.position, stage.kind, stage.method]
        for block in found.blocks(service.engine, stage):
            words, why = [STATUS[code] for code in block.status.tolist()], map(block.reasons.get, block.indices)
            cells = (
                words,
                why,
                block.seconds.tolist(),
                *map(finite_all, block.costs),
                *map(np.ndarray.tolist, block.values),
            )
            rows += [[*place, *row] for row in zip(block.indices, *cells, strict=True)]
    assert len(rows) == 11
    assert b"".join(evaluations_csv(service.engine, 1)) == lines(rows)


@pytest.mark.nightly
def test_fifty_thousand_evaluations_are_streamed(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    work = Work(service)
    work.store.begin(2)
    block, total = 2048, 50_000
    random = np.random.default_rng(1)
    for first in range(0, total, block):
        count = min(block, total - first)
        points = random.random((count, 2))
        costs = 1.0 + points[:, :1]
        work.store.append(2, first, Columns(points, costs, np.zeros(count, np.uint8), 0.001 * np.ones(count), {}))
    tracemalloc.start()
    size = lines = most = 0
    for piece in evaluations_csv(service.engine, 1):
        size, lines, most = size + len(piece), lines + piece.count(b"\n"), max(most, len(piece))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert lines == total + 1
    assert size > 3e6
    assert most < 0.05 * size
    assert peak < 5e6, peak
    with client.stream("GET", f"/api/v1/runs/{run}/exports/evaluations.csv") as answer:
        assert answer.headers.get("transfer-encoding") == "chunked"
        assert sum(piece.count(b"\n") for piece in answer.iter_bytes()) == total + 1


def test_flights_as_csv_hold_every_row(stored: Stored) -> None:
    client, run = stored
    head, *rows = table(client.get(f"/api/v1/runs/{run}/exports/traces.csv"))
    assert head[:4] == ["flight", "t [s]", "x [m]", "y [m]"]
    assert [row[0] for row in rows] == ["nominal"] * 3001 + ["F1"] * 3001
    stored = flight("F1", passing=0.8).data
    assert [float(row[-1]) for row in rows[3001:-1]] == stored[:-1, 9].tolist()
    assert rows[-1][-1] == ""


def test_flights_as_mat_file(stored: Stored) -> None:
    client, run = stored
    answer = client.get(f"/api/v1/runs/{run}/exports/traces.mat")
    assert int(answer.headers["content-length"]) == len(answer.content)
    read = loadmat(io.BytesIO(answer.content), simplify_cells=True)
    assert read["run"]["id"] == run
    stored = flight("F1", passing=0.8)
    assert np.array_equal(read["F1"]["separation"], stored.data[:, 9], equal_nan=True)
    assert read["nominal"]["units"]["v"] == "m/s"
    assert json.loads(read["F1"]["meta"])["closest"]["obstacle"] == 0


def test_no_column_is_lost_in_a_mat_file(service: Service, client: httpx.Client) -> None:
    """Also where its name is that of another field, or becomes the same as that of another column."""
    names = ["t", "units", "meta", "a.b", "a_b", f"{'x' * 70}1", f"{'x' * 70}2", "2.b", "units_2"]
    columns = results.columns(*((name, f"u{k}", "signal" if k else "time") for k, name in enumerate(names)))
    data = np.arange(3.0)[:, None] + 10 * np.arange(len(names))
    run = submit(client)
    Work(service).nominal(Trace("nominal", columns, data, results.head()))
    content = client.get(f"/api/v1/runs/{run}/exports/traces.mat").raise_for_status().content
    read = loadmat(io.BytesIO(content), simplify_cells=True)["nominal"]
    fields = json.loads(read["meta"])["names"]
    assert sorted(fields.values()) == sorted(names)
    assert (fields["units_2"], fields["a_b"], fields["a_b_2"]) == ("units_2", "a_b", "a.b"), "a valid name stays"
    for field, name in fields.items():
        k = names.index(name)
        assert len(field) <= 63
        assert (read[field].tolist(), read["units"][field]) == (data[:, k].tolist(), f"u{k}")


def test_run_json_has_what_the_routes_answer(stored: Stored) -> None:
    client, run = stored
    told = client.get(f"/api/v1/runs/{run}/exports/run.json").json()
    assert told["format"] == "clearance-run/1"
    assert told["run"] == client.get(f"/api/v1/runs/{run}").json()
    assert told["findings"] == client.get(f"/api/v1/runs/{run}/findings").json()
    stages = client.get(f"/api/v1/runs/{run}/stages").json()
    assert [{k: v for k, v in s.items() if k != "rows"} for s in told["stages"]] == stages
    rows = told["stages"][2]["rows"]
    assert (len(rows), told["stages"][0]["rows"]) == (1000, [])
    assert dict(zip(told["columns"], rows[9], strict=True))["status"] == "failed"
    assert [flight["name"] for flight in told["traces"]] == ["nominal", "F1"]
    assert len(told["traces"][1]["data"]["x"]) == 3001
    assert len(told["results_digest"]) == 64


@AT_NIGHT
def test_what_did_not_change_is_not_sent_again(service: Service, client: httpx.Client, run: str) -> None:
    address = f"/api/v1/runs/{run}/exports/run.json"
    tag = client.get(address).headers["etag"]
    again = client.get(address, headers={"If-None-Match": tag})
    assert (again.status_code, again.content) == (304, b"")
    waiting = submit(client, seed=2)
    assert "etag" not in client.get(f"/api/v1/runs/{waiting}/exports/run.json").headers


def test_a_run_without_results_has_empty_files(client: httpx.Client) -> None:
    run = submit(client)
    assert len(table(client.get(f"/api/v1/runs/{run}/exports/evaluations.csv"))) == 1
    assert table(client.get(f"/api/v1/runs/{run}/exports/traces.csv")) == [["flight"]]
    assert client.get(f"/api/v1/runs/{run}/exports/run.json").json()["traces"] == []
    why = {f["name"].rpartition("-")[2]: f["unavailable"] for f in client.get(f"/api/v1/runs/{run}/exports").json()}
    assert why["run.json"] is None
    assert "no stored flight" in why["traces.mat"]


@pytest.mark.parametrize("file", ["run.json", "evaluations.csv", "traces.csv", "traces.mat", ""])
def test_a_run_that_is_not_there_is_not_found(guest: httpx.Client, file: str) -> None:
    problem(guest.get(f"/api/v1/runs/R-0999/exports/{file}".rstrip("/")), 404)


def test_an_export_whose_run_is_purged_meanwhile_breaks_off(service: Service, client: httpx.Client) -> None:
    """A stream that ended as usual would be taken for the whole."""
    submit(client)
    work = Work(service, [StagePlan("search", "@odd", 9)])
    work.store.append(0, 0, Columns(np.zeros((9, 2)), np.zeros((9, 1)), np.zeros(9, np.uint8), np.zeros(9), {}))
    with read(service.engine) as reader:
        found = sheet(reader, 1, campaign(reader, 1))
    stage = next(stage for stage in found.stages if stage.evaluations)
    with service.engine.begin() as writer:
        writer.execute(sa.delete(EvaluationChunk).where(EvaluationChunk.run_id == 1))
    with pytest.raises(RuntimeError, match="lost its evaluations"):
        list(found.blocks(service.engine, stage))
