"""The same question over time in the browser: other runs with the same input, trends, sweeps, reports.

The runs are written as a worker writes them; nothing is simulated.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from typing import Any

import pytest
import sqlalchemy as sa
from playwright.sync_api import Browser, Page, expect

from backend.db.tables import Run
from tests.e2e.browser import Visit, visiting
from tests.e2e.looking import looks
from tests.e2e.stored import served
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(300),
    pytest.mark.nightly,
]  # by day tests/api/trends and sweeps
DRAWS = False


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """R-0001 to R-0003 of one campaign, R-0003 by other code; then a sweep with runs in every state."""
    with served(tmp_path_factory.mktemp("over-time")) as service:
        with service.signed_in() as client:
            for verdict in ("cleared", "violated", "inconclusive"):
                labels = {"branch": "other" if verdict == "violated" else "main"}
                sent = client.post("/api/v1/runs", json={"campaign": campaign(), "labels": labels})
                assert sent.status_code == 201
                finish_fully(service, verdict)
            swept: dict[str, Any] = {"campaign": campaign(), "path": "avoider.d_0", "values": [1.0, 1.5, 2.0, 2.5, 3.0]}
            assert client.post("/api/v1/sweeps", json=swept).status_code == 201
            for verdict in ("cleared", "violated", "inconclusive"):
                finish_fully(service, verdict)
            assert client.post("/api/v1/runs/R-0007/cancel").status_code == 200
        with service.engine.begin() as writer:
            writer.execute(sa.update(Run).where(Run.id == 3).values(flown={"code": "beef" * 16}))
            for run, worst in ((2, 0.4), (5, 0.2)):
                writer.execute(sa.update(Run).where(Run.id == run).values(worst_cost=worst))
        yield service


@pytest.fixture(scope="module")
def visit(filled: Service, browser: Browser) -> Iterator[Visit]:
    with visiting(browser, filled.url) as visit:
        visit.sign_in(filled.login_code())
        yield visit


def row(page: Page, text: str) -> Any:
    return page.locator("tr").filter(has_text=text)


@pytest.mark.nightly
def test_other_runs_with_the_same_input(visit: Visit) -> None:
    visit.go("/runs/R-0001")
    visit.near("#related")
    card = visit.page.locator("#related")
    expect(card.locator("tbody tr")).to_have_count(2)
    other = card.locator("tbody tr").first
    expect(other).to_contain_text("Inconclusive")
    expect(other).to_contain_text("code")
    expect(card.locator("tbody tr").last).to_contain_text("nothing")
    visit.shot("related", of=card)
    other.get_by_role("link", name="Compare R-0001 with R-0003").click()
    expect(visit.page).to_have_url(re.compile(r"/compare\?runs=R-0001,R-0003"))
    visit.page.go_back()
    card.get_by_role("link", name="Trend").click()
    expect(visit.page.get_by_text("The code changed before R-0003")).to_be_visible()
    expect(visit.page.locator("canvas")).to_have_count(2)
    expect(row(visit.page, "R-0002")).to_contain_text("−0.1000 m")
    looks(visit, "trend")
    visit.page.get_by_role("button", name="Label").click()
    visit.page.get_by_role("checkbox", name="branch=main").check()
    visit.page.keyboard.press("Escape")
    expect(row(visit.page, "R-0002")).to_have_count(0)
    expect(row(visit.page, "R-0003")).to_contain_text("branch=main")
    expect(visit.page).to_have_url(re.compile("label="))


def test_the_page_of_a_sweep_shows_its_runs(visit: Visit) -> None:
    visit.move("/sweeps")
    name = str(campaign()["name"])
    visit.page.get_by_role("link", name=name).click()
    expect(visit.page.get_by_role("heading", level=1)).to_have_text(name)
    expect(visit.page.locator("canvas")).to_have_count(2)
    expect(row(visit.page, "R-0005")).to_contain_text("Violated")
    for run, word in (("R-0007", "Cancelled"), ("R-0008", "Queued")):
        expect(row(visit.page, run)).to_contain_text(word)
        expect(row(visit.page, run).locator("td").nth(3)).to_have_text("—")
    looks(visit, "sweep")
    with visit.page.expect_download() as download:
        visit.page.get_by_role("link", name="CSV").click()
    with download.value.path().open(newline="") as file:
        assert [line["state"] for line in csv.DictReader(file)] == ["done", "done", "done", "cancelled", "queued"]
    visit.page.get_by_role("button", name="Cancel").click()
    visit.page.get_by_role("button", name="Cancel it").click()
    expect(row(visit.page, "R-0008")).to_contain_text("Cancelled")
    expect(visit.page.get_by_role("button", name="Cancel")).to_have_count(0)


def test_a_sweep_is_launched(visit: Visit) -> None:
    visit.move("/launch?from=R-0001")
    card = visit.page.locator("#sweep")
    card.get_by_role("button", name="Show").click()
    card.get_by_label("Parameter").select_option("avoider.k_rep")
    card.get_by_label("Values").fill("1, 1")
    expect(card).to_contain_text("given twice")
    card.get_by_label("Values").fill("1, 2, 4")
    visit.shot("sweep-form", of=card)
    card.get_by_role("button", name="Start 3 runs").click()
    expect(visit.page).to_have_url(re.compile(r"/sweeps/S-0002$"))
    expect(visit.page.locator("tbody tr")).to_have_count(3)


def test_reports_are_listed_and_searched(visit: Visit) -> None:
    visit.page.get_by_role("link", name="Reports").click()
    expect(visit.page.locator("tbody tr")).to_have_count(8)
    looks(visit, "reports")
    search = visit.page.get_by_role("searchbox", name="Search reports")
    search.fill("R-0002")
    expect(visit.page.locator("tbody tr")).to_have_count(1)
    expect(search).to_be_focused()
    link = visit.page.get_by_role("link", name="HTML report of R-0002")
    expect(link).to_have_attribute("href", "/api/v1/runs/R-0002/report.html")
    search.fill("nothing like it")
    expect(visit.page.get_by_text("No report matches.")).to_be_visible()
