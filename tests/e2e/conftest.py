"""A running service, a browser, and a page that is signed in. Start reading at `signed_in`."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, sync_playwright

from tests.e2e.browser import Visit, launch, visiting
from tests.faults.processes import REPOSITORY
from tests.faults.serving import Service, serving


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """`clearance serve` with one worker on an empty folder."""
    assert (REPOSITORY / "frontend/dist/index.html").is_file(), "the pages are not built: make install"
    with serving(tmp_path_factory.mktemp("service")) as running:
        yield running


@pytest.fixture(scope="module")
def browser(request: pytest.FixtureRequest) -> Iterator[Browser]:
    """A browser; it draws in 3D unless the module sets DRAWS to False."""
    with sync_playwright() as playwright:
        browser = launch(playwright.chromium, getattr(request.module, "DRAWS", True))
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def signed_in(service: Service, browser: Browser) -> Iterator[Visit]:
    """A page of a browser that signed in with the login link; shared by the tests of a module."""
    link = service.link()
    with visiting(browser, link.partition("/login")[0]) as visit:
        visit.page.goto(link)
        yield visit
