"""Processor time of loading a page, in the browser and in the service, and a profile of it for the developer tools.

The browser must have no 3D graphics: the 3D view is a program of its own.
"""

from __future__ import annotations

import json
import math
import os
import statistics
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from playwright.sync_api import Page

from tests.faults.processes import command_of, descendants

if TYPE_CHECKING:
    from tests.bench.pages import Visitor

REPEATS = 5
QUIET, LITTLE = 0.4, 0.01
"""A page is loaded once the browser has taken no more processor time than `LITTLE` for so long [s]."""

Pages = Mapping[str, tuple[str, str]]
"""By name: the path, and what is seen once its main content is there."""


def loads(visitor: Visitor, pages: Pages) -> dict[str, float]:
    """The median of every page [ms], in a new profile and, as `again`, in one that has loaded it before."""
    return {name: value for page, place in pages.items() for name, value in _load(visitor, page, *place).items()}


def profiles(visitor: Visitor, pages: Pages, folder: Path) -> None:
    """Which functions of the pages take the time: a file for each page that the developer tools of a browser open."""
    for name, (path, seen) in pages.items():
        with visitor.page() as page:
            devtools = page.context.new_cdp_session(page)
            devtools.send("Profiler.enable")
            devtools.send("Profiler.start")
            _opened(page, visitor.address + path, seen)
            profile = devtools.send("Profiler.stop")["profile"]
            (folder / f"load-{name}.cpuprofile").write_text(json.dumps(profile))


def _load(visitor: Visitor, name: str, path: str, seen: str) -> dict[str, float]:
    found: dict[str, list[float]] = {}
    for _ in range(REPEATS):
        with visitor.page() as page:
            settled(page)
            for kind in ("", "_again"):
                browser, service = _browser(), seconds(visitor.running.family())
                _opened(page, visitor.address + path, seen)
                found.setdefault(f"load_{name}{kind}_browser_ms", []).append(1e3 * (_browser() - browser))
                found.setdefault(f"load_{name}{kind}_service_ms", []).append(
                    1e3 * (seconds(visitor.running.family()) - service)
                )
    return {key: statistics.median(values) for key, values in found.items()}


def _opened(page: Page, address: str, seen: str) -> None:
    page.goto(address)
    page.locator(seen).first.wait_for()
    settled(page)


def settled(page: Page, patience: float = math.inf) -> None:
    """Wait until the browser has nothing to do, for so long [s]."""
    before, began = -LITTLE, time.monotonic()
    while (now := _browser()) - before > LITTLE and time.monotonic() - began < patience:
        before = now
        page.wait_for_timeout(1e3 * QUIET)


def _browser() -> float:
    """The processor time of the browser's processes so far [s]; all of them have this argument of ours."""
    return seconds(pid for pid in descendants(os.getpid()) if "--no-sandbox" in command_of(pid))


def seconds(pids: Iterable[int]) -> float:
    """The processor time of these processes so far."""
    ticks = 0
    for pid in pids:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")
