"""A simulator of an installed package through the command line and a whole service, which is in other processes."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import websockets
from websockets.sync.client import connect

from backend.exports.format import known
from clearance.cli import invoke
from tests.faults.serving import serving
from tests.given.problem_documents import problem
from tests.given.refused_commands import fields
from tests.given.reported_runs import missing
from tests.given.viewer_clients import PROTOCOL
from tests.simulators import package
from worker.evidence.scopes.simulators import UNCHECKED
from worker.running.catalogue.installed import forget_simulators

pytestmark = pytest.mark.timeout(300)

CLEARED = pytest.param(1.0, "cleared", 0, marks=pytest.mark.nightly)
"""By day a cleared run is submitted to the service, below."""

VERSIONS = ("integrator", "DOP853", "half the step", "horizon", "flight", "closest approach")


Command = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return package.install(tmp_path_factory.mktemp("package"))


@pytest.fixture
def clearance(
    installed: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Iterator[Command]:
    """The command line of an installation with the package, in this process: its exit code and output."""

    def run(*arguments: str) -> tuple[int, str, str]:
        capsys.readouterr()
        return invoke(arguments), *capsys.readouterr()

    monkeypatch.syspath_prepend(str(installed))
    forget_simulators()
    yield run
    monkeypatch.undo()
    sys.modules.pop("basins", None)
    forget_simulators()


@pytest.mark.parametrize(("threshold", "verdict", "code"), [(5.0, "violated", 1), CLEARED])
def test_the_command_line_runs_it_to_a_verdict(
    clearance: Command, tmp_path: Path, threshold: float, verdict: str, code: int
) -> None:
    file, out = tmp_path / "basins.json", tmp_path / "out"
    file.write_text(json.dumps(package.campaign(threshold)), encoding="utf-8")
    ended, shown, errors = clearance("run", str(file), "--json", "--out", str(out))
    assert ended == code, errors
    found: dict[str, Any] = json.loads(shown)
    assert found["verdict"] == verdict
    places = [(f["parameters"]["simulator.x"], f["parameters"]["simulator.y"]) for f in found["findings"]]
    assert places == [pytest.approx((0.2, 0.7), abs=0.01), pytest.approx((0.75, 0.25), abs=0.01)]
    assert all(f["validation"]["again"]["cost"] == f["cost"] for f in found["findings"])
    names = [c["name"] for c in found["checks"]]
    assert "repetition" in names
    assert {"closest approach", "motion", "avoidance", "validation"}.isdisjoint(names)
    statement = found["reason"] + " ".join(c["text"] for c in found["checks"])
    assert not [word for word in VERSIONS if word in statement]
    if verdict == "cleared":
        assert UNCHECKED in found["reason"]
    if verdict == "violated":
        assert clearance("audit", str(out))[0] == 0


def test_without_the_package_the_campaign_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "basins.json"
    file.write_text(json.dumps(package.campaign()), encoding="utf-8")
    assert invoke(["run", str(file)]) == 3
    assert fields(capsys.readouterr().err) == ["simulator.name"]


@pytest.fixture(scope="module")
def visit(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[httpx.Client, str, Path]]:
    """A signed-in client of `clearance serve`, a finished run, and the folder of the data."""
    with serving(tmp_path_factory.mktemp("service"), PYTHONPATH=package.path(installed)) as service:
        link = service.link()
        with httpx.Client(base_url=link.partition("/login")[0], trust_env=False, timeout=30) as client:
            assert client.get(link).status_code == 303
            client.headers["Origin"] = str(client.base_url).rstrip("/")
            given = client.post("/api/v1/runs", json={"campaign": package.campaign(), "name": "Basins"})
            assert given.status_code == 201, given.text
            yield client, finished(client, given.json()["id"]), service.data


def finished(client: httpx.Client, run: str) -> str:
    """Wait for a run to be done, by its own events."""
    from tests.faults.processes import until

    until(lambda: client.get(f"/api/v1/runs/{run}").json()["state"] in ("done", "failed"), "the run is over", 120)
    told = client.get(f"/api/v1/runs/{run}").json()
    assert told["state"] == "done", told
    return run


Visit = tuple[httpx.Client, str, Path]


def test_the_service_lists_it_and_shows_the_run(visit: Visit) -> None:
    client, run, _ = visit
    entry = client.get("/api/v1/components").json()["simulators"][0]
    assert (entry["name"], [r["name"] for r in entry["results"]]) == ("two_basins", ["separation", "effort"])
    told = client.get(f"/api/v1/runs/{run}").json()
    assert (told["verdict"], told["quantity"], told["unit"]) == ("violated", "d_sep", "m")
    assert told["campaign"]["simulator"]["name"] == "two_basins"
    assert "scenario" not in told["campaign"]
    listed = client.get("/api/v1/runs").json()["items"][0]
    assert (listed["id"], listed["quantity"]) == (run, "d_sep")


def test_every_result_and_export_answers(visit: Visit) -> None:
    client, run, _ = visit
    base = f"/api/v1/runs/{run}"
    for path in ("stages", "components", "history", "evaluations", "findings", "traces", "campaign.yaml"):
        answer = client.get(f"{base}/{path}")
        assert answer.status_code == 200, f"{path}: {answer.text}"
    assert len(client.get(f"{base}/findings").json()) == 2
    for name in ("run.json", "evaluations.csv", "findings.csv"):
        assert client.get(f"{base}/exports/{name}").status_code == 200, name
    report = client.get(f"{base}/report.html")
    assert report.status_code == 200, report.text
    assert "trace" in missing(report.text)
    assert "Evaluated again" in report.text
    assert "Reference integrator" not in report.text
    preview = client.post("/api/v1/campaigns/preview", json={"campaign": package.campaign()})
    assert [error["field"] for error in problem(preview, 422)["errors"]] == ["simulator"]


def test_an_unknown_simulator_is_refused(visit: Visit) -> None:
    client, _, _ = visit
    given = client.post("/api/v1/runs", json={"campaign": package.campaign(simulator={"name": "none_such"})})
    assert [e["field"] for e in problem(given, 422, "invalid-campaign")["errors"]] == ["simulator.name"]


@pytest.mark.parametrize(
    ("command", "statement"),
    [
        # by day the folder of the command line's run is audited, above
        pytest.param("audit", "follows", marks=pytest.mark.nightly),
        ("replay", "All 2 agree."),
    ],
)
def test_the_stored_run_is_audited_and_replayed(visit: Visit, clearance: Command, command: str, statement: str) -> None:
    _, run, data = visit
    code, shown, errors = clearance(command, run, "--data", str(data))
    assert code == 0, shown + errors
    assert statement in shown


KEY = "0b6c1e0e-4f5a-4a3b-9d1c-2f8e7a6b5c4d"
WITHOUT_A_TRACE = {
    "/api/v1/runs/{run}/traces/{name}": "no stored flight",
    "/api/v1/runs/{run}/exports/flight-F1.html": "no stored flight",
    "/api/v1/runs/{run}/exports/worst-case.svg": "no flight of it is stored",
    "/api/v1/runs/{run}/views/{key}": "it has no 3D view",
    "/view/{run}/": "it has no 3D view",
    "/view/{run}/F1/recorded/": "no stored flight",
}
"""What a run without a trace refuses, with 404 and these words; everything else that is read is there."""


class TestEveryRoute:
    """Every route and every action of a page, for a run whose system gives no trace."""

    def test_what_is_read_is_there_or_is_refused_in_words(self, visit: Visit) -> None:
        client, run, _ = visit
        described = client.get("/api/v1/openapi.json").json()["paths"]
        paths = [path for path, asked in described.items() if "{run}" in path and "get" in asked]
        assert len(paths) > 15
        served = [one.file.replace("{label}", "F1") for one in known() if not one.address]
        exports = {f"/api/v1/runs/{{run}}/exports/{file}" for file in served}
        for path in {*paths, *exports, *WITHOUT_A_TRACE}:
            place = path.format(run=run, name="F1", file="run.json", key=KEY)
            asked = {"against": run} if path.endswith("/code") else None
            answer = client.get(place, params=asked)
            if path in WITHOUT_A_TRACE:
                assert answer.status_code == 404, path
                assert WITHOUT_A_TRACE[path] in answer.json()["detail"], answer.text
            elif not path.endswith("report.pdf"):  # report.html in print: tests/api/reports/test_reports.py
                assert answer.status_code == 200, f"{path}: {answer.text[:300]}"

    def test_findings_are_written_without_flights(self, visit: Visit) -> None:
        client, run, _ = visit
        found = client.get(f"/api/v1/runs/{run}/findings").json()
        rows = list(csv.DictReader(io.StringIO(client.get(f"/api/v1/runs/{run}/exports/findings.csv").text)))
        assert [row["flight"] for row in rows] == ["nominal", "F1", "F2"]
        for row, finding in zip(rows[1:], found, strict=True):
            assert float(row["d_sep [m]"]) == finding["cost"]
            assert float(row["margin"]) == finding["margin"]
            assert {path: float(row[path]) for path in finding["parameters"]} == finding["parameters"]
        assert (float(rows[0]["simulator.x"]), rows[0]["validated"]) == (0.5, "")
        listed = {
            f["href"].rpartition("/")[2]: f["unavailable"] for f in client.get(f"/api/v1/runs/{run}/exports").json()
        }
        assert listed["findings.csv"] is None
        assert listed["traces.mat"].endswith(" trace")

    def test_its_socket_is_refused_and_nothing_goes_wrong_in_the_log(self, visit: Visit) -> None:
        client, run, data = visit
        cookies = "; ".join(f"{name}={value}" for name, value in client.cookies.items())
        headers = {"Cookie": cookies, "Origin": client.headers["Origin"]}
        address = f"{str(client.base_url).replace('http', 'ws', 1).rstrip('/')}/view/{run}/key/{KEY}"
        protocol = [websockets.Subprotocol(PROTOCOL)]
        with (
            pytest.raises(websockets.InvalidStatus),
            connect(address, additional_headers=headers, subprotocols=protocol, proxy=None),
        ):
            pass
        assert "Traceback" not in "".join(log.read_text(encoding="utf-8") for log in (data / "logs").iterdir())

    @pytest.mark.parametrize("given", [{"simulator.x": 0.3}, {"simulator.q": 1.0}, {}])
    def test_a_what_if_is_refused_in_words(self, visit: Visit, given: dict[str, float]) -> None:
        client, run, _ = visit
        answer = client.post(f"/api/v1/runs/{run}/flights", json={"parameters": given})
        assert answer.status_code == 422
        assert answer.json()["type"].endswith("not-flyable")

    def test_it_is_signed_off_and_the_word_withdrawn(self, visit: Visit) -> None:
        client, run, _ = visit
        base = f"/api/v1/runs/{run}/signoffs"
        digest = client.get(base).json()["digest"]
        signed = client.post(base, json={"name": "Ada", "role": "Engineer", "digest": digest})
        assert signed.status_code == 201, signed.text
        withdrawn = client.post(f"{base}/{signed.json()['id']}/withdraw", json={"reason": "Another model"})
        assert withdrawn.json()["withdrawn_reason"] == "Another model"

    @pytest.mark.nightly
    def test_a_draft_of_it_is_stored_checked_and_run(self, visit: Visit) -> None:
        client, run, _ = visit
        text = client.get(f"/api/v1/runs/{run}/campaign.yaml").text
        kept = client.post("/api/v1/drafts", json={"name": "Again", "text": text}).json()
        assert client.get(f"/api/v1/drafts/{kept['id']}").json()["text"] == text
        yaml = {"Content-Type": "application/yaml"}
        checked = client.post("/api/v1/campaigns/check", content=text, headers=yaml).json()
        assert checked["ok"], checked["problems"]
        assert checked["digest"] == client.get(f"/api/v1/runs/{run}").json()["campaign_digest"]
        stages = client.get(f"/api/v1/runs/{run}/stages").json()
        (seed,) = [stage["result"]["seed"] for stage in stages if stage["kind"] == "certify"]
        asked = {"campaign": checked["document"], "name": "Again", "text": text, "sample_seed": seed}
        again = client.post("/api/v1/runs", json=asked)
        assert again.status_code == 201, again.text
        other = finished(client, again.json()["id"])
        first, second = (client.get(f"/api/v1/runs/{name}/findings").json() for name in (run, other))
        assert [f["cost"] for f in second] == [f["cost"] for f in first]
        gone = client.delete(f"/api/v1/runs/{other}", params={"reason": "A copy"})
        assert gone.status_code in (200, 204), gone.text
        assert client.post(f"/api/v1/runs/{other}/restore").status_code in (200, 204)

    @pytest.mark.nightly
    def test_it_is_submitted_and_followed_from_the_command_line(
        self, visit: Visit, clearance: Command, tmp_path: Path
    ) -> None:
        client, _, data = visit
        file, out = tmp_path / "basins.json", tmp_path / "out"
        file.write_text(json.dumps(package.campaign(1.0)), encoding="utf-8")
        code, shown, errors = clearance("token", "create", "ci", "--data", str(data))
        assert code == 0, errors
        (tmp_path / "token").write_text(shown.split()[-1], encoding="utf-8")
        service = ("--service", str(client.base_url), "--token-file", str(tmp_path / "token"))
        code, shown, errors = clearance("submit", str(file), "--out", str(out), *service)
        assert code == 0, shown + errors
        assert shown.splitlines()[0] == "Cleared"
        assert (out / "findings.csv").read_text(encoding="utf-8").count("\n") == 4
