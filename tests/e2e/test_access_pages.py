"""Inviting a user and joining, in two browsers; signing in leads back to a shared page."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.axe import AXE, violations
from tests.e2e.browser import Visit, visiting
from tests.e2e.stored import served
from tests.given.joined_users import PASSWORD
from tests.given.service import Service

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(120), pytest.mark.nightly]  # by day tests/api/access

DRAWS = False


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with served(tmp_path_factory.mktemp("access")) as service:
        yield service


@pytest.fixture
def visit(service: Service, browser: Browser) -> Iterator[Visit]:
    """A browser that has opened the login link."""
    with visiting(browser, service.url) as visit:
        visit.go(f"/login?code={service.login_code()}")
        yield visit


@pytest.fixture
def other(browser: Browser) -> Iterator[Page]:
    """A browser that is not signed in. Chromium reports a page that is answered with 401 as an error."""
    context = browser.new_context(viewport={"width": 390, "height": 844}, color_scheme="dark")
    page = context.new_page()
    page.add_init_script(path=AXE)
    yield page
    context.close()


def test_an_invited_user_joins_and_a_shared_link_leads_back_to_itself(
    visit: Visit, other: Page, service: Service
) -> None:
    page = visit.page
    page.get_by_role("button", name="Session of local").click()
    page.get_by_role("menuitem", name="Invite").click()
    dialog = page.get_by_role("dialog", name="Invite a user")
    dialog.get_by_role("textbox", name="Name").fill("ada")
    dialog.get_by_role("radio", name="viewer reads").check()
    visit.shot("invite")
    dialog.get_by_role("button", name="Make the link").click()
    link = dialog.get_by_test_id("secret").inner_text()
    assert link.startswith(f"{service.url}/invite?code=")
    dialog.get_by_role("button", name="Done").click()
    expect(page.get_by_role("row", name="ada")).to_contain_text("invited, link valid until")

    other.goto(link)
    assert violations(other) == []
    other.get_by_label("New password", exact=True).fill(PASSWORD)
    other.get_by_label("The same password again").fill(PASSWORD)
    other.get_by_role("button", name="Set the password and sign in").click()
    other.wait_for_url(f"{service.url}/runs")
    other.get_by_role("button", name="Session of ada").click()
    expect(other.get_by_role("menuitem", name="Sessions")).to_be_visible()
    expect(other.get_by_role("menuitem", name="Invite")).to_have_count(0)
    other.get_by_role("menuitem", name="Sign out").click()
    other.get_by_role("link", name="sign in").click()

    other.goto(f"{service.url}/access/sessions")
    assert violations(other) == []
    other.get_by_label("Name").fill("ada")
    other.get_by_label("Password").fill("not the password")
    other.get_by_role("button", name="Sign in").click()
    expect(other.get_by_role("alert")).to_have_text("The name or the password is wrong.")
    assert violations(other) == []
    other.get_by_label("Password").fill(PASSWORD)
    other.get_by_label("Password").press("Enter")
    other.wait_for_url(f"{service.url}/access/sessions")
    expect(other.get_by_role("cell", name="this browser")).to_be_visible()

    page.get_by_role("link", name="Audit trail").click()
    page.get_by_label("User or token").select_option("ada")
    expect(page.get_by_role("cell", name="session.failed")).to_be_visible()
    visit.shot("audit")
