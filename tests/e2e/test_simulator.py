"""The page of a run that evaluates a simulator: no mention of flights, no errors, in 3D only what it declares."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.browser import Visit, draws, space_of, undrawn, visiting
from tests.e2e.flown import BASINS, CLEARED, DRAWN, Flown, asked
from tests.e2e.looking import api
from tests.faults.processes import until
from tests.given.service import Service
from tests.simulators import dropped

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(300),
    pytest.mark.nightly,
]  # by day tests/api/runs


@pytest.fixture(scope="module")
def visit(stored: Service, browser: Browser) -> Iterator[Visit]:
    with visiting(browser, stored.url, views=False) as visit:
        visit.sign_in(stored.login_code())
        yield visit


def test_the_launch_page_proposes_searches(visit: Visit) -> None:
    """From what the newest run measured; and the form takes them."""
    page = visit.page
    visit.go(f"/launch?from={BASINS}")
    card = page.locator("#section-proposal")
    expect(card).to_contain_text(re.compile(rf"One evaluation took .* \({CLEARED}, 15 evaluations\)\."))
    expect(card).to_contain_text("In 60 min on 1 slot: about")
    time, use = card.get_by_label("Time for all searches"), card.get_by_role("button", name="Use the proposal")
    time.fill("soon")
    expect(card).to_contain_text("Give the time as a number above 0")
    expect(use).to_be_disabled()
    time.fill("0.5")
    expect(card).to_contain_text("In 30 s on 1 slot: about")
    time.fill("30")  # time for as many as are ever proposed, also on a busy machine
    expect(card).to_contain_text("In 30 min on 1 slot: about")
    use.click()
    expect(card).to_contain_text("The campaign states these searches.")
    expect(use).to_be_disabled()
    expect(page.get_by_label("Auto, evaluations at most", exact=True)).to_have_value("10000")
    expect(page.get_by_label("Run Genetic algorithm")).not_to_be_checked()
    visit.shot("simulator-proposal")


def test_it_is_launched_again_from_the_form(visit: Visit) -> None:
    page = visit.page
    visit.go(f"/launch?from={BASINS}")
    expect(page.get_by_role("combobox", name="Simulator", exact=True)).to_have_value("Two basins")
    expect(page.get_by_role("combobox", name="Criterion, result")).to_have_value("Separation")
    page.get_by_label("Criterion, threshold").fill("2")
    page.get_by_label("Two basins, Offset along the track", exact=True).fill("0.4")
    page.get_by_role("button", name="Start run").click()
    launched = f"R-{len(asked()) + 1:04}"
    expect(page).to_have_url(re.compile(launched))
    given = api(visit, f"/runs/{launched}")["campaign"]
    assert given["simulator"] == {"name": "two_basins", "parameters": {"x": 0.4}}
    assert given["criterion"]["threshold"] == 2.0


def test_two_thresholds_are_compared(visit: Visit) -> None:
    page = visit.page
    visit.move(f"/compare?runs={BASINS},{CLEARED}")
    expect(page.get_by_text("From violated to cleared")).to_be_visible()
    expect(page.get_by_role("row", name="basins 1.0")).to_be_visible()
    visit.near("#convergence")
    expect(page.locator("#convergence canvas").first).to_be_visible()
    filled = page.locator("table, canvas, svg[role=img]")
    expect(page.locator("main section:has(> div > h2)").filter(has_not=filled)).to_have_count(0)
    visit.shot("simulator-compared")


def test_the_help_lists_it(visit: Visit) -> None:
    page = visit.page
    visit.move("/help/components")
    expect(page.locator("#simulator-two_basins")).to_contain_text("Results: 2")
    expect(page.get_by_role("link", name="Two basins")).to_have_attribute("href", re.compile("#simulator-two_basins$"))


def test_a_run_without_a_trace(visit: Visit) -> None:
    page = visit.page
    visit.move(f"/runs/{CLEARED}")
    expect(page.get_by_test_id("verdict")).to_have_text(re.compile("Cleared"))
    visit.move(f"/runs/{BASINS}")
    expect(page.get_by_test_id("verdict")).to_have_text(re.compile("Violated"))
    expect(page.get_by_text("This simulator declares no trace")).to_be_visible()
    expect(page.get_by_text("two_basins").first).to_be_visible()
    expect(page.get_by_role("columnheader", name="Integration")).to_have_count(0)
    expect(page.locator("iframe")).to_have_count(0)
    visit.shot("simulator")
    visit.move(f"/runs/{BASINS}/flight")
    expect(page.get_by_role("heading", name="There is no 3D view")).to_be_visible()


@pytest.mark.skipif(dropped.compiler() is None, reason="no C compiler")
def test_a_declared_scene_is_drawn_and_another_case_evaluated(
    visit: Visit, flown: Flown, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(flown.simulators))  # for the process that evaluates the case
    page, run = visit.page, f"{visit.address}/api/v1/runs/{DRAWN}"
    evaluations = page.request.get(run).json()["evaluations"]
    visit.move(f"/runs/{DRAWN}")
    view = page.locator("#flight iframe")
    view.scroll_into_view_if_needed()
    expect(view).to_have_attribute("src", re.compile(f"/view/{DRAWN}/"))
    page.get_by_role("button", name="Open the panel").click()
    frame = page.frame_locator("#flight iframe")
    panel = frame.locator("body")
    for word in ("Nominal", "Worst", "margin", "over ground"):
        expect(panel).to_contain_text(word)
    expect(panel).not_to_contain_text("Field")
    expect(page.get_by_role("button", name="Recording")).to_be_visible()
    until(lambda: draws(frame), "something drawn")
    expect(page.get_by_text("The 3D view shows what its trace declares, z up")).to_be_visible()
    expect(page.get_by_role("button", name="Closest approach")).to_have_count(0)
    assert not re.search(r"\bflights?\b", page.locator("main").inner_text(), re.IGNORECASE)
    space, card = space_of(page), page.locator("#what-if")
    space.get_by_role("button", name="Use its values").click()
    expect(space.get_by_role("status", name="Evaluated again")).to_contain_text("which evaluates them on request")
    card.get_by_label("Begin at the parameters of").select_option("F1")
    expect(card.get_by_text("Not evaluated yet.")).to_be_visible()
    card.get_by_role("button", name="Evaluate").click()
    expect(card.get_by_text("Evaluated as the values change: an evaluation takes")).to_be_visible()
    worst = page.request.get(f"{run}/findings").json()[0]["cost"]
    expect(page.get_by_test_id("what-if-cost")).to_have_text(re.compile(rf"^{worst:.1f}".replace(".", r"\.")))
    card.get_by_label("Steady wind towards the mast, m/s, value").fill("0")
    expect(page.get_by_test_id("what-if-cost")).to_have_text(re.compile(r"^12\.0"))
    expect(page.locator("#motion").get_by_text("What-if")).to_be_visible()
    visit.shot("simulator-3d")
    assert page.request.get(run).json()["evaluations"] == evaluations, "a what-if is not stored"
    with undrawn(page):
        visit.move(f"/runs/{DRAWN}/flight")
        expect(page.locator("#flight iframe")).to_have_attribute("src", re.compile(f"/view/{DRAWN}/"))
