"""`make bench-pages`: performance of the pages, real service in Debian's chromium; writes build/bench-pages.json and,
for each page whose load is measured, a profile build/load-PAGE.cpuprofile.

The service is a process of its own with its own data. Every visit has an empty browser cache; a figure is the median of
several visits. The machine should be idle.
"""

from __future__ import annotations

import json
import re
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import copy
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import sqlalchemy as sa
from playwright.sync_api import Browser, BrowserType, Page, Request, WebSocket, sync_playwright

from backend.db.engine import connect, default_url
from tests.bench import page_data, page_loads, page_view
from tests.bench.first_verdict import verdicts
from tests.bench.page_loads import seconds
from tests.e2e.browser import PATIENCE, in_3d, launch
from tests.faults.processes import Started, started, until

BUILD = Path("build")
RUNS, RUNNING = 10_000, 5
VISITS, REQUESTS = 5, 15
WATCHED = 15.0
"""How long the service is watched while it serves a live page [s]."""
SETTLED = 2.0
"""How long what the 3D view still fetches is waited for once it draws [s]."""

TARGETS = {
    "run_list_10000_ms": 200.0,
    "run_list_visible_ms": 1000.0,
    "run_page_100000_interactive_ms": 2000.0,
    "run_page_100000_mb": 3.0,
    "live_view_core_percent": 5.0,
    "live_list_core_percent": 5.0,
    "view_rest_core_percent": 1.0,
    "view_out_of_sight_core_percent": 1.0,
}
LISTS: dict[str, dict[str, str | int]] = {
    "newest": {},
    "long": {"limit": 200},
    "by_margin": {"sort": "-margin"},
    "by_tags": {"sort": "tags"},
    "searched": {"q": "release 7"},
    "filtered": {"verdict": "violated", "tag": "baseline", "owner": "ada", "sort": "worst"},
}


def main() -> None:
    """Measure, print, write."""
    BUILD.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, service(Path(folder)) as (running, address, data):
        engine = connect(default_url(data))
        page_data.publish(engine)
        large = page_data.flown(engine)
        page_data.copies(engine, large, RUNS - 1)
        with sync_playwright() as playwright:
            browser = launch(playwright.chromium, optimises=True)
            visitor = Visitor(browser, address, running)
            found = measured(address, visitor, engine, large) | loaded(playwright.chromium, visitor, large)
            found |= page_view.views(visitor, f"R-{large:04d}") | verdicts(browser)
            browser.close()
        engine.dispose()
    (BUILD / "bench-pages.json").write_text(json.dumps(found, indent=2) + "\n")
    show(found)


def measured(address: str, visitor: Visitor, engine: sa.Engine, large: int) -> dict[str, Any]:
    """Every figure by its name."""
    found: dict[str, Any] = {"runs": RUNS, "visits": VISITS}
    lists = {f"run_list_10000_{name}_ms": listed(address, visitor.cookies, given) for name, given in LISTS.items()}
    found["run_list_10000_ms"] = max(lists.values())
    found |= lists
    found["run_list_visible_ms"] = statistics.median(visitor.time(list_visible) for _ in range(VISITS))
    visits = [visitor.run_page(f"R-{large:04d}") for _ in range(VISITS)]
    found |= {key: statistics.median(visit[key] for visit in visits) for key in visits[0]}
    with page_data.growing(engine, RUNNING) as runs:
        found["live_view_core_percent"] = visitor.core(f"/runs/R-{runs[0]:04d}", "[data-testid=best]")
        found["live_list_core_percent"] = visitor.core("/runs", f"tr[data-run=R-{runs[-1]:04d}]")
    return found


def loaded(chromium: BrowserType, visitor: Visitor, large: int) -> dict[str, float]:
    """Processor time of loading pages, and profiles of it, in a browser without 3D graphics."""
    pages = {
        "list": ("/runs", "tr[data-run]"),
        "run": (f"/runs/R-{large:04d}", "[data-testid=verdict]"),
        "launch": ("/launch?case=unicycle_static", "text=Start run"),
    }
    without = copy(visitor)
    without.browser = launch(chromium, draws=False, optimises=True)
    found = page_loads.loads(without, pages)
    page_loads.profiles(without, pages, BUILD)
    without.browser.close()
    return found


@contextmanager
def service(folder: Path) -> Iterator[tuple[Started, str, Path]]:
    """`python -m backend` on an empty folder: the process, its address, the folder."""
    data = folder / "data"
    command = [sys.executable, "-m", "backend"]
    with started(command, folder, "backend", CLEARANCE_DATA=str(data), CLEARANCE_PORT="0") as running:
        until(lambda: running.link() or running.process.poll() is not None, "ready", 60)
        assert running.process.poll() is None, running.text()
        yield running, running.address(), data


def listed(address: str, cookies: dict[str, str], given: dict[str, str | int]) -> float:
    """A page of the run list: the median of what a client on this machine waits for [ms]."""
    times = []
    with httpx.Client(base_url=address, cookies=cookies, trust_env=False) as client:
        for _ in range(REQUESTS):
            began = time.perf_counter()
            answer = client.get("/api/v1/runs", params=given)
            times.append(1e3 * (time.perf_counter() - began))
            assert answer.json()["items"], answer.text
    return statistics.median(times)


def list_visible(page: Page, address: str) -> None:
    """The first rows of the run list are seen."""
    page.goto(f"{address}/runs", wait_until="commit")
    page.locator("tr[data-run]").first.wait_for()


def interactive(page: Page, address: str, run: str) -> None:
    """Verdict, findings and charts are drawn, and a click on a finding is answered."""
    page.goto(f"{address}/runs/{run}", wait_until="commit")
    page.get_by_test_id("verdict").wait_for()
    page.locator("#findings tr[data-finding=F1]").wait_for()
    for chart in (page.locator("#separation"), page.get_by_role("img", name=re.compile("^Convergence"))):
        chart.scroll_into_view_if_needed()  # charts are drawn near the window
        chart.locator("canvas").wait_for()
    page.get_by_role("img", name=re.compile("^Histogram")).wait_for()
    page.locator("tr[data-finding=nominal]").click()
    page.get_by_role("heading", name="Nominal case").wait_for()


class Visitor:
    """A browser signed in to the service; every visit is a fresh profile with the same session."""

    def __init__(self, browser: Browser, address: str, running: Started) -> None:
        self.browser, self.address, self.running = browser, address, running
        context = browser.new_context()
        context.new_page().goto(running.link())
        self.state = context.storage_state()
        self.cookies = {cookie["name"]: cookie["value"] for cookie in context.cookies()}
        context.close()

    @contextmanager
    def page(self) -> Iterator[Page]:
        """An empty page of a profile without anything in its cache."""
        context = self.browser.new_context(storage_state=self.state, viewport={"width": 1440, "height": 900})
        context.set_default_timeout(PATIENCE)
        try:
            yield context.new_page()
        finally:
            context.close()

    def time(self, visit: Callable[[Page, str], None]) -> float:
        """How long a visit takes [ms]."""
        with self.page() as page:
            began = time.perf_counter()
            visit(page, self.address)
            return 1e3 * (time.perf_counter() - began)

    def run_page(self, run: str) -> dict[str, float]:
        """A run's page: until it is interactive [ms], and the data transferred until its 3D view is open [MB]."""
        with self.page() as page:
            page_loads.settled(page)  # a browser that draws in software works on at the view of the visit before
            traffic = Traffic(page)
            began = time.perf_counter()
            interactive(page, self.address, run)
            taken = 1e3 * (time.perf_counter() - began)
            page.locator("#flight").scroll_into_view_if_needed()
            in_3d(page)
            page.frame_locator("#flight iframe").locator("canvas").first.wait_for()
            page.wait_for_timeout(1e3 * SETTLED)
            own, view = traffic.megabytes()
        return {
            "run_page_100000_interactive_ms": taken,
            "run_page_100000_mb": own,
            "run_page_100000_view_mb": view,
        }

    def core(self, path: str, seen: str) -> float:
        """The service's load of one core while a live page is open [%]."""
        with self.page() as page:
            page.goto(self.address + path)
            page.locator(seen).wait_for()
            before, began = seconds(self.running.family()), time.perf_counter()
            page.wait_for_timeout(1e3 * WATCHED)
            return 100.0 * (seconds(self.running.family()) - before) / (time.perf_counter() - began)


class Traffic:
    """What a page and the frames in it fetch; the 3D view's apart from all else."""

    def __init__(self, page: Page) -> None:
        self._done: list[Request] = []
        self._socket = 0
        page.on("requestfinished", self._finished)
        page.on("websocket", self._opened)

    def megabytes(self) -> tuple[float, float]:
        """The page's own, and those of its 3D view: headers and bodies as transferred [MB]."""
        own, view = 0, self._socket
        for request in self._done:
            sizes = request.sizes()
            size = sizes["responseBodySize"] + sizes["responseHeadersSize"]
            if urlsplit(request.url).path.startswith("/view/"):
                view += size
            else:
                own += size
        return own / 1e6, view / 1e6

    def _finished(self, request: Request) -> None:
        self._done.append(request)

    def _opened(self, socket: WebSocket) -> None:
        socket.on("framereceived", self._received)

    def _received(self, payload: str | bytes) -> None:
        self._socket += len(payload)


def show(found: dict[str, Any]) -> None:
    """The table."""
    width = max(map(len, found))
    for key, value in found.items():
        target = TARGETS.get(key)
        beside = "" if target is None else f"  target {target:g}: {'met' if value < target else 'MISSED'}"
        print(f"{key:<{width}}  {value:,.4g}{beside}")


if __name__ == "__main__":
    main()
