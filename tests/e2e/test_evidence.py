"""From a finished run to evidence: files, the report, figures, a sign-off, and the comparison of two runs.

The runs are written as a worker writes them, so that nothing is flown here.
"""

from __future__ import annotations

import csv
import json
import math
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urljoin, urlsplit

import httpx
import pytest
import sqlalchemy as sa
from PIL import Image
from playwright.sync_api import Browser, Download, Page, Route, expect

from backend.db.purge import purge
from backend.db.tables import CatalogueDocument
from backend.signoffs.present import changed_campaign
from campaigns.catalogue import UnusableEntry
from tests.e2e.browser import Visit, space_of, visiting
from tests.e2e.looking import looks
from tests.e2e.stored import served
from tests.given.at_night import nightly_but
from tests.given.code_versions import edited
from tests.given.reported_runs import finish_fully
from tests.given.service import Service, until
from tests.given.small_catalogue import CATALOGUE, campaign

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]
DRAWS = False


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with two finished runs of two criteria that differ in the mass."""
    with served(tmp_path_factory.mktemp("evidence")) as service:
        with service.signed_in() as client:
            for mass, verdict in ((5.0, "cleared"), (5.5, "inconclusive")):
                submit(client, mass)
                finish_fully(service, verdict, criteria=2)
        yield service


def submit(client: httpx.Client, mass: float) -> None:
    document: dict[str, Any] = campaign(objectives=[{"component": "goal_miss"}])
    document["scenario"]["vehicle"]["parameters"]["m"] = mass
    assert client.post("/api/v1/runs", json={"campaign": document, "name": f"Mass {mass:g}"}).status_code == 201


@pytest.fixture(scope="module")
def visit(finished: Service, browser: Browser) -> Iterator[Visit]:
    with visiting(browser, finished.url) as visit:
        visit.sign_in(finished.login_code())
        yield visit


@pytest.fixture
def page(visit: Visit) -> Page:
    """The page of the first run, as the test before has left it or fresh."""
    return visit.stay("/runs/R-0001")


def saved(page: Page, entry: str) -> Download:
    """A file of the Export menu."""
    page.get_by_role("button", name="Export").click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name=re.compile(f"^{entry}")).click()
    page.keyboard.press("Escape")
    return download.value


@pytest.mark.nightly
def test_nothing_is_asked_for_twice(visit: Visit) -> None:
    visit.page.goto("about:blank")  # pending requests of the previous page are not counted
    asked: list[str] = []
    visit.page.on("request", lambda request: asked.append(request.url))
    visit.go("/runs/R-0001")
    for chart in ("^Separation", "^Convergence"):
        drawn = visit.page.get_by_role("img", name=re.compile(chart))
        drawn.scroll_into_view_if_needed()
        expect(drawn.locator("canvas")).to_be_visible()
    # /health is asked again, on purpose, where another answer takes long.
    sent = [url for url in asked if "/api/v1/" in url and "/views/" not in url and "/health" not in url]
    together = [path for url in sent for path in parse_qs(urlsplit(url).query).get("path", [])]
    answers = [urljoin(visit.address, f"/api/v1{path}") for path in together] + [u for u in sent if "/batch" not in u]
    assert len(together) > 8
    assert sorted(set(answers)) == sorted(answers), "what came together is not asked for alone"


def test_a_card_is_laid_out_when_it_comes_near_and_cuts_nothing_off_when_it_is_used(visit: Visit) -> None:
    """What may be skipped has paint containment, also on the screen: it would clip the tips of its charts."""
    visit.stay("/runs/R-0001")
    for section, use in (("#separation", "hover"), ("#provenance", "focus")):
        card = visit.page.locator(section)
        expect(card).to_have_css("content-visibility", "auto")
        visit.near(section)
        place = card.locator(".u-over" if use == "hover" else "button, a, summary").first
        getattr(place, use)()
        expect(card).to_have_css("content-visibility", "visible")


def test_without_3d_graphics_the_page_states_it_and_has_everything_else(page: Page) -> None:
    expect(page.locator("#flight")).to_contain_text("this browser has no 3D graphics (WebGL 2)")
    expect(page.locator("iframe")).to_have_count(0)
    separation = page.get_by_role("img", name=re.compile("^Separation"))
    separation.scroll_into_view_if_needed()
    expect(separation.locator("canvas")).to_be_visible()


def test_a_run_is_taken_away_as_files(page: Page) -> None:
    download = saved(page, "Evaluations, CSV")
    assert download.suggested_filename == "R-0001-mass-5-evaluations.csv"
    with Path(download.path()).open(newline="") as file:
        assert len(list(csv.reader(file))) == 1001
    assert json.loads(saved(page, "Everything, JSON").path().read_text())["run"]["id"] == "R-0001"
    assert saved(page, "Flights, MAT-file").path().read_bytes().startswith(b"MATLAB 5.0 MAT-file")


def test_figures_are_saved_as_pictures(page: Page) -> None:
    for card, kind in (("separation", "PNG"), ("sample", "PNG"), ("sample", "SVG")):
        page.locator(f"#{card}").get_by_role("button", name="Save figure").click()
        with page.expect_download() as download:
            page.get_by_role("menuitem", name=kind).click()
        file = download.value.path()
        assert download.value.suggested_filename.endswith(kind.lower())
        if kind == "PNG":
            picture = Image.open(file)
            assert picture.width > 600
            assert len(picture.convert("RGB").getcolors(1 << 24) or []) > 50
        else:
            drawn = ElementTree.parse(file).getroot()
            assert len(list(drawn.iter("{http://www.w3.org/2000/svg}text"))) > 5


def test_the_charts_over_time_share_their_crosshair(page: Page) -> None:
    motion, separation = page.locator("#motion"), page.locator("#separation")
    for name in ("v over time", "force over time"):
        expect(motion.get_by_role("img", name=re.compile(name))).to_be_visible()
    expect(separation.locator("[data-float=tip]")).to_have_count(0)
    separation.get_by_role("img").first.hover()
    expect(motion.locator("[data-readout]")).to_have_count(2)
    time = float(separation.locator("[data-float=tip] .b").inner_text().removesuffix(" s"))
    speed = f"{0.4 + 0.05 * math.sin(time):.3f}"  # as `flight` has it
    expect(motion.locator("[data-readout]").first).to_have_text(speed * 2)
    separation.get_by_role("button", name="Whole flight").click()
    expect(page).to_have_url(re.compile("time=all"))
    with page.expect_download() as download:
        motion.get_by_role("button", name="Download CSV").click()
    assert download.value.path().read_text().startswith('"time since start, s","v nominal, m/s","v worst, m/s"')


def test_what_is_chosen_is_seen_in_every_card(page: Page) -> None:
    sensitivity, findings = page.locator("#sensitivity"), page.locator("#findings")
    findings.scroll_into_view_if_needed()
    expect(findings.get_by_role("img", name=re.compile("seen from above"))).to_have_count(3)
    expect(sensitivity.get_by_role("button", name="Others at worst")).to_be_visible()
    findings.locator("[data-finding=F2]").get_by_role("button", name="F2").click()
    expect(page).to_have_url(re.compile("finding=F2"))
    expect(sensitivity.get_by_role("button", name=re.compile("Others at"))).to_have_count(1)
    expect(page.get_by_role("heading", name="Nominal against F2")).to_be_visible()
    findings.locator("[data-finding=F1]").get_by_role("button", name="F1").click()


def test_every_criterion_is_shown(page: Page) -> None:
    space = space_of(page)
    row = page.get_by_role("row", name=re.compile("Goal miss"))
    expect(row).to_contain_text(re.compile("0.600.*0.700.*more is worse"))
    expect(page.locator("[data-finding=F1]")).to_contain_text("0.7000")
    space.get_by_role("group", name="Colours by").get_by_role("button", name="Goal miss").click()
    expect(space.get_by_role("img", name=re.compile("^Colour: d_goal from 1.01 to 2 m"))).to_be_visible()
    expect(space.get_by_role("group", name=re.compile("^Parallel .* d_min, d_goal, m, J"))).to_be_visible()
    expect(page).to_have_url(re.compile("by=goal_miss"))


def test_the_report_is_read_and_printed(page: Page) -> None:
    page.get_by_role("button", name="Export").click()
    with page.context.expect_page() as opened:
        page.get_by_role("menuitem", name="Safety-case report, HTML").click()
    report = opened.value
    report.wait_for_load_state()
    wrong: list[str] = []
    report.on("console", lambda message: wrong.append(message.text))
    report.reload()
    expect(report.get_by_role("heading", name="Mass 5", exact=True)).to_be_visible()
    expect(report.get_by_text("No sign-off is recorded")).to_be_visible()
    until(lambda: report.evaluate("document.fonts.check('12px \"Inter Variable\"')"))
    assert wrong == []
    report.close()
    page.keyboard.press("Escape")
    printed = saved(page, "Safety-case report, PDF")
    assert printed.path().read_bytes().startswith(b"%PDF-")


def test_later_changes_of_the_installation_are_shown(finished: Service, page: Page) -> None:
    card = page.locator("#components")
    expect(card).to_contain_text("The installed components are the same.")
    document = CATALOGUE.model_dump(mode="json")
    document["components"][0]["parameters"][1]["default"] = 0.2
    with finished.engine.begin() as writer:
        writer.execute(sa.update(CatalogueDocument).values(document=edited(document)))
    page.reload()
    expect(card).to_contain_text(re.compile("simulated this run, [0-9a-f]{12}"))
    with finished.signed_in() as client:
        changes = client.get("/api/v1/runs/R-0001/components").json()["changes"]
    assert len(changes) == 1
    expect(card.get_by_role("listitem")).to_have_text(changes)
    card.get_by_role("button", name="Show").click()
    card.get_by_text("Vehicle: unicycle").click()
    expect(card.get_by_role("row", name=re.compile("^J"))).to_contain_text("0.05")


def test_what_cannot_be_used_is_reported_where_components_are_chosen(finished: Service, visit: Visit) -> None:
    unusable = [
        UnusableEntry(file="components/broken.py", line=1, name="broken", text="there is no `component = ...` in it"),
        UnusableEntry(file="", line=None, name="far", text="the package far: it cannot be loaded"),
    ]
    document = CATALOGUE.model_copy(update={"unusable": unusable}).model_dump(mode="json")
    with finished.engine.begin() as writer:
        writer.execute(sa.update(CatalogueDocument).values(document=edited(document)))
    for path in ("/launch", "/help/components"):
        visit.move(path)
        statement = visit.page.get_by_test_id("skipped")
        expect(statement.get_by_role("listitem")).to_have_text([str(entry) for entry in unusable])


def test_results_are_signed_off_and_that_is_withdrawn(visit: Visit, page: Page) -> None:
    page.reload()
    card = page.locator("#signoff")
    expect(card).to_contain_text("These results have not been signed off yet")
    card.get_by_role("button", name="Sign off").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("textbox", name="Name").fill("Grace Hopper")
    expect(dialog).to_contain_text("You launched R-0001, and the sign-off states that.")
    role = dialog.get_by_role("combobox", name="Title")
    expect(role).to_have_value("")  # no independent review by who launched it
    role.fill("Designer")
    dialog.get_by_role("textbox", name="Comment").fill("Bounds agree with the hazard log.")
    dialog.get_by_role("button", name="Sign off").click()
    row = card.get_by_role("row", name=re.compile("Grace Hopper"))
    expect(row).to_contain_text("Suspect")  # R-0002 has another campaign of that name, and the catalogue other code
    expect(row).to_contain_text(changed_campaign(2)[1:])  # its first letter is large
    visit.shot("signoff-suspect-1440-light")
    row.get_by_role("button", name="Withdraw").click()
    page.get_by_role("textbox", name="Reason").fill("Signed too early.")
    page.get_by_role("dialog").get_by_role("button", name="Withdraw").click()
    expect(row).to_contain_text(re.compile(r"Withdrawn\S+ .* Signed too early\."))
    visit.shot("signoff-1440-light")


def test_two_runs_are_compared(visit: Visit) -> None:
    page = visit.page
    visit.move("/compare?runs=R-0001,R-0002")
    expect(page.get_by_test_id("change")).to_have_text("From cleared to inconclusive")
    settings = page.locator("[data-setting]")
    differing = ["vehicle.m", "uncertain.vehicle.m.low", "uncertain.vehicle.m.high"]
    expect(settings).to_have_count(len(differing))
    assert settings.evaluate_all("rows => rows.map((row) => row.dataset.setting)") == differing
    expect(page.locator("[data-case='F1 F1']")).to_contain_text("+0.8000")
    expect(page.locator("[data-row=worst]")).to_contain_text("0.000")
    for name in ("^Separation over time", "^Convergence", "^Trajectories"):
        expect(page.get_by_role("img", name=re.compile(name))).to_be_visible()
    looks(visit, "compare")
    page.get_by_role("button", name="All", exact=True).click()
    expect(page).to_have_url(re.compile("all=true"))
    expect(settings.nth(20)).to_be_attached()


REFUSED = {"title": "Unprocessable Entity", "status": 422, "detail": "The disk is full."}
SPANS = {
    "/runs": ("The disk is full.", "Mass 5.5"),
    "/runs/R-0001": ("The disk is full.", "stayed above 0.5 m in all"),
    "/compare?runs=R-0001,R-0002": (
        "R-0001, R-0002 could not be loaded and are not compared.",
        "From cleared to inconclusive",
    ),
    "/trends": ("The disk is full.", "By name, those with the most runs first"),
    "/reports": ("The disk is full.", "One for every listed run"),
    "/sweeps": ("The disk is full.", "There are no sweeps yet."),
    "/help/components": ("The disk is full.", "The components of scenarios in this installation"),
    "/launch": ("The disk is full.", "Unicycle, static obstacle"),
    "/access/users": ("The disk is full.", "Names stay in the records"),
}
"""Pages, what they say if nothing can be loaded, and what they show once it is."""


BY_DAY = ("/runs/R-0001", "/compare?runs=R-0001,R-0002")
"""A run, and the page with a sentence of its own; the others are tested nightly."""


@pytest.mark.parametrize("path", nightly_but(BY_DAY, SPANS))
def test_what_cannot_be_loaded_is_reported_and_loaded_again(visit: Visit, path: str) -> None:
    """The page itself, its session and its events are there."""
    page = visit.page
    statement, shown = SPANS[path]
    page.route(re.compile(r"/api/v1/(?!session|events|health|workers)"), refuse)
    visit.go(path)
    trouble = page.locator("main [role=alert]").filter(has_text=statement)
    expect(trouble).to_be_visible()
    page.unroute(re.compile(r"/api/v1/(?!session|events|health|workers)"))
    page.get_by_role("button", name="Try again").first.click()
    expect(page.get_by_role("main").get_by_text(shown).first).to_be_visible()
    expect(page.get_by_role("main").get_by_role("alert").filter(has_text="could not be loaded")).to_have_count(0)
    expect(trouble).to_have_count(0)
    expect(page.get_by_role("heading", level=1).first).to_be_visible()
    visit.wrong[:] = [entry for entry in visit.wrong if "422" not in entry]  # the browser reports them all


@pytest.mark.nightly  # by day the whole comparison, above
def test_a_part_of_a_comparison_that_cannot_be_loaded_is_reported(visit: Visit) -> None:
    page = visit.page
    part = re.compile(r"/api/v1/runs/R-0002/findings")
    page.route(part, refuse)
    visit.go("/compare?runs=R-0001,R-0002")
    trouble = page.get_by_role("alert", name="What could not be loaded")
    expect(trouble).to_contain_text("Some results could not be loaded and are missing below: The disk is full.")
    page.unroute(part)
    trouble.get_by_role("button", name="Try again").click()
    expect(trouble).to_have_count(0)
    expect(page.locator("[data-case='F1 F1']")).to_be_visible()
    visit.wrong[:] = [entry for entry in visit.wrong if "422" not in entry]


def refuse(route: Route) -> None:
    """As the service does what it cannot do."""
    route.fulfill(status=422, json=REFUSED, content_type="application/problem+json")


def test_runs_to_compare_are_chosen_on_the_page(visit: Visit) -> None:
    page = visit.page
    visit.go("/compare?runs=R-0001,R-0002")
    page.get_by_role("button", name="Take R-0001 out").click()
    expect(page).to_have_url(re.compile("runs=R-0002"))
    expect(page.get_by_text("Choose 2 to 4 runs here")).to_be_visible()
    page.get_by_role("combobox", name="Add a run to compare").fill("mass 5")
    page.get_by_role("option", name=re.compile("R-0001")).click()
    expect(page).to_have_url(re.compile("runs=R-0001(,|%2C)R-0002"))  # the older run first
    expect(page.get_by_test_id("change")).to_be_visible()


@pytest.mark.nightly
def test_a_run_is_removed_and_restored(visit: Visit) -> None:
    page = visit.page
    visit.move("/runs/R-0001")
    page.get_by_role("button", name="Remove").click()
    page.get_by_role("textbox", name="Reason").fill("The bounds were wrong.")
    page.get_by_role("dialog").get_by_role("button", name="Remove run").click()
    note = page.get_by_text(re.compile("Removed from the lists by local, .*: The bounds were wrong."))
    expect(note).to_be_visible()
    for name in ("Remove", "Sign off", "Write", "Change name and tags"):
        expect(page.get_by_role("button", name=name, exact=True)).to_have_count(0)
    visit.move("/runs")
    expect(page.locator("tr[data-run]")).to_have_count(1)
    page.get_by_role("checkbox", name="Select R-0002").check()
    page.get_by_role("button", name="Remove 1 run").click()
    page.get_by_role("textbox", name="Reason").fill("A trial.")
    page.get_by_role("dialog").get_by_role("button", name="Remove run").click()
    expect(page.get_by_role("heading", name="Every run is removed")).to_be_visible()
    page.get_by_role("button", name="Show removed runs").click()
    expect(page).to_have_url(re.compile("removed=true"))
    expect(page.locator("tr[data-run=R-0002]")).to_contain_text(re.compile("A trial.*by local"))
    page.reload()
    page.get_by_role("checkbox", name="Select all loaded runs").check()
    page.get_by_role("button", name="Restore 2 runs").click()
    expect(page.get_by_role("heading", name="No run matches")).to_be_visible()
    page.get_by_role("button", name="Clear search and filters").click()
    expect(page.locator("tr[data-run]")).to_have_count(2)


@pytest.mark.nightly  # by day a removed one, and tests/api/runs/test_removal.py
def test_a_purged_run_explains_what_was_removed(finished: Service, visit: Visit) -> None:
    page = visit.page
    visit.go("/runs/R-0001")
    page.get_by_role("button", name="Remove").click()
    page.get_by_role("textbox", name="Reason").fill("Versions again as R-0002.")
    page.get_by_role("textbox", name="Reason").press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Restore")).to_be_visible()
    assert purge(finished.engine, 1, 0.0, "root")
    visit.go("/runs/R-0001")
    expect(page.get_by_role("heading", name="R-0001 was purged")).to_be_visible()
    gone = page.request.get(f"{visit.address}/api/v1/runs/R-0001").json()["detail"]
    expect(page.get_by_role("alert")).to_contain_text(gone.partition(", and ")[0])
    page.locator("#history").get_by_role("button", name="Show").click()
    expect(page.locator("#history tbody tr").first).to_contain_text("Permanently deleted its results")
    visit.shot("purged-1440-light")
    visit.wrong = [wrong for wrong in visit.wrong if "410" not in wrong]  # the browser's own note of the answer
