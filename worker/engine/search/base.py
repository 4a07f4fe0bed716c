"""What a search method is: a generator that yields points of the unit cube and receives their batch.

The driver counts, stores, stops at the budget and tracks the best point; a method only chooses points.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field, is_dataclass, replace
from itertools import accumulate
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from campaigns.effort import Descents, Iterations
from campaigns.results.base import OK

Floats = NDArray[np.float64]


class Batch(NamedTuple):
    """The result of one request: costs (m, k), NaN where not ok; status (m,) uint8, numbered as `STATUS`."""

    costs: Floats
    status: NDArray[np.uint8]

    def ranked(self) -> Floats:
        """The first criterion's costs (m,) with infinity where not ok: for comparisons only, it is not a value."""
        return np.where(self.status == OK, self.costs[:, 0], np.inf)

    def split(self, lengths: Sequence[int]) -> list[Batch]:
        """The batches of the parts of a request, in their order."""
        ends = accumulate(lengths)
        rows = [slice(end - length, end) for length, end in zip(lengths, ends, strict=True)]
        return [Batch(self.costs[some], self.status[some]) for some in rows]


@dataclass
class Several:
    """A request of several groups of points at once, each by its number; the batch of one group is received.

    The others continue: the next request adds further groups, or none. `answered` is the number of the received group,
    which is the first of those begun to be complete. Only for a `Space` with slots.
    """

    groups: list[tuple[int, Floats]]
    answered: int = -1


class Minimum(NamedTuple):
    """A local minimum at which a method ended: point (n,), cost, the start it came from, evaluations spent, how it
    ended."""

    point: Floats
    cost: float
    start: Floats | None
    evaluations: int
    text: str


@dataclass(frozen=True)
class Space:
    """The input of a method: the unit cube of `dimension`, its budget, seeded randomness, starts and distributions.

    starts (s, n); quantile maps uniform samples (m, n) to points drawn from the campaign's distributions; report
    passes on a local minimum as soon as it is found, so that none is lost when the budget ends; attribute states, just
    before a request and in its order, which member of a method requests how many of its points. A cost at or below the
    threshold is a violation; confidence is that of statements on its probability. slots: number of evaluations that run
    side by side and end in any order; 0: a batch is evaluated as a whole, and a request must not be `Several`. What a
    method requests must not depend on their number, which may be another one when the run is resumed.
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
    slots: int = 0

    def of_member(self, budget: int, starts: Floats) -> Space:
        """The space of a member: with random numbers of its own, in batches, and without attributions of its own."""
        random = np.random.default_rng(self.random.integers(2**63))
        return replace(
            self, budget=budget, random=random, starts=starts, attribute=lambda member, points: None, slots=0
        )


class Ended(str):
    """The sentence of the rule by which a search stopped, with the rule's code and the numbers in the sentence.

    `Ended("iterations", "completed the {iterations} iterations", iterations=100)`. A number is named in braces,
    with its significant digits if it is not a whole number: `{width:.3g}`; the value may itself be such a sentence.
    A method may return a plain string, which has no code. `campaigns.codes.StopCode` lists the codes.
    """

    code: str
    template: str
    values: dict[str, object]

    def __new__(cls, code: str, template: str, **values: object) -> Ended:
        template = numbered(template, [name for name, value in values.items() if value == 1])
        made = super().__new__(cls, template.format(**values))
        made.code, made.template, made.values = code, template, values
        return made


def numbered(template: str, ones: Sequence[str]) -> str:
    """The template with a noun in the singular after each number that is 1: "{iterations} iteration"."""
    for name in ones:
        template = re.sub(rf"(\{{{name}\}} [a-z]+)s\b", r"\1", template)
    return template


Search = Generator[Floats, Batch, str]
"""Yields points (m, n), receives their `Batch`, returns the sentence of the rule by which it stopped: `Ended`."""

Parallel = Generator[Floats | Several, Batch, str]
"""A search that may also request several groups at once, in a space with slots."""


@dataclass(frozen=True)
class Sampling:
    """What the points of a random method support: as an independent sample, a bound on P(violation)."""

    points: str = "samples drawn from the stated distributions"
    barred: str = ""
    """Why they give no bound; empty if they do."""
    looks: int = 0
    """Interim analyses up to now, after each of which the sample could have ended."""
    level: float | None = None
    """The confidence that each needs for all of them to hold together; None without any."""


class Boxes(Protocol):
    """The rectangles into which a method has divided the cube."""

    count: int
    depth: NDArray[np.int64]
    """Divisions of each side into three (count or more, n)."""
    value: Floats
    """At the centre."""
    lost: NDArray[np.bool_]
    """Whether the centre has no value."""


@dataclass(frozen=True)
class MethodLook:
    """Its colour #rrggbb, its marker, its name in narrow tables, and its colour in the dark theme if that differs.

    See `campaigns.looks.MethodLook`, which also has named pairs of colours.
    """

    colour: str
    marker: str
    short: str = ""
    dark: str = ""


@dataclass(frozen=True)
class Method:
    """A search method: its options' defaults are the published settings.

    `kind`: global methods must agree before anything is cleared; a random one draws from the distributions; a multi one
    searches for the Pareto front of several criteria.
    `starts`: it begins at points that the campaign may specify.
    `repeats`: it may request a point twice; the driver answers the second request from memory.
    `extend`: the options that extend a finished search by at least so many evaluations, the same ones first; None if it
    cannot be extended.
    `compiles`: it compiles parts of itself when it first runs; the driver does this before it measures time.
    `costly`: it takes milliseconds of its own per evaluation, for evaluations that take longer; tests and benchmarks
    give it smaller budgets.
    `family`: the principle by which it searches; methods of one family do not confirm each other. `families`: where an
    option decides it, by option and value.
    `apart`: families of its members, by method, that do not use the others' evaluations: what such a member
    reaches, it confirms. `together`: families of those that use them, by method; together they are one witness, and no
    method of any of these families confirms it.
    `whole_budget`: it uses its whole budget; others may end by their own rule, after their `effort` if it is known.
    `own_rule`: the options with which it may end by its own rule all the same, at other values than their defaults.
    `most_parameters`: by option and value, the largest number of uncertain parameters with which it can begin, where a
    value limits it; campaigns with more are refused.
    `parallel`, `at_once`: how many points it requests at a time, in a few words; the option that states this number.
    `takes`: the option that states the time of an evaluation [s].
    `suits`: what it is for, in a few words.
    `drawback`: of a method that few problems of the score board prefer, by how much others are better, in figures.
    `proposed`: its rank among the methods that are proposed, from 1; 0 for one that never is.
    `confirms`: evaluations per parameter from which its parts that are apart can confirm each other.
    `sampling`: of a random method, what so many points with these options support at a confidence.
    `divide`: of a method that divides the cube, its rectangles, and the search with these options that fills them.
    `earlier`: its names in earlier versions.
    `look`: its colours and marker in charts; grey with a ring without one.
    """

    name: str
    title: str
    kind: Literal["global", "local", "random", "multi"]
    how: str
    source: str
    evaluations: int
    options: type
    search: Callable[[Space, Any], Parallel]
    repeats: bool = False
    starts: bool = False
    extend: Callable[[Any, int], Any] | None = None
    compiles: bool = False
    costly: bool = False
    family: str = ""
    families: Mapping[str, Mapping[str, str]] = field(default_factory=dict, hash=False)
    apart: Mapping[str, str] = field(default_factory=dict, hash=False)
    together: Mapping[str, str] = field(default_factory=dict, hash=False)
    whole_budget: bool = False
    own_rule: str = ""
    most_parameters: Mapping[str, Mapping[str, int]] = field(default_factory=dict, hash=False)
    effort: Iterations | Descents | None = None
    parallel: str = ""
    at_once: str = ""
    takes: str = ""
    suits: str = ""
    drawback: str = ""
    proposed: int = 0
    confirms: int = 0
    earlier: tuple[str, ...] = ()
    look: MethodLook | None = None
    sampling: Callable[[Any, int, float], Sampling] = lambda options, drawn, confidence: Sampling()
    divide: Callable[[int, Any], tuple[Boxes, Search]] | None = None

    def __post_init__(self) -> None:
        if not is_dataclass(self.options):
            text = f"method {self.name!r}: options is {self.options!r}; give a dataclass, a described field per option"
            raise TypeError(text)

    def family_with(self, options: Any) -> str:
        """Its family with these options; its name if it declares none."""
        chosen = (by.get(str(getattr(options, name))) for name, by in self.families.items())
        return next((family for family in chosen if family), self.family or self.name)


AT_ONCE = 256
"""Searches that `side_by_side` runs at a time: each may hold a thread."""


def side_by_side(
    searches: list[Search], at_once: int = AT_ONCE, in_slots: bool = False
) -> Generator[Any, Batch, list[str]]:
    """Advance several searches together: one request contains the next points of all of them. Returns their sentences.

    If there are more than `at_once`, the next begins when one has ended. Their order is the given order, so the
    outcome depends on nothing else. in_slots: each continues once its own points have ended; requests are `Several`.
    """
    endings = [""] * len(searches)
    wanted: dict[int, Floats] = {}
    begun = 0
    further: list[int] = []
    try:
        while True:
            while len(wanted) < at_once and begun < len(searches):
                if _advance(begun, searches[begun], None, wanted, endings):
                    further.append(begun)
                begun += 1
            if not wanted:
                return endings
            if in_slots:
                request = Several([(i, wanted[i]) for i in further])
                batch = yield request
                answers = {request.answered: batch}
            else:
                order = sorted(wanted)
                batch = yield np.concatenate([wanted[i] for i in order])
                answers = dict(zip(order, batch.split([len(wanted[i]) for i in order]), strict=True))
            further = [i for i, answer in answers.items() if _advance(i, searches[i], answer, wanted, endings)]
    finally:
        for search in searches:
            search.close()


def _advance(i: int, search: Search, batch: Batch | None, wanted: dict[int, Floats], endings: list[str]) -> bool:
    """Whether the search continues, with the points that it wants next."""
    try:
        wanted[i] = next(search) if batch is None else search.send(batch)
    except StopIteration as end:
        wanted.pop(i, None)
        endings[i] = end.value or ""
    return i in wanted
