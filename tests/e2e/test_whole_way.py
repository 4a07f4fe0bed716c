"""From the start of the service to an exported report, and from an edited campaign to a verdict and its flight.

The tests of this file are one story, in order: each begins where the one before it ended.
"""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, FrameLocator, Page, expect

from backend.db.engine import connect, default_url
from tests.audited import audited
from tests.e2e.browser import PATIENCE, Visit, draws, in_3d, near, pictured, pixels, undrawn, visiting
from tests.e2e.looking import api, looks
from tests.e2e.written import editor, write_over, written
from tests.faults.processes import until
from tests.faults.serving import Service

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(600)]

FIRST, WHOLE, LONG = (f"R-{i:04}" for i in (1, 2, 3))
"""The runs: of a new user, of the campaign that is edited here, and the one that is cancelled."""
LONGEST = 180.0
"""For a new user [s]."""
VERDICTS = "Cleared|Violated|Inconclusive"
VERMILLION = (222, 103, 20)
THIN = "\u202f"


@pytest.fixture(scope="module")
def signed_in(service: Service, browser: Browser) -> Iterator[Visit]:
    """A page of a browser that signed in with the login link; its 3D views are not drawn."""
    link = service.link()
    with visiting(browser, link.partition("/login")[0], views=False) as visit:
        visit.page.goto(link)
        yield visit


@pytest.fixture
def drawing(signed_in: Visit, browser: Browser) -> Iterator[Visit]:
    """The session in a browser that draws 3D views."""
    with visiting(browser, signed_in.address) as visit:
        if not pictured():  # drawing takes processor time for each of its pixels
            visit.page.set_viewport_size({"width": 800, "height": 600})
        visit.page.context.add_cookies(signed_in.page.context.cookies())  # type: ignore[arg-type]
        yield visit


def test_an_unauthenticated_client_sees_how_to_sign_in(service: Service, browser: Browser) -> None:
    with visiting(browser, service.address()) as stranger:
        stranger.go("/runs")
        expect(stranger.page.locator("body")).to_contain_text("clearance login-link")
        stranger.shot("sign-in", full=False)
        # The browser itself notes that the page was refused.
        assert [wrong for wrong in stranger.wrong if "401" not in wrong] == []
        stranger.wrong.clear()


def test_the_empty_list_explains_what_to_do_first(signed_in: Visit) -> None:
    page = signed_in.page
    expect(page).to_have_url(re.compile("/runs$"))
    expect(page.get_by_role("heading", name="No runs yet")).to_be_visible()
    looks(signed_in, "runs-empty")
    page.get_by_role("link", name="Choose a case study").click()
    expect(page.get_by_role("radio", name="Unicycle, static obstacle")).to_be_checked()


def test_a_new_user_has_a_report_within_three_minutes(service: Service, signed_in: Visit) -> None:
    """From the start of the service to the exported report by clicks alone; only the budgets are typed."""
    page = signed_in.page
    fields = page.get_by_label(re.compile("evaluations at most$"))
    expect(fields.first).to_be_visible()
    for field in fields.all():
        if field.is_enabled():
            field.fill("500")
    with undrawn(page):
        reported(service, page)


def reported(service: Service, page: Page) -> None:
    page.get_by_role("button", name="Start run").click()
    page.wait_for_url(f"**/runs/{FIRST}")
    # So small a run may be over before its page is open.
    expect(page.get_by_role("list", name="Stages").or_(page.get_by_test_id("verdict")).first).to_be_visible()
    expect(page.get_by_test_id("verdict")).to_have_text(re.compile(VERDICTS), timeout=1e3 * LONGEST)
    assert exported(page).startswith(b"%PDF-")
    assert time.monotonic() - service.began < LONGEST
    audited(connect(default_url(service.data)), run_id=1)


def exported(page: Page) -> bytes:
    """The report: opened from the run's page and read, then saved as PDF."""
    with page.context.expect_page() as opened:
        page.get_by_role("link", name="Safety-case report").click()
    report = opened.value
    expect(report.get_by_role("heading", name="Unicycle, static obstacle", exact=True)).to_be_visible()
    expect(report.get_by_text("No sign-off is recorded")).to_be_visible()
    report.close()
    page.get_by_role("button", name="Export").click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name=re.compile("^Safety-case report, PDF")).click()
    return Path(download.value.path()).read_bytes()


def test_a_wrong_bound_is_refused_next_to_its_field(signed_in: Visit) -> None:
    page = signed_in.page
    signed_in.move("/launch")
    low, start = page.get_by_label("Mass, low"), page.get_by_role("button", name="Start run")
    low.fill("-3")
    statement = page.locator("[data-problem='uncertain.vehicle.m.low']")
    expect(statement).to_contain_text("must be within")
    expect(low).to_have_attribute("aria-invalid", "true")
    expect(start).to_be_disabled()
    low.fill("4.2 kg")
    expect(statement).to_contain_text("Expected a number")
    signed_in.shot("launch-error-1440-light")
    page.locator("#problems").get_by_role("button", name="uncertain.vehicle.m.low").click()
    expect(low).to_be_focused()
    low.fill("4.2")
    expect(page.locator("[data-problem]")).to_have_count(0)
    expect(start).to_be_enabled()
    looks(signed_in, "launch")


def test_the_scenario_is_drawn_and_simulated_while_it_is_edited(signed_in: Visit) -> None:
    page = signed_in.page
    plan, statement = (
        page.get_by_role("img", name=re.compile("^Seen from above, Unicycle")),
        page.get_by_test_id("nominal-flight"),
    )
    expect(plan).to_be_visible()
    before = plan.inner_html()
    page.get_by_label("Obstacle 1, Centre, x").fill("3.5")
    until(lambda: plan.inner_html() != before, "the obstacle has moved", 10)
    page.get_by_label("Obstacle 1, Centre, x").fill("4")
    until(lambda: plan.inner_html() == before, "the obstacle is back", 10)
    page.get_by_role("button", name="Preview nominal case").press("Enter")
    expect(statement).to_contain_text("0.9436 m, clear by 0.4436 m", timeout=2 * PATIENCE)
    expect(page.get_by_test_id("closest")).to_be_visible()
    page.get_by_label("Criterion, threshold").fill("0.95")
    expect(statement).to_contain_text("violates 0.95 m by 0.0064 m")
    page.get_by_label("Criterion, threshold").fill("none")
    expect(statement).to_contain_text("after the problems are solved")
    expect(statement).to_contain_text("Of the campaign before the last edit")
    page.get_by_label("Criterion, threshold").fill("0.5")
    expect(statement).to_contain_text("clear by 0.4436 m")
    looks(signed_in, "launch-preview")
    page.get_by_role("button", name="Stop previewing every edit").click()


def test_further_criteria_and_faults_are_added_and_taken_out(signed_in: Visit) -> None:
    page = signed_in.page
    page.get_by_text("Further criteria").click()
    page.get_by_role("combobox", name="Add criterion").click()
    page.get_by_role("option", name="Time to goal").click()
    expect(page.get_by_role("combobox", name="Further criterion 1, component")).to_have_value("Time to goal")
    page.get_by_role("combobox", name="Add criterion").click()
    page.get_by_role("option", name="Time to goal").click()
    expect(page.locator("[data-problem='objectives.1.component']")).to_contain_text("already given")
    page.get_by_role("combobox", name="Add fault").click()
    page.get_by_role("option", name="Sensor noise").click()
    page.get_by_text("Noise realisations").click()
    page.get_by_label("Seeds of the realisations").fill("1, 2, x")
    expect(page.locator("[data-problem='scenario.realisations.seeds.2']")).to_be_visible()
    page.get_by_label("Seeds of the realisations").fill("0")
    for name in ("Further criterion 2", "Further criterion 1", "Fault 1"):
        page.get_by_role("button", name=f"Remove {name}").click()
    expect(page.locator("[data-problem]")).to_have_count(0)
    expect(page.get_by_role("combobox", name="Further criterion 1, component")).to_have_count(0)


def test_a_draft_is_stored_and_never_overwritten_unseen(signed_in: Visit) -> None:
    page, drafts = signed_in.page, f"{signed_in.address}/api/v1/drafts"
    page.get_by_label("Mass, low").fill("4.2 kg")
    page.get_by_role("link", name="Runs", exact=True).click()
    page.get_by_role("dialog", name="Unsaved changes").get_by_role("button", name="Stay").click()
    page.get_by_role("button", name="Save as draft").click()
    page.wait_for_url("**/launch?draft=D-0001")
    page.reload()
    expect(page.get_by_label("Mass, low")).to_have_value("4.2 kg")
    kept = api(signed_in, "/drafts/D-0001")
    theirs = {"name": "Theirs", "tags": [], "text": kept["text"].replace("4.2 kg", "4.1"), "version": kept["version"]}
    assert page.request.put(f"{drafts}/D-0001", data=theirs).ok
    page.get_by_label("Mass, low").fill("4.2")
    page.get_by_role("button", name="Save D-0001").click()
    signed_in.shot("launch-draft-overtaken-1440-light")
    page.get_by_role("button", name="Open theirs").click()
    expect(page.get_by_label("Name", exact=True)).to_have_value("Theirs")
    expect(page.get_by_label("Mass, low")).to_have_value("4.1")
    page.get_by_label("Mass, low").fill("4.2")
    page.get_by_role("button", name="Save D-0001").click()
    expect(page.get_by_test_id("kept")).to_have_text("All changes are saved in D-0001.")
    # The browser itself notes the save that was refused.
    assert [wrong for wrong in signed_in.wrong if "409" not in wrong] == []
    signed_in.wrong.clear()


def test_form_and_text_edit_the_same_campaign(signed_in: Visit) -> None:
    page = signed_in.page
    page.get_by_role("button", name="YAML", exact=True).click()
    expect(editor(page)).to_contain_text("low: 4.2")
    expect(page.get_by_text("Valid", exact=True)).to_be_visible()
    good = written(page)
    editor(page).focus()
    page.keyboard.press("Control+End")
    page.keyboard.type("# n, / and ? are text here")  # elsewhere they are keys of the page
    expect(editor(page)).to_contain_text("# n, / and ? are text here")
    write_over(page, good.replace("4.2", "[4.2"))
    expect(page.locator("[data-problem]").first).to_contain_text("not readable as YAML")
    write_over(page, good.replace("4.2", "4.3"))
    expect(page.get_by_text("Valid", exact=True)).to_be_visible()
    page.get_by_role("button", name="Form", exact=True).click()
    expect(page.get_by_label("Mass, low")).to_have_value("4.3")


def test_an_edit_in_the_form_changes_only_its_lines_of_the_text(signed_in: Visit) -> None:
    page = signed_in.page
    page.get_by_role("button", name="YAML", exact=True).click()
    first = written(page)
    ours = first.replace("name:", "# Ours.\nname:", 1).replace(
        "  horizon: 15.0", "  horizon:   15.0  # as flown in March"
    )
    assert ours.count("#") == first.count("#") + 2
    write_over(page, ours)
    expect(page.get_by_text("Valid", exact=True)).to_be_visible()
    looks(signed_in, "launch-yaml")
    page.get_by_role("button", name="Form", exact=True).click()
    page.get_by_label("Horizon").fill("15.5")
    page.get_by_label("Obstacle 1, Radius").fill("0.4")
    page.get_by_role("button", name="YAML", exact=True).click()
    edited = ours.replace("15.0  # as", "15.5  # as").replace("radius: 0.5", "radius: 0.4")
    assert written(page) == edited
    editor(page).focus()
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    until(lambda: written(page) == ours, "both edits of the form are taken back", 10)
    page.get_by_role("button", name="Redo").click()
    assert written(page) == ours.replace("15.0  # as", "15.5  # as")
    write_over(page, ours)
    expect(page.get_by_text("Valid", exact=True)).to_be_visible()


def test_a_run_is_watched_to_its_verdict(service: Service, signed_in: Visit) -> None:
    page = signed_in.page
    page.get_by_label("Name", exact=True).fill("The whole way")
    page.keyboard.press("Control+Enter")
    page.wait_for_url(f"**/runs/{WHOLE}")
    assert api(signed_in, "/drafts/D-0001")["run"] == WHOLE
    outcome = page.get_by_test_id("outcome")
    expect(outcome).to_have_text(re.compile("Queued|Running"))
    # As many before a worker has planned the run as after it.
    expect(page.get_by_role("list", name="Stages").get_by_role("listitem")).to_have_count(6)
    expect(page.get_by_role("img", name=re.compile("^Convergence"))).to_be_visible(timeout=2 * PATIENCE)
    signed_in.shot("run-live-1440-light")
    # The page is not reloaded: the event stream delivers the verdict.
    expect(outcome).to_have_text(re.compile(VERDICTS), timeout=2 * PATIENCE)
    run = api(signed_in, f"/runs/{WHOLE}")
    assert run["campaign"]["uncertain"]["vehicle.m"]["low"] == 4.3
    assert run["state"] == "done"
    expect(page.get_by_test_id("verdict")).to_have_text(run["verdict"].capitalize())
    expect(page.get_by_test_id("worst")).to_have_text(f"{run['worst_cost']:.4f}")
    expect(page.get_by_test_id("margin")).to_have_text(f"+{run['margin']:.4f}")
    expect(page.get_by_test_id("worst-cost")).to_have_text(f"{run['worst_cost']:.4f}")
    assert run["verdict"] == "cleared"
    audited(connect(default_url(service.data)), run_id=2)
    assert abs(run["worst_cost"] - 0.9417402) < 2e-6
    finding = api(signed_in, f"/runs/{WHOLE}/findings")[0]
    assert set(finding["at_bounds"].values()) == {"high"}
    expect(page.get_by_text("at high bound")).to_have_count(2)


def test_every_method_is_listed_and_drawn(signed_in: Visit) -> None:
    page = signed_in.page
    for stage in api(signed_in, f"/runs/{WHOLE}/stages"):
        if stage["kind"] == "search":
            row = page.locator(f"tr[data-method={stage['method']}]")
            expect(row).to_contain_text(f"{stage['evaluations']:,}".replace(",", THIN))
            row.scroll_into_view_if_needed()  # far from the window a card has no text that is shown
            shown = row.locator("td").nth(2).inner_text()
            assert abs(float(shown) - stage["best"]) <= 0.5001 * 10.0 ** -len(shown.partition(".")[2])
    for name in ("^Separation over time", "^d_min over Mass", "^Convergence", "^Histogram", "^Change of"):
        expect(page.get_by_role("img", name=re.compile(name))).to_be_visible()
    for heading in ("Validation", "Published values", "Ends of descents", "Provenance"):
        expect(page.get_by_role("heading", name=heading).first).to_be_visible()
    separation = page.locator("#separation")
    separation.get_by_role("button", name="Show data").click()
    expect(separation.get_by_role("region", name="Data of the chart").locator("tbody tr").nth(20)).to_be_visible()
    separation.get_by_role("button", name="Hide data").click()
    with page.expect_download() as download:
        separation.get_by_role("button", name="Download CSV").click()
    lines = download.value.path().read_text().splitlines()
    assert lines[0].startswith('"time since start, s"')
    assert len(lines) > 500


def flown(visit: Visit) -> FrameLocator:
    """The 3D view on the run's page, once something is drawn in it."""
    visit.page.locator("#flight").scroll_into_view_if_needed()
    in_3d(visit.page)
    frame = visit.page.frame_locator("#flight iframe")
    canvas = frame.locator("canvas").first
    expect(canvas).to_be_visible(timeout=2 * PATIENCE)

    def drawn() -> bool:
        picture = pixels(canvas.screenshot())
        return near(picture, VERMILLION, 45) > 60 and len(colours(picture)) > 50

    until(drawn, "the worst flight drawn in the 3D view", 90)
    return frame


def colours(picture: Any) -> set[tuple[int, ...]]:
    """The distinct colours of a picture."""
    return set(map(tuple, picture.reshape(-1, 3)[::7].tolist()))


def test_the_flight_is_seen_in_3d(drawing: Visit) -> None:
    drawing.go(f"/runs/{WHOLE}")
    drawing.page.locator("#flight").scroll_into_view_if_needed()
    expect(drawing.page.get_by_role("img", name="Worst seen from above at its closest approach")).to_be_visible()
    expect(drawing.page.locator("#flight iframe")).to_have_count(0)
    frame = flown(drawing)
    expect(frame.get_by_role("tab", name="Details")).to_be_visible()
    if pictured():
        looks(drawing, "run", flown)


def test_a_slider_simulates_the_case_again(signed_in: Visit) -> None:
    """Its numbers are on the page, the view draws the flight, and the address has it."""
    page = signed_in.page
    page.locator("#flight").scroll_into_view_if_needed()
    until(lambda: draws(page.frame_locator("#flight iframe")), "something drawn")
    page.get_by_role("button", name="What-if", exact=True).click()
    card = page.locator("#what-if")
    expect(page).to_have_url(re.compile("whatif=F1"))
    cost = card.get_by_test_id("what-if-cost")
    worst = page.get_by_test_id("worst-cost").inner_text()
    expect(cost).to_have_text(worst, timeout=PATIENCE)
    (run,) = re.findall(r"R-\d+", page.url)[:1]
    found = api(signed_in, f"/runs/{run}/findings")[0]["parameters"]
    card.get_by_role("combobox", name="Begin at the parameters of").select_option("nominal")
    expect(cost).to_have_text("0.9436")
    expect(card.get_by_test_id("what-if-margin")).to_have_text("+0.4436")
    slider = card.get_by_role("slider").first
    slider.focus()
    time = page.get_by_role("slider", name="Time").input_value()
    for _ in range(20):
        slider.press("ArrowRight")
    expect(card).to_contain_text("1 changed")
    expect(cost).not_to_have_text("0.9436")
    expect(cost).to_have_text(re.compile(r"^0\.94\d\d$"))
    assert page.get_by_role("slider", name="Time").input_value() == time, "the arrows moved the parameter alone"
    expect(page).to_have_url(re.compile(r"set=vehicle\.m:"))
    expect(page.locator("#separation")).to_contain_text("What-if")
    signed_in.shot("what-if-1440-light", full=False)
    slider.press("End")
    expect(card.get_by_role("textbox").first).to_have_value("6.000")
    field = card.get_by_role("textbox").first
    field.fill(repr(found["vehicle.m"]))
    field.press("Enter")
    other = card.get_by_role("textbox").nth(1)
    other.fill(repr(found["vehicle.J"]))
    other.press("Enter")
    expect(cost).to_have_text(worst)
    other.fill("7")
    expect(other).to_have_attribute("aria-invalid", "true")
    other.press("Escape")
    expect(page).to_have_url(re.compile(r"vehicle\.J:"))  # written when the values rest
    shared = page.url
    card.get_by_role("button", name="Back to nominal").click()
    expect(cost).to_have_text("0.9436")
    expect(page).not_to_have_url(re.compile("set="))
    with undrawn(page):
        page.goto(shared)
        expect(page.locator("#what-if").get_by_test_id("what-if-cost")).to_have_text(worst)
    looks(signed_in, "what-if", flown)
    page.get_by_role("button", name="Close the what-if").click()
    expect(page.locator("#what-if")).to_have_count(0)
    expect(page).not_to_have_url(re.compile("whatif"))


def test_the_list_shows_it_and_finds_it(signed_in: Visit) -> None:
    page = signed_in.page
    page.get_by_role("navigation", name="Main").get_by_role("link", name="Runs").click()
    row = page.locator(f"tr[data-run={WHOLE}]")
    expect(row).to_contain_text("Cleared")
    page.keyboard.press("/")
    page.keyboard.type("nothing of this name")
    expect(page.get_by_role("heading", name="No run matches")).to_be_visible()
    page.get_by_role("button", name="Clear search and filters").click()
    page.get_by_role("button", name=re.compile("^Cleared")).click()
    expect(page).to_have_url(re.compile("show=cleared"))
    expect(row).to_be_visible()
    page.keyboard.press("j")
    expect(row).to_have_attribute("aria-selected", "true")
    with undrawn(page):  # left while it may still load
        page.keyboard.press("Enter")
        expect(page).to_have_url(re.compile(f"/runs/{WHOLE}$"))
        expect(page.get_by_role("button", name="Open in 3D").or_(page.locator("#flight iframe"))).to_be_attached()


def test_a_long_run_is_cancelled(signed_in: Visit) -> None:
    page = signed_in.page
    page.get_by_role("link", name="Run again").click()
    expect(page.get_by_label("Mass, low")).to_have_value("4.3")
    page.get_by_role("button", name="YAML", exact=True).click()
    expect(editor(page)).to_contain_text("# Ours.")
    assert "horizon:   15.0  # as flown in March" in written(page)
    page.get_by_role("button", name="Form", exact=True).click()
    page.get_by_label("DIRECT, evaluations at most", exact=True).fill("9000000")
    page.get_by_role("button", name="Options of DIRECT", exact=True).click()
    page.get_by_label("Iterations").first.fill("1000000")
    page.get_by_label("Name", exact=True).fill("Too long")
    with undrawn(page):  # left while it may still load
        page.get_by_role("button", name="Start run").click()
        page.wait_for_url(f"**/runs/{LONG}")
        expect(page.get_by_test_id("outcome")).to_have_text("Running")
        expect(page.get_by_test_id("best")).to_have_text(re.compile(r"0\.94\d\d"))
        page.get_by_role("button", name="Cancel run").click()
        page.get_by_role("dialog").get_by_role("button", name="Cancel run").click()
        expect(page.get_by_test_id("outcome")).to_have_text("Cancelled")
        expect(page.get_by_test_id("verdict")).to_have_text("Cancelled: no verdict")
        assert api(signed_in, f"/runs/{LONG}")["verdict"] is None
        expect(page.get_by_role("heading", name="Methods")).to_be_visible()
        signed_in.shot("run-cancelled-1440-light")
        page.get_by_role("navigation", name="Main").get_by_role("link", name="Runs").click()
        expect(page.locator(f"tr[data-run={LONG}]")).to_contain_text("Cancelled")
        looks(signed_in, "runs")


def test_signing_out_ends_the_session(signed_in: Visit) -> None:
    page = signed_in.page
    page.get_by_role("button", name=re.compile("^Session of")).click()
    page.get_by_role("menuitem", name="Sign out").click()
    expect(page.get_by_role("heading", name="You are signed out")).to_be_visible()
    cookies = {c["name"]: c["value"] for c in page.context.cookies()}
    answer = httpx.get(f"{signed_in.address}/api/v1/runs", cookies=cookies, trust_env=False)
    assert answer.status_code == 401
