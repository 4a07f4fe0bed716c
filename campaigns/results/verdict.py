"""The verdict of a run: what may be claimed, the checks behind it, and its provenance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Any, Literal, Protocol

from pydantic import Field, computed_field, model_validator

from campaigns.claims.spans import Spans, values, words
from campaigns.claims.wording import CLEARING
from campaigns.codes import CheckCode
from campaigns.documented import UNLESS_EMPTY, UNLESS_NONE
from campaigns.limits import SAMPLE
from campaigns.results.base import Claim, Described, Result, Values, with_spans
from campaigns.results.regression import OptionalRegression, PolicyWord, policy_word
from campaigns.results.sample import Noise, QuantileBound
from campaigns.results.sureness import Sureness
from campaigns.versions import Versions


class VerdictWord(StrEnum):
    """What may be claimed about a campaign."""

    CLEARED = "cleared"
    VIOLATED = "violated"
    INCONCLUSIVE = "inconclusive"


SCOPE = "Scope: "
"""The prefix of the scope as plain text."""


class Check(Claim):
    """One condition of "cleared": what it is about, whether it holds, and a sentence."""

    code: CheckCode | str = Field(union_mode="left_to_right")
    """What it is about; any string for a check of another package."""
    ok: bool

    @computed_field  # type: ignore[prop-decorator]
    @property
    def name(self) -> str:
        """The code."""
        return str(self.code)

    @model_validator(mode="before")
    @classmethod
    def _coded(cls, stored: Any) -> Any:
        """Earlier versions stored the code as the name."""
        return {"code": stored["name"], **stored} if isinstance(stored, Mapping) and "name" in stored else stored


BoundSource = Literal["search", "certify"]
"""The stage whose sample bounds P(violation)."""


class Statistics(Described):
    """The bound on P(violation) and the counts of the sample that it is from; `source` states which sample."""

    samples: int
    violations: int
    failed: int | None = None
    """Counted among the violations."""
    excluded: int | None = None
    excluded_fraction: float | None = None
    confidence: float
    upper_bound: float
    bound_samples: Annotated[int | None, UNLESS_NONE] = None
    """As of the sample."""
    noise: Noise | None = None
    quantile: QuantileBound | None = None
    source: BoundSource = "search"  # what names none is older than the certify stage
    """`certify`: the sample of the certify stage, independent unless its seed was stated. `search`: there is no certify
    stage, and the sample is a random search with the seed of the campaign, by which nothing is cleared."""


class Worst(Result):
    """The worst finding; of a violated verdict the worst of those that were confirmed, by what every integration of it
    grants."""

    cost: float
    margin: float
    evaluated: float | None = None
    """Its cost as the search evaluated it; null in results of earlier versions."""
    parameters: Values
    method: str | None
    """The method that found it; of several the one with the lowest best value, or the quickest."""
    finding: str


class NominalCost(Result):
    """The nominal case."""

    cost: float | None
    margin: float | None


class Counts(Result):
    """All evaluations of the run; those that have a cost succeeded."""

    stored: int
    """The others are `counted`."""
    succeeded: int
    failed: int
    excluded: int
    violating: int = 0
    lowest: float | None = None
    flaky: Annotated[int, UNLESS_EMPTY] = 0
    """Succeeded only when a call of a simulator that had failed was tried again; omitted if there are none."""
    counted: Annotated[int, UNLESS_EMPTY] = 0
    """Not stored, of a sample of which only a part is; omitted if there are none."""

    @property
    def made(self) -> int:
        """Stored or only counted."""
        return self.stored + self.counted


class Provenance(Versions):
    """What reproduces a result: the campaign, the seed and the code."""

    digest: str | None = None
    """Of the campaign."""
    evidence: Annotated[str | None, UNLESS_NONE] = None
    """Of the campaign, all evaluations and all results: `campaigns.stored.digest`. Omitted in results of earlier
    versions."""
    seed: int | None = None


class Verdict(Result):
    """The conclusion of a run with everything that supports it."""

    verdict: VerdictWord
    statement: Spans = ()
    """What may be claimed."""
    holds_for: Spans = ()
    """The scope: components, conditions, bounds."""
    checks: list[Check]
    statistics: Statistics | None = None
    nominal: NominalCost | None = None
    worst: Worst | None = None
    evaluations: Counts | None = None
    quantity: str = ""
    unit: str = ""
    provenance: Provenance = Provenance()
    regression: OptionalRegression = None
    """What has changed since the baseline; omitted without one."""
    sureness: Annotated[Sureness | None, UNLESS_NONE] = None
    """How likely another search finds a lower case; omitted in results of earlier versions, and where it is not known:
    only of a whole search by `auto` alone."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def sentence(self) -> str:
        """What may be claimed, as plain text."""
        return words(self.statement)

    @computed_field  # type: ignore[prop-decorator]
    @property
    def scope(self) -> str:
        """The scope of the sentence, as plain text."""
        return f"{SCOPE}{words(self.holds_for)}" if self.holds_for else ""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def values(self) -> dict[str, float]:
        """The numbers of the sentence by name."""
        return values(self.statement)

    @computed_field  # type: ignore[prop-decorator]
    @property
    def not_sampled(self) -> bool:
        """Whether nothing but an independent sample is missing: every other check holds, as in what earlier versions
        cleared without one."""
        sample = self.statistics
        drawn = 0 if sample is None or sample.source != "certify" else sample.samples
        return not_sampled(self.verdict, [check.name for check in self.checks if not check.ok], drawn)

    @property
    def headline(self) -> str:
        """The verdict in large."""
        return headline(self.verdict, self, self.policy, None)

    @property
    def earlier_rules(self) -> bool:
        """Whether earlier rules cleared it."""
        return earlier_rules(self.verdict, self.provenance.wording)

    @property
    def policy(self) -> PolicyWord | None:
        """What the policy of the campaign says of the changes since the baseline; None without one."""
        since = self.regression
        return None if since is None else policy_word(since.ok, since.accepted, self.verdict)

    @model_validator(mode="before")
    @classmethod
    def _worded(cls, stored: Any) -> Any:
        """Earlier versions stored only text."""
        if isinstance(stored, Mapping) and stored.get("scope"):
            stored = {**stored, "scope": stored["scope"].removeprefix(SCOPE)}
        return with_spans(with_spans(stored, "sentence", "statement"), "scope", "holds_for")

    @property
    def reason(self) -> str:
        """Sentence and scope."""
        return f"{self.sentence} {self.scope}".strip()


class Marked(Protocol):
    """What a verdict in large states besides its word; a service of an earlier version may not send it."""

    @property
    def not_sampled(self) -> bool | None: ...
    @property
    def earlier_rules(self) -> bool | None: ...


def headline(word: str, of: Marked, policy: str | None, against: str | None) -> str:
    """A verdict in large, with what alone is missing to clear it, that earlier rules cleared it, that other runs speak
    against it, and that the policy on changes since the baseline fails: `cleared: contradicted, policy fails`. policy:
    None where a column or clause of its own states it; against: the sentence on those runs, which no result states."""
    marks = ["not sampled"] * bool(of.not_sampled) + ["earlier rules"] * bool(of.earlier_rules)
    marks += ["contradicted"] * bool(against)
    return f"{word}{': ' * bool(marks)}{', '.join(marks)}{', policy fails' if policy == 'fails' else ''}"


def earlier_rules(word: str | None, wording: int | None) -> bool:
    """Whether a stored verdict is "cleared" by rules of before one that can withdraw it; wording: of its versions."""
    return word == VerdictWord.CLEARED and (wording or 0) < CLEARING


def by_earlier_rules(run: str) -> str:
    """The sentence on such a run."""
    rules = "It was cleared by the rules of an earlier version of Clearance."
    return f"{rules} What does not hold by those of today: clearance audit {run}."


def not_sampled(word: str | None, lacking: Sequence[str], drawn: int) -> bool:
    """Whether a verdict with these failing checks and so many samples of a certify stage lacks a sample only."""
    return list(lacking) == [CheckCode.SAMPLE] or (word == VerdictWord.CLEARED and drawn < SAMPLE)
