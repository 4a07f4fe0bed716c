"""Every page in light and in dark by axe: nothing serious or critical against WCAG 2.1, levels A and AA.

Source: Deque, axe-core API, "axe.run". The pages show stored runs; nothing is simulated.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Literal

import httpx
import pytest
from playwright.sync_api import Browser, Page, Route, expect

from campaigns import library, load_file
from tests.e2e.axe import AXE, RULES, violations
from tests.e2e.browser import Visit, lay_out, visiting
from tests.e2e.stored import VIEW, served
from tests.e2e.written import editor, write_over, written
from tests.given.at_night import nightly_but
from tests.given.finished_runs import Work
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import published_by_workers
from worker.running.catalogue.installed import methods

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(120)]

COLOURS = {"type": "rule", "values": ["color-contrast", "link-in-text-block"]}
"""What differs between the themes."""

PAGES = {
    "runs": ("/runs", "tr[data-run=R-0004]"),
    # An address from elsewhere: what it does not know is left out.
    "runs-narrowed-to-nothing": ("/runs?q=no+such+run&show=odd&sort=colour", "text=No run matches"),
    "runs-removed": ("/runs?removed=true", "tr[data-run=R-0005]"),
    "run-removed": ("/runs/R-0005", "text=Removed from the lists"),
    "run": ("/runs/R-0001", "#separation canvas"),
    "run-what-if": ("/runs/R-0001?whatif=F1&set=vehicle.J:0.05", "#what-if input[type=range]"),
    "run-flight": ("/runs/R-0001/flight?whatif=nominal", "#what-if input[type=range]"),
    "run-violated": ("/runs/R-0002", "#separation canvas"),
    "run-live": ("/runs/R-0003", "[data-testid=best]"),
    "run-queued": ("/runs/R-0004", "text=No worker is running"),
    "launch": ("/launch", "role=radio[name=/Unicycle, static/]"),
    "launch-text": ("/launch?tab=yaml", "role=textbox[name='Campaign as YAML']"),
    "compare": ("/compare?runs=R-0001,R-0002", "[data-testid=change]"),
    "compare-nothing": ("/compare", "text=Choose 2 to 4 runs here"),
    "help-methods": ("/help/methods", "#direct"),
    "help-verdicts": ("/help", "role=heading[name=Verdicts]"),
    "help-components": ("/help/components", "#vehicle-unicycle"),
    "api": ("/docs", "#list_runs"),
    "users": ("/access/users", "text=Names stay in the records"),
    "tokens": ("/access/tokens", "text=There are no tokens"),
    "sessions": ("/access/sessions", "text=this browser"),
    "audit": ("/access/audit", "role=cell[name=session.opened]"),
}
"""Each with its address and what is seen once it is there."""
BY_DAY = ("runs", "run", "launch")
"""One of each kind; the others are tested nightly."""
PARTS = {
    "help-components": ["vehicle-unicycle", "avoider-potential_field"],
    "api": ["list_runs", "get_run", "submit_run"],
}
"""The cards that are tested of pages with many similar ones: all of them take 15 s, and are tested nightly."""
SHORTEN = """(kept) => {
    const cards = [...document.querySelectorAll('main section[id]:not(:has(section))')]
    cards.filter((card) => !kept.includes(card.id)).forEach((card) => card.remove())
    return cards.length
}"""


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service without runs, with the catalogue of the components that are really there."""
    with served(tmp_path_factory.mktemp("accessibility"), published_by_workers()) as service:
        yield service


@pytest.fixture(scope="module")
def visit(service: Service, browser: Browser) -> Iterator[Visit]:
    """A browser that is signed in and brings axe along; the pages' policy stays as it is."""
    with visiting(browser, service.url) as visit:
        visit.page.add_init_script(path=AXE)
        # The 3D view is another project's page, and takes seconds to draw without a graphics card.
        visit.page.route("**/view/**", lambda route: route.fulfill(body="", content_type="text/html"))
        visit.page.route("**/views/**", lambda route: route.fulfill(json=VIEW))
        visit.sign_in(service.login_code())
        yield visit


@pytest.fixture(scope="module")
def filled(service: Service) -> Service:
    """The service with a run that is cleared, one that is violated, one running, one queued, one removed."""
    document = load_file(library()["unicycle_static"]).document()
    with service.signed_in() as client:
        submit(client, document, "Full box")
        finish_fully(service, "cleared")
        submit(client, document | {"seed": 2}, "Once more, with a name that is long enough to be cut")
        finish_fully(service, "violated")
        submit(client, document, "In work")
        work = Work(service)
        work.nominal()
        work.search(0, 700)
        submit(client, document, "Waits")
        submit(client, document, "Removed")
        client.post("/api/v1/runs/R-0005/cancel")
        client.delete("/api/v1/runs/R-0005", params={"reason": "The bounds were those of another vehicle."})
    return service


def submit(client: httpx.Client, document: dict[str, Any], name: str) -> None:
    answer = client.post("/api/v1/runs", json={"campaign": document, "name": name, "tags": ["baseline"]})
    assert answer.status_code == 201, answer.text


def clean(page: Page, within: Sequence[str] = ()) -> None:
    """Nothing is found in the theme that is shown, nor, of what differs, in the other one, which is shown then."""
    lay_out(page)
    assert violations(page, RULES, within) == []
    now = page.locator("html").get_attribute("data-theme")
    other: Literal["light", "dark"] = "light" if now == "dark" else "dark"
    page.emulate_media(color_scheme=other)
    expect(page.locator("html")).to_have_attribute("data-theme", other)
    assert violations(page, COLOURS, within) == [], other


def seen(visit: Visit, path: str, mark: str, load: bool = True) -> None:
    """Open a page, and wait until it is there; load: the whole application again."""
    (visit.go if load else visit.move)(path)
    if mark.startswith("#"):
        visit.near(mark.partition(" ")[0])
    expect(visit.page.locator(mark).first).to_be_visible()
    expect(visit.page.get_by_role("button", name="Session of")).to_be_visible()


def test_axe_sees_what_is_wrong(visit: Visit) -> None:
    visit.go("/help")
    expect(visit.page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()
    visit.page.locator("main").evaluate("main => main.append(document.createElement('button'))")
    found = violations(visit.page, within=["main"])
    assert [line for line in found if line.startswith("button-name (critical)")]


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_every_method_has_its_colour_of_the_theme(visit: Visit, theme: Literal["light", "dark"]) -> None:
    looks = {name: method.look for name, method in methods().items() if method.look is not None}
    visit.page.emulate_media(color_scheme=theme)
    visit.move("/help")
    # The theme is set before the application begins, which brings the colours.
    expect(visit.page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()
    expect(visit.page.locator("html")).to_have_attribute("data-theme", theme)
    colour = "(all, names) => names.map((name) => getComputedStyle(all).getPropertyValue(`--m-${name}`))"
    shown = dict(zip(looks, visit.page.locator("html").evaluate(colour, [*looks]), strict=True))
    assert shown == {
        name: look.colour if theme == "light" else look.dark or look.colour for name, look in looks.items()
    }
    assert len({*shown.values()}) > 10


@pytest.mark.nightly  # by day the list with runs
def test_the_empty_list_is_accessible(visit: Visit) -> None:
    seen(visit, "/runs", "role=heading[name='No runs yet']")
    clean(visit.page)


@pytest.mark.parametrize("name", nightly_but(BY_DAY, PAGES))
def test_the_page_is_accessible(visit: Visit, filled: Service, name: str) -> None:
    seen(visit, *PAGES[name], load=False)
    if name in PARTS:
        assert visit.page.evaluate(SHORTEN, PARTS[name]) > 10
        expect(visit.page.locator("main section[id]:not(:has(section))")).to_have_count(len(PARTS[name]))
    clean(visit.page)
    if name in PARTS:
        visit.page.goto("about:blank")  # the application fails where its own elements are gone


@pytest.mark.nightly
def test_the_page_of_an_unknown_address_is_accessible(visit: Visit, filled: Service) -> None:
    seen(visit, "/no/such/page", "main")
    clean(visit.page)


@pytest.mark.nightly
@pytest.mark.parametrize("name", PARTS)
def test_every_part_of_a_long_page_is_accessible(visit: Visit, filled: Service, name: str) -> None:
    seen(visit, *PAGES[name])
    clean(visit.page)


@pytest.mark.nightly  # by day the pages below; what opens is used in test_browse.py and test_evidence.py
def test_what_opens_over_a_page_is_accessible(visit: Visit, filled: Service) -> None:
    page = visit.page
    seen(visit, *PAGES["run"])
    page.get_by_role("button", name="Export").click()
    expect(page.get_by_role("menuitem", name="Evaluations, CSV")).to_be_visible()
    clean(page, ["[role=menu]"])
    page.keyboard.press("Escape")
    page.keyboard.press("Control+k")
    expect(page.get_by_role("dialog", name="Search or jump to").get_by_role("option").first).to_be_visible()
    clean(page, ["[role=dialog]"])
    page.keyboard.press("Escape")
    page.locator("#signoff").get_by_role("button", name="Sign off").click()
    expect(page.get_by_role("dialog").get_by_role("textbox", name="Name")).to_be_visible()
    clean(page, ["[role=dialog]"])
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keys")).to_be_visible()
    clean(page)  # with the page behind it, which is out of reach


@pytest.mark.nightly
def test_a_refused_entry_is_accessible(visit: Visit, filled: Service) -> None:
    seen(visit, *PAGES["launch"])
    visit.page.get_by_label("Mass, low").fill("-3")
    expect(visit.page.locator("[data-problem='uncertain.vehicle.m.low']")).to_contain_text("must be within")
    clean(visit.page)


def without_inline_styles(route: Route) -> None:
    """The page under a policy that allows no style but those of files: violations are reported on the console."""
    answer = route.fetch()
    policy = answer.headers["content-security-policy"]
    assert "'unsafe-inline'" in policy
    route.fulfill(
        response=answer, headers=answer.headers | {"content-security-policy": policy.replace(" 'unsafe-inline'", "")}
    )


@pytest.mark.nightly
@pytest.mark.parametrize("searching", [False, pytest.param(True, marks=pytest.mark.nightly)])
def test_the_text_editor_is_accessible_at_work(visit: Visit, filled: Service, searching: bool) -> None:
    """With a problem, its tooltip and completions visible, at night the search, too; Tab leaves the editor, as
    documented."""
    page = visit.page
    seen(visit, *PAGES["launch-text"])
    write_over(page, written(page).replace("horizon: 15.0", "horizon: 15 s").replace("{m: 5.0, ", "{x: 1, m: 5.0, "))
    problems = page.get_by_role("list", name="Problems").get_by_role("listitem")
    expect(problems).to_have_count(1)
    expect(problems).to_contain_text("scenario.horizon expected a number")
    page.get_by_role("button", name="Line 30", exact=True).click()
    expect(editor(page)).to_be_focused()
    expect(page.get_by_test_id("standing")).to_contain_text("scenario.horizon")
    page.keyboard.type("15.0")
    expect(problems).to_contain_text("scenario.vehicle.parameters.x no such parameter")
    page.get_by_role("button", name="Show scenario.vehicle.parameters.x in the form").click()
    expect(page.locator("[id='f-scenario-vehicle-parameters-x']")).to_be_focused()
    page.locator("#problems").get_by_role("button", name="In the YAML").click()
    expect(editor(page)).to_be_focused()
    page.keyboard.press("Control+f")
    expect(page.get_by_role("textbox", name="Find")).to_be_focused()
    page.keyboard.press("Escape")
    page.keyboard.press("Control+End")
    page.keyboard.press("Control+Space")
    expect(page.get_by_role("option", name="correlations")).to_be_visible()
    clean(page)
    page.keyboard.press("Escape")
    page.keyboard.press("Control+f")
    expect(page.get_by_role("textbox", name="Find")).to_be_focused()
    if searching:
        clean(page, ["main"])
    page.keyboard.press("Escape")
    page.keyboard.press("Escape")
    page.keyboard.press("Tab")
    expect(editor(page)).not_to_be_focused()


def test_the_text_editor_needs_no_inline_styles(visit: Visit) -> None:
    page = visit.page
    page.route("**/launch?tab=yaml", without_inline_styles)
    visit.go("/launch?tab=yaml")
    editor(page).focus()
    page.keyboard.press("Control+f")
    expect(page.get_by_role("textbox", name="Find")).to_be_focused()
    page.keyboard.press("Escape")
    page.keyboard.press("Control+End")
    page.keyboard.press("Control+Space")
    expect(page.get_by_role("option", name="correlations")).to_be_visible()
    assert page.locator("[data-editor]").evaluate("e => e.shadowRoot.querySelectorAll('style').length") == 0
    assert visit.wrong == []
    page.unroute("**/launch?tab=yaml")


def test_completions_are_offered_as_soon_as_the_schema_is_there(visit: Visit) -> None:
    page = visit.page
    held: list[Route] = []
    page.route("**/api/v1/campaigns/schema", lambda route: held.append(route))
    visit.go("/launch?tab=yaml")
    editor(page).focus()
    page.keyboard.press("Control+End")
    with page.expect_request("**/api/v1/campaigns/check"):  # the editor has had the time to answer
        page.keyboard.type("c")
    expect(page.get_by_role("option", name="correlations")).to_have_count(0)
    assert len(held) == 1, "the schema is asked for once"
    held[0].continue_()
    expect(page.get_by_role("option", name="correlations")).to_be_visible()
    page.get_by_role("option", name="correlations").click()
    expect(page.locator("[data-editor] .cm-activeLine")).to_have_text("correlations: ")
    page.unroute("**/api/v1/campaigns/schema")


@pytest.mark.nightly  # by day one that comes late, above
def test_a_schema_that_could_not_be_loaded_is_asked_for_with_the_next_completions(visit: Visit) -> None:
    page = visit.page
    page.route("**/api/v1/campaigns/schema", lambda route: route.fulfill(status=422))
    with page.expect_response("**/api/v1/campaigns/schema"):
        visit.go("/launch?tab=yaml")
    statement = page.get_by_role("status").filter(has_text="The schema of campaigns could not be loaded")
    expect(statement).to_be_visible()
    editor(page).focus()
    page.unroute("**/api/v1/campaigns/schema")
    page.keyboard.press("Control+End")
    page.keyboard.press("Control+Space")
    expect(page.get_by_role("option", name="correlations")).to_be_visible()
    expect(statement).to_have_count(0)
    visit.wrong[:] = [entry for entry in visit.wrong if "422" not in entry]  # the browser reports it


@pytest.mark.parametrize("path", nightly_but(("/runs",), ("/runs", "/login?code=wrong")))
def test_the_sign_in_pages_are_accessible(service: Service, browser: Browser, path: str) -> None:
    with visiting(browser, service.url) as stranger:
        page = stranger.page
        page.add_init_script(path=AXE)
        stranger.go(path)
        expect(page.get_by_role("heading", level=1)).to_be_visible()
        expect(page.locator("body")).to_contain_text("clearance login-link")
        found = violations(page)
        page.emulate_media(color_scheme="dark")
        found += violations(page, COLOURS)
        # The browser itself notes that the page was refused.
        assert [wrong for wrong in stranger.wrong if "401" not in wrong and "403" not in wrong] == []
        stranger.wrong.clear()
    assert found == []
