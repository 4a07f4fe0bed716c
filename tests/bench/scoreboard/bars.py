"""The bars of the score board: what `auto`, the method without a choice, must reach, as data; met or missed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from tests.bench.scoreboard.contestants import Contestant
from tests.bench.scoreboard.parts import Table

JUDGED = "auto"
BBOB = {100: 0.45, 200: 0.48, 1000: 0.70}
"""In 5 dimensions, by evaluations per parameter."""
OF_THE_BEST = 0.95
"""Of the best single method of ours, on BBOB in every dimension at every budget."""
BEHIND = 3 / 30
"""Fraction of seeds by which it may be behind the best single method on a kind of landscape."""
NICHING = {"peak ratio": 0.85, "F1": 0.90}
FOUND, WHERE = 28 / 30, 29 / 30
"""Violations to be found, where any method of ours finds so many."""
TRUE = (0.07, 0.13)
"""Fraction of the statements at about 10 %, that another search finds a lower case, which come true."""
ABOUT = f"{100 * TRUE[0]:g} to {100 * TRUE[1]:g} %, came true"


class Bar(NamedTuple):
    """One bar: what it demands, the number, and what was measured; None if it was not."""

    part: str
    statement: str
    least: float
    measured: float | None
    most: float | None = None

    @property
    def verdict(self) -> str:
        """Met, missed, or not measured."""
        if self.measured is None:
            return "not measured"
        most = math.inf if self.most is None else self.most
        return "met" if self.least - 1e-9 <= self.measured <= most + 1e-9 else "missed"


def bars(tables: Mapping[str, Table], ours: list[str]) -> list[Bar]:
    """All bars; ours: our methods."""
    singles = [name for name in ours if name != JUDGED]
    return [
        *_bbob(tables.get("bbob", {}), singles),
        *_landscapes(tables.get("landscapes", {}), singles),
        *(Bar("niching", name, least, _own(tables, "niching", f"all, {name}")) for name, least in NICHING.items()),
        *_violations("loops", tables.get("loops", {}), singles, ", violated @ "),
        *_violations("falsification", tables.get("falsification", {}), singles, " @ "),
        *_verdicts(tables.get("verdicts", {})),
        Bar("sureness", "statements at about 10 % that come true", TRUE[0], _own(tables, "sureness", ABOUT), TRUE[1]),
    ]


def _own(tables: Mapping[str, Table], part: str, column: str) -> float | None:
    return tables.get(part, {}).get(column, {}).get(JUDGED)


def _best(by_method: Mapping[str, float], singles: list[str]) -> tuple[float, str] | None:
    """The highest figure of these methods, and whose it is."""
    found = max(((by_method[m], m) for m in singles if m in by_method), default=None)
    return found and (found[0], Contestant(found[1]).title)


def _bbob(table: Table, singles: list[str]) -> Iterator[Bar]:
    for budget, least in BBOB.items():
        column = f"5 parameters @ {budget}"
        yield Bar("bbob", f"5 parameters, {budget} n", least, table.get(column, {}).get(JUDGED))
    for column, by_method in table.items():
        best, own = _best(by_method, singles), by_method.get(JUDGED)
        if best is not None:
            ratio = own / best[0] if own is not None and best[0] > 0 else None
            yield Bar("bbob", f"{column.replace(' @ ', ', ')} n, relative to {best[1]}", OF_THE_BEST, ratio)


def _landscapes(table: Table, singles: list[str]) -> Iterator[Bar]:
    last = _last(table)
    for column, by_method in table.items():
        best = _best(by_method, singles)
        if best is not None and column.endswith(last) and not column.startswith("all"):
            kind, least = column.removesuffix(last), best[0] - BEHIND
            yield Bar("landscapes", f"{kind}, 3 of 30 below {best[1]}", least, by_method.get(JUDGED))


def _violations(part: str, table: Table, singles: list[str], ending: str) -> Iterator[Bar]:
    last = _last(table)
    for column, by_method in table.items():
        best = _best(by_method, singles)
        judged = column.endswith(last) and ending in column and not column.startswith("all")
        if judged and best is not None and best[0] >= WHERE - 1e-9:
            yield Bar(part, f"{column.removesuffix(last)}, as {best[1]} does", FOUND, by_method.get(JUDGED))


def _verdicts(table: Table) -> Iterator[Bar]:
    yield Bar("verdicts", "never cleared where a violation exists", 1.0, table.get("all, not cleared", {}).get(JUDGED))
    for column, by_method in table.items():
        if column.endswith(", found") and not column.startswith("all"):
            yield Bar("verdicts", column, FOUND, by_method.get(JUDGED))


def _last(table: Table) -> str:
    """The ending of the columns of the largest budget."""
    return f" @ {max((int(column.split(' @ ')[1]) for column in table if ' @ ' in column), default=0)}"
