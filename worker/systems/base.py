"""The interface between a campaign and what can be evaluated: parameters in, values of results and reasons out.

Everything above (problem, stages, verdicts, runs) is written against `System`; the closed loop of components is one,
a simulator of another package is another. Start reading at `System`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from backend.db.records import Trace
from campaigns.asked.problem import Problem as Wrong
from campaigns.claims.spans import Said
from campaigns.results.finding import ClosestApproach
from campaigns.results.validate import Unseen
from worker.search.base import Batch

Floats = NDArray[np.float64]
Seeds = NDArray[np.int64]
Reasons = dict[int, str]
"""By row of a batch: why it is not ok."""

Condition = Literal["closest approach", "motion", "avoidance"]
"""What shows that an encounter took place, as the checks of a verdict are named."""


class CampaignUnusable(ValueError):
    """The campaign cannot be run with what this installation has; the message says why."""

    def __init__(self, problems: Sequence[Wrong]) -> None:
        self.problems = list(problems)
        super().__init__("the campaign cannot be run here: " + "; ".join(map(str, problems)))


@dataclass(frozen=True)
class Parameter:
    """One number that a system takes: path in a campaign, unit, nominal value, its own limits, one line of text, and
    its symbol in print, if it has one."""

    path: str
    unit: str
    nominal: float
    low: float
    high: float
    text: str
    symbol: str = ""


@dataclass(frozen=True)
class Result:
    """One number that an evaluation gives: name, title, short name of the quantity, unit, and which end is worse."""

    name: str
    title: str
    quantity: str
    unit: str
    worse: Literal["low", "high"]


@dataclass(frozen=True)
class Realised:
    """Which realisations of its noise every evaluation simulates, and how they combine.

    random: whether a seed changes an evaluation at all.
    """

    seeds: tuple[int, ...] = (0,)
    combine: str = "worst"
    random: bool = False

    @property
    def several(self) -> bool:
        return len(self.seeds) > 1


@dataclass(frozen=True)
class Comparison:
    """One case evaluated by other means: which, the cost or why there is none, the step [s] where it has one."""

    kind: Literal["half_step", "integrator", "again"]
    name: str
    cost: float | None
    reason: str = ""
    step: float | None = None


@dataclass(frozen=True)
class Confirmed:
    """A case evaluated again as the campaign asks, and by every other means that the system has."""

    cost: float | None
    comparisons: tuple[Comparison, ...]
    step: float | None = None
    """Of the first [s]; None for a system without a step."""


@dataclass(frozen=True)
class Shown:
    """What a system shows of the encounter in the nominal case."""

    closest: ClosestApproach
    moved: float | None
    """Length of the path [m]; None for one without rows."""
    unseen: Unseen


@dataclass(frozen=True)
class Scope:
    """The words of a verdict's scope: what is evaluated, its settings (empty for none), and what it was made of."""

    what: Said
    settings: Said
    version: str


@dataclass(frozen=True)
class Words:
    """The words of sentences for an evaluation, and for what confirms it."""

    one: str
    agree: str
    """All other means agree, as an open clause: `the step-halving check and DOP853 agree`."""
    disagrees: str
    every: str
    """`all integrations`."""
    again: str
    """`simulated again at half the step and with the reference integrator`."""
    reference: str
    """The means with which random evaluations are compared."""
    check: str = "validation"
    """The name of the verdict's check of the confirmation."""


@dataclass(frozen=True)
class Settings:
    """What provenance stores of a system besides its digest; None where it has none of it."""

    lanes: int | None = None
    step: float | None = None
    """[s]"""
    integrator: str | None = None


class System(ABC):
    """What a campaign can be asked of.

    A *vector* is one set of all parameters (size,), in their units and in the order of `parameters`; a system may keep
    further numbers of its own behind them, which `nominal` has too. *Costs* are results that are lower when worse: a
    result that is worse when high counts with its sign changed. An evaluation depends on its vector (and seed) alone,
    never on the batch that it is in.
    """

    parameters: tuple[Parameter, ...]
    nominal: Floats
    """The vector of nominal values (size,), size >= len(parameters)."""
    results: tuple[Result, ...]
    """Those of a batch's columns: first the one that decides, which is worse when low; each name once."""
    realisations: Realised = Realised()
    repeatable: bool = True
    """Whether the same vector and seed give the same bits in every process on machines of one kind."""
    block: int = 0
    """Rows that are best evaluated together; threads are given whole blocks. 0: one call at a time."""
    shows: tuple[Condition, ...] = ()
    """What `encounter` can show; a check is left out of the verdict where it is not among these."""
    settings: Settings = Settings()
    cost: float | None = None
    """Time of one evaluation as measured over the latest batch [s]; None before the first. Batches are made as long as
    can be stored, shown and cancelled in time."""

    @property
    @abstractmethod
    def digest(self) -> str:
        """Identifies everything that could change a number, but the vector, the seeds and the machine."""

    @property
    @abstractmethod
    def scope(self) -> Scope:
        """What a verdict holds for, in words."""

    @property
    @abstractmethod
    def words(self) -> Words:
        """How sentences speak of its evaluations."""

    @property
    def caveat(self) -> str:
        """What "cleared" must say besides of what was not shown, as sentences; usually nothing."""
        return ""

    @abstractmethod
    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        """Evaluate vectors (m, size): costs (m, k) for k results, NaN unless ok, status (m,), and the reasons.

        Under the realisations that the campaign states, or each vector under the one of its own seed: seeds (m,).
        An evaluation that does not succeed is a status with a reason; what raises ends the run.
        """

    @abstractmethod
    def confirm(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Confirmed]:
        """Evaluate vectors (m, size) again, and by other means; seeds: of those that drew their own noise.

        Once cancelled, those until then: fewer than m.
        """

    @abstractmethod
    def compare(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Comparison]:
        """Evaluate vectors (m, size), all of which have a cost, by the strongest of the other means alone.

        Once cancelled, those until then: fewer than m.
        """

    def trace(self, name: str, values: Mapping[str, float], seed: int | None = None) -> Trace | None:
        """The columns over time that show one case; None for a system that gives none.

        values: parameters by path, what is left out is nominal. Raises KeyError for an unknown path.
        """
        return None

    def encounter(self, nominal: Trace | None) -> Shown | None:
        """What shows that the encounter took place in the nominal case, of which this is the trace; None for nothing.

        May evaluate: the nominal case without avoidance, say.
        """
        return None

    def warm(self) -> None:  # noqa: B027  usually there is nothing to do
        """Whatever is done once before the first evaluation, so that its time is not counted as work."""

    @property
    def source(self) -> Path | None:
        """The file of plain Python that an evaluation executes; None for a system that has none to show."""
        return None

    def bars(self) -> list[tuple[str, Said]]:
        """What bars "cleared" whatever is evaluated: the code of the check and the sentence; usually nothing."""
        return []

    def close(self) -> None:  # noqa: B027  usually there is nothing to give back
        """Give back what it holds: processes, files."""

    @property
    def names(self) -> dict[str, int]:
        """Where in a vector each parameter is, by path."""
        return {p.path: k for k, p in enumerate(self.parameters)}


def in_own_sign(results: Sequence[Result], costs: Floats) -> Floats:
    """Costs (m, k), all of them lower when worse, as the results' values in their own sign."""
    return np.stack([0.0 - c if r.worse == "high" else c for c, r in zip(costs.T, results, strict=True)], 1)
