"""Definition of a published result: its table, its value, how it is computed again, and the expected value.

Ours is compared with two numbers: the published one, and the known value of the reconstructed model (`Model`). The
source leaves out gains and geometry, which were fitted, so agreement is judged against the model's value, within its
tolerance, if one is stated. The difference from the published value is always shown. `robots` and `aircraft` hold the
data.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

D_MIN = "d_min"
PLACE = 0.02
"""Fraction of each range within which two worst cases count as the same point: stated for case 1, used for all."""
CHANCE = (
    "all of 8 seeds tried end within 0.003 m of it: mutations beyond a bound end on the bound; "
    "a child equal to a parent is not evaluated again"
)
"""The note on rows of the genetic algorithm."""


@dataclass(frozen=True)
class Case:
    """One case study: number, campaign in the library, and parameters by symbol in the published order."""

    number: int
    campaign: str
    paths: tuple[tuple[str, str], ...]

    @property
    def symbols(self) -> tuple[str, ...]:
        return tuple(symbol for symbol, _ in self.paths)

    def path(self, symbol: str) -> str:
        """The campaign's path for a published symbol."""
        return dict(self.paths)[symbol]


@dataclass(frozen=True)
class Fly:
    """One simulation: nominal except for these values by path."""

    values: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Search:
    """One search with its published settings; names: method names, of which the first installed one is used.

    Options that the method does not have are left out, since its defaults are the published settings. start: in the
    case's order of parameters.
    """

    title: str
    names: tuple[str, ...]
    evaluations: int
    options: tuple[tuple[str, float | str], ...] = ()
    start: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Corners:
    """The lowest value at the corners of the box."""


@dataclass(frozen=True)
class Sweep:
    """One parameter over its range, the others nominal: whether d_min rises or falls."""

    symbol: str


How = Fly | Search | Corners | Sweep
Trend = Literal["rises", "falls"]


@dataclass(frozen=True)
class Model:
    """The known result of the reconstructed model: value and tolerance, point and allowed fraction of each range.

    None means not stated. must: whether it is an error that a row does not agree.
    """

    value: float | Trend | None = None
    tolerance: float | None = None
    at: tuple[float, ...] | None = None
    place: float | None = None
    must: bool = True


@dataclass(frozen=True)
class Result:
    """One published number; if `published` is None, a number of the reconstruction only.

    quantity: d_min [m] or the symbol of a parameter of the worst case. variant: the campaign, if not the case's.
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
    """A simulation at this point, given in the case's order of parameters."""
    return Fly(tuple((path, value) for (_, path), value in zip(case.paths, values, strict=True)))


def parameters(worst: Result, table: str, values: tuple[float, ...]) -> Iterator[Result]:
    """The rows of a table of worst-case parameters: one per parameter, from the search of `worst`."""
    model, symbols = worst.model, worst.case.symbols
    known = (model and model.at) or (None,) * len(symbols)
    for symbol, value, expected in zip(symbols, values, known, strict=True):
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


def genetic(start: tuple[float, ...] | None = None) -> Search:
    """Population 20, crossover 0.8, roulette selection, 100 generations: 20 initial evaluations, 18 per generation."""
    options = (
        ("population", 20), ("crossover_fraction", 0.8), ("selection", "roulette"), ("generations", 100),
        ("as_published", True),
    )  # fmt: skip
    return Search("GA", ("genetic",), 2020, options, start)


def clustering(samples: int, evaluations: int) -> Search:
    """GLOBAL with UNIRANDI, stopped at the published number of evaluations if there is one."""
    options = (("samples", samples), ("local", "unirandi"), ("as_published", True))
    return Search("GLOBAL", ("global_clustering",), evaluations, options)


def direct(iterations: int, evaluations: int) -> Search:
    return Search("DIRECT", ("direct",), evaluations, (("iterations", iterations),))


def hybrid(iterations: int, evaluations: int) -> Search:
    """DIRECT with its published settings, then SQP from its best point, with 2000 further evaluations."""
    budget = evaluations + 2000
    options = (("iterations", iterations), ("share", evaluations / budget), ("centres", 1))
    return Search("H-DIRECT", ("hybrid_direct",), budget, options)


def sqp(start: tuple[float, ...]) -> Search:
    return Search("SQP", ("sqp",), 5000, (), start)


def monte_carlo(samples: int) -> Search:
    return Search("Monte Carlo", ("monte_carlo",), samples)
