"""A sign-off that became suspect, and one that a repetition carries on, on every page and report that shows it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa
from playwright.sync_api import Browser, expect

from backend.db.tables import CatalogueDocument
from tests.e2e.browser import Visit, visiting
from tests.e2e.looking import looks
from tests.e2e.stored import served
from tests.given.code_versions import edited
from tests.given.reported_runs import finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.submissions import submit

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(240)]
DRAWS = False
SIGNED, REPEATED, REQUIREMENT = "R-0001", "R-0002", "SYS-1"
API = "/api/v1"


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A signed run of a requirement, and one that repeats it bit by bit."""
    with served(tmp_path_factory.mktemp("standing") / "data") as service, service.signed_in() as client:
        text = {"id": REQUIREMENT, "text": "Keeps 0.5 m away."}
        assert client.put(f"{API}/requirements", json=text).status_code == 200
        for _ in range(2):
            submit(client, criterion={"threshold": 0.5, "requirements": [REQUIREMENT]})
            finish_fully(service)
        _sign(client)
        yield service


def _sign(client: httpx.Client) -> None:
    address = f"{API}/runs/{SIGNED}/signoffs"
    body = {"name": "Grace Hopper", "role": "Independent review", "digest": client.get(address).json()["digest"]}
    assert client.post(address, json=body).status_code == 201


def shown(visit: Visit, standing: str, word: str, picture: str) -> None:
    """The standing on the page of the run that repeats the signed one, in both lists, and in the report."""
    page = visit.page
    visit.go(f"/runs/{REPEATED}")
    card = page.locator("#signoff")
    expect(card.get_by_role("row").filter(has_text="Grace Hopper")).to_contain_text(standing)
    card.scroll_into_view_if_needed()
    looks(visit, f"{picture}-run")
    for path in ("/reports", "/requirements"):
        visit.go(path)
        expect(page.get_by_role("main")).to_contain_text(word)
        looks(visit, f"{picture}{path.replace('/', '-')}")
    visit.go(f"{API}/runs/{REPEATED}/report.html")
    approval = page.locator("section").filter(has=page.get_by_role("heading", name="Approval"))
    expect(approval).to_contain_text(word)
    approval.scroll_into_view_if_needed()
    visit.shot(f"{picture}-report")


def test_a_sign_off_is_carried_on_and_becomes_suspect(home: Service, browser: Browser) -> None:
    with visiting(browser, home.url) as visit:
        visit.go(f"/login?code={home.login_code()}")
        shown(visit, "Carried on", f"repeated by {REPEATED}", "carried-on")
        with changed(home.engine, sa.update(CatalogueDocument).values(document=edited())):
            shown(visit, "Suspect", "uspect", "suspect")


@pytest.mark.nightly
def test_the_printed_report_is_a_document(home: Service, tmp_path: Path) -> None:
    with home.signed_in() as client:
        answer = client.get(f"{API}/runs/{REPEATED}/report.pdf", timeout=120.0)
    assert (answer.status_code, answer.content[:5]) == (200, b"%PDF-"), answer.text
    (tmp_path / "report.pdf").write_bytes(answer.content)
