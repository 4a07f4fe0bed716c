"""What a published result is: where it stands, what it says, how it is computed again, and what is expected of that.

Two numbers stand beside ours. The published one, and the one the reconstructed model is known to give (`Model`): the
source leaves out gains and geometry, which were fitted, so that agreement is judged against the model's own value where
one is stated, within its tolerance, and the difference from the published one is always shown. `robots` and `aircraft`
hold the data. Start reading at `Result`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

D_MIN = "d_min"
PLACE = 0.02
"""Share of each range within which a worst case is at the same place: stated for case 1, used for all."""
CHANCE = (
    "all of 8 seeds tried end within 0.003 m of it: mutations beyond a bound end on the bound; "
    "a child equal to a parent is not flown again"
)
"""Of the genetic algorithm's rows."""


@dataclass(frozen=True)
class Case:
    """One case study: its number, its campaign in the library, its parameters in the published order by symbol."""

    number: int
    title: str
    campaign: str
    paths: tuple[tuple[str, str], ...]

    @property
    def symbols(self) -> tuple[str, ...]:
        return tuple(symbol for symbol, _ in self.paths)

    def path(self, symbol: str) -> str:
        """The campaign's path of a published symbol."""
        return dict(self.paths)[symbol]


@dataclass(frozen=True)
class Fly:
    """One flight: nominal but for these values by path."""

    values: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Search:
    """One search with its published settings; of several names the first that this installation knows.

    options it does not know are left out (its defaults are the published settings); start in the case's order.
    """

    title: str
    names: tuple[str, ...]
    evaluations: int
    options: tuple[tuple[str, float | str], ...] = ()
    start: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Corners:
    """The lowest of all corners of the box."""


@dataclass(frozen=True)
class Sweep:
    """One parameter over its bounds, the others nominal: does d_min rise or fall?"""

    symbol: str


How = Fly | Search | Corners | Sweep
Trend = Literal["rises", "falls"]


@dataclass(frozen=True)
class Model:
    """What the reconstructed model gives: value, its tolerance, and the place of it within `place` of each range.

    What is None is not stated. must: the product is held to it.
    """

    value: float | Trend | None = None
    tolerance: float | None = None
    at: tuple[float, ...] | None = None
    place: float | None = None
    must: bool = True


@dataclass(frozen=True)
class Result:
    """One published number (or one of the reconstruction alone, where `published` is None).

    quantity: d_min [m] or the symbol of a parameter of the worst case. variant: another campaign than the case's.
    """

    table: str
    row: str
    case: Case
    how: How
    published: float | Trend | None
    at: tuple[float, ...] | None = None
    quantity: str = D_MIN
    evaluations: int | None = None
    time: str = ""
    model: Model | None = None
    note: str = ""
    variant: str = ""

    @property
    def campaign(self) -> str:
        return self.variant or self.case.campaign


def at(case: Case, values: tuple[float, ...]) -> Fly:
    """A flight at this point, given in the case's order."""
    return Fly(tuple((path, value) for (_, path), value in zip(case.paths, values, strict=True)))


def parameters(worst: Result, table: str, values: tuple[float, ...]) -> Iterator[Result]:
    """The rows of a table of worst-case parameters: one per parameter, found by the search behind `worst`."""
    model = worst.model
    for symbol, value, expected in zip(worst.case.symbols, values, _places(worst), strict=True):
        yield replace(
            worst,
            table=table,
            row=f"{symbol}, {worst.row}",
            published=value,
            quantity=symbol,
            at=None,
            evaluations=None,
            time="",
            model=None if model is None else Model(expected, must=False, place=PLACE),
            note="",
        )


def _places(worst: Result) -> tuple[float | None, ...]:
    at = worst.model.at if worst.model is not None else None
    return at if at is not None else (None,) * len(worst.case.symbols)


def genetic(start: tuple[float, ...] | None = None) -> Search:
    """Population 20, crossover 0.8, roulette selection, 100 generations: 20 evaluations before them, 18 new in each."""
    options = (("population", 20), ("crossover_fraction", 0.8), ("selection", "roulette"), ("generations", 100))
    return Search("GA", ("genetic",), 2020, options, start)


def clustering(samples: int, evaluations: int) -> Search:
    """GLOBAL with UNIRANDI, stopped at the published number of evaluations where there is one."""
    return Search("GLOBAL", ("global_clustering",), evaluations, (("samples", samples), ("local", "unirandi")))


def direct(iterations: int, evaluations: int) -> Search:
    return Search("DIRECT", ("direct",), evaluations, (("iterations", iterations),))


def hybrid(iterations: int, evaluations: int) -> Search:
    """DIRECT as published for itself, then SQP from its best point alone, for which there is room."""
    budget = evaluations + 2000
    options = (("iterations", iterations), ("share", evaluations / budget), ("centres", 1))
    return Search("H-DIRECT", ("hybrid_direct",), budget, options)


def sqp(start: tuple[float, ...]) -> Search:
    return Search("SQP", ("sqp",), 5000, (), start)


def monte_carlo(samples: int) -> Search:
    return Search("Monte Carlo", ("monte_carlo",), samples)
