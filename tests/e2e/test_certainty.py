"""Large samples from the form to their verdicts, of a ground robot and of an aircraft: the bound is watched as it
falls, the worker is killed in the middle, and it ends at what so many flights without a violation show."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from backend.db.engine import connect, default_url
from tests.audited import audited
from tests.e2e.browser import Visit, visiting
from tests.e2e.looking import api, looks
from tests.faults.processes import kill, until
from tests.faults.serving import Service

pytestmark = [pytest.mark.e2e, pytest.mark.nightly, pytest.mark.timeout(1200)]

LONGEST = 900.0
CHILD = "worker.running.processes.child"
CASES = {"unicycle_static": (2_995_732, 1e-6), "uav_aca": (299_573, 1e-5)}
"""Flights, and the bound of so many."""


@pytest.fixture(scope="module")
def signed_in(service: Service, browser: Browser) -> Iterator[Visit]:
    link = service.link()
    with visiting(browser, link.partition("/login")[0], views=False) as visit:
        visit.page.goto(link)
        yield visit


def shown(text: str) -> float:
    """The bound in the row of stages."""
    found = re.search(r"P ≤ ([\d.e−]+)(\s?%)?", text)
    return float(found[1].replace("−", "-")) / (100 if found[2] else 1) if found else 1.0


@pytest.mark.parametrize("name", CASES)
def test_a_small_bound_is_watched_and_outlives_its_worker(service: Service, signed_in: Visit, name: str) -> None:
    page, (samples, bound) = signed_in.page, CASES[name]
    signed_in.move("/launch")
    page.locator(f"#case-{name}").check()
    page.locator("summary").filter(has_text="Certify").click()
    page.get_by_label("Certify samples").fill(str(samples))
    page.get_by_label("Stored flights").click()
    page.get_by_role("option", name=re.compile("^The lowest")).click()
    page.get_by_label("Target for P(violation)").fill(str(bound))
    page.get_by_role("button", name="Start run").click()
    page.wait_for_url(re.compile(r"/runs/R-\d+$"))
    run_id = int(page.url.rpartition("-")[2])
    path = f"/runs/R-{run_id:04d}"
    stage = page.get_by_role("list", name="Stages").get_by_role("listitem").filter(has_text="Certify")
    expect(stage).to_contain_text("P ≤", timeout=120_000)
    bounds = [shown(stage.inner_text())]

    def falling(below: float) -> bool:
        bounds.append(shown(stage.inner_text()))
        return bounds[-1] < below

    until(lambda: falling(20 * bound), "it falls", LONGEST)
    looks(signed_in, "bound-falling")
    kill(killed := service.part(CHILD))
    until(lambda: service.part(CHILD) not in (0, killed), "another process has its place", 60)
    counted = api(signed_in, path)["evaluations"]
    until(lambda: api(signed_in, path)["evaluations"] > counted, "it goes on", LONGEST)
    until(lambda: falling(3 * bound), "it falls on", LONGEST)
    assert bounds == sorted(bounds, reverse=True), "a bound of no violation only falls"
    expect(page.get_by_test_id("verdict")).to_have_text(re.compile("Cleared"), timeout=1e3 * LONGEST)
    run = api(signed_in, path)
    assert run["summary"]["statistics"]["upper_bound"] <= bound
    assert run["summary"]["statistics"]["samples"] == samples
    looks(signed_in, "bound-reached")
    audited(connect(default_url(service.data)), run_id=run_id)
