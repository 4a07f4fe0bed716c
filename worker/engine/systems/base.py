"""The interfaces of systems that a campaign can evaluate: parameters in, result values and reasons out.

Problem, stages, verdicts and runs use only these. `System` is what every system has, `ComponentLoop` what the closed
loop of components adds, `Slotted` what simulators add. A package's own simulator may define members of both, which
`worker.engine.systems.optional` reads of any system. `worker.evidence.scopes` describes systems in claims.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns.asked.problem import Problem as Wrong
from campaigns.claims.terms import Condition as Condition  # packages import these three from here
from campaigns.claims.terms import Scope as Scope
from campaigns.claims.terms import Words as Words
from campaigns.results.finding import ClosestApproach
from campaigns.results.validate import Beyond, Mismeasured, Unseen
from campaigns.stored.records import Trace as Trace
from worker.engine.search.base import Batch

Floats = NDArray[np.float64]
Seeds = NDArray[np.int64]
Stopping = Callable[[], bool]
Reasons = dict[int, str]
"""By row of a batch: why the evaluation failed or was excluded."""


class CampaignUnusable(ValueError):
    """The campaign cannot be run on this installation; the message gives the reasons."""

    def __init__(self, problems: Sequence[Wrong]) -> None:
        self.problems = list(problems)
        super().__init__("the campaign cannot be run here: " + "; ".join(map(str, problems)))


class NoTrace(Exception):
    """There is no trace of this case, although the system gives traces; the message gives the reason."""


class NoResult(NoTrace):
    """There is no trace, because the evaluation that was to return it timed out (`timeout`) or failed; `reason`."""

    def __init__(self, reason: str, timeout: bool) -> None:
        super().__init__(f"the evaluation that was to return it has no result: {reason}")
        self.reason, self.timeout = reason, timeout


@dataclass(frozen=True)
class Parameter:
    """An input of a system: path in a campaign, unit, nominal value, limits, one line of text, and the printed symbol,
    if any."""

    path: str
    unit: str
    nominal: float
    low: float
    high: float
    text: str
    symbol: str = ""


@dataclass(frozen=True)
class Result:
    """An output of an evaluation: name, title, short name of the quantity, unit, and which end is worse."""

    name: str
    title: str
    quantity: str
    unit: str
    worse: Literal["low", "high"]


@dataclass(frozen=True)
class Realised:
    """The noise realisations that every evaluation simulates, and how their costs combine.

    random: whether the seed affects an evaluation at all; undeclared: seeds that no campaign can vary, with their
    values.
    """

    seeds: tuple[int, ...] = (0,)
    combine: str = "worst"
    random: bool = False
    undeclared: Mapping[str, str] = field(default_factory=dict, kw_only=True)

    @property
    def several(self) -> bool:
        return len(self.seeds) > 1


@dataclass(frozen=True)
class Comparison:
    """One case evaluated by an independent means: its name, the cost or why there is none, the step [s] if any."""

    kind: Literal["half_step", "integrator", "again"]
    name: str
    cost: float | None
    reason: str = ""
    step: float | None = None


@dataclass(frozen=True)
class Confirmed:
    """A case evaluated again as in the campaign, and by every independent means that the system has, the strongest
    last."""

    cost: float | None
    comparisons: tuple[Comparison, ...]
    step: float | None = None
    """The step of the first evaluation [s]; None for a system without a step."""


@dataclass(frozen=True)
class Shown:
    """Evidence of the encounter in the nominal case."""

    closest: ClosestApproach
    moved: float | None
    """Length of the path [m]; None for a trace without rows."""
    unseen: Unseen
    mismeasured: Mismeasured | None = None
    """Where the criterion does not compute the distance that it declares; None if it does."""
    begins: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """As in `Encounter`."""
    idle: Mapping[str, int] = field(default_factory=dict)
    """As in `Encounter`."""
    whole: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """As in `Encounter`."""


@dataclass(frozen=True)
class PolynomialLoop:
    """A closed loop in deviations from its trim: dx/dt as exact polynomials, and as the system evaluates it."""

    states: tuple[tuple[str, str, str], ...]
    """Name, symbol and unit of each."""
    trim: tuple[float, ...]
    flow: tuple[dict[tuple[int, ...], Fraction], ...]
    """{exponents: coefficient} of each dx/dt."""
    limits: tuple[float | None, ...]
    """The largest magnitude of each deviation for which the polynomials apply; None without one."""
    references: tuple[tuple[str, float, str], ...]
    """The references that are held: words, value and unit."""
    rates: Callable[[Floats], Floats]
    """dx/dt at deviations (m, n) as the system evaluates it."""
    returns: Callable[[Floats, Floats, float, float], NDArray[np.bool_]]
    """Of starts (m, n), a norm (n, n), a fraction and a time [s]: which stay within the limits until their norm has
    fallen to that fraction, at the system's own step."""


@dataclass(frozen=True)
class Settings:
    """What provenance stores of a system besides its digest; None if not applicable."""

    lanes: int | None = None
    """Evaluations in lockstep: each call gets whole blocks of so many, on any thread; None: no concurrent calls."""
    step: float | None = None
    """[s]"""
    integrator: str | None = None


class Evaluated(NamedTuple):
    """One evaluation: costs (k,), NaN unless ok; its status, numbered as `STATUS`; its reason, empty without one."""

    costs: Floats
    status: int
    reason: str


class System(ABC):
    """A system that a campaign can evaluate: what every system has.

    A *vector* is one set of all parameters (size,), in their units and in the order of `parameters`; a system may
    append further numbers, which `nominal` then includes. *Costs* are results where lower is worse: a result that is
    worse when high changes its sign. An evaluation depends only on its vector and seed, never on its batch.
    """

    parameters: tuple[Parameter, ...]
    nominal: Floats
    """The vector of nominal values (size,), size >= len(parameters)."""
    results: tuple[Result, ...]
    """The results in the order of a batch's columns; the first one decides and is worse when low. Names are unique."""
    repeatable: bool = True
    """Whether, as declared, the same vector and seed give the same bits in every process on the same kind of machine.
    Of a simulator this is also measured."""
    cost: float | None = None
    """Time per evaluation as measured over the latest batch [s]; None before the first. The batch size follows from it,
    so that progress and cancellation stay prompt."""

    @property
    @abstractmethod
    def digest(self) -> str:
        """Identifies everything that could change a result, except the vector, the seeds and the machine."""

    @abstractmethod
    def evaluate(self, vectors: Floats, seeds: Seeds | None = None) -> tuple[Batch, Reasons]:
        """Evaluate vectors (m, size): costs (m, k) for k results, NaN unless ok, status (m,), and the reasons.

        By default under the realisations that the campaign states; with seeds (m,), each vector under its own seed. A
        failed evaluation is a status with a reason; an exception ends the run. One that is ok has a reason only if a
        call of it failed before it succeeded (`campaigns.results.base.FLAKY`).
        """

    @abstractmethod
    def confirm(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Callable[[], bool] = lambda: False
    ) -> list[Confirmed]:
        """Evaluate vectors (m, size) again and by independent means; seeds: those of vectors with their own noise.

        When cancelled, it returns the results until then: fewer than m.
        """

    def trace(self, name: str, values: Mapping[str, float], seed: int | None = None) -> Trace | None:
        """Time histories of one case; None for a system without traces.

        values: parameters by path; missing ones are nominal. Raises KeyError for an unknown path, and NoTrace if it
        cannot be given for this case.
        """
        return None


class ComponentLoop(System):
    """What the closed loop of components adds to a system."""

    settings: Settings
    realisations: Realised
    """The noise realisations of every evaluation."""

    @property
    @abstractmethod
    def own_rule(self) -> bool:
        """Whether the criterion excludes flights at their start by another rule than its threshold."""

    @abstractmethod
    def compare(
        self, vectors: Floats, seeds: Sequence[int | None], cancelled: Stopping = lambda: False
    ) -> list[Comparison]:
        """Evaluate vectors (m, size), all of which have a cost, by the strongest independent means only.

        When cancelled, it returns the results until then: fewer than m.
        """

    @abstractmethod
    def encounter(self, nominal: Trace | None) -> Shown | None:
        """Evidence that the encounter took place in the nominal case with this trace; None if there is none.

        It may run evaluations, such as the nominal case without avoidance.
        """

    @abstractmethod
    def beyond(
        self, names: Sequence[str], vectors: Floats, seeds: Sequence[int | None], below: float, cancelled: Stopping
    ) -> Beyond | None:
        """What vectors (m, size) meet beyond the horizon, and how many of them come below a value there; None if the
        system is not simulated on, or when cancelled.

        seeds: those of vectors with their own noise.
        """

    @abstractmethod
    def about_trim(self) -> PolynomialLoop | None:
        """The closed loop about its trim; None if it has no polynomial model. Raises `CampaignUnusable` without a
        trim."""

    @abstractmethod
    def warm(self) -> None:
        """Prepare the first evaluation, such as by compiling, so that this time is not counted as evaluation time."""


class Slotted(System):
    """A system of calls that may run side by side in slots, each in a process that can be replaced: a simulator."""

    elsewhere: str = ""
    """What evaluates on other machines; empty: this process or others of its machine."""
    campaign_command: str = ""
    """The command line that the campaign file gave; empty: the system is one of this installation."""
    settings: Settings = Settings()

    @property
    def names(self) -> dict[str, int]:
        """The index of each parameter in a vector, by path."""
        return indices(self.parameters)

    @property
    def slots(self) -> int:
        """Number of evaluations that run side by side and end in any order; `submit` starts one. 0: only `evaluate`."""
        return 0

    @property
    def recycle(self) -> int:
        """Calls after which a process of a slot is replaced by a fresh one; 0: never."""
        return 0

    def submit(self, vector: Floats, seed: int | None = None) -> Future[Evaluated]:
        """Start the evaluation of one vector (size,) in a slot, as `evaluate` would; only with slots."""
        raise NotImplementedError(f"{type(self).__name__} has no slots")

    def fresh(self) -> Slotted:
        """This system without any state of earlier evaluations, which the caller closes; itself if it has none."""
        return self

    def single(self) -> Slotted:
        """This system with one call for each evaluation; itself if that is what it does."""
        return self

    def warm(self) -> None:
        """Prepare the first evaluation, such as by connecting to other machines."""

    def close(self) -> None:
        """Release resources such as processes and files."""


def slotted(system: System) -> Slotted:
    """The system as one of calls. A package's own that derives from `System` alone gets the defaults of `Slotted` for
    whatever it does not define."""
    if not isinstance(system, Slotted):
        kind = type(system)
        system.__class__ = type(kind.__name__, (kind, Slotted), {"__module__": kind.__module__})
    return system  # type: ignore[return-value]


def slots(system: System) -> int:
    """How many evaluations run side by side in slots; 0 for a system without slots."""
    return system.slots if isinstance(system, Slotted) else 0


def indices(parameters: Sequence[Parameter]) -> dict[str, int]:
    """The index of each parameter in a vector, by path."""
    return {p.path: k for k, p in enumerate(parameters)}


def with_values(vector: Floats, at: Mapping[str, int], values: Mapping[str, float]) -> Floats:
    """The vector (size,) with these values by path, which are at these indices; KeyError for an unknown path."""
    changed = vector.copy()
    for path, value in values.items():
        changed[at[path]] = value
    return changed


def in_own_sign(results: Sequence[Result], costs: Floats) -> Floats:
    """Costs (m, k), where lower is worse, as the results' values in their own sign."""
    return np.stack([0.0 - c if r.worse == "high" else c for c, r in zip(costs.T, results, strict=True)], 1)
