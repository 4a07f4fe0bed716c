"""The changes since the baseline, as rows of a report."""

from __future__ import annotations

from backend.reports.record import Record
from campaigns.claims import numbers
from campaigns.claims.numbers import NONE
from campaigns.claims.say import say
from campaigns.results.regression import Standing


def changes(record: Record) -> dict[str, object] | None:
    """The comparison with the baseline, or the sentence on why there is none; None without a baseline."""
    regression = None if record.verdict is None else record.verdict.regression
    if regression is None:
        baseline = record.run.baseline
        if baseline is None:
            return None
        text = (
            baseline.sentence
            if baseline.run is None
            else f"{baseline.sentence} The run has no verdict, so nothing was compared."
        )
        return {"run": baseline.run or "", "cases": [], "statement": say(text), "lost": []}
    decimals = numbers.decimals_for(
        [m for c in regression.cases for m in (c.margin_before, c.margin_again, c.margin)], 5
    )
    changes = [c.change for c in regression.cases if c.change]
    # A change that is not 0 is not printed as 0, down to a millionth.
    smallest = min(6, max([3, *(numbers.decimals_for([change], 2) for change in changes)]))
    rows = [
        {
            "standing": str(case.standing),
            "fails": case.fails,
            "violates": case.margin is not None and case.margin <= 0,
            "before": case.before or NONE,
            "now": case.now or NONE,
            "margin_before": numbers.margin(case.margin_before, decimals),
            "margin_again": numbers.margin(case.margin_again, decimals),
            "margin": numbers.margin(case.margin, decimals),
            "change": numbers.difference(case.change, smallest),
            "tolerance": numbers.plain(case.tolerance, 2),
        }
        for case in regression.cases
    ]
    lost = [
        case.statement for case in regression.cases if case.standing in (Standing.NOT_COMPARED, Standing.UNRESOLVED)
    ]
    return {"run": regression.run, "cases": rows, "statement": regression.statement, "lost": lost}
