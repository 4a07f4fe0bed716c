"""A simulator of an installed package through the command line and a whole service, each in processes of its own."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.faults.processes import CLEARANCE, REPOSITORY
from tests.faults.serving import serving
from tests.simulators import package

pytestmark = pytest.mark.timeout(300)

FLOWN = ("integrator", "DOP853", "half the step", "horizon", "flight", "closest approach")


def clearance(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    env = {**os.environ, "PYTHONPATH": package.path(folder)}
    return subprocess.run(
        [*CLEARANCE, *arguments], cwd=REPOSITORY, env=env, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return package.install(tmp_path_factory.mktemp("package"))


@pytest.mark.parametrize(("threshold", "verdict", "code"), [(5.0, "violated", 1), (2.0, "cleared", 0)])
def test_the_command_line_runs_it_to_a_verdict(
    installed: Path, tmp_path: Path, threshold: float, verdict: str, code: int
) -> None:
    file, out = tmp_path / "basins.json", tmp_path / "out"
    file.write_text(json.dumps(package.campaign(threshold)), encoding="utf-8")
    done = clearance(installed, "run", str(file), "--json", "--out", str(out))
    assert done.returncode == code, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    assert found["verdict"] == verdict
    places = [(f["parameters"]["simulator.x"], f["parameters"]["simulator.y"]) for f in found["findings"]]
    assert places == [pytest.approx((0.2, 0.7), abs=0.01), pytest.approx((0.75, 0.25), abs=0.01)]
    assert all(f["validation"]["again"]["cost"] == f["cost"] for f in found["findings"])
    names = [c["name"] for c in found["checks"]]
    assert "repetition" in names
    assert {"closest approach", "motion", "avoidance", "validation"}.isdisjoint(names)
    said = found["reason"] + " ".join(c["text"] for c in found["checks"])
    assert not [word for word in FLOWN if word in said]
    if verdict == "cleared":
        assert "Whether an encounter takes place was not checked." in found["reason"]
    audited = clearance(installed, "audit", str(out))
    assert audited.returncode == 0, audited.stdout + audited.stderr


def test_without_the_package_the_campaign_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "basins.json"
    file.write_text(json.dumps(package.campaign()), encoding="utf-8")
    done = clearance(tmp_path, "run", str(file))
    assert done.returncode == 3, done.stderr
    assert "no such simulator in this installation" in done.stderr


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
    for path in ("stages", "components", "history", "evaluations?stage=2", "findings", "traces", "campaign.yaml"):
        answer = client.get(f"{base}/{path}")
        assert answer.status_code == 200, f"{path}: {answer.text}"
    assert len(client.get(f"{base}/findings").json()) == 2
    for name in ("run.json", "evaluations.csv", "findings.csv"):
        assert client.get(f"{base}/exports/{name}").status_code == 200, name
    report = client.get(f"{base}/report.html")
    assert report.status_code == 200, report.text
    assert "This simulator gives no trace." in report.text
    assert "Evaluated again" in report.text
    assert "Reference integrator" not in report.text
    preview = client.post("/api/v1/campaigns/preview", json={"campaign": package.campaign()})
    assert preview.status_code == 422
    assert "a simulator has no preview" in preview.text


def test_an_unknown_simulator_is_refused(visit: Visit) -> None:
    client, _, _ = visit
    given = client.post("/api/v1/runs", json={"campaign": package.campaign(simulator={"name": "none_such"})})
    assert given.status_code == 422
    assert "no such simulator in this installation" in given.text


def test_the_stored_run_is_audited(visit: Visit, installed: Path) -> None:
    _, run, data = visit
    done = clearance(installed, "audit", run, "--data", str(data))
    assert done.returncode == 0, done.stdout + done.stderr
