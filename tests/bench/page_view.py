"""Processor time of the 3D view in a browser that draws in software: at rest, out of sight, while it plays, and of
leaving its page.
"""

from __future__ import annotations

import contextlib
import os
import re
import time
from pathlib import Path
from typing import TYPE_CHECKING

from playwright.sync_api import Page, expect

from tests.bench.page_loads import settled
from tests.e2e.browser import in_3d
from tests.faults.processes import command_of, descendants

if TYPE_CHECKING:
    from tests.bench.pages import Visitor

WATCHED = 10.0
"""How long the view is watched in every state [s]."""
REST = 8.0
"""How long after an event the view may still draw [s]."""
DRAWING = re.compile("--type=(renderer|gpu-process|zygote)")
"""A zygote starts the others, and has the time of those that have ended."""


def views(visitor: Visitor, run: str) -> dict[str, float]:
    """The load of one core of the processes that draw pages [%], and the processor time of leaving [s]."""
    found: dict[str, float] = {}
    with visitor.page() as page:
        page.goto(f"{visitor.address}/runs/{run}")
        page.get_by_test_id("verdict").wait_for()
        page.locator("#flight").scroll_into_view_if_needed()
        before = drawing()
        opened(page)
        settled(page, 30.0)
        found["view_open_s"] = drawing() - before
        page.wait_for_timeout(1e3 * REST)
        found["view_rest_core_percent"] = core(page)
        found["view_playing_core_percent"] = played(page)
        page.evaluate("scrollTo({top: 1e6, behavior: 'instant'})")
        expect(page.locator("#flight")).not_to_be_in_viewport()
        page.wait_for_timeout(1e3 * REST)
        found["view_out_of_sight_core_percent"] = core(page)
        page.locator("#flight").scroll_into_view_if_needed()
        settled(page, 30.0)
        found |= left(page)
    return found


def opened(page: Page) -> None:
    in_3d(page)
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_enabled()


def played(page: Page) -> float:
    page.get_by_role("button", name="Play", exact=True).click()
    found = core(page)
    pause = page.get_by_role("button", name="Pause", exact=True)
    if pause.is_visible():
        pause.click()
    return found


def left(page: Page) -> dict[str, float]:
    """Go to the list of runs as a link does: until it is there, and all processor time until the browser is quiet."""
    before, began = drawing(), time.perf_counter()
    page.get_by_role("link", name="Runs", exact=True).first.click()
    page.locator("tr[data-run]").first.wait_for()
    visible = time.perf_counter() - began
    settled(page, 30.0)
    return {"view_leaving_visible_s": visible, "view_leaving_s": drawing() - before}


def core(page: Page) -> float:
    """The mean load of one core [%]."""
    before, began = drawing(), time.perf_counter()
    page.wait_for_timeout(1e3 * WATCHED)
    return 100.0 * (drawing() - before) / (time.perf_counter() - began)


def drawing() -> float:
    """The processor time of the browser's renderer and GPU processes so far [s], with those that have ended."""
    ticks = 0
    for pid in descendants(os.getpid()):
        if not (kind := DRAWING.search(command_of(pid))):
            continue
        with contextlib.suppress(OSError):  # it has ended meanwhile
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            ticks += sum(map(int, fields[13:15] if kind[1] == "zygote" else fields[11:13]))
    return ticks / os.sysconf("SC_CLK_TCK")
