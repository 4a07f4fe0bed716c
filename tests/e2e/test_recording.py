"""The flight in a browser: a recording from disk, the linked page, and the run page with its 3D view."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from backend.scenes.base.palette import LIGHT, rgb
from tests.e2e.browser import draws, near, pixels, visiting
from tests.e2e.stored import served
from tests.given.reported_runs import finish_fully
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(300),
    pytest.mark.nightly,
]  # by day what is recorded: tests/api/scenes/test_recordings.py


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with one finished run."""
    with served(tmp_path_factory.mktemp("recorded")) as service:
        with service.signed_in() as client:
            assert client.post("/api/v1/runs", json={"campaign": campaign(), "name": "Recorded"}).status_code == 201
            finish_fully(service)
        yield service


def playing(page: Page, worst: str | None = None) -> Locator:
    """Wait until the play bar advances; if a colour is given, until the worst flight is drawn."""
    page.set_viewport_size({"width": 900, "height": 600})  # software draws every pixel
    expect(page.locator("canvas").first).to_be_visible()
    time = page.locator("input").first
    expect(time).to_be_visible()
    if worst is not None:
        # The centre: the corners contain the caption and viser's notice of software rendering, in similar colours.
        until(lambda: near(pixels(page.screenshot())[150:540, 310:540], rgb(worst), 40) > 60, 60)
    before = time.input_value()
    until(lambda: time.input_value() != before, 60)
    return time


@pytest.mark.parametrize("drawn", [False, pytest.param(True, marks=pytest.mark.nightly)])
def test_the_file_opens_from_disk_without_requests(
    recorded: Service, browser: Browser, tmp_path: Path, drawn: bool
) -> None:
    """Drawn at night; by day the view that tests/e2e/test_whole_way.py draws shows the flight."""
    file = tmp_path / "flight.html"
    with recorded.signed_in() as client:
        file.write_bytes(client.get("/api/v1/runs/R-0001/exports/flight-F1.html").content)
    with visiting(browser, "file://", views=drawn) as visit:
        visit.page.context.set_offline(True)
        visit.go(str(file))
        playing(visit.page, LIGHT.worst if drawn else None)
        until(lambda: drawn or draws(visit.page))
        expect(visit.page.locator("#caption")).to_contain_text("R-0001 · F1")
        assert visit.page.title() == "R-0001 F1: Recorded"
        visit.shot("recording-file", full=False)


@pytest.mark.nightly  # by day the file, and tests/api/scenes
def test_a_link_from_the_run_page_plays_without_a_viewer(recorded: Service, browser: Browser) -> None:
    with visiting(browser, recorded.url, views=False) as visit:
        visit.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        visit.sign_in(recorded.login_code())
        visit.go("/runs/R-0001")
        visit.page.get_by_role("button", name="Export").click()
        download = visit.page.get_by_role("menuitem", name="Download as one file")
        with visit.page.expect_download() as saved:
            download.click()
        assert saved.value.suggested_filename == "R-0001-recorded-flight-F1.html"
        visit.page.get_by_role("button", name="Export").click()
        visit.page.get_by_role("menuitem", name="Copy link to the recording").click()
        expect(visit.page.get_by_text("Copied")).to_be_visible()
        link = str(visit.page.evaluate("navigator.clipboard.readText()"))
        assert link == f"{recorded.url}/view/R-0001/F1/recorded/"
        visit.page.keyboard.press("Escape")
        expect(visit.page.get_by_role("button", name="Recording")).to_be_visible()
        visit.page.goto(f"{link}dark/")
        playing(visit.page)
        until(lambda: draws(visit.page))
        visit.shot("recording-page-dark", full=False)
        until(lambda: recorded.app.state.viewers.open == 0)


def dragged(page: Page) -> bool:
    """The picture was turned a little by the mouse."""
    frame = page.locator("#flight iframe")
    frame.scroll_into_view_if_needed()
    box = frame.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y + 20, steps=5)
    page.mouse.up()
    return True


REFUSED = re.compile(r"ERR_CONNECTION_REFUSED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET|status of 404")
"""Console messages of a browser while the service is unavailable."""


def sided(side: Locator) -> bool:
    """The camera is chosen by name, again where the last message of a movement that came before it has undone this."""
    if side.get_attribute("aria-pressed") != "true":
        side.click()
    return side.get_attribute("aria-pressed") == "true"


@pytest.mark.nightly
def test_page_and_view_agree_and_a_lost_view_is_restored(recorded: Service, browser: Browser) -> None:
    with visiting(browser, recorded.url, views=False) as visit:
        page = visit.page
        page.set_viewport_size({"width": 1280, "height": 700})
        visit.sign_in(recorded.login_code())
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        visit.go("/runs/R-0001?t=4&time=all")
        time = page.get_by_role("group", name="Time of the flight").get_by_role("slider", name="Time")
        flag = page.locator("#separation [data-float=flag]")
        visit.near("#separation")
        expect(flag).to_have_text("4.00 s")
        page.locator("tr[data-finding=F2]").click()
        expect(page).to_have_url(re.compile("finding=F2"))
        expect(page.get_by_role("heading", name="Nominal against F2")).to_be_visible()
        time.fill("7.5")
        expect(flag).to_have_text("7.50 s")
        expect(page).to_have_url(re.compile(r"t=7\.5\b"))
        cameras = page.get_by_role("group", name="Camera")
        cameras.get_by_role("button", name="Side").click()
        expect(page).to_have_url(re.compile("cam=side"))
        page.get_by_role("button", name="Shown").click()
        page.get_by_role("checkbox", name="Nominal flight").click()
        page.keyboard.press("Escape")
        key = str(page.locator("#flight iframe").get_attribute("src")).rpartition("/key/")[2].strip("/")
        (shown,) = recorded.app.state.viewers.steered.values()
        until(lambda: not shown.state().layers.nominal)
        until(lambda: shown.state().camera == "side")
        # What its visitor does in the view itself, the page has, too: the camera is moved, and moved back by name.
        side = cameras.get_by_role("button", name="Side")
        until(lambda: dragged(page) and side.get_attribute("aria-pressed") == "false", 60)
        assert shown.state().camera is None
        until(lambda: sided(side) and shown.state().camera == "side")
        before = shown.state()
        # All that the page has to know by then, it has heard.
        until(lambda: page.evaluate("true") and f"since={shown.revision}&" in asked[-1])
        recorded.stop()
        notice = page.locator("#flight [role=status]").last
        expect(notice).to_contain_text("No response from this address")
        again = Service(recorded.settings, recorded.port)
        again.start()
        try:
            expect(notice).to_contain_text("The 3D view was lost and has been restored.")
            (handle, opened), *others = again.app.state.viewers.steered.items()
            assert (handle.key, others) == (key, [])
            state = opened.state()
            assert (state.flight, state.time, state.camera) == ("F2", 7.5, "side")
            assert state.layers == before.layers
            assert not state.layers.nominal
            expect(time).to_have_value("7.5")
            expect(flag).to_have_text("7.50 s")
            expect(page).to_have_url(re.compile(r"finding=F2&t=7\.5&cam=side|t=7\.5.*finding=F2.*cam=side"))
            expect(notice).to_be_empty()
        finally:
            page.goto("about:blank")
            again.stop()
        visit.wrong[:] = [wrong for wrong in visit.wrong if not REFUSED.search(wrong)]
