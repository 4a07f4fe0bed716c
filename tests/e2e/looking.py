"""Screenshots of a page at both widths in both themes, and API requests from its browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from playwright.sync_api import Page, expect

from tests.e2e.browser import Visit, pictured
from tests.faults.processes import until

LOOKS = [(width, theme) for width in (1440, 1280) for theme in ("light", "dark")]


def api(visit: Visit, path: str) -> Any:
    """An API response in this browser's session."""
    answer = visit.page.request.get(f"{visit.address}/api/v1{path}")
    assert answer.ok, answer.text()
    return answer.json()


def within(page: Page, width: int) -> None:
    """Nothing is wider than the window, once charts have its width."""
    until(lambda: page.evaluate("document.documentElement.scrollWidth") <= width, f"a page of {width} px", 10)


def looks(visit: Visit, name: str, settled: Callable[[Visit], object] = lambda visit: None) -> None:
    """Nothing may be wider than the window, in the narrower width and the dark theme.

    Where pictures are stored, at both widths in both themes, each once settled.
    """
    for width, theme in LOOKS if pictured() else LOOKS[-1:]:
        visit.page.set_viewport_size({"width": width, "height": 900})
        visit.page.emulate_media(color_scheme=theme)
        expect(visit.page.locator("html")).to_have_attribute("data-theme", theme)
        # Not by `wait_for_function`: it evaluates text in the page, which the page's policy refuses.
        until(lambda: visit.page.evaluate("document.fonts.status") == "loaded", "fonts loaded", 30)
        within(visit.page, width)
        if pictured():
            settled(visit)
        visit.shot(f"{name}-{width}-{theme}")
    visit.page.set_viewport_size({"width": 1440, "height": 900})
    visit.page.emulate_media(color_scheme="light")
