"""Runs axe on a page: what is serious or critical against WCAG 2.1, levels A and AA."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from playwright.sync_api import Page

from tests.faults.processes import REPOSITORY

AXE = REPOSITORY / "frontend/node_modules/axe-core/axe.min.js"
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]
SERIOUS = ("serious", "critical")


def violations(page: Page, rules: Any = RULES, within: Sequence[str] = ()) -> list[str]:
    """Serious and critical findings of axe: rule, element, message. The 3D view's frame is third-party.

    within: the parts of the page that are tested, as selectors; by default all of it.
    """
    found = page.evaluate(
        "([rules, within]) =>"
        " axe.run(within.length ? {include: within.map((part) => [part])} : document,"
        " {runOnly: rules, resultTypes: ['violations'], iframes: false})",
        [rules, list(within)],
    )
    return [
        f"{rule['id']} ({rule['impact']}): {node['target']}: {node['failureSummary']}"
        for rule in found["violations"]
        if rule["impact"] in SERIOUS
        for node in rule["nodes"]
    ]
