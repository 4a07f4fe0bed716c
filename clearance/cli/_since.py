"""The changes since a baseline as a table of `clearance run`."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table
from rich.text import Text

from campaigns.claims.numbers import NONE, signed
from campaigns.results.regression import Regression, Standing

COLOURS = {
    Standing.NEW: "yellow",
    Standing.WORSE: "red",
    Standing.BETTER: "green",
    Standing.FIXED: "green",
    Standing.NOT_COMPARED: "yellow",
}


def table(regression: Regression) -> Table:
    """A row for each finding of either run."""
    found = Table(f"Since {regression.run}", "")
    unit = f" [{regression.unit}]" if regression.unit else ""
    for heading in (f"Margin there{unit}", f"Same case here{unit}", f"Lowest here{unit}", f"FindingChange{unit}"):
        found.add_column(escape(heading), justify="right")
    found.add_column("Here")
    for case in regression.cases:
        numbers = (case.margin_before, case.margin_again, case.margin, case.change)
        standing = Text(f"{case.standing}{', fails' if case.fails else ''}", style=COLOURS.get(case.standing, ""))
        found.add_row(case.before or "", standing, *map(_number, numbers), case.now or "")
    return found


def _number(value: float | None) -> str:
    return NONE if value is None else signed(value)
