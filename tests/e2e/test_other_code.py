"""The page of a run that waits for the code that began it: what differs, and the two ways on."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.browser import visiting
from tests.e2e.stored import served
from tests.given.waiting_runs import DIFFERS, waiting

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(120)]


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
        visit.go(f"/login?code={service.login_code()}")
        visit.go(f"/runs/{run}")
        expect(page.get_by_role("status").filter(has_text="This run is waiting.")).to_contain_text(DIFFERS)
        visit.shot("other-code")
        page.get_by_role("button", name=button).click()
        expect(page.get_by_text("It starts automatically within a few seconds.")).to_be_visible()
        assert page.url.endswith(f"/runs/{then}")
        expect(page.get_by_text("Other code began it")).to_have_count(0)
