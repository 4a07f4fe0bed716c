"""That another run speaks against a cleared one is stated wherever that run is called cleared, and it is no success."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as Xml

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Run
from backend.webhooks.body import ended
from clearance.cli import CODES, _sweep
from clearance.client.answers import Sweep
from tests.faults.processes import REPOSITORY
from tests.given.databases import AT_NIGHT
from tests.given.reported_runs import finish_fully
from tests.given.requirement_rows import AT, ran, row
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.small_catalogue import campaign

API, MARK = "/api/v1", ": contradicted"
SENTENCE = "R-0003 violates the criterion, on the same question and model."
FILES = ("junit", "summary", "sarif")
TWO = ("R-0001", "R-0002")


def violated(service: Service) -> None:
    """Another run of the question of the first two, which violates it."""
    with service.engine.begin() as writer:
        values = dict(writer.execute(sa.select(Run.__table__).where(Run.id == 1)).mappings().one())
        writer.execute(sa.insert(Run).values(**{**values, "id": 3, "verdict": "violated"}))


def stated(service: Service, client: httpx.Client) -> dict[str, object]:
    """What each place states of the two cleared runs."""
    with service.engine.connect() as reader:
        message, following = (json.loads(ended(reader, run_id, ""))["data"] for run_id in (1, 2))
    listed = {one["id"]: one for one in client.get(f"{API}/runs").json()["items"]}
    trends = client.get(f"{API}/trends", params={"name": listed["R-0001"]["campaign_name"]}).json()
    reports = client.get(f"{API}/reports").json()["items"]
    related = client.get(f"{API}/runs/R-0001/related").json()["runs"]
    return {
        "list": listed["R-0001"]["against"],
        "run": client.get(f"{API}/runs/R-0001").json()["against"],
        **{f"trend {one['id']}": one["against"] for one in trends["runs"] if one["id"] in TWO},
        **{f"report {one['run']}": one["against"] for one in reports if one["run"] in TWO},
        **{f"related {one['id']}": one["against"] for one in related if one["id"] in TWO},
        **{f"row {one['id']}": one["against"] for one in row(client, "REQ-1")["runs"] if one["id"] in TWO},
        "webhook": message["against"],
        "webhook on the next run": following["before"]["against"],
        "export": client.get(f"{API}/runs/R-0001/exports/run.json").json()["run"]["against"],
    }


def marks(client: httpx.Client) -> dict[str, bool]:
    texts = {
        "printed report": client.get(f"{API}/runs/R-0001/report.html").text,
        "matrix": client.get(f"{AT}/export/matrix.csv").text,
        "picture": client.get(f"{API}/runs/R-0001/exports/worst-case.svg").text,
    }
    return {name: f"cleared{MARK}" in text.lower() for name, text in texts.items()}


@AT_NIGHT
def test_every_place_states_that_another_run_speaks_against_it(service: Service, client: httpx.Client) -> None:
    for _ in TWO:
        ran(service, client, "REQ-1")
    before = stated(service, client)
    assert before == dict.fromkeys(before, "")
    assert not any(marks(client).values())
    tick = '<section class="vbox ok"'
    assert tick in client.get(f"{API}/runs/R-0001/report.html").text
    violated(service)
    assert tick not in client.get(f"{API}/runs/R-0001/report.html").text
    after = stated(service, client)
    assert after == dict.fromkeys(before, SENTENCE)
    assert all(marks(client).values())


def test_a_job_does_not_succeed_by_such_a_run(
    service: Service, command: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with service.signed_in() as client:
        for _ in TWO:
            ran(service, client, "REQ-1")
    files = {name: tmp_path / name for name in FILES}
    arguments = ("follow", "R-0001", *(part for name in FILES for part in (f"--{name}", files[name])))
    assert command(*arguments) == 0
    violated(service)
    files["summary"].unlink()
    capsys.readouterr()
    assert command(*arguments) == CODES["inconclusive"]
    shown = capsys.readouterr().out
    assert f"Cleared{MARK}\n" in shown
    assert "exit code is 2:" in shown
    suite = Xml.fromstring(files["junit"].read_text())
    failed = {case.get("name"): case.find("failure") for case in suite.iter("testcase")}
    failing = {name: case.get("message") for name, case in failed.items() if case is not None}
    failing.pop("check: X")
    assert failing == dict.fromkeys(("verdict", "criterion: d_min", "requirement: REQ-1"), SENTENCE)
    (log,) = json.loads(files["sarif"].read_text())["runs"]
    first = log["results"][0]
    assert (first["ruleId"], first["level"], first["message"]["text"]) == ("contradicted", "warning", SENTENCE)
    assert log["invocations"][0]["exitCode"] == CODES["inconclusive"]
    assert log["properties"]["headline"] == f"cleared{MARK}"
    with changed(service.engine, sa.update(Run).where(Run.id == 1).values(verdict="inconclusive")):
        assert command("follow", "R-0001", "--junit", files["junit"]) == CODES["inconclusive"]
    cases = {
        case.get("name"): case.find("failure") for case in Xml.fromstring(files["junit"].read_text()).iter("testcase")
    }
    failing = {name: case.get("message") for name, case in cases.items() if case is not None}
    failing.pop("check: X")
    assert failing == dict.fromkeys(("verdict", "criterion: d_min", "requirement: REQ-1"), SENTENCE)
    opening = files["summary"].read_text().partition("\n")[0]
    assert opening.startswith("## ❔ ")
    assert opening.endswith(f": exit code 2: cleared, but {SENTENCE.rstrip('.')}")
    command("runs")
    assert f"cleared{MARK}" in capsys.readouterr().out


def test_a_sweep_does_not_succeed_by_such_a_run(service: Service, client: httpx.Client) -> None:
    body = {"campaign": campaign(), "path": "avoider.d_0", "values": [1, 2]}
    assert client.post(f"{API}/sweeps", json=body).status_code == 201
    for _ in TWO:
        finish_fully(service, "cleared")

    def swept() -> tuple[Sweep, dict[str, int], list[str]]:
        sweep = Sweep.model_validate(client.get(f"{API}/sweeps/S-0001").json())
        (listed,) = client.get(f"{API}/sweeps").json()
        assert listed["states"] == sweep.states
        table = csv.DictReader(io.StringIO(client.get(f"{API}/sweeps/S-0001/table.csv").text))
        return sweep, sweep.states, [line["verdict"] + line["against"] for line in table]

    sweep, states, verdicts = swept()
    assert (states, verdicts, _sweep._code(sweep)) == ({"done": 2, "cleared": 2}, ["cleared"] * 2, 0)
    assert _sweep._counted(states) == "2 cleared"
    violated(service)
    sweep, states, verdicts = swept()
    assert states == {"done": 2, "cleared": 2, "contradicted": 1}
    assert _sweep._counted(states) == "2 cleared, of these 1 contradicted"
    assert verdicts == [f"cleared{MARK}{SENTENCE}", "cleared"]
    assert _sweep._code(sweep) == CODES["inconclusive"]
    assert f"cleared{MARK}, worst margin" in _sweep._line(sweep, sweep.points[0])
    assert _sweep._line(sweep, sweep.points[0]).endswith(f"; {SENTENCE.rstrip('.')}")


def test_what_states_a_verdict_and_what_it_lacks_states_what_speaks_against_it() -> None:
    stored = json.loads((REPOSITORY / "frontend" / "openapi.json").read_text(encoding="utf-8"))
    shown = {name: set(schema.get("properties", ())) for name, schema in stored["components"]["schemas"].items()}
    both = {name for name, fields in shown.items() if {"verdict", "not_sampled"} <= fields}
    assert {name for name in both if "against" not in shown[name]} == {"RunVerdict"}, "a result states no other run"
