"""The program of docs/examples/drop: its page, its form, and what the API answers of it; a worker evaluated the run."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from clearance.cli import invoke
from tests.e2e.browser import Visit, visiting
from tests.e2e.flown import DROP, asked
from tests.e2e.looking import api
from tests.faults.processes import until
from tests.faults.serving import serving
from tests.given.reported_runs import missing
from tests.given.service import Service
from tests.simulators import dropped

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(300),
    pytest.mark.nightly,
]  # by day tests/api/runs
DRAWS = False
LAUNCHED = f"R-{len(asked()) + 1:04}"
"""The run that a test launches."""
FLIES = re.compile(r"\b(flights?|flown|flies|fly)\b", re.IGNORECASE)


@dataclass
class Opened:
    """A signed-in page, and the service."""

    visit: Visit
    service: Service

    def get(self, path: str) -> Any:
        answer = self.visit.page.request.get(f"{self.visit.address}/api/v1{path}")
        assert answer.ok, f"{path}: {answer.text()}"
        return answer.json() if "json" in answer.headers["content-type"] else answer.text()

    def post(self, path: str, data: Any) -> Any:
        return post(self.visit, path, data)


def post(visit: Visit, path: str, data: Any) -> Any:
    """Ask the API in this browser's session."""
    return visit.page.request.post(f"{visit.address}/api/v1{path}", data=data, headers={"Origin": visit.address})


@pytest.fixture(scope="module")
def opened(stored: Service, browser: Browser) -> Iterator[Opened]:
    if dropped.compiler() is None:
        pytest.skip("no C compiler")
    with visiting(browser, stored.url) as visit:
        visit.sign_in(stored.login_code())
        yield Opened(visit, stored)


def test_the_page_of_the_run_shows_its_traces_and_no_flights(opened: Opened) -> None:
    visit, page = opened.visit, opened.visit.page
    visit.go(f"/runs/{DROP}")
    expect(page.get_by_test_id("verdict")).to_have_text(re.compile("Violated"))
    trace = page.locator("#motion")
    expect(trace.get_by_text("Trace over time")).to_be_visible()
    visit.near("#motion")
    expect(trace.locator("canvas")).to_have_count(3)
    expect(trace.get_by_text("in evaluations with the stored values")).to_be_visible()
    expect(page.get_by_text("This run evaluates a simulator: there is no 3D view.")).to_be_visible()
    expect(page.get_by_text("which columns of the trace are positions")).to_be_visible()
    expect(page.get_by_text("This simulator declares no trace")).to_have_count(0)
    expect(page.get_by_text("Measured before the search")).to_be_visible()
    expect(page.locator("iframe")).to_have_count(0)
    assert FLIES.findall(page.locator("main").inner_text()) == []
    visit.shot("simulator-trace")
    visit.move(f"/runs/{DROP}/flight")
    expect(page.get_by_role("heading", name="There is no 3D view")).to_be_visible()


def test_it_is_launched_from_the_form_with_repeats_and_retries(opened: Opened) -> None:
    visit, page = opened.visit, opened.visit.page
    visit.move(f"/launch?from={DROP}")
    expect(page.get_by_role("combobox", name="Simulator", exact=True)).to_have_value("Parachute drop past a mast")
    mass = page.get_by_label("Parachute drop past a mast, Mass of the load", exact=True)
    expect(mass).to_be_visible()
    card = page.get_by_role("region", name="Simulator")
    expect(card).to_contain_text("kg")
    expect(card).to_contain_text("m/s")
    card.get_by_text("one call for every evaluation").click()
    page.get_by_label("Calls of the simulator for every evaluation").fill("2")
    page.get_by_label("Retries of a failed call").fill("99")
    expect(card.get_by_text(re.compile("at most 10"))).to_be_visible()
    page.get_by_label("Retries of a failed call").fill("1")
    expect(card.get_by_text(re.compile("at most 10"))).to_have_count(0)
    mass.fill("1.5")
    page.get_by_role("button", name="Start run").click()
    expect(page).to_have_url(re.compile(LAUNCHED))
    given = opened.get(f"/runs/{LAUNCHED}")["campaign"]["simulator"]
    assert (given["repeats"]["count"], given["repeats"]["combine"], given["retries"]) == (2, "worst", 1)
    assert given["parameters"] == {"mass": 1.5}
    assert opened.post(f"/runs/{LAUNCHED}/cancel", {}).ok
    assert opened.get(f"/runs/{LAUNCHED}")["state"] == "cancelled"


@pytest.mark.nightly
def test_repeats_are_shown_as_calls(tmp_path: Path, browser: Browser) -> None:
    if dropped.compiler() is None:
        pytest.skip("no C compiler")
    folder = dropped.install(tmp_path / "simulators")
    with (
        serving(tmp_path, CLEARANCE_SIMULATORS=str(folder)) as service,
        visiting(browser, service.address()) as visit,
    ):
        page = visit.page
        page.goto(service.link())
        repeated = {"name": "drop", "repeats": {"count": 2}, "retries": 1}
        run = post(visit, "/runs", {"campaign": dropped.campaign(simulator=repeated), "name": "Calls"}).json()["id"]
        until(lambda: api(visit, f"/runs/{run}")["state"] == "done", f"{run} is over", 90)
        visit.go(f"/runs/{run}")
        expect(page.get_by_test_id("verdict")).to_be_visible()
        expect(page.get_by_text(re.compile(r"in \d+ of 10")).first).to_be_visible()
        assert FLIES.findall(page.locator("main").inner_text()) == []


def test_traces_are_exported_as_stored(opened: Opened) -> None:
    listed = {trace["name"]: trace for trace in opened.get(f"/runs/{DROP}/traces")}
    findings = {finding["label"]: finding for finding in opened.get(f"/runs/{DROP}/findings")}
    assert listed.keys() == {"nominal", *findings}
    assert [(c["name"], c["unit"], c["group"]) for c in listed["nominal"]["columns"]] == [
        ("time", "s", "time"), ("x", "m", "signal"), ("z", "m", "signal"), ("descent", "m/s", "signal"),
    ]  # fmt: skip
    rows = list(csv.DictReader(io.StringIO(opened.get(f"/runs/{DROP}/exports/traces.csv"))))
    for name, trace in listed.items():
        of = [row for row in rows if row["flight"] == name]
        assert len(of) == trace["rows"] > 100
        assert (float(of[0]["z [m]"]), float(of[0]["time [s]"])) == (100.0, 0.0)
        if name in findings:
            assert trace["meta"]["cost"] == findings[name]["cost"]
    files = {f["href"].rpartition("/")[2]: f for f in opened.get(f"/runs/{DROP}/exports")}
    assert not [name for name in files if name.startswith("flight-")]
    assert not [f["title"] for f in files.values() if FLIES.search(f["title"] + f["text"])]
    assert files["traces.csv"]["unavailable"] is None
    assert len(opened.get(f"/runs/{DROP}/exports/run.json")["traces"]) == len(listed)


def test_report_sign_off_and_audit(opened: Opened, capsys: pytest.CaptureFixture[str]) -> None:
    report = opened.get(f"/runs/{DROP}/report.html")
    assert "drawing" in missing(report)
    base = f"/runs/{DROP}/signoffs"
    digest = opened.get(base)["digest"]
    signed = opened.post(base, {"name": "Ada", "role": "Engineer", "digest": digest})
    assert signed.status == 201, signed.text()
    capsys.readouterr()
    assert invoke(["audit", DROP, "--data", str(opened.service.settings.data)]) == 0, capsys.readouterr()


def test_3d_recordings_and_what_if_simulations_are_refused_with_a_sentence(opened: Opened) -> None:
    page, address = opened.visit.page, opened.visit.address
    recorded = page.request.get(f"{address}/api/v1/runs/{DROP}/exports/flight-nominal.html")
    assert (recorded.status, "has no 3D view" in recorded.text()) == (404, True), recorded.text()
    assert opened.post(f"/runs/{DROP}/flights", {"parameters": {"simulator.wind": 1.0}}).status == 422


def test_a_simulator_given_as_code_is_refused(opened: Opened) -> None:
    given = opened.post("/runs", {"campaign": dropped.campaign(simulator={"command": ["sh", "-c", "true"]})})
    assert given.status == 422
    assert "CLEARANCE_SIMULATORS" in given.text()


def test_the_two_runs_are_compared(opened: Opened) -> None:
    visit, page = opened.visit, opened.visit.page
    visit.move(f"/compare?runs={DROP},{LAUNCHED}")
    visit.near("#convergence")
    expect(page.locator("#convergence canvas").first).to_be_visible()
    assert FLIES.findall(page.locator("main").inner_text()) == []
