"""The parts of the guide of methods that state figures of benches, as kept in `tests/bench/figures`."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from worker.running.catalogue.installed import methods

FOLDER = Path(__file__).parents[1] / "tests" / "bench" / "figures"
GROUPS = ("many valleys", "few valleys")
BUDGETS = (20, 50, 100)
"""Evaluations per parameter."""

Row = Sequence[str]


def small_budgets() -> tuple[Row, Iterable[Row]]:
    """The header, and a row for each method."""
    header = ["method"]
    for group in GROUPS:
        header += [f"{group}, {BUDGETS[0]} n", *(f"{budget} n" for budget in BUDGETS[1:])]
    rows = [
        (methods()[name].title, *(f"{score:.2f}" for group in GROUPS for score in one[group]), f"{one['failed']:.0%}")
        for name, one in _kept("small_budgets")["methods"].items()
    ]
    return [*header, "failed"], [[cell.replace("%", " %") for cell in row] for row in rows]


def rare() -> tuple[Row, Iterable[Row]]:
    """The header, and a row for each way to begin the estimate."""
    found = _kept("rare")
    judging, whole = found["judging"], found["whole"]
    noticed = f"{_part(judging['large_noticed'])} of {judging['large_withheld']} withheld"
    first = "a start in every mode but one that is withheld", str(judging["seeds"]), _part(judging["holds_or_alarm"])
    rows = [(*first, "", noticed, _part(judging["false_alarms"]))]
    for cube, distributions in {"truncated": "truncated normal", "uniform": "uniform"}.items():
        one, begun = whole[cube], f"a search by `auto`, {distributions} distributions (`--whole`)"
        known = _part(one["large_given"]), _part(one["large_noticed"])
        rows.append((begun, str(whole["seeds"]), _part(one["holds_or_alarm"]), *known, ""))
    header = ("begun with", "seeds", "P in the interval, or an alarm", "modes that the search has")
    return [*header, "modes found, or an alarm", "false alarms"], rows


def subset() -> str:
    """What subset simulation comes to, in two sentences."""
    one = _kept("rare")["subset"]
    within, wrongly = _part(one["within_factor_two"], 0), _part(one["contradicted_wrongly"], 0)
    text = (
        f"{one['seeds']} seeds: P within a factor of two in {within} of {one['runs']} runs; of modes above a tenth of "
        f"P it reaches {_part(one['large_reached'], 0)}. Of {one['missed_by_estimate']} modes that the estimate missed "
        f"in silence when they were withheld, it reaches {one['reached']}, and exceeds twice the upper end of the "
        f"interval for {one['contradicted']} (wrongly in {wrongly} of runs). With its evaluations given to the "
        f"estimate instead, {one['noticed_with_twice']} are noticed."
    )
    return textwrap.fill(text, 120) + "\n"


def _part(value: float, digits: int = 1) -> str:
    return f"{100.0 * value:.{digits}f} %"


def _kept(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    return found
