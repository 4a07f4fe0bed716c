"""What a search method is: a generator that yields points of the unit cube and receives their batch.

The driver counts, stores, stops at the budget and keeps the best point; a method only chooses points.
Start reading at `Method`.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns.results.base import OK

Floats = NDArray[np.float64]


class Batch(NamedTuple):
    """What the points of one request cost: costs (m, k), NaN where not ok; status (m,) uint8, numbered as `STATUS`."""

    costs: Floats
    status: NDArray[np.uint8]

    def ranked(self) -> Floats:
        """The first criterion's costs (m,) with infinity where not ok: for comparing only, it is nobody's value."""
        return np.where(self.status == OK, self.costs[:, 0], np.inf)


class Minimum(NamedTuple):
    """A local minimum a method ended at: point (n,), cost, the start it came from, evaluations spent, how it ended."""

    point: Floats
    cost: float
    start: Floats | None
    evaluations: int
    text: str


@dataclass(frozen=True)
class Space:
    """What a method is given: the unit cube of `dimension`, its budget, seeded randomness, starts and distributions.

    starts (s, n); quantile maps uniform numbers (m, n) to points drawn from the campaign's distributions; report
    hands over a local minimum as soon as it is found, so that none is lost when the budget ends; attribute tells, just
    before a request and in its order, which member of a method asks for how many of its points. A cost at or below the
    threshold is a violation; confidence is that of statements on its probability.
    """

    dimension: int
    budget: int
    random: np.random.Generator
    starts: Floats
    quantile: Callable[[Floats], Floats]
    report: Callable[[Minimum], None]
    attribute: Callable[[str, int], None] = lambda member, points: None
    threshold: float = float("-inf")
    confidence: float = 0.95


class Ended(str):
    """The sentence of the rule by which a search stopped, with the rule's code and the numbers in the sentence.

    `Ended("iterations", "did the {iterations} iterations asked for", iterations=100)`. A number is named in braces,
    with its significant digits where it is no whole number: `{width:.3g}`; what stands there may be such a sentence
    itself. A method may return a plain string: it has no code. `campaigns.claims.codes.StopCode` lists the codes.
    """

    code: str
    template: str
    values: dict[str, Any]

    def __new__(cls, code: str, template: str, **values: Any) -> Ended:
        made = super().__new__(cls, template.format(**values))
        made.code, made.template, made.values = code, template, values
        return made


Search = Generator[Floats, Batch, str]
"""Yields points (m, n), receives their `Batch`, returns the sentence of the rule by which it stopped: `Ended`."""


@dataclass(frozen=True)
class MethodLook:
    """Its colour token, its marker and its name in narrow tables: see `campaigns.looks.MethodLook`."""

    colour: str
    marker: str
    short: str = ""


@dataclass(frozen=True)
class Method:
    """A search method: its options' defaults are the published settings.

    `kind`: global methods must agree before anything is cleared; a random one draws from the distributions; a multi one
    looks for the front of several criteria.
    `starts`: it begins at points that the campaign may give.
    `repeats`: it may ask for a point twice; the driver answers the second time from memory.
    `extend`: the options under which a finished search goes on for at least so many evaluations more, the same ones
    first; None where it cannot be continued.
    `compiles`: it compiles parts of itself when it first runs; the driver lets it do so before time is counted.
    `look`: its colour and marker in charts; grey with a ring without one.
    """

    name: str
    title: str
    kind: Literal["global", "local", "random", "multi"]
    how: str
    source: str
    evaluations: int
    options: type
    search: Callable[[Space, Any], Search]
    repeats: bool = False
    starts: bool = False
    extend: Callable[[Any, int], Any] | None = None
    compiles: bool = False
    look: MethodLook | None = None


AT_ONCE = 256
"""Searches that `side_by_side` keeps going at a time: each may hold a thread."""


def side_by_side(searches: list[Search], at_once: int = AT_ONCE) -> Generator[Floats, Batch, list[str]]:
    """Advance several searches together: one request holds the points that all of them want next.

    Where there are more than `at_once`, the next begins when one has ended. Their order is the order given, so that
    the outcome depends on nothing else. Returns their sentences.
    """
    said = [""] * len(searches)
    wanted: dict[int, Floats] = {}
    begun = 0
    try:
        while True:
            while len(wanted) < at_once and begun < len(searches):
                _advance(begun, searches[begun], None, wanted, said)
                begun += 1
            if not wanted:
                return said
            order = sorted(wanted)
            batch = yield np.concatenate([wanted[i] for i in order])
            ends = np.cumsum([len(wanted[i]) for i in order])
            for i, end in zip(order, ends, strict=True):
                first = end - len(wanted[i])
                _advance(i, searches[i], Batch(batch.costs[first:end], batch.status[first:end]), wanted, said)
    finally:
        for search in searches:
            search.close()


def _advance(i: int, search: Search, batch: Batch | None, wanted: dict[int, Floats], said: list[str]) -> None:
    try:
        wanted[i] = next(search) if batch is None else search.send(batch)
    except StopIteration as end:
        wanted.pop(i, None)
        said[i] = end.value or ""
