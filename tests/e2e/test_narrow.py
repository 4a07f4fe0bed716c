"""Every page in the window of a telephone: nothing is wider than the window, and the 3D view is not covered.

The runs were evaluated by a worker, so that every section of their pages has content.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Sequence

import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from tests.e2e.browser import PATIENCE, Visit, draws, rests, visiting
from tests.e2e.flown import BASINS, BOX, CANCELLED, CLEARED, INTRUDER, SEVERAL
from tests.e2e.stored import VIEW, served
from tests.faults.processes import until
from tests.given.at_night import nightly_but
from tests.given.service import Service
from tests.given.small_catalogue import campaign

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]

WINDOW: ViewportSize = {"width": 390, "height": 844}
DESK: ViewportSize = {"width": 1280, "height": 900}
TABLETS: tuple[ViewportSize, ...] = ({"width": 768, "height": 844}, {"width": 1024, "height": 844})
"""[px]"""
WINDOWS: dict[str, Sequence[ViewportSize]] = {"telephone": (WINDOW,), "tablets": TABLETS}
"""By day the narrowest; small pages are seen in all of them."""
RUN = ["#methods", "#space canvas", "#validation", "#provenance", "#notes"]
FLOWN = ["#separation canvas", "#motion canvas", *RUN]
PAGES: dict[str, tuple[str, list[str]]] = {
    "runs": ("/runs", [f"tr[data-run={BASINS}]"]),
    "run": (f"/runs/{BOX}", FLOWN),
    "run-intruder": (f"/runs/{INTRUDER}", FLOWN),
    "run-several-criteria": (f"/runs/{SEVERAL}", [*FLOWN, "#front table"]),
    "run-simulator": (f"/runs/{BASINS}", RUN),
    "run-cancelled": (f"/runs/{CANCELLED}", ["#provenance"]),
    "flight": (f"/runs/{INTRUDER}/flight?whatif=nominal", ["#what-if input[type=range]"]),
    "no-flight": (f"/runs/{BASINS}/flight", ["text=There is no 3D view"]),
    "launch": ("/launch", ["role=radio[name=/Unicycle, static/]", "role=region[name=Scenario]"]),
    "launch-text": ("/launch?tab=yaml", ["role=textbox[name='Campaign as YAML']"]),
    "launch-simulator": (f"/launch?from={BASINS}", ["role=combobox[name='Simulator']"]),
    "compare": (f"/compare?runs={INTRUDER},{BOX}", ["#separation canvas", "#convergence canvas", "#code"]),
    "compare-simulator": (f"/compare?runs={BASINS},{CLEARED}", ["#convergence canvas", "#ranges", "#code"]),
    "compare-nothing": ("/compare", ["text=Choose 2 to 4 runs here"]),
    "help": ("/help", ["role=heading[name=Verdicts]"]),
    "help-methods": ("/help/methods", ["#direct"]),
    "help-components": ("/help/components", ["#vehicle-unicycle", "#simulator-two_basins"]),
    "help-evidence": ("/help/evidence", ["main table"]),
    "api": ("/docs", ["#list_runs"]),
    "users": ("/access/users", ["text=Names stay in the records"]),
    "audit": ("/access/audit", ["role=cell[name=/session.opened/]"]),
}
"""Each with its address and what is drawn once it is scrolled to."""
BY_DAY = ("runs", "run-intruder", "launch", "first-campaign")
"""One of each kind; the others are tested nightly."""
GUIDES = (
    "first-campaign",
    "your-own-component",
    "your-own-simulator",
    "python",
    "recipes-px4-nav2",
    "cluster",
    "methods",
    "scoreboard",
    "evidence",
    "requirements",
    "ci",
    "access",
    "operation",
    "architecture",
)

BEYOND = """() => {
    const scrolls = (element) => /auto|scroll/.test(getComputedStyle(element).overflowX)
    const cut = (element) => getComputedStyle(element).textOverflow === 'ellipsis'
    const found = []
    for (const element of document.body.querySelectorAll('*')) {
        const { left, right, width, height } = element.getBoundingClientRect()
        if (width * height <= 1 || element.closest('svg *') || (left >= -1 && right <= innerWidth + 1)) continue
        if (!element.checkVisibility({ contentVisibilityAuto: true })) continue // laid out when it comes near
        let around = element.parentElement
        while (around && around !== document.body && !scrolls(around) && !cut(around)) around = around.parentElement
        if (around === document.body)
            found.push(`${element.tagName}.${element.getAttribute('class')} ${left}..${right}: ${element.textContent}`)
    }
    return found
}"""


def beyond(visit: Visit) -> list[str]:
    """What is beside the window although nothing scrolls it: it widens the page, or is cut off."""
    wide = visit.page.evaluate("document.documentElement.scrollWidth - innerWidth")
    found: list[str] = visit.page.evaluate(BEYOND)
    return ([f"the page is {wide} px wider than the window"] if wide > 0 else []) + found


@pytest.fixture(scope="module")
def visit(stored: Service, browser: Browser) -> Iterator[Visit]:
    """A telephone that is signed in."""
    with visiting(browser, stored.url, views=False) as visit:
        # The 3D view is another project's page, which takes seconds to start; it has a test of its own.
        visit.page.route("**/view/**", lambda route: route.fulfill(body="", content_type="text/html"))
        visit.page.route("**/views/**", lambda route: route.fulfill(json=VIEW))
        visit.page.set_viewport_size(WINDOW)
        visit.sign_in(stored.login_code())
        yield visit


def fits(visit: Visit, path: str, marks: list[str], windows: Sequence[ViewportSize]) -> None:
    """Nothing of a page within the application is beyond the window."""
    visit.move(path)
    drawn(visit, marks, windows)


def drawn(visit: Visit, marks: list[str], windows: Sequence[ViewportSize]) -> None:
    """Nothing is beyond the window, once everything that comes into sight is drawn."""
    found: list[str] = []
    for window in windows:
        visit.page.set_viewport_size(window)
        for mark in marks:
            come_near(visit, mark)
            found += [f"at {window['width']} px, {mark}: {one}" for one in settled(visit)]
    visit.page.set_viewport_size(WINDOW)
    assert not found, "; ".join(found)


def come_near(visit: Visit, mark: str) -> None:
    """Scroll to what matches, until it is there, laid out and visible."""
    if mark.startswith("#"):
        visit.near(mark.partition(" ")[0])
    place = visit.page.locator(mark).first
    expect(place).to_be_attached()
    # In the page: a chart may be built again meanwhile.
    place.evaluate("element => element.scrollIntoView({behavior: 'instant', block: 'center'})")
    expect(place).to_be_visible()
    until(lambda: place.evaluate("e => e.checkVisibility({ contentVisibilityAuto: true })"), f"{mark} is laid out", 10)


def settled(visit: Visit) -> list[str]:
    """What is beyond the window and stays there: charts get their new width only after the page has it."""
    with contextlib.suppress(AssertionError):
        until(lambda: not beyond(visit), "everything within the window", 5)
    return beyond(visit)


def test_it_sees_what_is_too_wide(visit: Visit) -> None:
    visit.go("/help")
    expect(visit.page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()
    found = beyond(visit)
    assert not found, "; ".join(found)
    visit.page.locator("main").evaluate(
        "main => { main.innerHTML = '<p class=wide>x</p>'; main.firstChild.style.width = '500px' }"
    )
    widened, *found = beyond(visit)
    assert "wider than the window" in widened
    assert [line.partition(" ")[0] for line in found] == ["P.wide"]
    visit.page.locator("main").evaluate("main => { main.style.overflow = 'hidden' }")
    assert beyond(visit) == found, "what is cut off is seen, too"
    visit.page.goto("about:blank")  # the application fails where its own elements are gone


def test_every_main_page_is_one_tap_away(visit: Visit) -> None:
    visit.go("/help")
    links = visit.page.get_by_role("navigation", name="Main").get_by_role("link")
    expect(links).to_have_text(["Runs", "Launch", "Compare", "Requirements", "Reports", "Help"])
    for box in (link.bounding_box() for link in links.all()):
        assert box is not None
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= WINDOW["width"]
        assert box["height"] >= 32


@pytest.mark.parametrize("on", nightly_but(("telephone",), WINDOWS))
@pytest.mark.parametrize("name", nightly_but(BY_DAY, PAGES))
def test_the_page_fits(visit: Visit, name: str, on: str) -> None:
    fits(visit, *PAGES[name], WINDOWS[on])


UNBROKEN = ("/runs/R-0001", "/runs/R-0001/flight", "/launch?from=R-0001", "/sweeps/S-0001")


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory: pytest.TempPathFactory, browser: Browser) -> Iterator[Visit]:
    """A run and a sweep of which nothing that a user names has a space."""
    with served(tmp_path_factory.mktemp("unbroken")) as service, visiting(browser, service.url) as visit:
        label = {"branch": "l" * 100}
        document = campaign() | {"name": "C" * 120}
        body = {"campaign": document, "name": "W" * 120, "tags": ["t" * 40], "labels": label}
        sweep = {"campaign": document, "name": "S" * 120, "path": "start.v", "values": [1, 2]}
        with service.signed_in() as client:
            for path, sent in (("runs", body | {"baseline": f"label:branch={'l' * 100}"}), ("sweeps", sweep)):
                answer = client.post(f"/api/v1/{path}", json=sent)
                assert answer.status_code == 201, answer.text
        visit.sign_in(service.login_code())
        yield visit


@pytest.mark.parametrize("path", nightly_but(("/runs/R-0001",), UNBROKEN))
def test_names_without_spaces_fit(unbroken: Visit, path: str) -> None:
    page = unbroken.page
    for window in (WINDOW, DESK):
        page.set_viewport_size(window)
        unbroken.go(path)
        heading = page.locator("main h1")
        expect(heading).to_be_visible()
        if path.startswith("/launch"):
            expect(page.get_by_role("textbox", name="Name", exact=True)).to_have_value("W" * 120)
            box = heading.bounding_box()
            assert box is not None
            assert box["height"] < 40, "the note beside the heading wraps, not the heading"
        else:
            expect(heading).to_have_text(re.compile("^(W|S){120}$"))
        found = settled(unbroken)
        assert not found, "; ".join(found)


def test_the_page_of_an_unknown_address_fits(visit: Visit) -> None:
    visit.go("/no/such/page")
    drawn(visit, ["text=Page not found"], (WINDOW, *TABLETS))


@pytest.mark.parametrize("name", nightly_but(BY_DAY, GUIDES))
def test_the_guide_fits(visit: Visit, name: str) -> None:
    fits(visit, f"/help/guides/{name}", ["main h1"], (WINDOW, *TABLETS))


@pytest.mark.parametrize("path", nightly_but(("/login?code=wrong",), ("/runs", "/login?code=wrong")))
def test_the_sign_in_pages_fit(stored: Service, browser: Browser, path: str) -> None:
    with visiting(browser, stored.url) as stranger:
        stranger.page.set_viewport_size(WINDOW)
        stranger.go(path)
        expect(stranger.page.get_by_role("heading", level=1)).to_be_visible()
        assert beyond(stranger) == []
        # The browser itself notes that the page was refused.
        assert [wrong for wrong in stranger.wrong if "401" not in wrong and "403" not in wrong] == []
        stranger.wrong.clear()


@pytest.mark.nightly  # it loads two views; by day the pages above
def test_the_panel_of_the_view_opens_on_request(visit: Visit) -> None:
    page = visit.page
    page.unroute("**/view/**")
    page.unroute("**/views/**")
    visit.go(f"/runs/{INTRUDER}/flight")
    opened = page.get_by_role("button", name="Open the panel")
    expect(opened).to_be_enabled(timeout=PATIENCE)
    # A sandboxed frame is drawn by another process: a click right after scrolling may meet it where it was before.
    opened.scroll_into_view_if_needed()
    frame = page.frame_locator("#flight iframe")
    tab = frame.get_by_text("Search", exact=True)
    expect(frame.get_by_text("Details", exact=True).first).to_be_visible(timeout=PATIENCE)
    expect(tab).to_be_hidden()
    opened.click()
    expect(tab).to_be_visible()
    until(lambda: draws(frame), "something drawn")
    until(lambda: rests(frame), "a view at rest draws nothing")
    page.get_by_role("group", name="Time of the flight").get_by_role("slider", name="Time").press("ArrowRight")
    until(lambda: not rests(frame), "a moved one is drawn")
