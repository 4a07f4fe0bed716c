"""Exports that other programs read: MCAP and Parquet by their own libraries, capsules by `clearance replay`."""

from __future__ import annotations

import csv
import io
import json
import math
import zipfile
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader

from backend.db import queue
from backend.db import sources as stored
from backend.db.engine import read as read_of
from backend.db.store import RunStore
from backend.exports.formats import evaluations_parquet, traces_mcap
from backend.scenes.recordings import recording as recorder
from campaigns.capsules.packing import read
from campaigns.capsules.sources import SourceFile, Sources
from campaigns.stored.records import Trace
from clearance.cli import WRONG_INPUT, invoke
from tests.given.corrupted_records import ran
from tests.given.databases import BOTH
from tests.given.finished_runs import Work, encounter, finish, flight
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit
from worker.engine.stages.parts import offered
from worker.running.catalogue.installed import catalogue
from worker.running.runs import identity

Messages = dict[str, list[dict[str, Any]]]

OWN = "worker.engine.components.own.my_robot"


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Recordings of two frames a second, and fewer simulations, as in the tests of both."""
    monkeypatch.setattr(recorder, "RATE", 2.0)
    monkeypatch.setattr(offered, "SPOT_CHECKS", 2)
    monkeypatch.setattr(offered, "AT_MOST", 3)


@pytest.fixture(scope="module")
def run(still: Service, guest: httpx.Client) -> str:
    """A finished run with a nominal flight and F1."""
    run = submit(guest)
    finish(still)
    return run


@pytest.fixture(scope="module")
def aloft(still: Service, guest: httpx.Client) -> tuple[str, Trace]:
    """A run whose finding meets a moving intruder, in axes with z down; and its trace."""
    run = submit(guest)
    trace = encounter("F1", "ned", lambda t: np.column_stack([400 - 20 * t, 0 * t, 0 * t - 10]))
    work = Work(still)
    work.nominal()
    work.found(("F1",), trace)
    work.conclude()
    return run, trace


def exported(client: httpx.Client, run: str, file: str) -> bytes:
    answer = client.get(f"/api/v1/runs/{run}/exports/{file}")
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-disposition"].endswith(f'-{file}"')
    return answer.content


def messages(data: bytes) -> Messages:
    """By topic, as the library of MCAP reads them, every fiftieth checked against the schema in the file."""
    from jsonschema import Draft202012Validator  # the formats that it loads cost every test process 3 s

    found: Messages = {}
    validators: dict[str, Any] = {}
    for schema, channel, message in make_reader(io.BytesIO(data), validate_crcs=True).iter_messages():
        assert schema is not None
        assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
        document = json.loads(message.data)
        if schema.name not in validators:
            validators[schema.name] = Draft202012Validator(json.loads(schema.data))
        if len(found.get(channel.topic, [])) % 50 == 0:
            validators[schema.name].validate(document)
        stamp = document["entities"][0] if "entities" in document else document
        assert stamp["timestamp"]["sec"] * 10**9 + stamp["timestamp"]["nsec"] == message.log_time
        found.setdefault(channel.topic, []).append(document | {"schema": schema.name})
    return found


@pytest.mark.nightly
def test_flights_as_mcap_hold_every_row(guest: httpx.Client, run: str) -> None:
    data = exported(guest, run, "traces.mcap")
    found = messages(data)
    expected = flight("F1", passing=0.8)
    assert {topic: statement[0]["schema"] for topic, statement in found.items() if topic.startswith("/F1/")} == {
        "/F1/trajectory": "foxglove.PosesInFrame",
        "/F1/scene": "foxglove.SceneUpdate",
        "/F1/pose": "foxglove.PoseInFrame",
        "/F1/separation": "clearance.Values",
    }
    assert any(topic.startswith("/nominal/") for topic in found)
    told = [one["pose"]["position"] for one in found["/F1/pose"]]
    assert [[one["x"], one["y"], one["z"]] for one in told] == expected.data[:, 1:4].tolist()
    separations = [one["values"][0] for one in found["/F1/separation"]]
    assert {(one["name"], one["unit"]) for one in separations} == {("separation", "m")}
    stored = [None if math.isnan(value) else value for value in expected.data[:, -1].tolist()]
    assert [one["value"] for one in separations] == stored
    (ball,) = found["/F1/scene"][0]["entities"][0]["spheres"]
    assert (ball["pose"]["position"], ball["size"]["x"]) == ({"x": 4.0, "y": 4.0, "z": 0.0}, 1.0)
    (about,) = make_reader(io.BytesIO(data)).iter_metadata()
    assert (about.name, about.metadata["run"]) == ("clearance", run)


@pytest.mark.nightly
def test_a_flight_that_begins_below_0_is_shifted_to_0(still: Service, guest: httpx.Client) -> None:
    """As of a simulator whose time counts up to the end."""
    trace, run = flight("nominal"), submit(guest)
    data = trace.data - np.array([20.0] + [0.0] * (len(trace.columns) - 1))
    Work(still).nominal(replace(trace, data=data))
    file = exported(guest, run, "traces.mcap")
    log = [message.log_time for _, _, message in make_reader(io.BytesIO(file)).iter_messages(["/nominal/separation"])]
    assert (log[0], log[-1]) == (0, 15 * 10**9)
    assert len(messages(file)["/nominal/pose"]) == len(data)
    about = {record.name: record.metadata for record in make_reader(io.BytesIO(file)).iter_metadata()}
    assert about["time offsets"] == {"nominal": "-20.0"}


@pytest.mark.nightly
def test_axes_with_z_down_are_turned_upright(guest: httpx.Client, aloft: tuple[str, Trace]) -> None:
    run, trace = aloft
    found = messages(exported(guest, run, "traces.mcap"))
    names = [column.name for column in trace.columns]
    north, east, down = (trace.data[:, names.index(name)] for name in "xyz")
    position = np.array([[one["pose"]["position"][axis] for axis in "xyz"] for one in found["/F1/pose"]])
    assert np.array_equal(position, np.column_stack([east, north, -down]))
    # x of the body, which climbs by the trace's pitch and yaw.
    turn = found["/F1/pose"][0]["pose"]["orientation"]
    w, x, y, z = (turn[k] for k in "wxyz")
    ahead = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
    pitch, yaw = (float(trace.data[0, names.index(name)]) for name in ("pitch", "yaw"))
    expected = [math.cos(pitch) * math.sin(yaw), math.cos(pitch) * math.cos(yaw), math.sin(pitch)]
    assert ahead == pytest.approx(expected, abs=1e-12)
    intruder = np.array([[one["entities"][0]["spheres"][0]["pose"]["position"][a] for a in "xyz"]
                         for one in found["/F1/obstacles"]])  # fmt: skip
    assert intruder[:, 1].tolist() == trace.data[:, names.index("obstacle.0.x")].tolist()
    assert (intruder[:, 2] == 10.0).all()


def test_evaluations_as_parquet_are_those_of_the_csv(guest: httpx.Client, run: str) -> None:
    table = pq.read_table(io.BytesIO(exported(guest, run, "evaluations.parquet")))
    head, *rows = csv.reader(io.StringIO(exported(guest, run, "evaluations.csv").decode(), newline=""))
    assert table.column_names == head
    columns = [column.to_pylist() for column in table.columns]
    shown = [["" if value is None else str(value) for value in row] for row in zip(*columns, strict=True)]
    assert shown == rows
    assert len(rows) == 1000
    units = {field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in table.schema}
    assert (units["d_min [m]"], units["vehicle.J [kg m2]"], units["status"]) == ("m", "kg m2", "")
    about = json.loads(table.schema.metadata[b"clearance"])
    assert (about["run"], len(about["results_digest"])) == (run, 64)


def test_a_capsule_holds_the_finding_its_flights_and_its_view(
    guest: httpx.Client, run: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "capsule.zip"
    file.write_bytes(exported(guest, run, "capsule-F1.zip"))
    capsule, arrays, _ = read(file)
    detail = guest.get(f"/api/v1/runs/{run}").json()
    (finding,) = [one for one in guest.get(f"/api/v1/runs/{run}/findings").json() if one["label"] == "F1"]
    assert (capsule.finding.cost, capsule.finding.parameters) == (finding["cost"], finding["parameters"])
    assert (capsule.origin.run, capsule.campaign) == (run, detail["campaign"])
    assert capsule.components is not None
    assert capsule.components_digest == detail["components_digest"]
    assert arrays["F1"].tobytes() == flight("F1", passing=0.8).data.tobytes()
    with zipfile.ZipFile(file) as archive:
        page = archive.read("flight.html").decode()
    assert page == exported(guest, run, "flight-F1.html").decode()
    assert "default-src 'none'" in page
    # These results were written by hand, which the evaluation notices.
    assert invoke(["replay", str(file)]) != 0
    assert "1 of 1 do not agree" in capsys.readouterr().out
    file.write_bytes(file.read_bytes()[:-30])
    assert invoke(["replay", str(file)]) == WRONG_INPUT


def test_a_capsule_of_what_is_not_there_is_a_problem(guest: httpx.Client, run: str) -> None:
    for file in ("capsule-F9.zip", "capsule-nominal.zip"):
        problem(guest.get(f"/api/v1/runs/{run}/exports/{file}"), 404)


def test_without_the_packages_the_menu_and_the_files_say_so(
    guest: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module, file, package in (
        (traces_mcap, "traces.mcap", "mcap"),
        (evaluations_parquet, "evaluations.parquet", "pyarrow"),
    ):
        monkeypatch.setattr("backend.exports.format.find_spec", lambda _: None)
        (listed,) = [one for one in guest.get(f"/api/v1/runs/{run}/exports").json() if one["name"].endswith(file)]
        assert listed["unavailable"] == module.MISSING()
        refused = problem(guest.get(f"/api/v1/runs/{run}/exports/{file}"), 503)
        assert package in str(refused["detail"])


@BOTH
def test_the_source_of_a_run_is_stored_once(bare: Service) -> None:
    text, of = b"component = 1\r\n\x0c", {"package": False}
    files = [SourceFile(module=f"{OWN}{i}", digest=sha256(text).hexdigest(), **of) for i in range(2)]
    given = Sources(files=tuple(files)), {file.module: text for file in files}
    for number in (1, 2):
        with bare.engine.begin() as writer:
            queue.submit(writer, ran("violated")[0], name="", tags=[], owner="", planned=1, catalogue=catalogue())
        claim = queue.Queue(bare.engine).claim("w1")
        assert claim is not None
        for _ in range(2):
            RunStore(bare.engine, claim).record_sources(*given)
        with read_of(bare.engine) as reader:
            assert stored.of_run(reader, number) == given
            assert stored.of_run(reader, 3) is None
    assert (bare.rows()["run_sources"], bare.rows()["source_texts"]) == (2, 1)


@pytest.mark.nightly
def test_the_capsule_of_an_evaluated_run_replays_to_the_same_bits(
    bare: Service, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    campaign, evaluated = ran("violated")
    with bare.engine.begin() as writer:
        queue.submit(writer, campaign, name="Evaluated", tags=[], owner="local", planned=1, catalogue=catalogue())
    claim = queue.Queue(bare.engine).claim("w1")
    assert claim is not None
    store = RunStore(bare.engine, claim)
    store.plan([stage.plan for stage in evaluated.stages])
    assert evaluated.versions is not None
    store.record_versions(evaluated.versions, identity.code(campaign))
    text = b"component = 1\r\n\x0c"
    store.record_sources(
        Sources(files=(SourceFile(module=OWN, package=False, digest=sha256(text).hexdigest()),)), {OWN: text}
    )
    for at, stage in enumerate(evaluated.stages):
        store.begin(at)
        columns, last = evaluated.evaluations(at), at == len(evaluated.stages) - 1
        if columns is not None:
            store.append(at, 0, columns)
        assert stage.result is not None
        more = {"findings": evaluated.findings, "traces": list(evaluated.traces.values())} if last else {}
        store.finish(at, stage.result, 1.0, **more)
    assert evaluated.verdict is not None
    store.conclude(evaluated.verdict)
    with bare.signed_in() as client:
        file = tmp_path / "capsule.zip"
        file.write_bytes(exported(client, "R-0001", "capsule-F1.zip"))
        assert exported(client, "R-0001", "capsule-F1.zip") == file.read_bytes(), "the same finding, the same file"
    assert read(file).sources == {OWN: text}
    for named in (["R-0001", "--data", str(bare.settings.data)], [str(file)]):
        assert invoke(["replay", *named, "--json"]) == 0
        statement = json.loads(capsys.readouterr().out)
        assert (statement["agrees"], statement["differences"]) == (True, [])
        assert {case["agreement"] for case in statement["cases"]} == {"same bits"}
    assert statement["component_changes"] == []
