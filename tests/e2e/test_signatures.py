"""A sign-off that became suspect, one that a repetition carries on, and one that nothing carries on, on every page.

With CLEARANCE_SCREENSHOTS set, the pictures are stored, and the PDF report next to them.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa
from playwright.sync_api import Browser, Locator, expect

from backend.db.tables import CatalogueDocument, EvaluationChunk
from backend.reports import pdf
from tests.e2e.browser import SCREENSHOTS, Visit, pictured, visiting
from tests.e2e.looking import looks
from tests.e2e.stored import served
from tests.given.code_versions import edited
from tests.given.joined_users import joined
from tests.given.printed_words import printed_words
from tests.given.reported_runs import finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.small_catalogue import campaign

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(240)]
DRAWS = False

SIGNED, REPEATED, OTHER = "R-0001", "R-0002", "R-0003"
REQUIREMENT = {"id": "SYS-1", "text": "The vehicle keeps 0.5 m away from every obstacle."}


def ran(service: Service, client: httpx.Client) -> None:
    stated = {"threshold": 0.5, "requirements": [REQUIREMENT]}
    answer = client.post("/api/v1/runs", json={"campaign": campaign(criterion=stated)})
    assert answer.status_code == 201, answer.text
    finish_fully(service)


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    """A run that a reviewer has signed."""
    with served(tmp_path) as service, service.signed_in() as admin, joined(service, admin, "reviewer") as (_, reviewer):
        ran(service, admin)
        address = f"/api/v1/runs/{SIGNED}/signoffs"
        body = {"role": "Independent review", "comment": "Bounds and scope read against the hazard analysis."}
        digest = reviewer.get(address).json()["digest"]
        assert reviewer.post(address, json=body | {"digest": digest}).status_code == 201
        yield service


def places(visit: Visit, run: str) -> Iterator[tuple[str, Locator]]:
    """Each place that shows the sign-offs of a run."""
    page = visit.page
    visit.go(f"/runs/{run}")
    visit.near("#signoff")
    yield "run", page.locator("#signoff")
    visit.move("/reports")
    yield "reports", page.locator("tr", has=page.locator(f"a[href='/runs/{run}']"))
    visit.move("/requirements")
    yield "matrix", page.locator("[data-requirement='SYS-1']")
    visit.go(f"/api/v1/runs/{run}/report.html")
    yield "report", page.locator("table", has=page.locator("[data-current]"))


def seen(visit: Visit, name: str, run: str, *texts: str) -> None:
    """Every place states them, in both themes, and the words of the PDF."""
    for place, part in places(visit, run):
        for text in texts:
            expect(part).to_contain_text(text, ignore_case=True)
        if place == "report":  # it is of one theme, and paged
            visit.shot(f"signature-{name}-{place}", of=part)
            continue
        looks(visit, f"signature-{name}-{place}")
        if place == "run":
            for theme in ("light", "dark"):
                visit.page.emulate_media(color_scheme=theme)
                visit.shot(f"signature-{name}-card-{theme}", of=part)
            visit.page.emulate_media(color_scheme="light")
    printed = visit.page.request.get(f"{visit.address}/api/v1/runs/{run}/report.pdf").body()
    if pictured():
        (SCREENSHOTS / f"signature-{name}.pdf").write_bytes(printed)
    words = printed_words(printed).lower()
    assert not [text for text in texts if "".join(text.split()).lower() not in words]


@contextmanager
def opened(service: Service, browser: Browser) -> Iterator[Visit]:
    with visiting(browser, service.url, views=False) as visit:
        visit.sign_in(service.login_code())
        yield visit


@pytest.mark.nightly  # by day tests/api/signoffs/test_standing.py, which states it in every place
def test_the_standing_of_a_sign_off_is_on_every_page(service: Service, browser: Browser) -> None:
    assert pdf.browser() is not None
    with opened(service, browser) as visit, service.signed_in() as client:
        with changed(service.engine, sa.update(CatalogueDocument).values(document=edited())):
            (one,) = client.get(f"/api/v1/runs/{SIGNED}/signoffs").json()["items"]
            assert one["standing"] == "suspect"
            seen(visit, "suspect", SIGNED, "suspect", one["reasons"][0])
        ran(service, client)
        (one,) = client.get(f"/api/v1/runs/{REPEATED}/signoffs").json()["items"]
        assert (one["run"], one["standing"]) == (SIGNED, "carried on")
        assert f"repeated by {REPEATED}" in one["sentence"]
        seen(visit, "carried", REPEATED, one["sentence"][1:])
        ran(service, client)
        with service.engine.begin() as writer:
            of = EvaluationChunk.run_id == 3
            costs = writer.scalar(sa.select(EvaluationChunk.costs).where(of))
            writer.execute(sa.update(EvaluationChunk).where(of).values(costs=costs[::-1]))
        found = client.get(f"/api/v1/runs/{OTHER}/signoffs").json()
        assert found["items"] == []
        visit.go(f"/runs/{OTHER}")
        expect(visit.page.locator("#signoff")).to_contain_text(found["not_carried"][1:])
        visit.shot("signature-not-carried-card", of=visit.page.locator("#signoff"))
        visit.move("/requirements")
        expect(visit.page.locator("[data-requirement='SYS-1']")).to_contain_text(found["not_carried"])
        looks(visit, "signature-not-carried-matrix")
