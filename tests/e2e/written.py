"""The text editor of the launch page, used by keyboard and by file."""

from __future__ import annotations

from playwright.sync_api import Locator, Page

NAME = "Campaign as YAML"


def editor(page: Page) -> Locator:
    """Where the campaign is typed; only the lines in sight are in the page."""
    return page.get_by_label(NAME)


def written(page: Page) -> str:
    """The whole text, as a file gets it."""
    with page.expect_download() as download:
        page.get_by_role("button", name="Download", exact=True).click()
    return download.value.path().read_text(encoding="utf-8")


def write_over(page: Page, text: str) -> None:
    """Replace the text."""
    editor(page).focus()
    page.keyboard.press("Control+A")
    page.keyboard.insert_text(text)
