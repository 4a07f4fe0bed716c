"""What a search returns: the verdict with its checks, the findings, and every evaluation as arrays.

`of` makes one from the store of a run.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from campaigns.results import Finding as Stored
    from campaigns.results import Verdict as Concluded
    from clearance.function.origin import Origin
    from clearance.local.citation import Cited

Floats = NDArray[np.float64]
Texts = NDArray[np.str_]
Array = TypeVar("Array", Floats, Texts)


class Check(NamedTuple):
    """One condition of "cleared": its title, whether it holds ("holds", "open", "fails"), and a sentence."""

    title: str
    standing: str
    text: str


class Sureness(NamedTuple):
    """The estimated chance that another search of the same budget finds a case lower by more than `lower` [unit], a
    hundredth of nominal minus worst: an estimate, no bound, and no verdict rests on it. text: it as a sentence."""

    chance: float
    lower: float
    text: str


class Verdict(str):
    """What may be claimed: "cleared", "violated" or "inconclusive", with the sentence that explains it.

    It is a string: `result.verdict == "cleared"`. checks: every condition of "cleared"; scope: what the sentence holds
    for. sureness: the estimated chance that another search finds a lower case, None where it is not known.
    """

    sentence: str
    scope: str
    checks: tuple[Check, ...]
    sureness: Sureness | None

    def __new__(
        cls, word: str, sentence: str = "", scope: str = "", checks: Sequence[Check] = (),
        sureness: Sureness | None = None,
    ) -> Verdict:  # fmt: skip
        made = super().__new__(cls, word)
        made.sentence, made.scope, made.checks, made.sureness = sentence, scope, tuple(checks), sureness
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        return str(self), self.sentence, self.scope, self.checks, self.sureness


@dataclass(frozen=True)
class Nominal:
    """The nominal case: parameters [unit] by name; cost and margin to the threshold [unit], None where it failed."""

    parameters: Mapping[str, float]
    cost: float | None
    margin: float | None
    reason: str = ""


@dataclass(frozen=True)
class Finding:
    """One distinct worst case: parameters [unit] by name, the value stated for it and its margin to the threshold
    [unit].

    cost: what the function returned; of a violation whose repeated evaluations differ, the mildest of them, as in the
    verdict. evaluated: what the search saw. label: F1 is the worst. methods: the search methods that found it by
    themselves; empty if only polishing did. at_bounds: "low" or "high" by parameter. validation: whether a repeated
    evaluation agrees, in words.
    """

    label: str
    cost: float
    margin: float
    evaluated: float
    parameters: Mapping[str, float]
    methods: tuple[str, ...]
    at_bounds: Mapping[str, str] = field(default_factory=dict)
    validation: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class Evaluations:
    """Every evaluation, in the order of the stages: m evaluations of n parameters.

    names (n,): the parameters in the order of the columns of points. points (m, n) [unit]. costs (m,) [unit]: what the
    function returned, NaN unless the status is "ok". status (m,): "ok", "failed", "timeout". stage (m,): "nominal",
    "sensitivity", "search", "certify", "validate". method (m,): the search method, empty for other stages.
    reasons: why an evaluation failed or was tried again, by row. threshold [unit]. The arrays are read-only.
    """

    names: tuple[str, ...]
    points: Floats
    costs: Floats
    status: Texts
    stage: Texts
    method: Texts
    reasons: Mapping[int, str]
    threshold: float
    quantity: str
    unit: str
    origin: Origin

    def to_dataframe(self) -> Any:
        """A data frame with a row for each evaluation; our columns end with `_` if a parameter has their name.

        Raises ImportError with a sentence if pandas is not installed.
        """
        try:
            pandas = importlib.import_module("pandas")
        except ImportError:
            raise ImportError(
                "to_dataframe needs pandas, which is not installed: pip install pandas; "
                "points, costs, status and method have the same data as arrays"
            ) from None
        columns: dict[str, object] = dict(zip(self.names, self.points.T, strict=True))
        reasons = np.array([self.reasons.get(k, "") for k in range(len(self.costs))], dtype=object)
        for name in ("cost", "status", "stage", "method", "reason"):
            value = {"cost": self.costs, "reason": reasons}.get(name, getattr(self, name, None))
            columns[name + "_" * (name in self.names)] = value
        return pandas.DataFrame(columns)

    def __repr__(self) -> str:
        excluded = int((self.status == "excluded").sum())
        failed = int((self.status != "ok").sum()) - excluded
        but = f", {excluded} excluded" if excluded else ""
        return f"<{len(self.costs)} evaluations of {', '.join(self.names)}; {failed} failed{but}>"


@dataclass(frozen=True, eq=False, repr=False)
class Result(Evaluations):
    """The result of a search: what may be claimed and why, the worst cases, and every evaluation.

    findings: the distinct worst cases, the lowest first. worst: the one that the verdict names, of a violated run the
    worst that is confirmed; None if nothing could be evaluated.
    """

    verdict: Verdict
    findings: tuple[Finding, ...]
    nominal: Nominal
    worst: Finding | None

    @property
    def sample_seed(self) -> int | None:
        """The seed of its independent sample, with which a search repeats it; None without one."""
        seed = self.origin.store.sample_seed
        return None if seed is None else seed.value

    @property
    def continues(self) -> Cited | None:
        """What it resumed: `run`, a folder or "an earlier search", and the `digest` of its campaign; None for a search
        of its own. `code` is None if its code version was not stored."""
        return self.origin.cites

    @property
    def bound(self) -> int:
        """How many evaluations the search could take at most, those made again to confirm results included."""
        from campaigns.stages.plan import most

        return most(self.origin.campaign)

    def save(self, folder: str | Path) -> Path:
        """Write the folder of `clearance run --out`, which `clearance audit` checks; returns its path."""
        from clearance.function.saving import save

        return save(self.origin, Path(folder))

    def report(self, file: str | Path) -> Path:
        """Write the report of the run as one self-contained HTML file; returns its path."""
        from clearance.function.saving import report

        return report(self.origin, Path(file))

    def __repr__(self) -> str:
        from campaigns.claims.numbers import beside

        lowest = "no value"
        if self.worst is not None:
            lowest = f"worst {self.quantity} {beside(self.worst.cost, self.threshold)} {self.unit}".rstrip()
        return f"<Result {self.verdict}: {lowest}, {len(self.costs)} evaluations>"

    def __str__(self) -> str:
        from clearance.function.display import text

        return text(self)

    def _repr_html_(self) -> str:
        from clearance.function.display import page

        return page(self)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a search; `evaluations` has what was evaluated until then. There is no verdict.

    The message states the lowest value if it is at or below the threshold.
    """

    def __init__(self, evaluations: Evaluations) -> None:
        from campaigns.claims.lowest_value import unconfirmed
        from campaigns.claims.spans import words
        from campaigns.runs import RunState
        from clearance.local.interrupt import lowest

        self.evaluations = evaluations
        many, found = len(evaluations.costs), lowest(evaluations.origin.store)
        stated = words(unconfirmed(RunState.CANCELLED, found, evaluations.threshold, evaluations.unit))
        super().__init__(
            f"the search was interrupted after {many} evaluations, so there is no verdict; "
            f"they are in the attribute `evaluations` of this exception{f'. {stated}' if stated else ''}"
        )


def of(origin: Origin, verdict: Concluded) -> Result:
    """The result of a run that has ended."""
    from campaigns.results.verdicts import checks_of

    checks = [Check(c.title, c.standing, f"{c.text}; {c.but}" if c.but else c.text) for c in checks_of(verdict)]
    result = origin.store.stages[0].result
    first = None if result is None else result.at_nominal
    assert first is not None
    nominal = Nominal(_by_name(origin, first.parameters), first.cost, first.margin, first.reason)
    findings = tuple(_finding(origin, f) for f in origin.store.found())
    named = None if verdict.worst is None else verdict.worst.finding
    sure = verdict.sureness
    sureness = None if sure is None else Sureness(sure.chance, sure.lower, f"{sure.text}.")
    return Result(
        **vars(evaluations(origin)),
        verdict=Verdict(verdict.verdict.value, verdict.sentence, verdict.scope, checks, sureness),
        findings=findings,
        nominal=nominal,
        worst=next((f for f in findings if f.label == named), None),
    )


def _finding(origin: Origin, f: Stored) -> Finding:
    from campaigns.results.verdicts import validated

    bounds = {path.removeprefix("simulator."): str(at) for path, at in f.at_bounds.items()}
    return Finding(
        f.label,
        f.granted,
        f.margin + (f.granted - f.cost),
        f.cost,
        _by_name(origin, f.parameters),
        tuple(f.methods),
        bounds,
        validated(f.validation),
    )


def _by_name(origin: Origin, parameters: Mapping[str, float]) -> dict[str, float]:
    """Values by path as values by the user's names, in the user's order."""
    return {name: parameters[f"simulator.{name}"] for name in origin.names}


def evaluations(origin: Origin) -> Evaluations:
    """What was evaluated until now, such as before an interrupt."""
    from campaigns.results.base import STATUS

    problem, store = origin.problem, origin.store
    paths = [r.path for r in problem.ranges]
    order = [paths.index(f"simulator.{name}") for name in origin.names]
    points, costs, status, stage, method = [], [], [], list[str](), list[str]()
    reasons: dict[int, str] = {}
    for position, record in enumerate(store.stages):
        columns = store.evaluations(position)
        if columns is None:
            continue
        reasons |= {len(stage) + k: why for k, why in columns.reasons.items()}
        points.append(problem.values(columns.points)[:, order])
        costs.append(columns.costs[:, 0])
        status += [STATUS[s] for s in columns.status.tolist()]
        stage += [record.plan.kind] * len(columns.status)
        method += [record.plan.method or ""] * len(columns.status)
    return Evaluations(
        names=origin.names,
        points=_fixed(np.concatenate(points) if points else np.empty((0, len(order)))),
        costs=_fixed(np.concatenate(costs) if costs else np.empty(0)),
        status=_fixed(np.array(status, dtype=np.str_)),
        stage=_fixed(np.array(stage, dtype=np.str_)),
        method=_fixed(np.array(method, dtype=np.str_)),
        reasons=reasons,
        threshold=problem.threshold,
        quantity=problem.quantity,
        unit=problem.unit,
        origin=origin,
    )


def _fixed(array: Array) -> Array:
    array.flags.writeable = False
    return array
