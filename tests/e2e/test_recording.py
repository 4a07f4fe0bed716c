"""A recording in a browser: the file from disk, with nothing asked of anybody, and the page that a link leads to.

Start reading at `recorded`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from backend.scenes.palette import LIGHT, rgb
from tests.api.catalogue import campaign
from tests.api.reported import finish_fully
from tests.api.server import Service, until
from tests.e2e.browser import SCREENSHOTS, near, pixels, visiting
from tests.e2e.stored import served

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with one finished run."""
    with served(tmp_path_factory.mktemp("recorded")) as service:
        with service.signed_in() as client:
            assert client.post("/api/v1/runs", json={"campaign": campaign(), "name": "Recorded"}).status_code == 201
            finish_fully(service)
        yield service


def playing(page: Page, worst: str | None = None) -> Locator:
    """The play bar, once the time runs, and the worst flight is drawn where its colour is given."""
    page.set_viewport_size({"width": 900, "height": 600})  # software draws every pixel
    expect(page.locator("canvas").first).to_be_visible()
    time = page.locator("input").first
    expect(time).to_be_visible()
    if worst is not None:
        # The middle: in the corners stand the caption and viser's word on software rendering, in colours like these.
        until(lambda: near(pixels(page.screenshot())[150:540, 310:540], rgb(worst), 40) > 60, 60)
    before = time.input_value()
    until(lambda: time.input_value() != before, 60)
    return time


def test_the_file_opens_from_disk_and_asks_nobody(recorded: Service, browser: Browser, tmp_path: Path) -> None:
    file = tmp_path / "flight.html"
    with recorded.signed_in() as client:
        file.write_bytes(client.get("/api/v1/runs/R-0001/exports/flight-F1.html").content)
    with visiting(browser, "file://") as visit:
        visit.page.context.set_offline(True)
        visit.go(str(file))
        playing(visit.page, LIGHT.worst)
        expect(visit.page.locator("#told")).to_contain_text("R-0001 · F1")
        assert visit.page.title() == "R-0001 F1: Recorded"
        visit.shot("recording-file", full=False)
    assert (SCREENSHOTS / "recording-file.png").is_file()


def test_a_link_from_the_run_page_plays_without_a_viewer(recorded: Service, browser: Browser) -> None:
    with visiting(browser, recorded.url) as visit:
        visit.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        visit.go(f"/login?code={recorded.login_code()}")
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
        visit.shot("recording-page-dark", full=False)
        until(lambda: recorded.app.state.viewers.open == 0)
