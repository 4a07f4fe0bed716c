"""Browsing, annotating, selecting and explaining runs.

The tests of this file are one story, in order, over runs that a worker evaluated.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
import sqlalchemy as sa
from playwright.sync_api import Browser, Page, Response, Route, expect

from backend.db.tables import Run
from campaigns import library, load_file
from tests.e2e.browser import PATIENCE, Visit, draws, pictured, visiting
from tests.e2e.conftest import Browsers
from tests.e2e.flown import AGAIN, BOX, INTRUDER, asked
from tests.e2e.looking import api, looks
from tests.faults.processes import until
from tests.given.reported_runs import finish_fully
from tests.given.service import Service

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(600)]
DRAWS = False
"""One test opens 3D views, which are not drawn."""

NOTES = "# Why\n\nThe *planning radius* is <b>75 m</b>.\n\n- [x] flown"
WATCH = """
    window.told = [];
    window.Notification = class extends window.Notification {
        static permission = 'granted'
        constructor(title, more) { super(title, more); told.push([title, more.body]); }
    };
"""
"""Writes down what the page has the browser show; one without windows shows nothing, and permits nothing by itself."""


def post(visit: Visit, path: str, data: Any) -> Any:
    """Ask the API as this browser's session."""
    answer = visit.page.request.post(f"{visit.address}/api/v1{path}", data=data, headers={"Origin": visit.address})
    assert answer.ok, answer.text()
    return answer.json()


def waiting(visit: Visit, name: str) -> str:
    """Submit a run, which no worker begins."""
    document = load_file(library()["unicycle_static"]).document()
    return str(post(visit, "/runs", {"campaign": document, "name": name})["id"])


@pytest.fixture(scope="module")
def signed_in(stored: Service, browser: Browser) -> Iterator[Visit]:
    """A page of a browser that signed in with the login link."""
    with visiting(browser, stored.url) as visit:
        visit.sign_in(stored.login_code())
        yield visit


@pytest.fixture
def drawing(stored: Service, browsers: Browsers) -> Iterator[Visit]:
    """Another session, with 3D views."""
    with visiting(browsers(pictured()), stored.url, views=False) as visit:
        visit.sign_in(stored.login_code())
        yield visit


def named(page: Page) -> list[str]:
    return [row.get_attribute("data-run") or "" for row in page.locator("tr[data-run]").all()]


def test_the_list_is_narrowed_and_ordered_by_the_address(signed_in: Visit) -> None:
    page = signed_in.page
    signed_in.go("/runs")
    expect(page.locator("tr[data-run]")).to_have_count(len(asked()))
    page.get_by_role("button", name="Tag: any").click()
    page.get_by_role("dialog").get_by_role("checkbox", name="baseline").check()
    expect(page.locator("tr[data-run]")).to_have_count(2)
    expect(page).to_have_url(re.compile("tag=baseline"))
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Margin").click()
    expect(page).to_have_url(re.compile("sort=margin"))
    page.reload()
    expect(page.locator("tr[data-run]")).to_have_count(2)
    expect(page.get_by_role("columnheader", name="Margin")).to_have_attribute("aria-sort", "ascending")
    page.get_by_role("button", name="Clear all").click()
    expect(page.locator("tr[data-run]")).to_have_count(len(asked()))
    page.get_by_role("button", name="Columns").click()
    page.get_by_role("dialog").get_by_role("checkbox", name="Failed evaluations").check()
    page.keyboard.press("Escape")
    expect(page.get_by_role("columnheader", name="Failed")).to_be_visible()
    expect(page).to_have_url(re.compile("cols=.*failed"))
    signed_in.go("/runs?campaign=UAV%2C+intruder&days=1")
    expect(page.locator("tr[data-run]")).to_have_count(1)
    expect(page.locator("tr[data-run]")).to_contain_text("Intruder")


def test_name_tags_pin_and_notes_are_stored(signed_in: Visit) -> None:
    page = signed_in.page
    signed_in.move(f"/runs/{BOX}")
    page.get_by_role("button", name="Change name and tags").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Name").fill("Release 2.4, full box")
    dialog.get_by_label("Tags").fill("assessed")
    dialog.get_by_role("button", name="Save").click()
    expect(page.get_by_role("heading", level=1)).to_have_text("Release 2.4, full box")
    page.get_by_role("button", name="Pin this run").click()
    expect(page.get_by_role("button", name="Unpin this run")).to_be_visible()
    notes = page.locator("#notes")
    notes.get_by_role("button", name="Write").click()
    notes.get_by_label("Notes in Markdown").fill(NOTES)
    notes.get_by_role("button", name="Save notes").click()
    expect(notes.get_by_role("heading", name="Why")).to_be_visible()
    expect(notes.locator("em")).to_have_text("planning radius")
    expect(notes.locator("b")).to_have_count(0)
    expect(notes).to_contain_text("<b>75 m</b>")
    # The page shows what was written at once, before the service has it.
    until(lambda: api(signed_in, f"/runs/{BOX}")["notes"] == NOTES, "the notes are kept", 20)
    kept = api(signed_in, f"/runs/{BOX}")
    assert kept["pinned"] is True
    assert kept["tags"] == ["release-2.4", "baseline", "assessed"]
    history = page.locator("#history")
    history.get_by_role("button", name="Show").click()
    expect(history.locator("tbody tr").first).to_contain_text("Wrote its notes")
    expect(history.locator("tbody tr").last).to_contain_text("Submitted")
    notes.scroll_into_view_if_needed()
    signed_in.shot("notes-1440-light", full=False)


def test_notes_written_meanwhile_by_another_user_are_not_lost(signed_in: Visit) -> None:
    page = signed_in.stay(f"/runs/{BOX}")
    notes = page.locator("#notes")
    notes.get_by_role("button", name=re.compile("Edit|Write")).click()
    notes.get_by_label("Notes in Markdown").fill("Mine.")
    other = f"{signed_in.address}/api/v1/runs/{BOX}"
    page.request.patch(other, data={"notes": "Theirs."}, headers={"Origin": signed_in.address})
    notes.get_by_role("button", name="Save notes").click()
    expect(notes).to_contain_text("These notes were changed")
    expect(notes.get_by_role("status")).to_contain_text("Theirs.")
    assert api(signed_in, f"/runs/{BOX}")["notes"] == "Theirs."
    notes.get_by_label("Notes in Markdown").fill("Theirs and mine.")
    notes.get_by_role("button", name="I have read it").click()
    notes.get_by_role("button", name="Save notes").click()
    expect(notes.locator("textarea")).to_have_count(0)
    assert api(signed_in, f"/runs/{BOX}")["notes"] == "Theirs and mine."
    signed_in.wrong = [
        wrong for wrong in signed_in.wrong if "409" not in wrong
    ]  # the browser's own note of the refusal


def test_a_pinned_run_is_the_first(signed_in: Visit) -> None:
    page = signed_in.page
    pinned = f"{signed_in.address}/api/v1/runs/{BOX}"
    assert page.request.patch(pinned, data={"pinned": True}, headers={"Origin": signed_in.address}).ok
    signed_in.go("/runs?sort=created")
    expect(page.locator("tr[data-run]")).to_have_count(len(asked()))
    assert named(page)[0] == BOX


@pytest.mark.nightly
def test_every_finding_and_the_nominal_flight_can_be_chosen(drawing: Visit) -> None:
    page = drawing.page
    found = api(drawing, f"/runs/{INTRUDER}/findings")
    drawing.go(f"/runs/{INTRUDER}?t=12.5&cam=top")
    rows = page.locator("#findings tr[data-finding]")
    expect(rows).to_have_count(len(found) + 1)
    for finding in found:
        row = page.locator(f"tr[data-finding={finding['label']}]")
        expect(row).to_contain_text(
            "Integrations agree" if finding["validation"]["agrees"] else "Integrations disagree"
        )
        if not finding["found"]:
            expect(row).to_contain_text("reached only by local refinement")
    expect(page.locator("tr[data-finding=F1]").get_by_role("button")).to_have_attribute("aria-pressed", "true")
    view = page.locator("#flight iframe")
    view.scroll_into_view_if_needed()
    expect(view).to_have_attribute("src", re.compile(f"/view/{INTRUDER}/"))
    opened = view.element_handle()
    page.get_by_role("button", name="Open the panel").click()
    panel = page.frame_locator("#flight iframe").locator("body")
    expect(panel).to_contain_text("Worst")
    page.locator("tr[data-finding=nominal]").click()
    expect(page).to_have_url(re.compile("finding=nominal"))
    expect(panel).not_to_contain_text("Worst")
    shared(drawing, f"/runs/{INTRUDER}?finding=nominal&t=12.50&cam=top")
    expect(page.get_by_role("heading", name="Nominal case")).to_be_visible()
    expect(page.get_by_role("img", name="Separation over time, nominal flight, with the criterion")).to_be_visible()
    page.keyboard.press("k")
    last = found[-1]["label"]
    expect(page.locator(f"tr[data-finding={last}]").get_by_role("button")).to_have_attribute("aria-pressed", "true")
    shown = page.get_by_test_id("worst-cost").inner_text()
    assert abs(float(shown) - found[-1]["cost"]) <= 0.5001 * 10.0 ** -len(shown.partition(".")[2])
    expect(panel).to_contain_text("Worst" if last == "F1" else last)
    assert opened is not None
    assert opened.evaluate("frame => frame.isConnected"), "the view is the one that was opened first"
    filled(page)
    looks(drawing, "findings", lambda visit: visit.page.locator("#findings").scroll_into_view_if_needed())


def shared(visit: Visit, path: str) -> None:
    """The link to the instant that the view shows is this one; and its keys move the time on."""
    page = visit.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"], origin=visit.address)
    page.get_by_role("button", name="Copy link to this instant").click()
    expect(page.get_by_text("Copied, at 12.50 s")).to_be_visible()
    assert page.evaluate("navigator.clipboard.readText()") == visit.address + path
    page.get_by_role("group", name="Flight in 3D and its keys").focus()
    page.keyboard.press("Shift+ArrowRight")
    steered(page)


def shows_layers(answer: Response) -> bool:
    """Whether it answers the request to show other layers in a view."""
    asked = answer.request
    return "/views/" in answer.url and asked.method == "PATCH" and "layers" in (asked.post_data or "")


def steered(page: Page) -> None:
    """The bar below the view has it show another instant and other things, and goes along with it."""
    bar = page.get_by_role("group", name="Time of the flight")
    time = bar.get_by_role("slider", name="Time")
    expect(time).to_have_value("13.5")
    bar.get_by_role("button", name="Closest approach").click()
    near = page.locator("tr[data-finding=nominal] td").nth(4).inner_text()
    expect(time).to_have_value(re.compile(rf"^{re.escape(near.rstrip('0').rstrip('.'))}"))
    bar.get_by_role("combobox", name="Speed of play").select_option("5")
    expect(bar.get_by_role("combobox", name="Speed of play")).to_have_value("5")
    at = float(time.input_value())
    bar.get_by_role("button", name="Play").click()
    until(lambda: float(time.input_value()) > at + 1, "the bar goes along while the flight plays", 20)
    bar.get_by_role("button", name="Pause").click()
    bar.get_by_role("button", name="Shown").click()
    box = page.get_by_role("checkbox", name="Velocity", exact=True)
    for _ in range(2):
        before = box.is_checked()
        with page.expect_response(shows_layers) as told:  # not what paused the flight, which may be answered later
            box.click()  # final state once confirmed by the view
        assert told.value.json()["layers"]["velocity"] is not before
        expect(box).to_be_checked(checked=not before)
    page.keyboard.press("Escape")


def filled(page: Page) -> None:
    """The view fills the screen, and gives it back."""
    page.get_by_role("button", name="Full screen").click()
    full = "!!document.fullscreenElement?.closest('#flight') && !!document.fullscreenElement.querySelector('iframe')"
    until(lambda: page.evaluate(full), "full screen", 10)
    page.evaluate("document.exitFullscreen()")
    until(lambda: page.evaluate("document.fullscreenElement === null"), "back from the full screen", 10)


@pytest.mark.nightly  # by day the flight's page in tests/e2e/test_narrow.py and its controls on the page of a run
def test_the_view_in_a_window_of_its_own_has_the_same_controls(drawing: Visit) -> None:
    drawing.go(f"/runs/{BOX}")
    with drawing.page.context.expect_page() as opened:
        drawing.page.get_by_role("link", name="Own window").click()
    window = Visit(opened.value, drawing.address)
    page = window.page
    expect(page).to_have_url(re.compile(rf"/runs/{BOX}/flight\?.*finding=F1"))
    until(lambda: draws(page.frame_locator("#flight iframe")), "something drawn")
    bar = page.get_by_role("group", name="Time of the flight")
    bar.get_by_role("button", name="Closest approach").click()
    page.get_by_role("combobox", name="Flight shown").select_option("nominal")
    expect(page).to_have_url(re.compile("finding=nominal"))
    page.get_by_role("button", name="What-if", exact=True).click()
    expect(page.get_by_test_id("what-if-cost")).to_have_text("0.9436")
    bar.get_by_role("button", name="Shown").click()
    expect(page.get_by_role("checkbox", name="What-if flight")).to_be_checked()
    page.keyboard.press("Escape")
    window.shot("flight-window-1440-light", full=False)
    # An address of the view itself, as earlier links have it, leads here.
    window.go(f"/view/{BOX}/F1/t/3.25/cam/top/dark")
    expect(page).to_have_url(re.compile(rf"/runs/{BOX}/flight\?.*finding=F1.*t=3\.25.*cam=top"))
    expect(bar.get_by_role("slider", name="Time")).to_have_value("3.25")
    page.close()
    assert window.wrong == []


def test_selected_runs_are_cancelled_together(signed_in: Visit) -> None:
    page = signed_in.page
    queued = [waiting(signed_in, f"Waiting {i}") for i in range(2)]
    signed_in.go("/runs?show=running")
    signed_in.go("/runs")
    for run in queued:
        page.get_by_role("checkbox", name=f"Select {run}").check()
    expect(page.get_by_text("2 selected")).to_be_visible()
    page.get_by_role("button", name="Cancel 2 runs").click()
    page.get_by_role("dialog").get_by_role("button", name="Cancel 2 runs").click()
    for run in queued:
        expect(page.locator(f"tr[data-run={run}]")).to_contain_text("Cancelled", timeout=PATIENCE)
        assert api(signed_in, f"/runs/{run}")["state"] == "cancelled"


def the_focus_returns(page: Page) -> None:
    """From every opening of a dialog to the button that opened it; the search is mounted open at the first."""
    for name in ("Change name and tags", "Remove", "Sign off", "Keys", "Search or jump to"):
        button = page.get_by_role("button", name=name).first
        for _ in range(2):
            button.focus()
            page.keyboard.press("Enter")
            within = page.locator("[role=dialog] :focus")
            expect(within).to_have_count(1)
            page.keyboard.press("Escape")
            expect(page.get_by_role("dialog")).to_have_count(0)
            expect(button).to_be_focused()


def the_menu_has_the_focus_when_its_files_come(page: Page) -> None:
    requests: list[Route] = []
    page.route(re.compile("/exports$"), lambda route: requests.append(route))
    page.get_by_role("button", name="Export").click()
    expect(page.get_by_role("menuitem", name="Loading the list of files")).to_be_focused()
    until(lambda: bool(requests), "the list is asked for", 20)
    requests[0].continue_()
    page.unroute_all()
    items = page.get_by_role("menuitem")
    expect(items.first).to_be_focused()
    expect(items.first).not_to_contain_text("Loading")
    page.keyboard.press("j")  # no key of the page
    page.keyboard.press("ArrowDown")
    expect(page.locator("[role=menu] :focus")).to_have_count(1)
    expect(items.first).not_to_be_focused()
    page.keyboard.press("Escape")
    expect(page.get_by_role("button", name="Export")).to_be_focused()


def links_and_buttons_are_used_with_enter(page: Page) -> None:
    """On the list, too, where Enter opens the chosen run: what has the focus comes first."""
    page.get_by_role("button", name="Columns").focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog", name="Columns")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.get_by_role("button", name="Session of").click()
    expect(page.locator("[role=menu] :focus")).to_have_count(1)
    page.keyboard.press("x")  # no key of the page either: the run stays selected
    page.keyboard.press("Escape")
    expect(page.get_by_text("1 selected")).to_be_visible()
    page.get_by_role("link", name="Help", exact=True).focus()
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile("/help"))
    page.go_back()
    expect(page.locator("tr[data-run]")).to_have_count(1)
    page.get_by_role("heading", level=1).click()
    page.keyboard.press("j")


def test_the_keys_are_listed_and_work(signed_in: Visit) -> None:
    page = signed_in.page
    signed_in.move(f"/runs/{BOX}")
    expect(page.get_by_role("heading", name="Findings")).to_be_visible()
    page.keyboard.press("?")
    dialog = page.get_by_role("dialog", name="Keys")
    expect(dialog).to_contain_text("Next and previous run")
    signed_in.shot("keys-1440-light", full=False)
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()
    the_focus_returns(page)
    the_menu_has_the_focus_when_its_files_come(page)
    page.keyboard.press("/")
    expect(page.get_by_label("Search runs")).to_be_focused()
    page.keyboard.type("once more")
    expect(page.locator("tr[data-run]")).to_have_count(1)
    page.keyboard.press("Escape")
    expect(page.get_by_label("Search runs")).to_have_value("once more")
    page.keyboard.press("j")
    page.keyboard.press("x")
    expect(page.get_by_text("1 selected")).to_be_visible()
    links_and_buttons_are_used_with_enter(page)
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile(f"/runs/{AGAIN}$"))
    page.keyboard.press("n")
    expect(page).to_have_url(re.compile("/launch"))


def test_anything_is_found_and_gone_to(signed_in: Visit) -> None:
    page = signed_in.page
    signed_in.move("/help")
    expect(page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()
    page.keyboard.press("Control+k")
    page.keyboard.type("webhook")  # at once, while the dialog is loaded
    dialog = page.get_by_role("dialog", name="Search or jump to")
    found = dialog.get_by_role("option")
    expect(dialog.get_by_label("Search or jump to")).to_have_value("webhook")
    expect(found.filter(has_text="POST /webhooks").first).to_be_visible()
    signed_in.shot("jump-1440-light", full=False)
    found.filter(has_text="Operation: ").first.click()
    expect(page).to_have_url(re.compile("/help/guides/operation#webhooks$"))
    expect(page.get_by_role("heading", name="Webhooks", exact=True)).to_be_in_viewport()
    page.keyboard.press("Control+k")
    page.keyboard.type("once more")
    expect(found.first).to_contain_text(AGAIN)
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile(f"/runs/{AGAIN}$"))
    expect(dialog).to_be_hidden()
    page.get_by_role("button", name="Search or jump to").click()
    page.keyboard.type("potential field")
    expect(found.filter(has_text="Avoider").first).to_be_visible()
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()


@pytest.mark.nightly
def test_a_notification_is_shown_when_a_run_ends(signed_in: Visit, stored: Service) -> None:
    page = signed_in.page
    page.context.grant_permissions(["notifications"], origin=signed_in.address)
    page.add_init_script(WATCH)
    run = waiting(signed_in, "Awaited")
    signed_in.go(f"/runs/{run}")
    page.get_by_role("button", name="Notify me").click()
    expect(page.get_by_role("button", name="Will notify")).to_be_visible()
    signed_in.go("/help")
    finish_fully(stored)
    until(lambda: page.evaluate("told.length > 0"), "a notification", 60)
    title, body = page.evaluate("told[0]")
    assert title == f"{run} cleared"
    assert body.startswith("Awaited: margin +0.")


COLOUR = "name => getComputedStyle(document.documentElement).getPropertyValue(name).trim()"


def test_help_explains_methods_verdicts_and_components(signed_in: Visit) -> None:
    page = signed_in.page
    signed_in.move(f"/runs/{BOX}")
    page.get_by_role("link", name="What this means").click()
    expect(page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()
    looks(signed_in, "help-verdicts")
    catalogue = api(signed_in, "/components")
    page.get_by_role("link", name="Search methods").click()
    for method in catalogue["methods"]:
        expect(page.locator(f"#{method['name']}")).to_contain_text(method["source"])
        colour = page.evaluate(COLOUR, f"--m-{method['name']}")
        assert colour in (method["look"]["colour"], method["look"]["dark"])
    looks(signed_in, "help-methods")
    page.get_by_role("navigation", name="Help").get_by_role("link", name="Components").click()
    expect(page.locator("#vehicle-unicycle")).to_contain_text("dx/dt = v cos(theta)")
    expect(page.locator("#vehicle-unicycle")).to_contain_text("Source:")
    for component in catalogue["components"]:
        expect(page.locator(f"[id='{component['role']}-{component['name']}']")).to_have_count(1)
    signed_in.shot("help-components-1440-light", full=False)
    signed_in.move("/launch?case=unicycle_static")
    scenario = page.get_by_role("region", name="Scenario")
    scenario.get_by_text("Equations and source").first.click()
    scenario.get_by_role("link", name="In the help").first.click()
    expect(page).to_have_url(re.compile("/help/components#vehicle-unicycle"))
    expect(page.locator("#vehicle-unicycle")).to_be_in_viewport()


@pytest.mark.nightly  # by day tests/api/http, which holds the document to the answers
def test_the_api_page_describes_and_tries_the_api(signed_in: Visit) -> None:
    page = signed_in.page
    signed_in.move("/docs")
    expect(page.get_by_role("heading", name="API", exact=True)).to_be_visible()
    operation = page.locator("#get_run")
    operation.get_by_label("run of get_run").fill(BOX)
    expect(operation).to_contain_text(f"/api/v1/runs/{BOX}")
    operation.get_by_role("button", name="Send").click()
    expect(operation.get_by_label("Response")).to_contain_text('"campaign_digest"')
    operation.get_by_text(re.compile("^Response 200")).click()
    expect(operation).to_contain_text("campaign_digest")
    page.locator("#list_runs").get_by_role("button", name="Send").click()
    expect(page.locator("#list_runs").get_by_label("Response")).to_contain_text('"items"')
    looks(signed_in, "api")


@pytest.mark.nightly
def test_ten_thousand_runs_scroll(signed_in: Visit, stored: Service) -> None:
    page = signed_in.page
    with stored.engine.begin() as writer:
        names = [column.name for column in Run.__table__.columns if column.name not in ("id", "name")]
        kept = writer.execute(sa.select(*(Run.__table__.c[name] for name in names)).where(Run.id == 1)).one()
        row = dict(zip(names, kept, strict=True)) | {"pinned": False}
        writer.execute(sa.insert(Run), [row | {"name": f"copy {i}"} for i in range(10_000)])
    signed_in.go("/runs?sort=name")
    expect(page.locator("tr[data-run]").first).to_be_visible()
    expect(page.get_by_role("button", name=re.compile("^All"))).to_contain_text("10")
    assert page.locator("tr[data-run]").count() < 80
    page.get_by_role("button", name="Clear all").count()
    first = set(named(page))

    def further() -> bool:
        page.mouse.wheel(0, 4000)
        assert page.locator("tr[data-run]").count() < 80
        return bool(page.evaluate("scrollY > 12000"))

    until(further, "three hundred rows further down", 60)
    assert first.isdisjoint(named(page))
    looks(signed_in, "runs-many")
