"""The program of docs/examples/drop the whole way: launched from the form, its page, and what the API answers of it."""

from __future__ import annotations

import csv
import io
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.browser import Visit, visiting
from tests.faults.processes import CLEARANCE, REPOSITORY, until
from tests.faults.serving import Service, serving
from tests.simulators import dropped

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]
DRAWS = False
FLIES = re.compile(r"\b(flights?|flown|flies|fly)\b", re.IGNORECASE)


@dataclass
class Opened:
    """A signed-in page, the service, and the runs: one call for each evaluation, and with repeats."""

    visit: Visit
    service: Service

    def get(self, path: str) -> Any:
        answer = self.visit.page.request.get(f"{self.visit.address}/api/v1{path}")
        assert answer.ok, f"{path}: {answer.text()}"
        return answer.json() if "json" in answer.headers["content-type"] else answer.text()

    def post(self, path: str, data: Any) -> Any:
        headers = {"Origin": self.visit.address}
        return self.visit.page.request.post(f"{self.visit.address}/api/v1{path}", data=data, headers=headers)

    def over(self, run: str) -> None:
        until(lambda: self.get(f"/runs/{run}")["state"] in ("done", "failed"), f"{run} is over", 90)
        assert self.get(f"/runs/{run}")["state"] == "done"


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory, browser: Browser) -> Iterator[Opened]:
    folder = dropped.install(tmp_path_factory.mktemp("simulators"))
    with (
        serving(tmp_path_factory.mktemp("service"), CLEARANCE_SIMULATORS=str(folder)) as service,
        visiting(browser, service.link().partition("/login")[0]) as visit,
    ):
        visit.page.goto(service.link())
        found = Opened(visit, service)
        given = found.post("/runs", {"campaign": dropped.campaign(), "name": "Drop"})
        assert given.status == 201, given.text()
        found.over("R-0001")
        yield found


def test_the_page_of_the_run_shows_its_traces_and_no_flights(opened: Opened) -> None:
    visit, page = opened.visit, opened.visit.page
    visit.go("/runs/R-0001")
    expect(page.get_by_test_id("verdict")).to_have_text(re.compile("Violated"))
    trace = page.locator("#motion")
    expect(trace.get_by_text("Trace over time")).to_be_visible()
    expect(trace.locator("canvas")).to_have_count(3)
    expect(trace.get_by_text("in evaluations with the stored values")).to_be_visible()
    expect(page.get_by_text("This run evaluates a simulator: there is no 3D view.")).to_be_visible()
    expect(page.get_by_text("which columns of the trace are positions")).to_be_visible()
    expect(page.get_by_text("This system provides no trace")).to_have_count(0)
    expect(page.get_by_text("Measured before the search")).to_be_visible()
    expect(page.locator("iframe")).to_have_count(0)
    assert FLIES.findall(page.locator("main").inner_text()) == []
    visit.shot("simulator-trace")
    visit.go("/runs/R-0001/flight")
    expect(page.get_by_role("heading", name="There is no 3D view")).to_be_visible()


def test_it_is_launched_from_the_form_with_repeats_and_retries(opened: Opened) -> None:
    visit, page = opened.visit, opened.visit.page
    visit.go("/launch?from=R-0001")
    expect(page.get_by_role("combobox", name="Simulator", exact=True)).to_have_value("Parachute drop past a mast")
    mass = page.get_by_label("Parachute drop past a mast, Mass of the load", exact=True)
    expect(mass).to_be_visible()
    card = page.get_by_role("region", name="Simulator")
    expect(card).to_contain_text("kg")
    expect(card).to_contain_text("m/s")
    card.get_by_text("one call for every evaluation").click()
    page.get_by_label("Calls of the simulator for every evaluation").fill("2")
    page.get_by_label("Retries of a failed call").fill("99")
    expect(card.get_by_text(re.compile("less than or equal to 10"))).to_be_visible()
    page.get_by_label("Retries of a failed call").fill("1")
    expect(card.get_by_text(re.compile("less than or equal to 10"))).to_have_count(0)
    mass.fill("1.5")
    page.get_by_role("button", name="Start run").click()
    expect(page).to_have_url(re.compile("R-0002"))
    asked = opened.get("/runs/R-0002")["campaign"]["simulator"]
    assert (asked["repeats"]["count"], asked["repeats"]["combine"], asked["retries"]) == (2, "worst", 1)
    assert asked["parameters"] == {"mass": 1.5}
    assert opened.post("/runs/R-0002/cancel", {}).ok
    until(lambda: opened.get("/runs/R-0002")["state"] in ("cancelled", "done"), "R-0002 is over", 60)


@pytest.mark.nightly
def test_repeats_are_shown_as_calls(opened: Opened) -> None:
    visit, page = opened.visit, opened.visit.page
    asked = {"name": "drop", "repeats": {"count": 2}, "retries": 1}
    run = opened.post("/runs", {"campaign": dropped.campaign(simulator=asked), "name": "Calls"}).json()["id"]
    opened.over(run)
    visit.go(f"/runs/{run}")
    expect(page.get_by_test_id("verdict")).to_be_visible()
    expect(page.get_by_text(re.compile(r"in \d+ of 10")).first).to_be_visible()
    assert FLIES.findall(page.locator("main").inner_text()) == []


def test_traces_are_exported_as_stored(opened: Opened) -> None:
    listed = {trace["name"]: trace for trace in opened.get("/runs/R-0001/traces")}
    findings = {finding["label"]: finding for finding in opened.get("/runs/R-0001/findings")}
    assert listed.keys() == {"nominal", *findings}
    assert [(c["name"], c["unit"], c["group"]) for c in listed["nominal"]["columns"]] == [
        ("time", "s", "time"), ("x", "m", "signal"), ("z", "m", "signal"), ("descent", "m/s", "signal"),
    ]  # fmt: skip
    rows = list(csv.DictReader(io.StringIO(opened.get("/runs/R-0001/exports/traces.csv"))))
    for name, trace in listed.items():
        of = [row for row in rows if row["flight"] == name]
        assert len(of) == trace["rows"] > 100
        assert (float(of[0]["z [m]"]), float(of[0]["time [s]"])) == (100.0, 0.0)
        if name in findings:
            assert trace["meta"]["cost"] == findings[name]["cost"]
    files = {f["href"].rpartition("/")[2]: f for f in opened.get("/runs/R-0001/exports")}
    assert not [name for name in files if name.startswith("flight-")]
    assert not [f["title"] for f in files.values() if FLIES.search(f["title"] + f["text"])]
    assert files["traces.csv"]["unavailable"] is None
    assert len(opened.get("/runs/R-0001/exports/run.json")["traces"]) == len(listed)


def test_report_sign_off_and_audit(opened: Opened) -> None:
    report = opened.get("/runs/R-0001/report.html")
    assert "The traces of this simulator are on the page of the run and in its exports" in report
    base = "/runs/R-0001/signoffs"
    digest = opened.get(base)["digest"]
    signed = opened.post(base, {"name": "Ada", "role": "Engineer", "digest": digest})
    assert signed.status == 201, signed.text()
    data = str(opened.service.data)
    done = subprocess.run(
        [*CLEARANCE, "audit", "R-0001", "--data", data], cwd=REPOSITORY, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_3d_recordings_and_what_if_simulations_are_refused_with_a_sentence(opened: Opened) -> None:
    page, address = opened.visit.page, opened.visit.address
    recorded = page.request.get(f"{address}/api/v1/runs/R-0001/exports/flight-nominal.html")
    assert (recorded.status, "has no 3D view" in recorded.text()) == (404, True), recorded.text()
    assert opened.post("/runs/R-0001/flights", {"parameters": {"simulator.wind": 1.0}}).status == 422


def test_a_simulator_given_as_code_is_refused(opened: Opened) -> None:
    given = opened.post("/runs", {"campaign": dropped.campaign(simulator={"command": ["sh", "-c", "true"]})})
    assert given.status == 422
    assert "CLEARANCE_SIMULATORS" in given.text()


def test_the_two_runs_are_compared(opened: Opened) -> None:
    visit, page = opened.visit, opened.visit.page
    visit.go("/compare?runs=R-0001,R-0002")
    expect(page.locator("#convergence canvas").first).to_be_visible()
    assert FLIES.findall(page.locator("main").inner_text()) == []
