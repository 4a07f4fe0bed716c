"""The daily work: whether anybody works, a service that hangs, cancelling, and launching a file of one's own.

No run is executed: workers are rows of the database.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
import yaml
from playwright.sync_api import Browser, Error, Locator, Route, expect

from backend.db import workers
from backend.db.queue import Queue
from backend.db.tables import Run
from backend.runs.waiting import SOON, no_worker
from tests.e2e.browser import Visit, visiting
from tests.e2e.looking import within
from tests.e2e.stored import served
from tests.given.heartbeats import beating
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]
DRAWS = False
PHONE = {"width": 390, "height": 844}
"""[px]"""


@pytest.fixture(scope="module")
def working(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service without a worker; one that arrives stays alive for as long as a slow machine takes."""
    with served(tmp_path_factory.mktemp("work")) as service:
        with service.signed_in() as client:
            submit(client)
        with beating(service.engine):
            yield service


@pytest.fixture(scope="module")
def visit(working: Service, browser: Browser) -> Iterator[Visit]:
    with visiting(browser, working.url) as visit:
        visit.sign_in(working.login_code())
        yield visit


def beat(service: Service, run: int | None = None) -> None:
    with service.engine.begin() as connection:
        workers.arrive(connection, "w1")
        workers.beat(connection, "w1", run)


def box(part: Locator) -> dict[str, float]:
    found = part.bounding_box()
    assert found is not None
    return dict(found)


def test_the_header_shows_whether_a_worker_is_alive(working: Service, visit: Visit) -> None:
    page = visit.page
    visit.go("/runs")
    row = page.locator("tr[data-run=R-0001]")
    expect(row).to_contain_text(no_worker(None, 0.0).replace("`", ""))
    page.get_by_role("button", name="No worker is alive").click()
    panel = page.get_by_role("dialog")
    expect(panel).to_contain_text("1 run waits.")
    visit.shot("no-worker", full=False)
    beat(working)
    expect(panel).to_contain_text("1 worker alive")
    expect(row).to_contain_text(SOON)
    page.keyboard.press("Escape")
    expect(panel).to_be_hidden()
    expect(page.get_by_role("button", name="1 worker alive, 0 busy")).to_be_focused()


@pytest.mark.nightly
def test_a_service_that_hangs_is_reported_until_it_answers(visit: Visit) -> None:
    page = visit.page
    visit.move("/help")
    expect(page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    page.route("**/api/v1/**", hold)
    connection = page.get_by_role("status", name="Connection")
    expect(connection).to_contain_text("The service does not answer")
    visit.shot("hung", full=False)
    page.unroute("**/api/v1/**")
    for route in held:
        with suppress(Error):  # the page asks again after a while
            route.continue_()
    expect(connection).to_be_empty()


def test_a_page_is_drawn_while_the_service_is_slow_and_has_its_data_once_it_answers(visit: Visit) -> None:
    page = visit.page
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    page.route("**/api/v1/batch*", hold)
    for path, seen in (
        ("/runs", "tr[data-run=R-0001]"),
        ("/runs/R-0001", "main h1:has-text('Unicycle past a pillar')"),
    ):
        visit.go(path)
        expect(page.get_by_role("navigation", name="Main")).to_be_visible()
        assert held, "the page asks for what it shows first"
        while held:
            with suppress(Error):  # the page may have asked again
                held.pop().continue_()
        expect(page.locator(seen)).to_be_visible()
    page.unroute("**/api/v1/batch*")


def test_who_goes_on_before_the_first_drawing_is_where_the_address_says(visit: Visit) -> None:
    page = visit.page
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    page.route("**/api/v1/batch*", hold)  # the page waits for it, at most for half a second
    visit.go("/runs")
    page.evaluate("history.pushState(null, '', '/help')")
    expect(page.get_by_role("heading", name="Verdicts", level=1)).to_be_visible()
    page.unroute("**/api/v1/batch*")


def behind_a_proxy(route: Route) -> None:
    """What a proxy says while the service behind it is away."""
    route.fulfill(status=502, body="<html>Bad gateway</html>", content_type="text/html")


def without_502(visit: Visit) -> None:
    visit.wrong[:] = [entry for entry in visit.wrong if "502" not in entry]  # the browser reports them all


def test_a_service_for_which_a_proxy_answers_is_reported_until_it_answers(visit: Visit) -> None:
    page = visit.page
    visit.move("/help")
    page.route("**/api/v1/**", behind_a_proxy)
    connection = page.get_by_role("status", name="Connection")
    expect(connection).to_contain_text("does not answer")
    page.evaluate("history.pushState(null, '', '/reports')")
    expect(page.get_by_role("main")).to_contain_text("says 502")
    page.unroute("**/api/v1/**")
    expect(connection).to_be_empty()
    expect(page.get_by_role("main")).not_to_contain_text("502")
    without_502(visit)


@pytest.mark.nightly
def test_live_updates_return_after_a_refusal_and_the_list_asks_meanwhile(working: Service, visit: Visit) -> None:
    page = visit.page
    page.route("**/api/v1/events*", behind_a_proxy)
    visit.go("/runs")
    connection = page.get_by_role("status", name="Connection")
    expect(connection).to_contain_text("interrupted")
    with working.signed_in() as client:
        run = submit(client, seed=2)
        expect(page.locator(f"tr[data-run={run}]")).to_be_visible()
        page.unroute("**/api/v1/events*")
        expect(connection).to_be_empty()
        run = submit(client, seed=3)
        expect(page.locator(f"tr[data-run={run}]")).to_be_visible()
    without_502(visit)


def test_the_stream_is_opened_again_when_the_network_returns(visit: Visit) -> None:
    page = visit.stay("/runs")
    with page.expect_response("**/api/v1/events*"):
        page.evaluate("dispatchEvent(new Event('online'))")
    expect(page.get_by_role("status", name="Connection")).to_be_empty()


def test_removal_never_takes_the_place_of_cancelling(working: Service, visit: Visit) -> None:
    page = visit.page
    claim = Queue(working.engine).claim("w1")
    assert claim is not None
    beat(working, claim.run_id)
    with working.engine.begin() as connection:
        workers.doing(connection, "w1", claim.run_id, "compiling", 14.0)
    for width in (1440, PHONE["width"]):
        with working.engine.begin() as connection:
            connection.execute(sa.update(Run).values(state="running", finished=None))
        page.set_viewport_size({"width": width, "height": 844})
        visit.go("/runs/R-0001")
        expect(page.get_by_text("Compiling your closed loop, about 14 s, once")).to_be_visible()
        cancel = page.get_by_role("button", name="Cancel run")
        place = box(cancel)
        within(page, width)
        with working.engine.begin() as connection:
            connection.execute(sa.update(Run).values(state="cancelled", finished=1e9))
        expect(page.get_by_role("button", name="Remove", exact=True)).to_be_visible()
        expect(cancel).to_be_disabled()
        removal = box(page.get_by_role("button", name="Remove", exact=True))
        apart = removal["x"] + removal["width"] <= place["x"] or removal["x"] >= place["x"] + place["width"]
        assert apart or removal["y"] + removal["height"] <= place["y"]
    page.set_viewport_size({"width": 1440, "height": 900})


def test_the_name_in_a_file_is_used(visit: Visit, tmp_path: Path) -> None:
    page = visit.page
    visit.move("/launch?tab=yaml")
    expect(page.get_by_label("Name", exact=True)).to_have_value("Unicycle, static obstacle")
    document: dict[str, Any] = campaign(name="Quadrotor, wall", tags=["quadrotor"])
    file = tmp_path / "quadrotor.yaml"
    file.write_text(yaml.safe_dump(document))
    page.get_by_label("Name", exact=True).fill("My own")
    page.locator("input[type=file]").set_input_files(file)
    expect(page.get_by_label("Name", exact=True)).to_have_value("Quadrotor, wall")
    expect(page.locator(".mantine-TagsInput-pill")).to_have_text(["quadrotor"])


@pytest.mark.parametrize("width", [pytest.param(1440, marks=pytest.mark.nightly), 390])
def test_the_start_and_the_estimate_stay_in_sight(visit: Visit, width: int) -> None:
    page = visit.page
    page.set_viewport_size({"width": width, "height": 844})
    visit.go("/launch?from=R-0001")
    start, effort = page.get_by_role("button", name="Start run"), page.get_by_test_id("effort")
    expect(effort).to_have_text(re.compile(r"^Evaluations: at most [\d\s]+\. Time: not known$"))
    tabs = page.get_by_role("navigation", name="Sections")
    names = tabs.get_by_role("link")
    tops = [page.locator(href).evaluate("e => e.getBoundingClientRect().top") for href in hrefs(names)]
    assert tops == sorted(tops)
    for i in range(names.count()):
        page.locator(hrefs(names)[i]).evaluate("e => e.scrollIntoView({behavior: 'instant'})")
        expect(names.nth(i)).to_have_attribute("aria-current", "true")
        expect(names.nth(i)).to_be_in_viewport(ratio=0.9)
        expect(start).to_be_in_viewport(ratio=1)
        expect(effort).to_be_in_viewport(ratio=1)
    assert box(effort)["x"] + box(effort)["width"] <= box(start)["x"]
    assert effort.evaluate("e => e.scrollWidth <= e.clientWidth"), "it is not cut off"
    visit.shot(f"launch-scrolled-{width}", full=False)
    within(page, width)


def hrefs(links: Locator) -> list[str]:
    return [str(link.get_attribute("href")) for link in links.all()]


def test_the_chosen_methods_come_first(visit: Visit) -> None:
    page = visit.page
    page.set_viewport_size({"width": 1440, "height": 900})
    visit.go("/launch?from=R-0001")
    ticks = page.locator("#section-methods").get_by_role("checkbox")
    expect(ticks.first).to_be_checked()
    before = ticks.count()
    assert all(tick.is_checked() for tick in ticks.all())
    more = page.get_by_role("button", name=re.compile("^More methods"))
    more.click()
    other = ticks.nth(before)
    expect(other).to_be_attached()
    other.evaluate("e => e.scrollIntoView({block: 'center', behavior: 'instant'})")
    name, place = other.get_attribute("aria-label"), box(other)
    other.check()
    same = page.get_by_role("checkbox", name=name)
    assert abs(box(same)["y"] - place["y"]) < 2, "it stays under the pointer"
    page.get_by_role("button", name="Fewer methods").click()
    expect(same).to_be_checked()
    expect(ticks).to_have_count(before + 1)


def test_controls_that_repeat_have_different_names(visit: Visit) -> None:
    page = visit.page
    visit.go("/launch")
    for tab in ("Form", "YAML"):
        page.get_by_role("button", name=tab, exact=True).click()
        expect(page.get_by_role("button", name="Start run")).to_be_visible()
        if tab == "YAML":
            expect(page.get_by_label("Campaign as YAML")).to_be_visible()
        names = page.evaluate(
            """() => [...document.querySelectorAll('main button, main input')].flatMap((e) => {
                const name = e.getAttribute('aria-label') ?? e.labels?.[0]?.textContent ?? e.textContent
                return e.checkVisibility() && name ? [`${e.tagName} ${name.trim()}`] : []
            })"""
        )
        assert len(names) > 10
        assert sorted(set(names)) == sorted(names)
