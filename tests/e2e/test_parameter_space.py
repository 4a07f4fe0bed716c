"""The parameter space on a run's page: drawing, ranges by mouse and keyboard, toggles, the data."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Literal

import pytest
from playwright.sync_api import Browser, Locator, Page, Request, Response, expect

from campaigns.claims.coverage import NO_PROOF
from campaigns.claims.spans import words
from tests.e2e.browser import PATIENCE, Visit, space_of, visiting
from tests.e2e.looking import LOOKS, api, within
from tests.e2e.stored import served
from tests.faults.processes import until
from tests.given.finished_runs import Work
from tests.given.reported_runs import finish_fully
from tests.given.runs_with_failures import FLYING, INSIDE, lose
from tests.given.service import Service
from tests.given.small_catalogue import campaign, published_by_workers

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(300),
    pytest.mark.nightly,
]  # by day frontend/src/run/space/space.test.ts
DRAWS = False

POINTS = "/evaluations?max_points=2000"
ALL = re.compile("^1.?000 of 1.?000 evaluations selected, lowest dmin 1.007 m")


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with a finished run of 1000 evaluations of two parameters, every tenth of them failed, one of 21
    simulated ones, of which 4 are excluded and 7 failed, and an active one of a shipped campaign."""
    with served(tmp_path_factory.mktemp("space"), published_by_workers()) as service:
        with service.signed_in() as client:
            assert client.post("/api/v1/runs", json={"campaign": campaign(), "name": "Space"}).status_code == 201
            finish_fully(service)
            lose(service, client, publish=False)
            document = client.get("/api/v1/campaigns/unicycle_static").json()["document"]
            assert client.post("/api/v1/runs", json={"campaign": document}).status_code == 201
            Work(service).search(0, 100)
        yield service


@pytest.fixture(scope="module")
def visit(finished: Service, browser: Browser) -> Iterator[Visit]:
    with visiting(browser, finished.url) as visit:
        visit.sign_in(finished.login_code())
        visit.go("/runs/R-0001")
        yield visit


@pytest.fixture
def card(visit: Visit) -> Locator:
    """The card without any range."""
    card = space_of(visit.page)
    card.get_by_role("slider").first.press("Escape")
    return card


def kept(card: Locator) -> Locator:
    return card.get_by_test_id("kept")


def drag(visit: Visit, area: Locator, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag between two positions, in fractions of an area's width and height."""
    area.scroll_into_view_if_needed()
    box = area.bounding_box()
    assert box is not None
    mouse = visit.page.mouse
    mouse.move(box["x"] + start[0] * box["width"], box["y"] + start[1] * box["height"])
    mouse.down()
    mouse.move(box["x"] + end[0] * box["width"], box["y"] + end[1] * box["height"], steps=5)
    mouse.up()


def press(visit: Visit, area: Locator, at: tuple[float, float]) -> None:
    """Click a position, in fractions of an area's width and height."""
    drag(visit, area, at, at)


def test_all_evaluations_are_drawn(visit: Visit, card: Locator) -> None:
    expect(
        card.get_by_role("group", name=re.compile("^Parallel coordinates of 1000 evaluations: d_min"))
    ).to_be_visible()
    expect(card.get_by_role("group", name=re.compile("^Scatter of 1000 evaluations"))).to_be_visible()
    expect(card.get_by_role("img", name=re.compile("^Colour: d_min from 1.007 to 3 m"))).to_be_visible()
    expect(kept(card)).to_have_text(ALL)
    expect(card).to_contain_text("Failed 100")


@pytest.mark.parametrize("by", ["keys", pytest.param("menu", marks=pytest.mark.nightly)])
def test_evaluations_are_read_where_they_are_drawn_or_when_a_print_may_begin(visit: Visit, by: str) -> None:
    page = visit.page
    every: list[str] = []
    come: list[str] = []

    def note(request: Request) -> None:
        every.append(request.url)

    def received(response: Response) -> None:
        come.append(response.url)

    page.on("request", note)
    page.on("response", received)
    try:
        page.evaluate("scrollTo({top: 0, behavior: 'instant'})")  # where a load begins that is of the same address
        visit.go("/runs/R-0001")
        expect(page.locator("#provenance")).to_be_attached()
        assert not [url for url in every if POINTS in url]
        until(lambda: begun(page, by) or any(POINTS in url for url in come), "the evaluations", PATIENCE / 1e3)
        page.evaluate("dispatchEvent(new Event('beforeprint'))")
        expect(page.locator("#space").get_by_test_id("kept")).to_have_text(ALL)
        page.keyboard.press("Control")
        assert len([url for url in every if POINTS in url]) == 1
    finally:
        page.remove_listener("request", note)
        page.remove_listener("response", received)


def test_what_is_read_near_the_window_has_been_read_when_a_print_begins(visit: Visit) -> None:
    page = visit.page
    page.evaluate("scrollTo({top: 0, behavior: 'instant'})")  # where a load begins that is of the same address
    visit.go("/runs/R-0001")
    expect(page.locator("#provenance")).to_be_attached()
    waiting = page.locator("main").get_by_text(re.compile("^(Loading|Reading) .* …$"))
    expect(page.locator("#coverage")).to_contain_text("Loading")
    expect(page.locator("#related")).to_contain_text("Loading")
    until(lambda: begun(page, "menu") or page.locator("#coverage").get_by_test_id("radius").count(), "coverage", 60)
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    expect(waiting).to_have_count(0)


def begun(page: Page, by: str) -> None:
    """What comes before a print, also where a page that was only just drawn does not listen yet."""
    if by == "menu":
        page.locator("html").dispatch_event("mouseleave")  # the pointer, on its way to the menu
    else:
        page.keyboard.press("Control")


def test_evaluations_that_cannot_be_read_can_be_read_again(visit: Visit) -> None:
    page = visit.page
    page.route(f"**{POINTS}", lambda route: route.fulfill(status=500, json={"title": "Broken", "detail": "No disk."}))
    visit.go("/runs/R-0001")
    page.locator("#space").scroll_into_view_if_needed()
    failed = page.locator("#space").get_by_role("alert")
    expect(failed).to_contain_text("No disk.")
    page.unroute(f"**{POINTS}")
    failed.get_by_role("button", name="Try again").click()
    expect(kept(space_of(page))).to_have_text(ALL)
    visit.wrong = [wrong for wrong in visit.wrong if POINTS not in wrong]


@pytest.mark.parametrize(
    ("width", "theme"),
    [pytest.param(*look, marks=[] if look == LOOKS[-1] else [pytest.mark.nightly]) for look in LOOKS],
)
def test_it_fits_at_both_widths_in_both_themes(
    visit: Visit, card: Locator, width: int, theme: Literal["light", "dark"]
) -> None:
    """By day at the narrower one, in the dark, as other pages."""
    page = visit.page
    coverage = page.locator("#coverage")
    page.set_viewport_size({"width": width, "height": 900})
    page.emulate_media(color_scheme=theme)
    expect(page.locator("html")).to_have_attribute("data-theme", theme, timeout=PATIENCE)
    within(page, width)
    # The card alone: the 3D view above it takes seconds to be drawn without a graphics card.
    visit.shot(f"space-{width}-{theme}", of=card)
    coverage.scroll_into_view_if_needed()
    expect(coverage.get_by_test_id("radius")).to_be_visible(timeout=PATIENCE)
    within(page, width)
    visit.shot(f"coverage-{width}-{theme}", of=coverage)
    page.set_viewport_size({"width": 1440, "height": 900})
    page.emulate_media(color_scheme="light")


def test_the_coverage_is_below_and_is_no_proof(visit: Visit, card: Locator) -> None:
    coverage = visit.page.locator("#coverage")
    coverage.scroll_into_view_if_needed()
    found = api(visit, "/runs/R-0001/coverage")
    expect(coverage.get_by_test_id("radius")).to_have_text(str(found["ball"]["radius"]), timeout=PATIENCE)
    expect(coverage.get_by_test_id("least")).to_have_text(f"{found['pairs'][0]['touched']}\u202f%")
    expect(coverage.locator("p").last).to_have_text(words(NO_PROOF))


def test_a_range_on_an_axis_filters_every_view(visit: Visit, card: Locator) -> None:
    lines = card.get_by_role("group", name=re.compile("^Parallel"))
    drag(visit, lines.locator("[data-hit]").nth(1), (0.5, 0.2), (0.5, 0.6))
    expect(kept(card)).not_to_have_text(ALL)
    number = int(re.sub(r"\D", "", kept(card).inner_text().split(" of ")[0]))
    assert 300 < number < 500
    for view in ("Parallel coordinates", "Scatter"):
        expect(card.get_by_role("group", name=re.compile(f"^{view} of {number} evaluations"))).to_be_visible()
    visit.shot("space-range", of=card)
    with visit.page.expect_download() as download:
        card.get_by_role("button", name="Download CSV").click()
    with Path(download.value.path()).open(newline="") as file:
        rows = list(csv.reader(file))
    assert len(rows) == number + 1
    card.get_by_role("button", name="Clear brush").click()
    expect(kept(card)).to_have_text(ALL)


def test_a_rectangle_in_a_cell_is_a_range_on_both_axes(visit: Visit, card: Locator) -> None:
    scatter = card.get_by_role("group", name=re.compile("^Scatter"))
    drag(visit, scatter.locator("[data-hit]").first, (0.25, 0.25), (0.75, 0.75))
    expect(card.get_by_role("button", name=re.compile("^Clear range of"))).to_have_count(2)
    number = int(re.sub(r"\D", "", kept(card).inner_text().split(" of ")[0]))
    assert 200 < number < 300
    card.get_by_role("button", name=re.compile(r"^Clear range of\s+m\s")).click()
    expect(card.get_by_role("button", name=re.compile("^Clear range of"))).to_have_count(1)


@pytest.mark.nightly  # by day an evaluation is chosen by keys
def test_a_range_is_set_by_keys(visit: Visit, card: Locator) -> None:
    card.get_by_role("slider", name="d_min, to").press("PageDown")
    expect(kept(card)).to_have_text(re.compile("^894 of 1.?000 evaluations selected, lowest dmin 1.007 m"))
    expect(card.get_by_role("button", name=re.compile(r"^Clear range of\s+d\s*min"))).to_be_visible()
    expect(visit.page).to_have_url(re.compile(r"brush=value:[\d.]+:[\d.]+"))
    visit.page.reload()
    space_of(visit.page)
    expect(kept(card)).to_have_text(re.compile("^894 of"))
    card.get_by_role("slider").first.focus()
    visit.page.keyboard.press("Escape")
    expect(kept(card)).to_have_text(ALL)


def test_stages_and_failures_are_switched_off(visit: Visit, card: Locator) -> None:
    failed = card.get_by_role("button", name=re.compile("^Failed"))
    failed.click()
    expect(kept(card)).to_have_text(re.compile("^900 of 1.?000 evaluations selected"))
    failed.click()
    method = card.get_by_role("button", name=re.compile("^DIRECT"))
    method.click()
    expect(kept(card)).to_have_text(re.compile("^0 of 1.?000 evaluations selected, none with a value"))
    expect(card).to_contain_text("No selected evaluation has a value.")
    method.click()
    expect(kept(card)).to_have_text(ALL)


@pytest.fixture
def lost(visit: Visit) -> Locator:
    """The card of the run of 21 simulated evaluations."""
    visit.page.set_viewport_size({"width": 1440, "height": 900})
    visit.move("/runs/R-0002")
    card = space_of(visit.page)
    expect(kept(card)).to_have_text(re.compile("^21 of 21 evaluations selected"))
    return card


def test_excluded_and_failed_evaluations_are_distinguished(visit: Visit, lost: Locator) -> None:
    card = lost
    for fate, number in (("Failed", 7), ("Excluded", 4)):
        switch = card.get_by_role("button", name=f"{fate} {number}", exact=True)
        switch.click()
        expect(kept(card)).to_have_text(re.compile(f"^{21 - number} of 21 evaluations selected"))
        switch.click()
    visit.shot("space-lost", of=card)
    failures = visit.page.locator("#failures")
    expect(failures).to_contain_text(re.compile("7 failed.*4 excluded", re.S))
    expect(failures.get_by_role("row", name=re.compile("Excluded"))).to_have_count(4)


def simulated(visit: Visit, act: Callable[[], None]) -> dict[str, Any]:
    """The flight that this simulates, which the page draws."""
    with visit.page.expect_response(re.compile("/api/v1/runs/R-0002/flights$"), timeout=120_000) as response:
        act()
    answer: dict[str, Any] = response.value.json()
    shown = visit.page.locator("#what-if")
    expect(shown.get_by_role("status", name="What-if flight")).to_have_attribute("aria-busy", "false")
    expect(visit.page.locator("#flight")).to_contain_text("what-if")
    return answer


def test_a_click_in_the_scatter_simulates_an_evaluation_and_compares_it(visit: Visit, lost: Locator) -> None:
    evaluations = visit.page.request.get(f"{visit.address}/api/v1/runs/R-0002/evaluations").json()["stages"]
    stored = next(stage for stage in evaluations if stage["kind"] == "search")
    cell = lost.get_by_role("group", name=re.compile("^Scatter")).locator("[data-hit]").first
    again = lost.get_by_role("status", name="Simulated again")
    for row, point in ((12, FLYING[1]), (1, INSIDE[1])):
        answer = simulated(visit, lambda point=point: press(visit, cell, (point[0], 1 - point[1])))
        assert answer["cost"] == stored["cost"][row]
        assert answer["status"] == stored["status"][row]
        assert {path: answer["parameters"][path] for path in stored["parameters"]} == {
            path: column[row] for path, column in stored["parameters"].items()
        }
        expect(again).to_contain_text("identical to the stored value" if row == 12 else "as stored")
        expect(lost).to_contain_text(f"Simulated: DIRECT, evaluation {row + 1}")
    visit.shot("space-simulated", of=lost)
    again.get_by_role("link", name="Show it").click()
    card = visit.page.locator("#what-if")
    expect(card).to_be_in_viewport()
    expect(card).to_contain_text("Excluded:")
    expect(visit.page).to_have_url(re.compile("whatif=nominal.*set=obstacles.0.position.x:"))


@pytest.mark.nightly  # by day the click in the scatter, which simulates it in the same way
def test_a_click_on_a_line_of_the_parallel_axes_simulates_it(visit: Visit, lost: Locator) -> None:
    """On an axis and between two; next to all lines a click clears the range of the axis."""
    lines = lost.get_by_role("group", name=re.compile("^Parallel"))
    axis = lines.locator("[data-hit]").nth(1)
    box = axis.bounding_box()
    assert box is not None
    inside = 8 / box["height"]  # the axis ends so far from the ends of its area
    share = inside + (1 - FLYING[9][0]) * (1 - 2 * inside)
    answer = simulated(visit, lambda: press(visit, axis, (0.5, share)))
    assert answer["parameters"]["obstacles.0.position.x"] == pytest.approx(0.1 + 4 * FLYING[9][0], abs=1e-12)
    expect(lost.get_by_role("status", name="Simulated again")).to_contain_text("identical to the stored value")
    drag(visit, axis, (0.5, 0.02), (0.5, 0.4))
    expect(kept(lost)).not_to_have_text(re.compile("^21 of 21"))
    press(visit, axis, (0.5, 0.9))
    expect(kept(lost)).to_have_text(re.compile("^21 of 21"))
    between = lines.locator("[data-between]")
    before = visit.page.url
    simulated(visit, lambda: press_a_line(visit, lines, between, lost))
    expect(visit.page).not_to_have_url(before)


def press_a_line(visit: Visit, lines: Locator, between: Locator, card: Locator) -> None:
    """Click the first line that the pointer meets between the second and the third axis."""
    area, left, right = between.bounding_box(), *(lines.locator("[data-hit]").nth(k).bounding_box() for k in (1, 2))
    assert area is not None
    assert left is not None
    assert right is not None
    x = (left["x"] + right["x"] + right["width"]) / 2
    for step in range(20, 90):
        visit.page.mouse.move(x, area["y"] + area["height"] * step / 100)
        if card.get_by_text("Pointed at").count():
            visit.page.mouse.down()
            visit.page.mouse.up()
            return
    raise AssertionError("there is no line between the axes")


def test_an_evaluation_is_chosen_and_simulated_by_keys(visit: Visit, lost: Locator) -> None:
    lost.get_by_role("button", name="Higher value").press("Enter")
    expect(lost).to_contain_text(re.compile(r"Pointed at: \w+, evaluation"))
    statement = lost.get_by_text(re.compile(r"^Pointed at")).inner_text()
    answer = simulated(visit, lambda: lost.get_by_role("button", name="Simulate").press("Enter"))
    assert answer["status"] == "ok"
    expect(lost.get_by_role("status", name="Simulated again")).to_contain_text("identical to the stored value")
    expect(lost).to_contain_text(statement.replace("Pointed at", "Simulated"))


def test_an_evaluation_of_an_active_run_is_simulated_in_the_window_of_its_flight(visit: Visit) -> None:
    """Last here: the window has no card of the parameter space."""
    visit.go("/runs/R-0003")
    card = visit.page.locator("#space")
    card.scroll_into_view_if_needed()
    expect(kept(card)).to_have_text(re.compile("^100 of 100 evaluations selected"))
    card.get_by_role("button", name="Simulate").click()
    expect(visit.page).to_have_url(re.compile("/runs/R-0003/flight.*whatif=nominal.*set=vehicle"))
    shown = visit.page.locator("#what-if")
    expect(shown.get_by_test_id("what-if-cost")).to_have_text(re.compile(r"^\d\.\d+$"), timeout=120_000)
