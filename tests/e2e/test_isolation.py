"""The 3D view cannot act for its visitor: what a script inside its frame, or its page opened alone, is refused."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Frame, Page, Request, expect

from tests.e2e.browser import Visit, undrawn, visiting
from tests.e2e.stored import served
from tests.given.finished_runs import finish
from tests.given.service import Service, until
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(300),
    pytest.mark.nightly,
]  # by day the headers that isolate it: tests/api/middleware/test_headers.py

ATTEMPTS = {
    "a cookie": "() => document.cookie",
    "the page around it": "() => parent.document.title",
    "the address of the page": "() => { top.location.href = '/login' }",
    "a window": "() => { if (open('/runs') === null) throw 'blocked' }",
    "stored data": "() => localStorage.length",
    "data of the session": "() => sessionStorage.length",
    "a database": "() => indexedDB.open('x')",
    "a service worker": "() => navigator.serviceWorker.register('/x.js')",
    "the API": "() => fetch('/api/v1/session')",
    "the API with cookies": "() => fetch('/api/v1/session', {credentials: 'include'})",
    "the API unseen": "() => fetch('/api/v1/session', {credentials: 'include', mode: 'no-cors'})",
    "a write": "() => fetch('/api/v1/runs/R-0001', {method: 'PATCH', body: '{}', credentials: 'include'})",
    "another socket": "url => new Promise((resolve, reject) => {"
    "const one = new WebSocket(url, 'viser-v1.1.1'); one.onopen = resolve; one.onerror = reject})",
}
"""Expressions that must throw or be rejected."""
FROM_A_WINDOW = ("the page around it", "the address of the page")
"""Refused only in a frame: the page of a window is its own parent."""
NOTED = re.compile(
    "CORS policy|Content Security Policy|Failed to load resource|Unsafe attempt|WebSocket connection|Blocked opening"
)
"""What the browser itself reports of refused attempts."""


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service with one finished run."""
    with served(tmp_path_factory.mktemp("isolated")) as service:
        with service.signed_in() as client:
            assert submit(client) == "R-0001"
        finish(service)
        yield service


def refused(place: Frame | Page, attempt: str, given: str) -> bool:
    """Whether it throws, or is rejected."""
    guarded = f"async given => {{ try {{ await ({attempt})(given); return false }} catch {{ return true }} }}"
    return bool(place.evaluate(guarded, given))


def isolated(visit: Visit, place: Frame | Page, *, alone: bool = False) -> None:
    """Everything that a script tries there fails, and what it sends has no session."""
    assert visit.wrong == []
    sent: list[Request] = []

    def noted(request: Request) -> None:
        sent.append(request)

    visit.page.on("request", noted)
    assert place.evaluate("() => self.origin") == "null"
    socket = f"{visit.address.replace('http', 'ws')}/view/R-0001/key/{KEY}/"
    for name, attempt in ATTEMPTS.items():
        if not (alone and name in FROM_A_WINDOW):
            assert refused(place, attempt, socket), name
    visit.page.remove_listener("request", noted)
    asked = [one for one in sent if "/api/v1/session" in one.url and one.frame.url.startswith(f"{visit.address}/view/")]
    assert len(asked) == 3 or alone, "a recording asks nobody"
    for one in asked:
        assert "cookie" not in one.all_headers()
        answer = one.response()
        assert answer is None or answer.status == 401
    assert [wrong for wrong in visit.wrong if not NOTED.search(wrong)] == []
    visit.wrong.clear()


def test_a_script_in_the_view_has_nothing_of_its_visitor(flown: Service, browser: Browser) -> None:
    with visiting(browser, flown.url, views=False) as visit:
        page = visit.page
        visit.sign_in(flown.login_code())
        visit.go("/runs/R-0001")
        page.locator("#flight").scroll_into_view_if_needed()
        expect(page.get_by_role("button", name="Open the panel")).to_be_enabled()
        (frame,) = [one for one in page.frames if "/view/" in one.url]
        until(lambda: frame.evaluate("() => window.blankDraws > 0"))
        isolated(visit, frame)
        assert page.url == f"{flown.url}/runs/R-0001"


@pytest.mark.nightly  # by day tests/api/scenes: what the pages of views are sent with
def test_neither_has_a_script_in_a_window_of_its_own(flown: Service, browser: Browser) -> None:
    """With a key, for which nobody waits, and as a recording."""
    with visiting(browser, flown.url, views=False) as visit:
        page = visit.page
        visit.sign_in(flown.login_code())
        visit.go(f"/view/R-0001/key/{KEY}/")
        assert page.evaluate("() => self.origin") == "null"
        visit.go("/view/R-0001/F1/recorded/")
        visit.wrong[:] = [wrong for wrong in visit.wrong if not NOTED.search(wrong)]
        expect(page.locator("#caption")).to_contain_text("R-0001")
        isolated(visit, page, alone=True)
        # An address of the view alone leads to the page that has its controls, with the session.
        with undrawn(page):
            visit.go("/view/R-0001/F1/t/1.25/cam/top")
            expect(page).to_have_url(re.compile(r"/runs/R-0001/flight\?.*finding=F1.*t=1\.25.*cam=top"))
            expect(page.locator("#flight iframe")).to_have_attribute("src", re.compile("/view/R-0001/"))
