"""What is typed stays where code cannot be loaded, where the service was updated, and where the session ends."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from tests.e2e.browser import Visit, visiting
from tests.e2e.stored import served
from tests.given.service import Service
from tests.given.submissions import submit

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300), pytest.mark.nightly]  # by day frontend/src/launch/campaign
DRAWS = False
CODE = re.compile(r"/assets/.*\.js$")
MISSING = "This part of the page could not be loaded"
WORDS = {
    "updated part": "Clearance was updated. Save what you are writing",
    "updated page": "Clearance was updated. Reload this page.",
    "silent": "It is loaded as soon as the service answers",
    "typed": "What you typed on this page is kept",
}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with served(tmp_path_factory.mktemp("kept")) as service:
        with service.signed_in() as client:
            submit(client)
        yield service


@pytest.fixture
def visit(service: Service, browser: Browser) -> Iterator[Visit]:
    """A browser that has no code yet, besides that of the pages it goes to."""
    with visiting(browser, service.url) as visit:
        visit.sign_in(service.login_code())
        # Requests are looked at from the first page on: where that begins on an open page, chromium answers before it
        # has told the page's process, and what is asked for meanwhile comes.
        visit.page.context.route(CODE, lambda route: route.continue_())
        yield visit
        visit.wrong.clear()  # the browser reports what it was refused


@contextmanager
def answered(page: Page, status: int | None) -> Iterator[None]:
    """No more code comes: with this answer, or without any."""

    def refuse(route: Route) -> None:
        if status is None:
            route.abort("connectionfailed")
        else:
            route.fulfill(status=status, body="")

    page.route(CODE, refuse)
    try:
        yield
    finally:
        page.unroute(CODE)


def named(visit: Visit) -> None:
    """The launch page with a name that is not saved."""
    visit.go("/launch?from=R-0001")
    name = visit.page.get_by_role("textbox", name="Name", exact=True)
    expect(name).to_have_value("Unicycle past a pillar")
    name.fill("precious")


def still_named(page: Page) -> None:
    expect(page.get_by_role("textbox", name="Name", exact=True)).to_have_value("precious")


@pytest.mark.nightly
def test_the_search_is_loaded_again_over_what_was_typed(visit: Visit) -> None:
    page = visit.page
    named(visit)
    with answered(page, None):
        page.keyboard.press("Control+k")
        told = page.get_by_role("dialog", name="Search")
        expect(told).to_contain_text(MISSING)
    told.get_by_role("button", name="Try again").click()
    expect(page.get_by_role("dialog", name="Search or jump to")).to_be_visible()
    page.keyboard.press("Escape")
    still_named(page)


@pytest.mark.nightly
def test_an_updated_service_is_told_from_one_out_of_reach(visit: Visit) -> None:
    page = visit.page
    named(visit)
    with answered(page, 404):
        page.keyboard.press("Control+k")
        told = page.get_by_role("dialog", name="Search")
        expect(told).to_contain_text(WORDS["updated part"])
        expect(told.get_by_role("button", name="Reload this page")).to_be_visible()
        page.keyboard.press("Escape")
        expect(told).to_be_hidden()
        still_named(page)
        page.on("dialog", lambda dialog: dialog.dismiss())  # it asks before what is not saved is lost
        page.keyboard.press("Control+k")
        with page.expect_event("dialog"):
            told.get_by_role("button", name="Reload this page").click()
    page.keyboard.press("Escape")
    still_named(page)


@pytest.mark.nightly  # by day the search, and what is edited before its code is there
def test_the_editor_of_the_text_is_loaded_again(visit: Visit) -> None:
    page = visit.page
    named(visit)
    with answered(page, None):
        page.get_by_role("button", name="YAML").click()
        told = page.get_by_role("alert").filter(has_text=MISSING)
        expect(told).to_be_visible()
        expect(page.locator("pre").filter(has_text="scenario:")).to_be_visible()
        still_named(page)
    told.get_by_role("button", name="Try again").click()
    expect(page.get_by_role("textbox", name="Campaign as YAML")).to_be_visible()
    still_named(page)


def test_what_is_edited_before_its_code_is_there_is_saved_once_it_is(visit: Visit) -> None:
    page = visit.page
    text = re.compile(r"/assets/text-.*\.js$")
    page.route(text, lambda route: route.abort("connectionfailed"))
    visit.go("/launch?from=R-0001")
    trouble = page.get_by_role("alert").filter(has_text="A part of this page could not be loaded")
    expect(trouble).to_be_visible()
    low = page.get_by_label("M, low")
    low.fill("4.25")
    page.context.set_offline(True)
    expect(page.get_by_role("status", name="Connection")).to_contain_text("cannot be reached")
    page.unroute(text)
    page.context.set_offline(False)
    expect(trouble).to_have_count(0)
    expect(low).to_have_value("4.25")
    page.get_by_role("button", name="YAML").click()
    expect(page.get_by_role("textbox", name="Campaign as YAML")).to_contain_text("4.25")


@pytest.mark.nightly  # by day the search, which is loaded in the same way
def test_notes_are_written_without_their_preview(visit: Visit) -> None:
    page = visit.page
    visit.go("/runs/R-0001")
    notes = page.locator("#notes")
    with answered(page, 502):
        notes.get_by_role("button", name="Write").click()
        typed = notes.get_by_role("textbox")
        typed.fill("**precious**")
        expect(notes.get_by_role("alert")).to_contain_text(MISSING)
        expect(page.get_by_role("heading", level=1)).to_contain_text("Unicycle")
    notes.get_by_role("button", name="Try again").click()
    expect(notes.get_by_role("region", name="Preview").locator("strong")).to_have_text("precious")
    expect(typed).to_have_value("**precious**")


def test_a_page_that_cannot_be_loaded_comes_once_the_service_answers(visit: Visit) -> None:
    page = visit.page
    visit.go("/runs")
    expect(page.locator("tr[data-run=R-0001]")).to_be_visible()
    page.context.set_offline(True)
    page.get_by_role("link", name="Help", exact=True).click()
    expect(page.get_by_role("heading", name="This page could not be loaded", level=1)).to_be_visible()
    expect(page.get_by_role("navigation", name="Main")).to_be_visible()
    expect(page.get_by_role("main")).to_contain_text(WORDS["silent"])
    page.context.set_offline(False)
    expect(page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()


@pytest.mark.nightly  # by day a part of an updated service, and a page that cannot be loaded
def test_a_page_of_an_updated_service_is_reloaded_once(visit: Visit) -> None:
    page = visit.page
    visit.go("/runs")
    expect(page.locator("tr[data-run=R-0001]")).to_be_visible()
    help_page = re.compile(r"/assets/VerdictsPage.*\.js$")
    page.route(help_page, lambda route: route.fulfill(status=404, body=""))
    with page.expect_event("load"):
        page.get_by_role("link", name="Help", exact=True).click()
    expect(page.get_by_role("main")).to_contain_text(WORDS["updated page"])
    page.unroute(help_page)
    page.get_by_role("button", name="Reload this page").click()
    expect(page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()


def ended(visit: Visit) -> None:
    """The session is no more, as after signing out in another tab."""
    assert visit.page.request.delete(f"{visit.address}/api/v1/session").status == 204


def back(visit: Visit, service: Service) -> None:
    """The user has signed in again elsewhere, and comes back to this tab."""
    visit.sign_in(service.login_code())
    visit.page.evaluate("window.dispatchEvent(new Event('focus'))")


def test_a_campaign_outlives_the_session(visit: Visit, service: Service) -> None:
    page = visit.page
    named(visit)
    title = page.title()
    ended(visit)
    page.get_by_role("button", name="Save as draft").click()
    notice = page.get_by_role("dialog", name="You are signed out")
    expect(notice).to_be_visible()
    visit.shot("signed-out", full=False)
    expect(page.get_by_role("textbox", name="Name", exact=True)).to_have_count(0)
    page.keyboard.press("Escape")
    page.keyboard.press("Escape")
    page.keyboard.press("n")
    page.keyboard.press("Control+k")
    page.evaluate("window.dispatchEvent(new Event('focus'))")
    expect(notice).to_contain_text(WORDS["typed"])
    with page.context.expect_page() as opened:
        notice.get_by_role("link", name="Sign in on a new tab").click()
    expect(opened.value).to_have_url(f"{visit.address}/login?next=%2Flaunch%3Ffrom%3DR-0001")
    opened.value.close()
    back(visit, service)
    expect(notice).to_have_count(0)
    expect(page).to_have_title(title)
    still_named(page)
    page.get_by_role("button", name="Save as draft").click()
    page.wait_for_url(re.compile(r"/launch\?draft=D-0001"))
    still_named(page)


@pytest.mark.nightly  # by day a campaign does, in the same way
def test_notes_outlive_the_session(visit: Visit, service: Service) -> None:
    page = visit.page
    visit.go("/runs/R-0001")
    notes = page.locator("#notes")
    notes.get_by_role("button", name="Write").click()
    notes.get_by_role("textbox").fill("precious")
    ended(visit)
    notes.get_by_role("button", name="Save notes").click()
    notice = page.get_by_role("dialog", name="You are signed out")
    expect(notice).to_be_visible()
    back(visit, service)
    expect(notice).to_have_count(0)
    notes.get_by_role("button", name="Save notes").click()
    expect(notes.get_by_role("textbox")).to_have_count(0)
    expect(notes).to_contain_text("precious")


@pytest.mark.nightly  # by day a campaign outlives the session
def test_without_anything_to_lose_signing_in_is_in_this_tab(visit: Visit, service: Service) -> None:
    page = visit.page
    visit.go("/runs")
    expect(page.locator("tr[data-run=R-0001]")).to_be_visible()
    page.get_by_role("button", name=re.compile("^Session of")).click()
    page.get_by_role("menuitem", name="Sign out").click()
    notice = page.get_by_role("dialog", name="You are signed out")
    expect(page.locator("tr[data-run]")).to_have_count(0)  # nothing stays of who has left
    notice.get_by_role("link", name="Sign in").click()
    expect(page).to_have_url(f"{visit.address}/login?next=%2Fruns")
    visit.sign_in(service.login_code())
    page.reload()
    expect(page.locator("tr[data-run=R-0001]")).to_be_visible()


@pytest.mark.nightly  # by day a campaign outlives the session
def test_another_user_gets_a_page_of_their_own(visit: Visit, service: Service) -> None:
    page = visit.page
    visit.go("/runs")
    expect(page.locator("tr[data-run=R-0001]")).to_be_visible()
    mine = page.request.get(f"{visit.address}/api/v1/session").json()
    ended(visit)
    visit.move("/reports")
    expect(page.get_by_role("dialog", name="You are signed out")).to_be_visible()
    page.route("**/api/v1/batch*", lambda route: route.fulfill(body=""))  # the page asks for its session itself
    page.route("**/api/v1/session", lambda route: route.fulfill(json=mine | {"user": "bob", "account": "bob"}))
    with page.expect_event("load"):
        back(visit, service)
    expect(page.get_by_role("button", name="Session of bob, BO")).to_be_visible()
