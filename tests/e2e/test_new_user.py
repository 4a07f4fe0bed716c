"""A new user, from the start of the service to an exported report by clicks alone, in under three minutes.

Only the budgets are typed; nothing is asked of the API. Start reading at the one test.
"""

from __future__ import annotations

import re
import time
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from backend.db.engine import connect, default_url
from tests.audited import audited
from tests.e2e.browser import visiting
from tests.faults.serving import serving

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]

LONGEST = 180.0
"""[s]"""
BUDGET = 500


def test_from_the_start_to_an_exported_report(tmp_path: Path, browser: Browser) -> None:
    began = time.monotonic()
    with serving(tmp_path) as service, visiting(browser, service.link().partition("/login")[0]) as visit:
        visit.page.goto(service.link())
        launched(visit.page)
        outcome = visit.page.get_by_test_id("verdict")
        expect(outcome).to_have_text(re.compile("Cleared|Violated|Inconclusive"), timeout=1e3 * LONGEST)
        printed = exported(visit.page)
        assert printed.startswith(b"%PDF-")
        assert time.monotonic() - began < LONGEST
        audited(connect(default_url(service.data)))


def launched(page: Page) -> None:
    """Choose the library's first case on the empty list, make its budgets small, start it."""
    page.get_by_role("link", name="Choose a case study").click()
    expect(page.get_by_role("radio", name="Unicycle, static obstacle")).to_be_checked()
    fields = page.get_by_label(re.compile("evaluations at most$"))
    expect(fields.first).to_be_visible()
    for field in fields.all():
        if field.is_enabled():
            field.fill(str(BUDGET))
    page.get_by_role("button", name="Start run").click()
    page.wait_for_url("**/runs/R-0001")
    # So small a run may be over before its page is open.
    expect(page.get_by_role("list", name="Stages").or_(page.get_by_test_id("verdict")).first).to_be_visible()


def exported(page: Page) -> bytes:
    """The report: opened from the run's page and read, then saved as PDF."""
    with page.context.expect_page() as opened:
        page.get_by_role("link", name="Safety-case report").click()
    report = opened.value
    expect(report.get_by_role("heading", name="Unicycle, static obstacle", exact=True)).to_be_visible()
    expect(report.get_by_text("No sign-off is recorded")).to_be_visible()
    report.close()
    page.get_by_role("button", name="Export").click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name=re.compile("^Safety-case report, PDF")).click()
    return Path(download.value.path()).read_bytes()
