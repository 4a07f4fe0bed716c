"""The page of a run that evaluates a simulator: no mention of flights, no errors, in 3D only what it declares."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.browser import Visit, visiting
from tests.faults.processes import until
from tests.faults.serving import serving
from tests.simulators import dropped, package

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]


def test_launched_again_from_the_form_and_compared(tmp_path: Path, browser: Browser) -> None:
    folder = package.install(tmp_path / "package")
    with (
        serving(tmp_path, PYTHONPATH=package.path(folder)) as service,
        visiting(browser, service.link().partition("/login")[0]) as visit,
    ):
        page = visit.page
        page.goto(service.link())
        body = {"campaign": package.campaign(), "name": "Basins"}
        given = page.request.post(f"{visit.address}/api/v1/runs", data=body, headers={"Origin": visit.address})
        assert given.status == 201, given.text()
        visit.go("/launch?from=R-0001")
        expect(page.get_by_role("combobox", name="Simulator", exact=True)).to_have_value("Two basins")
        expect(page.get_by_role("combobox", name="Criterion, result")).to_have_value("Separation")
        page.get_by_label("Criterion, threshold").fill("2")
        page.get_by_label("Two basins, Offset along the track", exact=True).fill("0.4")
        page.get_by_role("button", name="Start run").click()
        expect(page).to_have_url(re.compile("R-0002"))
        expect(page.get_by_test_id("verdict")).to_have_text(re.compile("Cleared"), timeout=40_000)
        asked = page.request.get(f"{visit.address}/api/v1/runs/R-0002").json()["campaign"]
        assert asked["simulator"] == {"name": "two_basins", "parameters": {"x": 0.4}}
        assert asked["criterion"]["threshold"] == 2.0
        visit.go("/compare?runs=R-0001,R-0002")
        expect(page.get_by_text("From violated to cleared")).to_be_visible()
        expect(page.get_by_text("Simulator digest")).to_be_visible()
        expect(page.locator("#convergence canvas").first).to_be_visible()
        empty = "cards => cards.filter((card) => !card.querySelector('table, canvas, svg.ch')).map((card) => card.id)"
        assert page.locator("main .grid .card").evaluate_all(empty) == []
        visit.shot("simulator-compared")
        visit.go("/help/components")
        listed = page.locator("#simulator-two_basins")
        expect(listed).to_contain_text("Results: 2")
        expect(page.get_by_role("link", name="Two basins")).to_have_attribute(
            "href", re.compile("#simulator-two_basins$")
        )
        visit.go("/runs/R-0002/flight")
        expect(page.get_by_role("heading", name="There is no 3D view")).to_be_visible()
        proposal_is_used(visit)


def proposal_is_used(visit: Visit) -> None:
    """The launch page proposes searches from what the newest run measured, and the form takes them."""
    page = visit.page
    visit.go("/launch?from=R-0001")
    card = page.locator("#section-proposal")
    expect(card).to_contain_text(re.compile(r"One evaluation took .* \(R-0002, 15 evaluations\)\."))
    expect(card).to_contain_text("In 60 min on 1 slot: about")
    time, use = card.get_by_label("Time for all searches"), card.get_by_role("button", name="Use the proposal")
    time.fill("soon")
    expect(card).to_contain_text("Give the time as a number above 0")
    expect(use).to_be_disabled()
    time.fill("0.5")
    expect(card).to_contain_text("In 30 s on 1 slot: about")
    use.click()
    expect(card).to_contain_text("The campaign states these searches.")
    expect(use).to_be_disabled()
    expect(page.get_by_label("CMA-ES, evaluations at most", exact=True)).to_have_value("5000")
    expect(page.get_by_label("Run Genetic algorithm")).not_to_be_checked()
    visit.shot("simulator-proposal")


def test_a_run_without_a_trace(tmp_path: Path, browser: Browser) -> None:
    folder = package.install(tmp_path / "package")
    with (
        serving(tmp_path, PYTHONPATH=package.path(folder)) as service,
        visiting(browser, service.link().partition("/login")[0]) as visit,
    ):
        page = visit.page
        page.goto(service.link())
        body = {"campaign": package.campaign(), "name": "Basins"}
        given = page.request.post(f"{visit.address}/api/v1/runs", data=body, headers={"Origin": visit.address})
        assert given.status == 201, given.text()
        visit.go("/runs/R-0001")
        expect(page.get_by_test_id("verdict")).to_have_text(re.compile("Violated"), timeout=40_000)
        page.reload()
        expect(page.get_by_text("This system provides no trace")).to_be_visible()
        expect(page.get_by_text("two_basins").first).to_be_visible()
        expect(page.get_by_role("columnheader", name="Integration")).to_have_count(0)
        expect(page.locator("iframe")).to_have_count(0)
        visit.shot("simulator")


def test_a_declared_scene_is_drawn_and_another_case_evaluated(tmp_path: Path, browser: Browser) -> None:
    folder = dropped.install(tmp_path / "simulators", scene=True)
    with (
        serving(tmp_path, CLEARANCE_SIMULATORS=str(folder)) as service,
        visiting(browser, service.link().partition("/login")[0]) as visit,
    ):
        page = visit.page
        page.goto(service.link())
        body = {"campaign": dropped.campaign(), "name": "Drop"}
        given = page.request.post(f"{visit.address}/api/v1/runs", data=body, headers={"Origin": visit.address})
        assert given.status == 201, given.text()
        run = f"{visit.address}/api/v1/runs/R-0001"
        until(lambda: page.request.get(run).json()["state"] == "done", "R-0001 is over", 90)
        evaluations = page.request.get(run).json()["evaluations"]
        visit.go("/runs/R-0001")
        view = page.locator("#flight iframe")
        view.scroll_into_view_if_needed()
        expect(view).to_have_attribute("src", re.compile("/view/R-0001/"))
        page.get_by_role("button", name="Open the panel").click()
        panel = page.frame_locator("#flight iframe").locator("body")
        for word in ("Nominal", "Worst", "margin", "over ground"):
            expect(panel).to_contain_text(word)
        expect(panel).to_contain_text("Space")
        expect(panel).not_to_contain_text("Field")
        expect(page.get_by_role("button", name="Recording")).to_be_visible()
        expect(page.get_by_text("The 3D view shows what its trace declares, z up")).to_be_visible()
        expect(page.get_by_role("button", name="Closest approach")).to_have_count(0)
        assert not re.search(r"\bflights?\b", page.locator("main").inner_text(), re.IGNORECASE)
        page.get_by_role("button", name="What-if").click()
        card = page.locator("#what-if")
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
        visit.go("/runs/R-0001/flight")
        expect(page.locator("#flight iframe")).to_have_attribute("src", re.compile("/view/R-0001/"))
