"""A browser that fails on console errors and on requests to other hosts."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
from PIL import Image
from playwright.sync_api import (
    Browser,
    BrowserContext,
    BrowserType,
    ConsoleMessage,
    Error,
    Frame,
    FrameLocator,
    Locator,
    Page,
    Request,
    Route,
    WebSocket,
    expect,
)

from backend.reports import pdf
from tests.faults.processes import REPOSITORY, until

SCREENSHOTS = REPOSITORY / "build" / "screenshots"

NAMED = "clearance.test"
"""A name of this machine. By it, unlike by 127.0.0.1, a page over HTTP is what it is for colleagues: not secure."""

ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    # A sandboxed frame in a process of its own is a separate target of clicks, which meet it where it was before the
    # page scrolled. What a sandbox refuses, it refuses in one process as well.
    "--disable-site-isolation-trials",
    "--no-first-run",
    f"--host-resolver-rules=MAP {NAMED} 127.0.0.1",
)

HASTY = ("--js-flags=--no-opt --no-maglev",)
"""A page of a test lives for seconds: optimising its code takes a tenth of its processor time, more than is gained."""

DRAWN_IN_SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
WITHOUT_3D = ("--disable-3d-apis",)

BLANK = Path(__file__).with_name("blank_webgl.js")
"""3D graphics that accept every call and draw nothing."""

LEFT = re.compile("^console: Failed to load HDR JPEG: TypeError: Failed to fetch")

UNTRUSTWORTHY = re.compile("^console: The Cross-Origin-Opener-Policy header has been ignored")
"""Said of every page over HTTP that is not of this machine; nothing is lost by it that such a page could have."""

PATIENCE = 60_000
"""[ms]"""
expect.set_options(timeout=PATIENCE / 2)  # a 3D view drawn in software holds its page for seconds


def pictured() -> bool:
    """Whether pictures are stored."""
    return bool(os.environ.get("CLEARANCE_SCREENSHOTS"))


def executable() -> str:
    """The path of the system's browser; fails if there is none."""
    found = pdf.browser()
    assert found is not None, "these tests need chromium; `make test` installs it"
    return found


class Visit:
    """One page of the browser, and everything it did that it should not have done."""

    def __init__(self, page: Page, address: str) -> None:
        self.page = page
        self.address = address
        self.wrong: list[str] = []
        self.left = False
        """Whether a 3D view was left: its library reports as an error if what it then fetches is aborted."""
        page.on("console", self._statement)
        page.on("pageerror", self._threw)
        page.on("request", self._asked)
        page.on("framedetached", self._detached)
        page.on("websocket", self._opened)

    def sign_in(self, code: str) -> None:
        """Sign in with a login code without loading a page; links are opened in tests/e2e/test_whole_way.py."""
        answer = self.page.context.request.get(f"{self.address}/login?code={code}", max_redirects=0)
        assert answer.status == 303, answer.text()

    def go(self, path: str) -> None:
        """Open an address of the service."""
        self.page.goto(self.address + path)

    def move(self, path: str) -> None:
        """Go to another page within the application, as a link does, and return once its title is set.

        Loading the whole application takes a second of processor time. It is loaded if the page is of another address,
        or if only the query changes, which no title shows.
        """
        expect(self.page).not_to_have_title("Clearance")  # it is still being loaded, and may lead elsewhere
        here = urlsplit(self.page.url)
        if f"{here.scheme}://{here.netloc}" != self.address or here.path == urlsplit(path).path:
            self.go(path)
            return
        self.page.evaluate("path => { document.title = ''; history.pushState(null, '', path) }", path)
        expect(self.page).to_have_title(re.compile("Clearance"))

    def stay(self, path: str) -> Page:
        """Go to an address; a page that is already there, with any query, is not reloaded."""
        if urlsplit(self.page.url).path != path:
            self.go(path)
        return self.page

    def near(self, part: str) -> None:
        """Bring a part of the page into the window, where its charts are drawn."""
        place = self.page.locator(part).first
        expect(place).to_be_attached()
        place.evaluate("element => element.scrollIntoView({behavior: 'instant', block: 'center'})")

    def shot(self, name: str, *, full: bool = True, of: Locator | None = None) -> None:
        """Save a screenshot of the page, or of a part of it, if CLEARANCE_SCREENSHOTS is set."""
        if not pictured():
            return
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        file = SCREENSHOTS / f"{name}.png"
        if of is not None:
            of.screenshot(path=file, animations="disabled")
            return
        if full:
            lay_out(self.page)
            self.page.evaluate("dispatchEvent(new Event('beforeprint'))")  # draws the charts beyond the window, too
            expect(self.page.get_by_text("Loading the evaluations …")).to_have_count(0)
            self.page.evaluate("scrollTo({top: 0, behavior: 'instant'})")  # else the header stands in the middle
        self.page.screenshot(path=file, full_page=full, animations="disabled")

    def _statement(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self.wrong.append(f"console: {message.text} {message.location.get('url', '')}".rstrip())

    def _detached(self, frame: Frame) -> None:
        self.left |= "/view/" in frame.url

    def faults(self) -> list[str]:
        """All that is wrong, but what a 3D view says that is left while it loads, and what HTTP lacks."""
        known = (UNTRUSTWORTHY, LEFT) if self.left else (UNTRUSTWORTHY,)
        return [wrong for wrong in self.wrong if not any(words.search(wrong) for words in known)]

    def _threw(self, error: Error) -> None:
        self.wrong.append(f"uncaught: {error.message}")

    def _asked(self, request: Request) -> None:
        parts = urlsplit(request.url)
        if parts.scheme not in ("data", "blob") and f"{parts.scheme}://{parts.netloc}" != self.address:
            self.wrong.append(f"left the service: {request.url}")

    def _opened(self, socket: WebSocket) -> None:
        if urlsplit(socket.url).netloc != urlsplit(self.address).netloc:
            self.wrong.append(f"left the service: {socket.url}")


@contextmanager
def undrawn(page: Page) -> Iterator[None]:
    """3D views that a page opens meanwhile stay empty: where they are beside the point, and not pictured."""

    def empty(route: Route) -> None:
        if route.request.frame.parent_frame is None:
            route.continue_()
        else:
            route.fulfill(body="", content_type="text/html")

    if not pictured():
        page.route("**/view/**", empty)
    try:
        yield
    finally:
        page.unroute("**/view/**")


def blank(context: BrowserContext) -> None:
    """3D views that are opened from now on behave as ever, but have no picture, unless pictures are stored.

    Opening a view in software takes some 15 s of processor time, most of it for compiling shaders.
    """
    if not pictured():
        context.add_init_script(path=BLANK)


def draws(view: FrameLocator | Page) -> bool:
    """Whether a view that has no picture was asked to draw something."""
    return bool(view.locator("body").evaluate("() => window.blankDraws !== 0"))


def rests(view: FrameLocator) -> bool:
    """Whether a view that has no picture draws nothing for longer than viser's own interval between frames."""
    drawn = "() => new Promise(done => { const n = blankDraws; setTimeout(() => done(n === blankDraws), 1500) })"
    return bool(view.locator("body").evaluate(drawn))


def space_of(page: Page) -> Locator:
    """The parameter space of a run, which is drawn where it is seen; what is above it may still grow."""
    space = page.locator("#space")

    def seen() -> bool:
        space.scroll_into_view_if_needed()
        return space.locator("section").is_visible()

    until(seen, "the parameter space", PATIENCE / 1e3)
    return space


def in_3d(page: Page) -> None:
    """Open the 3D view, in place of which a browser without a graphics processor shows a picture at first."""
    still = page.get_by_role("button", name="Open in 3D")
    expect(still.or_(page.locator("#flight iframe"))).to_be_visible(timeout=PATIENCE)
    if still.is_visible():
        still.click()


@contextmanager
def visiting(browser: Browser, address: str, *, views: bool = True, moving: bool = False) -> Iterator[Visit]:
    """A new browser profile at 1440 x 900; fails at the end if the browser reported errors.

    views: whether 3D views are drawn, as far as the browser draws; otherwise see `blank`. moving: whether pages are
    animated, which takes a sixth of their processor time.
    """
    context = browser.new_context(
        viewport={"width": 1440, "height": 900},
        color_scheme="light",
        reduced_motion="no-preference" if moving else "reduce",
    )
    context.set_default_timeout(PATIENCE)
    if not views:
        blank(context)
    visit = Visit(context.new_page(), address)
    if not views and pictured():
        visit.page.add_locator_handler(visit.page.get_by_role("button", name="Open in 3D"), lambda still: still.click())
    try:
        yield visit
    finally:
        context.close()
    assert visit.faults() == [], "\n".join(visit.faults())


def launch(chromium: BrowserType, draws: bool = True, optimises: bool = False) -> Browser:
    """The system's chromium, which draws WebGL in software, or not at all. optimises: as users have it."""
    graphics = DRAWN_IN_SOFTWARE if draws else WITHOUT_3D
    arguments = [*ARGUMENTS, *graphics, *(() if optimises else HASTY)]
    return chromium.launch(executable_path=executable(), args=arguments)


def pixels(png: bytes) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    """A picture's red, green and blue (height, width, 3)."""
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def lay_out(page: Page) -> None:
    """Lay out what is beyond the window, too, and wait until what depends on its size is rendered."""
    page.add_style_tag(content="* { content-visibility: visible !important }")
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def near(picture: np.ndarray[tuple[int, ...], np.dtype[np.uint8]], colour: tuple[int, int, int], reach: int) -> int:
    """How many pixels come this close to a colour in every channel."""
    apart = np.abs(picture.astype(np.int16) - np.array(colour, np.int16))
    return int(np.count_nonzero((apart <= reach).all(axis=2)))
