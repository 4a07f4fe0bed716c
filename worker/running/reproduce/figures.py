"""Data of the published figures as CSV: sweeps, distances over time, speeds, paths, samples, convergence.

One file per figure; every column header states its unit.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from campaigns.cells import Writer
from campaigns.results.base import OK
from campaigns.results.trace import TraceColumn
from worker.running.reproduce import aircraft, robots
from worker.running.reproduce.aircraft import DECISION, MOVING, STATIC
from worker.running.reproduce.ours import Flights, NotAvailable
from worker.running.reproduce.published import Case, Fly, How, Search, direct, genetic, monte_carlo
from worker.running.reproduce.robots import PIONEER, UNICYCLE

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
"""Figures of d_min over each parameter."""


class Shown(NamedTuple):
    """Trajectories of one figure: what it shows, and for each its values or the search whose worst case it is."""

    case: Case
    what: Literal["path", "distance", "speed"]
    flights: tuple[tuple[str, Fly | Search], ...]
    variant: str = ""


NOMINAL = ("nominal", Fly())


def _searches(case: Case, *names: str) -> tuple[tuple[str, Search], ...]:
    """The searches behind rows of a case's tables."""
    results = (*robots.RESULTS, *aircraft.RESULTS)
    return tuple(
        next((n, r.how) for r in results if r.case is case and r.row.startswith(n) and isinstance(r.how, Search))
        for n in names
    )


WORST = {
    case.number: (NOMINAL, ("worst", _searches(case, "DIRECT")[0][1]))
    for case in (UNICYCLE, PIONEER, STATIC, MOVING, DECISION)
}
STARTS = ("fmincon, start 1", "fmincon, start 2")
ALONE = (NOMINAL,)

FLIGHTS = {
    "3.6": Shown(UNICYCLE, "path", ALONE),
    "5.3": Shown(UNICYCLE, "path", WORST[1]),
    "5.4": Shown(UNICYCLE, "path", WORST[1], "unicycle_two_obstacles"),
    "3.16-3.19": Shown(PIONEER, "path", ALONE),
    "4.5": Shown(PIONEER, "distance", (NOMINAL, *_searches(PIONEER, "fmincon, case 1", "fmincon, case 2"))),
    "5.6": Shown(PIONEER, "path", WORST[2]),
    "5.7": Shown(PIONEER, "distance", WORST[2]),
    "3.31": Shown(STATIC, "path", ALONE),
    "4.6": Shown(STATIC, "speed", (NOMINAL, *_searches(STATIC, *STARTS))),
    "5.10": Shown(STATIC, "path", WORST[3]),
    "5.11": Shown(STATIC, "distance", WORST[3]),
    "3.33": Shown(MOVING, "path", ALONE),
    "4.7": Shown(MOVING, "speed", (NOMINAL, *_searches(MOVING, *STARTS))),
    "5.14": Shown(MOVING, "path", WORST[4]),
    "5.15": Shown(MOVING, "distance", WORST[4]),
    "7.4": Shown(DECISION, "path", (("no avoidance", Fly((("avoider.range", 0.0),))),)),
    "7.5-7.7": Shown(DECISION, "path", ALONE),
    "7.13": Shown(DECISION, "path", WORST[5]),
    "7.14": Shown(DECISION, "distance", WORST[5]),
}

SAMPLES: dict[str, tuple[Case, Search]] = {
    "6.1": (UNICYCLE, monte_carlo(1000)),
    **{f: (c, monte_carlo(5000)) for f, c in (("6.2", PIONEER), ("6.3", STATIC), ("6.4", MOVING), ("7.15", DECISION))},
}
"""Figures of Monte Carlo samples."""

CONVERGENCE: dict[str, tuple[Case, Search]] = {
    "5.2": (UNICYCLE, direct(100, 3000)), "5.5": (PIONEER, direct(200, 8751)), "5.9": (STATIC, direct(500, 18505)),
    "5.12": (MOVING, direct(200, 6061)), "5.13": (MOVING, direct(200, 6061)), "7.12": (DECISION, direct(500, 31697)),
    "5.8": (STATIC, genetic((1.52, -1.13, 11.82))), "7.11": (DECISION, genetic()),
}  # fmt: skip
"""Figures of the lowest d_min so far over evaluations."""


def write(folder: Path, flights: Flights, cases: Collection[int]) -> tuple[list[Path], list[str]]:
    """Write the data of every figure of these cases; returns the files, and a sentence for each unavailable figure."""
    written: list[Path] = []
    missing: list[str] = []
    for figure, make in _figures(cases).items():
        path = folder / f"figure-{figure}.csv"
        try:
            headings, rows = make(flights)
        except NotAvailable as error:
            missing.append(f"figure {figure}: not available: {error}")
            path.unlink(missing_ok=True)  # of an earlier command
            continue
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = Writer(file)
            writer.writerow(headings)
            writer.writerows([repr(v) if isinstance(v, float) else v for v in row] for row in rows)
        written.append(path)
    return written, missing


Make = Callable[[Flights], tuple[list[str], Rows]]


def _figures(cases: Collection[int]) -> dict[str, Make]:
    made: dict[str, tuple[Case, Make]] = {
        **{f: (case, partial(_sweep, case=case, symbols=symbols)) for f, (case, symbols) in SWEEPS.items()},
        **{f: (shown.case, partial(_flights, shown=shown)) for f, shown in FLIGHTS.items()},
        **{f: (case, partial(_samples, case=case, how=how)) for f, (case, how) in SAMPLES.items()},
        **{f: (case, partial(_convergence, case=case, how=how)) for f, (case, how) in CONVERGENCE.items()},
    }
    order = sorted(made, key=lambda figure: [int(n) for n in figure.split("-")[0].split(".")])
    return {figure: made[figure][1] for figure in order if made[figure][0].number in cases}


def _sweep(flights: Flights, case: Case, symbols: Sequence[str]) -> tuple[list[str], Rows]:
    opened = flights.open(case.campaign)
    opened.require(path for _, path in case.paths)
    columns = []
    headings = ["fraction of the range [-]"]
    for symbol in symbols:
        path = case.path(symbol)
        unit = opened.campaign.uncertain[path].unit or "-"
        values, costs = opened.sweep(path)
        columns += [values, costs]
        headings += [f"{symbol} [{unit}]", f"d_min over {symbol} [m]"]
    fractions = np.linspace(0.0, 1.0, len(columns[0]))
    return headings, np.column_stack([fractions, *columns]).tolist()


def _flights(flights: Flights, shown: Shown) -> tuple[list[str], Rows]:
    headings: list[str] = []
    rows: list[list[object]] = []
    for name, how in shown.flights:
        if isinstance(how, Fly):
            values = dict(how.values)
        else:
            values = flights.computed(shown.case.campaign, shown.case, how).at or {}
        simulated = flights.traced(shown.variant or shown.case.campaign, name, values)
        kept = [i for i, c in enumerate(simulated.columns) if _shows(shown.what, c)]
        headings = ["flight", *(f"{simulated.columns[i].name} [{simulated.columns[i].unit}]" for i in kept)]
        rows += [[name, *row] for row in simulated.data[:, kept].tolist()]
    return headings, rows


def _shows(what: str, column: TraceColumn) -> bool:
    """Whether a figure of this kind shows this column of a trace; the time is always shown."""
    if column.name == "t":
        return True
    if what == "speed":
        return column.name in ("u", "v", "w", "speed")
    return column.group == {"distance": "separation", "path": "pose"}[what]


def _samples(flights: Flights, case: Case, how: How) -> tuple[list[str], Rows]:
    flights.computed(case.campaign, case, how)
    columns = flights.columns[case.campaign, how]
    opened = flights.opened[case.campaign]
    uncertain = opened.campaign.uncertain
    headings = ["run", "d_min [m]", *(f"{symbol} [{uncertain[path].unit or '-'}]" for symbol, path in case.paths)]
    order = [[r.path for r in opened.problem.ranges].index(p) for _, p in case.paths]
    values = opened.problem.values(columns.points)[:, order].tolist()
    costs = columns.costs[:, 0].tolist()
    return headings, ([i, cost, *row] for i, (cost, row) in enumerate(zip(costs, values, strict=True), 1))


def _convergence(flights: Flights, case: Case, how: How) -> tuple[list[str], Rows]:
    flights.computed(case.campaign, case, how)
    columns = flights.columns[case.campaign, how]
    best = np.minimum.accumulate(np.where(columns.status == OK, columns.costs[:, 0], np.inf))
    better = np.flatnonzero(np.r_[True, np.diff(best) < 0.0] & np.isfinite(best))
    kept = np.unique(np.r_[better, len(best) - 1])
    return ["evaluations", "lowest d_min [m]"], ([int(i) + 1, float(best[i])] for i in kept)
