"""The pages as colleagues have them who call the service by its name without TLS: browsers withhold some functions.

Those are listed at developer.mozilla.org, "Features restricted to secure contexts".
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.browser import NAMED, Visit, visiting
from tests.e2e.stored import served
from tests.given.submissions import submit

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(120),
    pytest.mark.nightly,
]  # by day the same pages over what browsers trust
DRAWS = False


@pytest.fixture(scope="module")
def visit(tmp_path_factory: pytest.TempPathFactory, browser: Browser) -> Iterator[Visit]:
    with served(tmp_path_factory.mktemp("named"), allowed_hosts=NAMED) as service:
        with service.signed_in() as client:
            submit(client)
        with visiting(browser, f"http://{NAMED}:{service.port}") as visit:
            visit.go(f"/login?code={service.login_code()}")
            yield visit


def test_a_run_and_a_sweep_are_launched(visit: Visit) -> None:
    page = visit.page
    visit.go("/launch?from=R-0001")
    assert page.evaluate("isSecureContext") is False
    page.get_by_role("button", name="Start run").click()
    page.wait_for_url("**/runs/R-0002")
    visit.go("/launch?from=R-0001")
    sweep = page.locator("#sweep")
    sweep.get_by_role("button", name="Show").click()
    sweep.get_by_label("Values").fill("1, 2")
    sweep.get_by_role("button", name="Start 2 runs").click()
    page.wait_for_url(re.compile(r"/sweeps/\w+"))


def test_what_notifications_need_is_stated(visit: Visit) -> None:
    page = visit.page
    visit.move("/runs/R-0001")
    page.get_by_role("button", name="Notify me").click()
    expect(page.get_by_text("Notifications need HTTPS, or a browser on the service’s machine.")).to_be_visible()
    page.get_by_role("button", name=re.compile("Session of")).click()
    page.get_by_role("menuitem", name="Notify when my runs end").click()
    expect(page.get_by_role("menuitem", name="Notifications need HTTPS")).to_be_visible()
    page.keyboard.press("Escape")


def test_a_token_is_copied(visit: Visit) -> None:
    page = visit.page
    visit.move("/access/tokens")
    page.get_by_role("button", name="New token").click()
    page.get_by_label("Name").fill("nightly-ci")
    page.get_by_role("button", name="Create").click()
    secret = page.get_by_test_id("secret").inner_text()
    page.get_by_role("button", name="Copy the token").click()
    expect(page.get_by_role("button", name="Copied")).to_be_visible()
    page.get_by_role("button", name="Done").click()
    page.get_by_role("button", name="New token").click()
    name = page.get_by_label("Name")
    name.press("Control+V")
    expect(name).to_have_value(secret)
