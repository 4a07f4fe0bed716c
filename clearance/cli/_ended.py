"""A run that has ended, as the command line reports it: its exit code, and what its files state. Read `EndedRun`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from campaigns.runs import RunState
from clearance.cli import CODES, INCONCLUSIVE, INTERNAL, INTERRUPTED, VIOLATED

if TYPE_CHECKING:
    from campaigns.identity.identity import Identity
    from campaigns.results import Verdict
    from campaigns.results.regression import FindingChange, Regression
    from campaigns.results.verdicts import DescribedCheck

OUTCOMES = {
    0: "cleared",
    VIOLATED: "violated",
    INCONCLUSIVE: "inconclusive, neither cleared nor violated",
    INTERNAL: "the run failed, there is no verdict",
    INTERRUPTED: "the run was cancelled, there is no verdict",
}
"""The meaning of each exit code of a run, unless a policy decides it."""


UNKNOWN = ("not compared", "unresolved")
"""Of a finding of the baseline: standings that say what was not examined, not what has become of it."""


def read(value: float, threshold: float | None) -> str:
    """A value with so many digits that it is read on its own side of the threshold; an earlier version of a service
    may state none."""
    from campaigns.claims.numbers import beside, number

    return number(value) if threshold is None else beside(value, threshold)


@dataclass(frozen=True)
class Case:
    """One finding: the value to state for it and its margin [unit of the criterion], parameters by path.

    evaluated: by the search, if another evaluation of a confirmed violation is milder and therefore stated. likelihood:
    under the stated distributions, a clause; empty where none is stated. seed: of the noise, if it was drawn
    for this case: without it the value does not follow from the parameters. confirmed: of one at or below the
    threshold, whether it violates when evaluated again as well."""

    label: str
    cost: float
    margin: float
    parameters: Mapping[str, float]
    evaluated: float | None = None
    likelihood: str = ""
    seed: int | None = None
    confirmed: bool = True

    def beside(self, threshold: float | None) -> str:
        """The evaluated value, where another one is stated, the noise seed, and that a violation is not confirmed, as
        the rest of a clause."""
        other = None if self.evaluated == self.cost else self.evaluated
        lower = "" if other is None else f", evaluated as {read(other, threshold)}"
        drawn = "" if self.seed is None else f", with noise seed {self.seed}"
        return lower + drawn + (", not confirmed" if self.margin <= 0 and not self.confirmed else "")


@dataclass(frozen=True)
class Source:
    """The campaign as text: its file, or its address in a service."""

    address: str
    text: str


@dataclass(frozen=True)
class EndedRun:
    """One run. run: R-0001, or the campaign's file; link: its page, if it has one; replay: the command that evaluates a
    case of it again, without the case; notes: sentences on the runs that speak against it, the rules
    that cleared it, its baseline, its reuse and its removal."""

    run: str
    campaign: str
    state: str
    verdict: Verdict | None
    error: str = ""
    link: str = ""
    replay: str = ""
    labels: dict[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    against: str = ""
    """Which other runs speak against its verdict, a sentence; empty if none does."""
    against_runs: tuple[str, ...] = ()
    """All of them."""
    seconds: float = 0.0
    compared: bool = True
    """False if a baseline was asked for and there is none."""
    requirements: tuple[str, ...] = ()
    """The ids of the requirements that its criterion states."""
    quantity: str = ""
    unit: str = ""
    threshold: float | None = None
    lowest: float | None = None
    """The lowest value that it found [unit]; None if it is not known."""
    findings: tuple[Case, ...] = ()
    """The worst first."""
    source: Source | None = None
    identity: Identity | None = None
    """Of the code that ran it; None before its first stage."""
    picture: str = ""
    """Name of the picture of the worst case, next to the summary; empty if there is none."""

    @property
    def violating(self) -> tuple[Case, ...]:
        """The findings at or below the threshold, those that are not confirmed included."""
        worst = None if self.verdict is None else self.verdict.worst
        found = self.findings
        if not found and worst is not None:
            found = (Case(worst.finding, worst.cost, worst.margin, worst.parameters, worst.evaluated),)
        return tuple(case for case in found if case.margin <= 0)

    @property
    def unconfirmed(self) -> str:
        """The sentence on a value at or below the threshold that no verdict confirms; empty if there is none."""
        from campaigns.claims.lowest_value import unconfirmed
        from campaigns.claims.spans import words

        return words(unconfirmed(self.state, self.lowest, self.threshold, self.unit))

    @property
    def no_verdict(self) -> str:
        """Why there is no verdict, and what was found all the same."""
        text = f"no verdict: {self.state}" + (f": {self.error}" if self.error else "")
        return f"{text.rstrip('.')}. {self.unconfirmed}" if self.unconfirmed else text

    @property
    def accepted(self) -> bool:
        """Whether the policy of the campaign accepts its violations, so that they fail nothing."""
        return self.verdict is not None and self.verdict.verdict == "violated" and self.code == 0

    @property
    def checks(self) -> list[DescribedCheck]:
        """The checks of the verdict; empty without one."""
        from campaigns.results.verdicts import checks_of

        return [] if self.verdict is None else checks_of(self.verdict)

    @property
    def regression(self) -> Regression | None:
        """What has changed since the baseline."""
        return None if self.verdict is None else self.verdict.regression

    @property
    def code(self) -> int:
        if self.verdict is None:
            return INTERRUPTED if self.state == RunState.CANCELLED else INTERNAL
        own = code(self.verdict)
        return INCONCLUSIVE if own == 0 and self.contradicted else own

    @property
    def contradicted(self) -> bool:
        """Whether it is cleared and other runs speak against that: they violate, or found what no verdict confirms."""
        return self.verdict is not None and self.verdict.verdict == "cleared" and bool(self.against)

    @property
    def passes(self) -> bool:
        """Whether its verdict is a success: cleared and not contradicted, or violated as the policy accepts."""
        verdict = None if self.verdict is None else self.verdict.verdict
        return (verdict == "cleared" and not self.contradicted) or self.accepted

    @property
    def headline(self) -> str:
        """The verdict in large; the state without one."""
        from campaigns.results.verdict import headline

        found = self.verdict
        return self.state if found is None else headline(found.verdict, found, found.policy, self.against)

    @property
    def outcome(self) -> str:
        """The exit code and its meaning, without a full stop: the first words of a summary; empty until then."""
        from campaigns.results.verdict import headline

        if self.state == RunState.RUNNING:
            return ""
        meaning = OUTCOMES[self.code]
        if self.verdict is not None:
            stated = f"cleared, but {self.against.rstrip('.')}" if self.contradicted else ""
            meaning = by_policy(self.verdict) or stated or headline(meaning, self.verdict, None, self.against)
        return f"exit code {self.code}: {meaning}"

    def command(self, case: FindingChange) -> str:
        """The command that evaluates a case again; empty if there is none."""
        if not self.replay or self.regression is None:
            return ""
        own = case.now if case.margin_again is None or case.margin != case.margin_again else None
        place = own or (None if case.evaluation is None else f"{self.regression.position}:{case.evaluation}")
        return f"{self.replay} {place}" if place else ""


def code(verdict: Verdict) -> int:
    """The exit code of a verdict and of the policy on its changes since a baseline.

    A change that fails is 1 whatever the verdict; a violated verdict is 0 only if the policy accepts violations and the
    baseline had all of them.
    """
    return {"fails": VIOLATED, "accepts": 0}.get(verdict.policy or "", CODES[verdict.verdict])


def by_policy(verdict: Verdict) -> str:
    """Why the exit code is not that of the verdict, as a clause; empty if it is."""
    regression = verdict.regression
    if regression is None or code(verdict) == CODES[verdict.verdict]:
        return ""
    if verdict.policy == "fails":
        return "the policy of the campaign fails"
    return f"every violating finding was known in {regression.run}, and the policy accepts those"


def exit_sentence(verdict: Verdict) -> str:
    """`by_policy` as a sentence."""
    clause = by_policy(verdict)
    return f"The exit code is {code(verdict)}: {clause}." if clause else ""


def changes(verdict: Verdict) -> list[str]:
    """The sentence on the changes since a baseline, each finding of which the change is not known, and why the exit
    code is not that of the verdict; empty without a baseline."""
    regression = verdict.regression
    if regression is None:
        return []
    lost = [f"{case.text}." for case in regression.cases if case.standing in UNKNOWN]
    return [regression.text, *lost, *filter(None, [exit_sentence(verdict)])]


def sureness(verdict: Verdict) -> list[str]:
    """The sentence on how likely another search finds a lower case; empty where that is not known."""
    return [] if verdict.sureness is None else [f"{verdict.sureness.text}."]
