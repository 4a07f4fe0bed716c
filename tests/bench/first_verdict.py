"""From "Start run" to the verdict on the page, for the library's case 1.

Cold: the worker's process has just started and its kernel cache is empty, so the loop and the reference integrator are
compiled first. Warm: the same worker, again.
"""

from __future__ import annotations

import os
import re
import statistics
import tempfile
import time
from pathlib import Path

from playwright.sync_api import Browser, Page, expect

from tests.e2e.browser import blank
from tests.faults.serving import serving

CASE = "/launch?case=unicycle_static"
WARM_RUNS = 3
LONGEST = 300_000
"""A run is waited for this long [ms]."""


def verdicts(browser: Browser) -> dict[str, float]:
    """The cold and the warm time [s] on a service with one worker; the warm one is the median of several runs."""
    with tempfile.TemporaryDirectory() as folder:
        kernels = Path(folder, "kernels")
        kernels.mkdir()
        with serving(Path(folder), CLEARANCE_KERNEL_CACHE=str(kernels)) as service:
            context = browser.new_context(viewport={"width": 1440, "height": 900})
            blank(context)  # drawing in software would take the processor from the worker
            page = context.new_page()
            page.goto(service.link())
            address = service.address()
            cold = _run(page, address)
            assert any(kernels.rglob("*.nbi")), f"nothing was compiled into {kernels}: {os.listdir(kernels)}"
            warm = [_run(page, address) for _ in range(WARM_RUNS)]
            context.close()
    return {"verdict_cold_s": cold, "verdict_warm_s": statistics.median(warm)}


def _run(page: Page, address: str) -> float:
    """Start a run; the time until its verdict is on the page [s]."""
    page.goto(address + CASE)
    start = page.get_by_role("button", name="Start run")
    expect(start).to_be_enabled(timeout=LONGEST)
    began = time.perf_counter()
    start.click()
    page.wait_for_url(re.compile(r"/runs/R-\d+"), timeout=LONGEST)
    page.get_by_test_id("verdict").wait_for(timeout=LONGEST)
    taken = time.perf_counter() - began
    statement = page.get_by_test_id("verdict").inner_text()
    assert re.fullmatch("Cleared|Violated|Inconclusive", statement), f"the run ended without a verdict: {statement}"
    return taken
