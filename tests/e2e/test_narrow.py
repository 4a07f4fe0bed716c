"""Every page in the window of a telephone: nothing is wider than the window, and the 3D view is not covered.

The runs are evaluated by a worker, so that every section of their pages has content. Start reading at `beyond`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from tests.e2e.browser import PATIENCE, Visit, visiting
from tests.e2e.looking import api
from tests.e2e.stored import VIEW
from tests.faults.processes import until
from tests.faults.serving import Service, serving
from tests.simulators import package

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]

WINDOW: ViewportSize = {"width": 390, "height": 844}
"""[px]"""
QUICK = {
    "sensitivity": {"points": 3, "sobol": {"samples": 8}},
    "search": [
        {"method": "direct", "evaluations": 200},
        {"method": "sqp", "evaluations": 100},
        {"method": "nsga2", "evaluations": 200},
        {"method": "monte_carlo", "evaluations": 100},
    ],
    "certify": {"samples": 200},
    "validate": {"neighbours": 5},
}
RUN = ["#methods", "#space canvas", "#validation", "#provenance", "#notes"]
FLOWN = ["#separation canvas", "#motion canvas", *RUN]
PAGES: dict[str, tuple[str, list[str]]] = {
    "runs": ("/runs", ["tr[data-run=R-0003]"]),
    "run": ("/runs/R-0001", FLOWN),
    "run-several-criteria": ("/runs/R-0002", [*FLOWN, "#front table"]),
    "run-simulator": ("/runs/R-0003", RUN),
    "run-cancelled": ("/runs/R-0004", ["#provenance"]),
    "flight": ("/runs/R-0001/flight?whatif=nominal", ["#what-if input[type=range]"]),
    "no-flight": ("/runs/R-0003/flight", ["text=There is no 3D view"]),
    "launch": ("/launch", ["role=radio[name=/Unicycle, static/]", "role=region[name=Scenario]"]),
    "launch-text": ("/launch?tab=yaml", ["role=textbox[name='Campaign as YAML']"]),
    "launch-simulator": ("/launch?from=R-0003", ["role=combobox[name='Simulator']"]),
    "compare": ("/compare?runs=R-0001,R-0002", ["#separation canvas", "#convergence canvas", "#code"]),
    "compare-simulator": ("/compare?runs=R-0003,R-0005", ["#convergence canvas", "#ranges", "#code"]),
    "compare-nothing": ("/compare", ["text=Choose two to 4 runs here"]),
    "help": ("/help", ["role=heading[name=Verdicts]"]),
    "help-methods": ("/help/methods", ["#direct"]),
    "help-components": ("/help/components", ["#vehicle-unicycle", "#simulator-two_basins"]),
    "help-evidence": ("/help/evidence", ["main table"]),
    "api": ("/docs", ["#list_runs"]),
    "no-such-page": ("/no/such/page", ["text=Page not found"]),
}
"""Each with its address and what is drawn once it is scrolled to."""
GUIDES = (
    "first-campaign",
    "your-own-component",
    "your-own-simulator",
    "python",
    "recipes-px4-nav2",
    "cluster",
    "methods",
    "evidence",
    "ci",
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
        let around = element.parentElement
        while (around && around !== document.body && !scrolls(around) && !cut(around)) around = around.parentElement
        if (around === document.body)
            found.push(`${element.tagName}.${element.getAttribute('class')} ${left}..${right}: ${element.textContent}`)
    }
    return found
}"""


def beyond(visit: Visit) -> list[str]:
    """What is beside the window although nothing scrolls it: it widens the page, or is cut off."""
    wide = visit.page.evaluate("document.documentElement.scrollWidth") - WINDOW["width"]
    found: list[str] = visit.page.evaluate(BEYOND)
    return ([f"the page is {wide} px wider than the window"] if wide > 0 else []) + found


def submit(visit: Visit, body: dict[str, Any]) -> str:
    given = visit.page.request.post(f"{visit.address}/api/v1/runs", data=body, headers={"Origin": visit.address})
    assert given.status == 201, given.text()
    return str(given.json()["id"])


def over(visit: Visit, run: str) -> bool:
    return api(visit, f"/runs/{run}")["state"] in ("done", "cancelled")


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with a worker and a simulator of its own."""
    folder = tmp_path_factory.mktemp("narrow")
    with serving(folder, PYTHONPATH=package.path(package.install(folder / "package"))) as service:
        yield service


@pytest.fixture(scope="module")
def visit(own: Service, browser: Browser) -> Iterator[Visit]:
    """A telephone that is signed in, with runs: many parameters, several criteria, a simulator's, a cancelled one."""
    link = own.link()
    with visiting(browser, link.partition("/login")[0]) as visit:
        visit.page.emulate_media(reduced_motion="reduce")
        # The 3D view takes seconds to draw without a graphics card; it has a test of its own.
        visit.page.route("**/view/**", lambda route: route.fulfill(body="", content_type="text/html"))
        visit.page.route("**/views/**", lambda route: route.fulfill(json=VIEW))
        visit.page.set_viewport_size(WINDOW)
        visit.page.goto(link)
        for case in ("pioneer_moving", "uav_moving_criteria"):
            asked = api(visit, f"/campaigns/{case}")["document"] | {"stages": QUICK}
            submit(
                visit, {"campaign": asked, "name": "With a long name that does not fit", "tags": ["a-long-tag", "b"]}
            )
        submit(visit, {"campaign": package.campaign(), "name": "Basins"})
        cancelled = submit(visit, {"campaign": asked, "name": "Cancelled"})
        visit.page.request.post(f"{visit.address}/api/v1/runs/{cancelled}/cancel", headers={"Origin": visit.address})
        runs = ["R-0001", "R-0002", "R-0003", cancelled]
        runs.append(submit(visit, {"campaign": package.campaign(2.0), "name": "Basins, another threshold"}))
        until(lambda: all(over(visit, run) for run in runs), "all over", 200)
        yield visit


def fits(visit: Visit, path: str, marks: list[str]) -> None:
    """Nothing is beyond the window, once everything that comes into sight is drawn."""
    visit.go(path)
    for mark in marks:
        place = visit.page.locator(mark).first
        expect(place).to_be_attached()
        # In the page: a chart may be built again meanwhile.
        place.evaluate("element => element.scrollIntoView({behavior: 'instant', block: 'center'})")
        expect(place).to_be_visible()
    assert beyond(visit) == []


def test_it_sees_what_is_too_wide(visit: Visit) -> None:
    visit.go("/help")
    expect(visit.page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()
    assert beyond(visit) == []
    visit.page.locator("main").evaluate(
        "main => { main.innerHTML = '<p class=wide>x</p>'; main.firstChild.style.width = '500px' }"
    )
    widened, *found = beyond(visit)
    assert "wider than the window" in widened
    assert [line.partition(" ")[0] for line in found] == ["P.wide"]
    visit.page.locator("main").evaluate("main => { main.style.overflow = 'hidden' }")
    assert beyond(visit) == found, "what is cut off is seen, too"


@pytest.mark.parametrize("name", PAGES)
def test_the_page_fits(visit: Visit, name: str) -> None:
    fits(visit, *PAGES[name])


@pytest.mark.parametrize("name", GUIDES)
def test_the_guide_fits(visit: Visit, name: str) -> None:
    fits(visit, f"/help/guides/{name}", ["main h1"])


@pytest.mark.parametrize("path", ["/runs", "/login?code=wrong"])
def test_the_sign_in_pages_fit(own: Service, browser: Browser, path: str) -> None:
    with visiting(browser, own.link().partition("/login")[0]) as stranger:
        stranger.page.set_viewport_size(WINDOW)
        stranger.go(path)
        expect(stranger.page.get_by_role("heading", level=1)).to_be_visible()
        assert beyond(stranger) == []
        # The browser itself notes that the page was refused.
        assert [wrong for wrong in stranger.wrong if "401" not in wrong and "403" not in wrong] == []
        stranger.wrong.clear()


def test_the_panel_of_the_view_opens_on_request(visit: Visit) -> None:
    page = visit.page
    page.unroute("**/view/**")
    page.unroute("**/views/**")
    visit.go("/runs/R-0001/flight")
    opened = page.get_by_role("button", name="Open the panel")
    expect(opened).to_be_enabled(timeout=PATIENCE)
    frame = page.frame_locator("#flight iframe")
    tab = frame.get_by_text("Space", exact=True)
    expect(frame.get_by_text(re.compile("Values, space, search")).first).to_be_visible(timeout=PATIENCE)
    expect(tab).to_be_hidden()
    opened.click()
    expect(tab).to_be_visible()
