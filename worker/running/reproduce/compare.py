"""Compares computed values with the published ones and with the known values of the reconstructed model.

`Row` is one line of the output.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from worker.engine.problem.problem import Problem
from worker.running.reproduce import aircraft, robots
from worker.running.reproduce.ours import Flights, Found, NotAvailable
from worker.running.reproduce.published import D_MIN, Case, Model, Result, Search

Value = float | str | None


@dataclass(frozen=True)
class Spent:
    """The effort for a value: evaluations, and the time as published or, for ours, in seconds."""

    evaluations: int | None
    time: str | float | None


@dataclass(frozen=True)
class Row:
    """One published number and ours.

    model: the known value of the reconstructed model; tolerance: for the difference of ours to it, in `unit`, or None.
    place: fraction of each range within which `ours_at` must be of `model_at`, or None. agrees: whether both hold; None
    if neither is stated or, with `available` false, nothing was computed. must: whether it is an error that it
    does not agree, also where it is not available.
    The `..._at` are parameter values by path.
    """

    table: str
    row: str
    case: int
    campaign: str
    quantity: str
    unit: str
    method: str
    published: Value
    ours: Value
    model: Value
    tolerance: float | None
    place: float | None
    agrees: bool | None
    must: bool
    available: bool
    published_at: dict[str, float] | None
    ours_at: dict[str, float] | None
    model_at: dict[str, float] | None
    published_spent: Spent
    ours_spent: Spent
    note: str

    @property
    def difference(self) -> float | None:
        """Ours minus the published value."""
        if isinstance(self.ours, float) and isinstance(self.published, float):
            return self.ours - self.published
        return None

    @property
    def broken(self) -> bool:
        """Whether the row must agree and does not, also where nothing was computed."""
        return self.must and self.agrees is not True


@dataclass(frozen=True)
class Reproduction:
    """All rows, the computation time, and the compilation time [s]."""

    rows: tuple[Row, ...]
    seconds: float
    compile_seconds: float

    def longer(self, seconds: float, compile_seconds: float) -> Reproduction:
        """The reproduction with further times added [s]."""
        return Reproduction(self.rows, self.seconds + seconds, self.compile_seconds + compile_seconds)


RESULTS: tuple[Result, ...] = (*robots.RESULTS, *aircraft.RESULTS)


def tables(published: Sequence[Result] | None = None) -> list[str]:
    """Every table, figure and section with results, in the published order."""
    return sorted({r.table for r in (RESULTS if published is None else published)}, key=_order)


def _order(table: str) -> tuple[list[int], str]:
    number = _number(table)
    return ([int(part) for part in number.split(".")] if number[0].isdigit() else [99], table)


def chosen(names: Sequence[str], published: Sequence[Result] | None = None) -> list[str]:
    """The tables selected by these names, each a table or a chapter; raises ValueError for an unknown name."""
    known = tables(published)
    if not names:
        return known
    found = []
    for name in names:
        means = [t for t in known if name in (t, _number(t)) or _number(t).startswith(f"{name}.")]
        if not means:
            raise ValueError(f"unknown table {name!r}; choose from {', '.join(known)}")
        found.extend(means)
    return [t for t in known if t in found]


def _number(table: str) -> str:
    """The number of a table's name: 3.7 of "figure 3.7"."""
    return table.rpartition(" ")[2]


def reproduce(
    names: Sequence[str] = (),
    flights: Flights | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
    published: Sequence[Result] | None = None,
) -> Reproduction:
    """Compute every row of the named tables, by default of all tables."""
    wanted = set(chosen(names, published))
    results = sorted(
        (r for r in (RESULTS if published is None else published) if r.table in wanted), key=lambda r: _order(r.table)
    )
    flights = flights or Flights()
    began, compiled = time.perf_counter(), flights.compile_seconds
    rows = []
    for done, result in enumerate(results):
        progress(done, len(results))
        rows.append(_row(flights, result))
    progress(len(results), len(results))
    spent = flights.compile_seconds - compiled
    return Reproduction(tuple(rows), time.perf_counter() - began - spent, spent)


def _row(flights: Flights, result: Result) -> Row:
    try:
        found, missing = flights.found(result), ""
    except NotAvailable as error:
        found, missing = Found(None), f"not available: {error}"
    problem = flights.opened[result.campaign].problem if result.campaign in flights.opened else None
    model, case = result.model or Model(must=False), result.case
    tolerance, place = model.tolerance, model.place
    if result.quantity != D_MIN and place is not None:  # the row is about one coordinate of the worst case
        width = None if problem is None else _range(problem, case.path(result.quantity))
        tolerance, place = None if width is None else place * width, None
    row = Row(
        table=result.table,
        row=result.row,
        case=case.number,
        campaign=result.campaign,
        quantity=result.quantity,
        unit=_unit(problem, result),
        method=result.how.title if isinstance(result.how, Search) else "",
        published=result.published,
        ours=found.value,
        model=model.value,
        tolerance=tolerance,
        place=place,
        agrees=None,
        must=model.must,
        available=not missing,
        published_at=None if result.at is None else _named(case, result.at),
        ours_at=None if found.at is None else {path: found.at[path] for _, path in case.paths},
        model_at=None if model.at is None else _named(case, model.at),
        published_spent=Spent(result.evaluations, result.time or None),
        ours_spent=Spent(found.evaluations, found.seconds),
        note="; ".join(filter(None, (missing, result.note, found.note))),
    )
    return row if problem is None else _judged(row, problem)


def _judged(row: Row, problem: Problem) -> Row:
    if row.ours is None:
        return replace(row, agrees=False) if row.available and row.model is not None else row
    comparisons = []
    if isinstance(row.ours, str):
        comparisons = [row.ours == expected for expected in (row.published, row.model) if expected is not None]
    if row.tolerance is not None and isinstance(row.ours, float) and isinstance(row.model, float):
        comparisons.append(abs(row.ours - row.model) <= row.tolerance)
    if row.place is not None and row.ours_at is not None and row.model_at is not None:
        comparisons.extend(
            abs(row.ours_at[path] - value) <= row.place * (_range(problem, path) or 0.0) * (1.0 + 1e-9)
            for path, value in row.model_at.items()
        )
    return replace(row, agrees=all(comparisons) if comparisons else None)


def _range(problem: Problem, path: str) -> float | None:
    return next((r.high - r.low for r in problem.ranges if r.path == path), None)


def _named(case: Case, point: tuple[float, ...]) -> dict[str, float]:
    return {path: value for (_, path), value in zip(case.paths, point, strict=True)}


def _unit(problem: Problem | None, result: Result) -> str:
    if result.quantity == D_MIN:
        return "m"
    uncertain = None if problem is None else problem.campaign.uncertain.get(result.case.path(result.quantity))
    return "" if uncertain is None else uncertain.unit or ""
