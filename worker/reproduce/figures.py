"""The data behind the published figures, as CSV: sweeps, distances over time, speeds, paths, samples, convergence.

One file a figure; every column names its unit. Start reading at `write`.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from worker.reproduce import aircraft, robots
from worker.reproduce.aircraft import DECISION, MOVING, STATIC
from worker.reproduce.ours import Flights, NotAvailable
from worker.reproduce.published import Case, How, Search, direct, genetic, monte_carlo, sqp
from worker.reproduce.robots import FIRST_START, PIONEER, SECOND_START, UNICYCLE
from worker.search.base import OK
from worker.trace import trace

Rows = Iterable[Sequence[object]]
TOGETHER = ("m", "C_mde", "C_dt")

SWEEPS: dict[str, tuple[Case, tuple[str, ...]]] = {
    "3.7": (UNICYCLE, ("m",)), "3.8": (UNICYCLE, ("J",)),
    "3.20": (PIONEER, ("m",)), "3.21": (PIONEER, ("I_e",)), "3.22": (PIONEER, ("B_e",)),
    "3.23": (PIONEER, ("delta_u",)), "3.24": (PIONEER, ("delta_w",)), "3.25": (PIONEER, ("u_s",)),
    "3.26": (PIONEER, ("dx",)), "3.27": (PIONEER, ("dy",)),
    "3.32": (STATIC, TOGETHER), "3.34": (MOVING, TOGETHER),
    "7.8": (DECISION, ("m", "C_mde")), "7.9": (DECISION, ("du", "du0")), "7.10": (DECISION, ("dpsi", "dpsi0")),
}  # fmt: skip
"""d_min over each parameter."""

NOMINAL = ("nominal", None)
STARTS = (("fmincon, case 1", sqp(FIRST_START)), ("fmincon, case 2", sqp(SECOND_START)))


def _searches(case: Case, *names: str) -> tuple[tuple[str, Search], ...]:
    """The searches behind rows of a case's tables."""
    results = (*robots.RESULTS, *aircraft.RESULTS)
    return tuple(
        next((n, r.how) for r in results if r.case is case and r.row.startswith(n) and isinstance(r.how, Search))
        for n in names
    )


WORST = {case.number: (NOMINAL, *_searches(case, "DIRECT")) for case in (UNICYCLE, PIONEER, STATIC, MOVING, DECISION)}
LOCAL = ("fmincon, start 1", "fmincon, start 2")

FLIGHTS: dict[str, tuple[Case, tuple[tuple[str, Search | None], ...], str]] = {
    "3.6": (UNICYCLE, (NOMINAL,), "path"), "5.3": (UNICYCLE, WORST[1], "path"),
    "3.16": (PIONEER, (NOMINAL,), "path"), "4.5": (PIONEER, (NOMINAL, *STARTS), "distance"),
    "5.6": (PIONEER, WORST[2], "path"), "5.7": (PIONEER, WORST[2], "distance"),
    "3.31": (STATIC, (NOMINAL,), "path"), "4.6": (STATIC, (NOMINAL, *_searches(STATIC, *LOCAL)), "speed"),
    "5.10": (STATIC, WORST[3], "path"), "5.11": (STATIC, WORST[3], "distance"),
    "3.33": (MOVING, (NOMINAL,), "path"), "4.7": (MOVING, (NOMINAL, *_searches(MOVING, *LOCAL)), "speed"),
    "5.14": (MOVING, WORST[4], "path"), "5.15": (MOVING, WORST[4], "distance"),
    "7.5": (DECISION, (NOMINAL,), "path"), "7.13": (DECISION, WORST[5], "path"),
    "7.14": (DECISION, WORST[5], "distance"),
}  # fmt: skip
"""Flights: nominal, and at the point where a search ended; what of them the figure shows."""

SAMPLES: dict[str, tuple[Case, Search]] = {
    "6.1": (UNICYCLE, monte_carlo(1000)),
    **{f: (c, monte_carlo(5000)) for f, c in (("6.2", PIONEER), ("6.3", STATIC), ("6.4", MOVING), ("7.15", DECISION))},
}
"""Monte Carlo."""

CONVERGENCE: dict[str, tuple[Case, Search]] = {
    "5.2": (UNICYCLE, direct(100, 3000)), "5.5": (PIONEER, direct(200, 8751)), "5.9": (STATIC, direct(500, 18505)),
    "5.12": (MOVING, direct(200, 6061)), "5.13": (MOVING, direct(200, 6061)), "7.12": (DECISION, direct(500, 31697)),
    "5.8": (STATIC, genetic((1.52, -1.13, 11.82))), "7.11": (DECISION, genetic()),
}  # fmt: skip
"""The lowest d_min so far over evaluations."""


def write(folder: Path, flights: Flights, cases: Collection[int]) -> tuple[list[Path], list[str]]:
    """Write the data of every figure of these cases; the files, and a sentence for each that cannot be computed."""
    written: list[Path] = []
    missing: list[str] = []
    for figure, make in _figures(cases).items():
        path = folder / f"figure-{figure}.csv"
        try:
            headings, rows = make(flights)
        except NotAvailable as error:
            missing.append(f"figure {figure}: not available: {error}")
            continue
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(headings)
            writer.writerows([repr(v) if isinstance(v, float) else v for v in row] for row in rows)
        written.append(path)
    return written, missing


Make = Callable[[Flights], tuple[list[str], Rows]]


def _figures(cases: Collection[int]) -> dict[str, Make]:
    made: dict[str, tuple[Case, Make]] = {
        **{f: (case, partial(_sweep, case=case, symbols=symbols)) for f, (case, symbols) in SWEEPS.items()},
        **{f: (case, partial(_flights, case=case, shown=shown, what=w)) for f, (case, shown, w) in FLIGHTS.items()},
        **{f: (case, partial(_samples, case=case, how=how)) for f, (case, how) in SAMPLES.items()},
        **{f: (case, partial(_convergence, case=case, how=how)) for f, (case, how) in CONVERGENCE.items()},
    }
    order = sorted(made, key=lambda figure: [int(n) for n in figure.split(".")])
    return {figure: made[figure][1] for figure in order if made[figure][0].number in cases}


def _sweep(flights: Flights, case: Case, symbols: Sequence[str]) -> tuple[list[str], Rows]:
    opened = flights.open(case.campaign)
    opened.require(path for _, path in case.paths)
    columns = []
    headings = ["share of the range [-]"]
    for symbol in symbols:
        path = case.path(symbol)
        unit = opened.campaign.uncertain[path].unit or "-"
        values, costs = opened.sweep(path)
        columns += [values, costs]
        headings += [f"{symbol} [{unit}]", f"d_min over {symbol} [m]"]
    shares = np.linspace(0.0, 1.0, len(columns[0]))
    return headings, np.column_stack([shares, *columns]).tolist()


def _flights(
    flights: Flights, case: Case, shown: Sequence[tuple[str, Search | None]], what: str
) -> tuple[list[str], Rows]:
    opened = flights.open(case.campaign)
    opened.require(path for _, path in case.paths)
    problem = opened.problem
    headings: list[str] = []
    rows: list[list[object]] = []
    for name, how in shown:
        at = {} if how is None else flights.computed(case.campaign, case, how).at or {}
        flown = trace(problem, name, at)
        kept = [i for i, c in enumerate(flown.columns) if _shows(what, c)]
        headings = ["flight", *(f"{flown.columns[i]['name']} [{flown.columns[i]['unit']}]" for i in kept)]
        rows += [[name, *values] for values in flown.data[:, kept].tolist()]
    return headings, rows


def _shows(what: str, column: dict[str, str]) -> bool:
    """Which columns of a trace a figure of this kind shows: always the time."""
    if column["name"] == "t":
        return True
    if what == "speed":
        return column["name"] in ("u", "v", "w", "speed")
    return column["group"] == {"distance": "separation", "path": "pose"}[what]


def _samples(flights: Flights, case: Case, how: How) -> tuple[list[str], Rows]:
    flights.computed(case.campaign, case, how)
    columns = flights.columns[case.campaign, how]
    opened = flights.opened[case.campaign]
    headings = ["run", "d_min [m]", *(_with_unit(opened.campaign.uncertain[p].unit, s) for s, p in case.paths)]
    order = [[r.path for r in opened.problem.ranges].index(p) for _, p in case.paths]
    values = opened.problem.values(columns.points)[:, order].tolist()
    costs = columns.costs[:, 0].tolist()
    return headings, ([i, cost, *row] for i, (cost, row) in enumerate(zip(costs, values, strict=True), 1))


def _with_unit(unit: str | None, symbol: str) -> str:
    return f"{symbol} [{unit or '-'}]"


def _convergence(flights: Flights, case: Case, how: How) -> tuple[list[str], Rows]:
    flights.computed(case.campaign, case, how)
    columns = flights.columns[case.campaign, how]
    best = np.minimum.accumulate(np.where(columns.status == OK, columns.costs[:, 0], np.inf))
    better = np.flatnonzero(np.r_[True, np.diff(best) < 0.0] & np.isfinite(best))
    kept = np.unique(np.r_[better, len(best) - 1])
    return ["evaluations", "lowest d_min [m]"], ([int(i) + 1, float(best[i])] for i in kept)
