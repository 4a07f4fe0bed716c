"""The page of a run that waits for the code that began it: what differs, and the two ways on."""

from __future__ import annotations

from pathlib import Path

import pytest
import sqlalchemy as sa
from playwright.sync_api import Browser, expect

from backend.db.tables import CatalogueDocument
from tests.e2e.browser import visiting
from tests.e2e.stored import served
from tests.given.code_versions import edited
from tests.given.waiting_runs import DIFFERS, waiting

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(120), pytest.mark.nightly]  # by day tests/api/runs/test_onward.py


@pytest.mark.parametrize(
    ("button", "then"),
    [("Continue as a new run", "R-0002"), ("Begin again, discard 100 evaluations", "R-0001")],
)
def test_its_page_says_what_differs_and_offers_ways_on(
    tmp_path: Path, browser: Browser, button: str, then: str
) -> None:
    with served(tmp_path) as service, visiting(browser, service.url) as visit:
        with service.signed_in() as client:
            run = waiting(service, client)
        page = visit.page
        visit.sign_in(service.login_code())
        visit.go(f"/runs/{run}")
        expect(page.get_by_role("status").filter(has_text="This run is waiting.")).to_contain_text(DIFFERS)
        visit.shot("other-code")
        page.get_by_role("button", name=button).click()
        expect(page.get_by_text("It starts automatically within a few seconds.")).to_be_visible()
        assert page.url.endswith(f"/runs/{then}")
        expect(page.get_by_text("Other code began it")).to_have_count(0)


@pytest.mark.nightly  # by day what is offered, above; that the service refuses it: tests/api/runs/test_onward.py
def test_it_is_not_offered_to_continue_what_no_evaluation_can_be_used_of(tmp_path: Path, browser: Browser) -> None:
    with served(tmp_path) as service, visiting(browser, service.url) as visit:
        with service.signed_in() as client:
            run = waiting(service, client)
        with service.engine.begin() as writer:
            writer.execute(sa.update(CatalogueDocument).values(document=edited()))
        visit.sign_in(service.login_code())
        visit.go(f"/runs/{run}")
        expect(visit.page.get_by_role("button", name="Begin again, discard 100 evaluations")).to_be_visible()
        expect(visit.page.get_by_role("button", name="Continue as a new run")).to_have_count(0)
        visit.shot("other-code-not-continuable")
