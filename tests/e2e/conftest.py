"""Running services, a browser, and a page that is signed in.

The browsers and the evaluated runs are made once for all files here, which therefore run in one process.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, sync_playwright

from tests.e2e import flown as runs_flown
from tests.e2e.browser import Visit, launch, visiting
from tests.e2e.flown import Flown
from tests.faults.processes import REPOSITORY
from tests.faults.serving import Service, serving
from tests.given.service import Service as StoredService

Browsers = Callable[[bool], Browser]


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """`clearance serve` with one worker on an empty folder. It costs 12 s of processor time: prefer `stored`."""
    assert (REPOSITORY / "frontend/dist/index.html").is_file(), "the pages are not built: make install"
    with serving(tmp_path_factory.mktemp("service")) as running:
        yield running


@pytest.fixture(scope="package")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Flown:
    """Runs of every kind that a worker evaluated, for `stored`."""
    return runs_flown.fly(tmp_path_factory.mktemp("flown"))


@pytest.fixture(scope="module")
def stored(flown: Flown, tmp_path_factory: pytest.TempPathFactory) -> Iterator[StoredService]:
    """A service without a worker on a copy of the evaluated runs; see `tests.e2e.flown`."""
    with runs_flown.copied(flown, tmp_path_factory.mktemp("stored")) as running:
        yield running


@pytest.fixture(scope="package")
def browsers() -> Iterator[Browsers]:
    """A browser that draws in 3D, and one that does not; each is started when it is first asked for."""
    started: dict[bool, Browser] = {}
    with sync_playwright() as playwright:

        def of(draws: bool) -> Browser:
            if draws not in started or not started[draws].is_connected():
                started[draws] = launch(playwright.chromium, draws)
            return started[draws]

        yield of
        for browser in started.values():
            browser.close()


@pytest.fixture(scope="module")
def browser(request: pytest.FixtureRequest, browsers: Browsers) -> Browser:
    """A browser, shared with other files; it draws in 3D unless the module sets DRAWS to False."""
    return browsers(getattr(request.module, "DRAWS", True))


@pytest.fixture(scope="module")
def signed_in(service: Service, browser: Browser) -> Iterator[Visit]:
    """A page of a browser that signed in with the login link; shared by the tests of a module."""
    link = service.link()
    with visiting(browser, link.partition("/login")[0]) as visit:
        visit.page.goto(link)
        yield visit
