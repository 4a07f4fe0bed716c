"""Whether a requirement is met, from all runs whose campaigns state it. Pure functions.

A requirement has the status of its worst evidence. Every campaign that states it, by name, must have evidence of its
own; the evidence of a campaign is its newest run with a verdict, and every violation that nothing has changed since. A
run that does not count as evidence, such as a cancelled one, can still speak against it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from backend.runs.violations import CLOSER, SAME, WITHIN, above, at_threshold, comes_closer, named
from backend.runs.within import Found, within
from campaigns.results.regression import PolicyWord
from campaigns.results.verdict import VerdictWord
from campaigns.runs import run_name

Status = Literal["violated", "inconclusive", "not sampled", "no verdict", "suspect", "unsigned", "no evidence", "met"]

ORDER: tuple[Status, ...] = get_args(Status)
"""The worst first."""

How = Literal["violated", "found", "closer", "lowered", "higher", "found higher", "before", "other"]
"""How a run speaks against newer or older evidence, see `how`."""

LOWERED = "at a higher threshold, which was lowered since, {} violated it"
BEFORE = "before, another campaign of that name or another model violated it: {}"
EARLIER: dict[How, str] = {"lowered": LOWERED, "before": BEFORE}
"""How earlier violations are stated that do not stand any more; removed ones in the same words."""

ONLY_OWN = " only by who launched it"
"""What a sentence adds to *signed off*."""


@dataclass(frozen=True)
class Edge(Found):
    """One run of a requirement. not_sampled and earlier_rules: as its outcome has them;
    signed: whether a valid sign-off covers its results; repeats: the signed run that it repeats, if it was not signed
    itself; own: whether only users who launched the signed run have signed; not_carried: why
    no earlier sign-off counts for it; changes: what has changed since it ran, as
    clauses; policy: what that of its campaign says of the changes since its baseline."""

    not_sampled: bool = False
    earlier_rules: bool = False
    signed: bool = False
    repeats: int | None = None
    own: bool = False
    not_carried: str | None = None
    changes: tuple[str, ...] = ()
    policy: PolicyWord | None = None


@dataclass(frozen=True)
class Standing:
    status: Status
    sentence: str
    evidence: frozenset[int] = frozenset()
    """The newest run with a verdict of each campaign; the newest one, if none has a verdict."""
    violations: frozenset[int] = frozenset()
    """Runs that violate, found a value that would, or saw it beyond the horizon, and that nothing has changed since."""
    closer: frozenset[int] = frozenset()
    """Of these, the last."""


def standing(edges: Sequence[Edge], others: Sequence[Edge] = (), sweeps: int = 0) -> Standing:
    """The standing of a requirement with these runs, without removed ones and those of sweeps.

    others: further runs of these campaigns that are no evidence for it, such as those of sweeps, and those that do not
    state it; they can violate it. sweeps: how many runs of sweeps state it.
    """
    if not edges:
        variants = f": the {sweeps} that do are variants of sweeps, which are no evidence" if sweeps else ""
        return Standing("no evidence", f"No run that counts refers to this requirement{variants}.")
    names = dict.fromkeys(e.campaign for e in edges)
    newest = [newest_of([e for e in edges if e.campaign == name]) for name in names]
    found = [
        _of_campaign(name, [e for e in edges if e.campaign == name], [e for e in others if _asks(e, name)])
        for name in names
    ]
    worst = min((one.status for one in found), key=ORDER.index)
    sentences = [one.sentence for one in found if one.status == worst]
    better = len(found) - len(sentences)
    rest = f" The evidence of {better} other campaign{'s' if better > 1 else ''} is no worse."
    return Standing(
        worst,
        " ".join(sentences) + (rest if better else "") + _earlier(newest) + _policy(newest),
        frozenset().union(*(one.evidence for one in found)),
        frozenset().union(*(one.violations for one in found)),
        frozenset().union(*(one.closer for one in found)),
    )


def _asks(other: Edge, name: str) -> bool:
    """Whether another run can speak against the campaign of a name: by its question, by the name if that is unknown."""
    return bool(other.question) or other.campaign == name


def _earlier(newest: Sequence[Edge]) -> str:
    """The evidence that earlier rules cleared: the status is that of its version, and a reader must see both."""
    earlier = [e for e in newest if e.earlier_rules]
    return f" By the rules of an earlier version {_listed(earlier)} was cleared." if earlier else ""


def _policy(newest: Sequence[Edge]) -> str:
    """The evidence of which the policy fails: the verdict alone decides the status, and a reader must see both."""
    failing = [e for e in newest if e.policy == "fails"]
    if not failing:
        return ""
    return f" By the policy of the campaign on changes since its baseline, {_listed(failing)} fails; it is no verdict."


def newest_of(edges: Sequence[Edge]) -> Edge:
    """The newest run with a verdict; the newest one, if none has a verdict."""
    return max(edges, key=lambda e: (e.verdict is not None, e.run_id))


def how(edge: Edge, newest: Edge) -> How | None:
    """How a run speaks against the newest evidence, whether it counts or is removed; None if it does not.

    `violated`, `found` and, beyond the horizon, `closer` are within the question, of the model and of the threshold of
    that evidence; `lowered`, `higher` and `found higher` met a higher threshold only; `before` and `other` violated
    another question, or on another model.
    """
    earlier, seen = edge.run_id < newest.run_id, within(edge, newest)
    if seen is None:
        return ("before" if earlier else "other") if edge.verdict == VerdictWord.VIOLATED else None
    edge, violated = seen, seen.verdict == VerdictWord.VIOLATED
    if at_threshold(edge, newest):
        return "violated" if violated else "found"
    if violated:
        return "lowered" if earlier else "higher"
    if comes_closer(edge, newest):
        return "closer"
    known = edge.worst is not None and edge.threshold is not None and above(edge.threshold, newest.threshold)
    return "found higher" if known and not above(edge.worst, edge.threshold) else None


def _of_campaign(name: str, edges: Sequence[Edge], others: Sequence[Edge]) -> Standing:
    judged = sorted((e for e in edges if e.verdict is not None), key=lambda e: -e.run_id)
    # What asks the same of the same model as the newest run speaks against it, also before that run has a verdict.
    newest = newest_of(edges)
    evidence = frozenset({newest.run_id})
    every = {e.run_id: e for e in (*edges, *others)}
    against = [seen for _, e in sorted(every.items(), reverse=True) if (seen := _stands(e, newest)) is not None]
    violations = [e for e in against if e.verdict == VerdictWord.VIOLATED and at_threshold(e, newest)]
    runs = frozenset(e.run_id for e in against)
    if violations:
        return Standing("violated", _violated(name, violations, newest), evidence, runs)
    run, before = run_name(newest.run_id), _before(judged, newest)
    if against:
        closer = [e for e in against if not at_threshold(e, newest)]
        lower = [e for e in against if e not in closer]
        parts = [f"{_listed(lower)} found a value at or below the threshold of {run}"] if lower else []
        parts += [f"{_listed(closer)} {CLOSER} of {run}"] if closer else []
        text = (
            f"{name}: {' and '.join(parts)}, {_newest(newest)}, {_where(against)}"
            f"{'; no verdict confirms it' if lower else ''}.{before}"
        )
        return Standing("inconclusive", text, evidence, runs, frozenset(e.run_id for e in closer))
    if newest.verdict is None:
        return Standing("no verdict", f"{name}: no run that counts has a verdict.", evidence)
    if newest.not_sampled:
        lacks = "has no independent sample with a seed drawn at launch, so what every search missed would not show"
        return Standing("not sampled", f"{name}: {run}, the newest with a verdict, {lacks}.{before}", evidence)
    if newest.verdict != VerdictWord.CLEARED:
        text = f"{name}: {run}, the newest with a verdict, is {newest.verdict}.{before}"
        return Standing("inconclusive", text, evidence)
    if not newest.signed:
        lost = f"; {newest.not_carried}" if newest.not_carried else ""
        text = f"{name}: {run} is cleared, and no valid sign-off covers its results{lost}.{before}"
        return Standing("unsigned", text, evidence)
    signed = "is signed off"
    if newest.repeats is not None:
        signed = f"repeats {run_name(newest.repeats)} bit by bit, which is signed off"
    if newest.changes:
        text = f"{name}: {run} {signed}, but {'; '.join(newest.changes)}.{before}"
        return Standing("suspect", text, evidence)
    by = ONLY_OWN if newest.own else ""
    signed = signed.removeprefix("is ")
    text = f"{name}: {run} is cleared and {signed}{by}, and no change is known since.{before}"
    return Standing("met", text, evidence)


def _newest(newest: Edge) -> str:
    return "the newest, which has no verdict" if newest.verdict is None else "the newest with a verdict"


def _before(judged: Sequence[Edge], newest: Edge) -> str:
    """Earlier violations that do not stand any more, and why: a lowered threshold is what a reader must see."""
    violated = [e for e in judged[1:] if e.verdict == VerdictWord.VIOLATED]
    by: dict[How | None, list[Edge]] = {}
    for edge in violated:
        by.setdefault(how(edge, newest), []).append(edge)
    clauses = [text.format(_listed(by[of])) for of, text in EARLIER.items() if of in by]
    return "".join(f" {clause[0].upper()}{clause[1:]}." for clause in clauses)


def _listed(edges: Sequence[Edge]) -> str:
    return named([e.run_id for e in edges])


def _stands(edge: Edge, newest: Edge) -> Edge | None:
    """What a run found within the question and on the model of the newest run, if it violates or has a value that
    would; also beyond the horizon, where that run is cleared.

    A cleared run of the same question on the same model has missed a case that exists.
    """
    if edge.run_id == newest.run_id and newest.verdict is not None:
        return edge if edge.verdict == VerdictWord.VIOLATED else None
    seen = within(edge, newest)
    return seen if seen is not None and (at_threshold(seen, newest) or comes_closer(seen, newest)) else None


def _violated(name: str, violations: Sequence[Edge], newest: Edge) -> str:
    runs = _listed(violations)
    verb = "violates" if len(violations) == 1 else "violate"
    if newest.verdict == VerdictWord.VIOLATED:
        return f"{name}: {runs} {verb} it."
    later = run_name(newest.run_id)
    inside = any(e.inside for e in violations)
    if newest.verdict is None:
        asks = "which has that case within its bounds" if inside else "which asks the same of the same model"
        return f"{name}: {runs} {verb} it, and {later}, {asks}, has no verdict."
    asks = "has that case within its bounds" if inside else "asks the same of the same model, in which that case exists"
    the = "The newer " if newest.run_id > max(e.run_id for e in violations) else ""
    return f"{name}: {runs} {verb} it. {the}{later} is {newest.verdict}, but {asks}."


def _where(against: Sequence[Edge]) -> str:
    return WITHIN if any(e.inside for e in against) else SAME
