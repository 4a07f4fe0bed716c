"""Extends a finished search: the new run replays the stored evaluations and simulates only the rest.

A method is deterministic, so its first evaluations under the larger budget are bit-identical to the stored ones. Stages
that depend on all earlier ones are computed again. Runs of other code are refused, and those that saw only in such
stages what bars "cleared": the new run could miss it.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, fields
from typing import Any

from pydantic import TypeAdapter

from campaigns import Campaign, check
from campaigns.asked.load import load_document
from campaigns.asked.spec import MAX_EVALUATIONS, Search
from campaigns.claims.numbers import count
from campaigns.claims.say import listed
from campaigns.claims.spans import words
from campaigns.identity.identity import differences, identity_of, simulator_of
from campaigns.refusals import Refusal, RefusalCode
from campaigns.sample_seed import SampleSeed
from campaigns.stages.found import declared
from campaigns.stages.plan import plan
from campaigns.stored.records import Ahead, Columns, StageRecord
from campaigns.versions import Versions, differing, other_code
from worker.running.catalogue.installed import catalogue, methods
from worker.running.opening import opened
from worker.running.runs import identity
from worker.running.runs.losses import MADE_AGAIN, Stored, lost, unstored, violations
from worker.running.runs.provenance import versions
from worker.running.runs.store import MemoryStore


class CannotContinue(Refusal, ValueError):
    """The run cannot be extended; the message states why and what to do."""


class WouldLose(CannotContinue):
    """What bars "cleared" in the run would not be stored by the new one; why: without what to do."""

    def __init__(self, why: str) -> None:
        super().__init__(
            f"{why}; run the campaign again as a new run, with this one as its baseline", RefusalCode.WOULD_LOSE
        )
        self.why = why


@dataclass(frozen=True)
class Budget:
    """A search's new budget: so many further evaluations, or so many in total."""

    evaluations: int
    more: bool

    @staticmethod
    def read(text: str) -> Budget:
        """`+20000` adds evaluations, `20000` is the total; raises `CannotContinue` for anything else."""
        if not re.fullmatch(r"\+?[0-9_]{1,12}", text) or int(text) < 1:
            raise CannotContinue(
                f"invalid budget {text!r}: give +20000 for 20000 further evaluations, or 20000 for the total"
            )
        return Budget(int(text), text.startswith("+"))

    def after(self, before: int) -> int:
        """The budget after the extension of a search that had `before` evaluations."""
        return before + self.evaluations if self.more else max(before, self.evaluations)


def continued(campaign: Campaign, budget: Budget) -> Campaign:
    """The campaign with larger budgets for every search that can be extended; raises `CannotContinue` if none can."""
    document = campaign.document()
    larger_ones = [raised(search, budget) for search in campaign.stages.search]
    if not any(larger_ones):
        searches = [f"{methods()[s.method].title}, {count(s.evaluations)}" for s in campaign.stages.search]
        able = words(listed([m.title for m in methods().values() if m.extend is not None]))
        raise CannotContinue(
            f"none of its searches ({'; '.join(searches)}) can be extended "
            f"{'by' if budget.more else 'to'} {count(budget.evaluations)} evaluations; give more than it has, of a "
            f"method that can be extended: {able}"
        )
    document["stages"]["search"] = [
        changed or search for changed, search in zip(larger_ones, document["stages"]["search"], strict=True)
    ]
    larger = load_document(document, "the extended campaign")
    if problems := check(larger, catalogue()):
        raise CannotContinue(f"such a campaign is now refused: {'; '.join(map(str, problems))}")
    return larger


def raised(search: Search, budget: Budget) -> dict[str, object] | None:
    """The search with its larger budget, and the options by which its method continues; None if it cannot."""
    method = methods()[search.method]
    evaluations = budget.after(search.evaluations)
    if method.extend is None or evaluations <= search.evaluations:
        return None
    if evaluations > MAX_EVALUATIONS:
        raise CannotContinue(f"{count(evaluations)} evaluations are more than the {count(MAX_EVALUATIONS)} allowed")
    known: TypeAdapter[Any] = TypeAdapter(method.options)
    try:
        options = method.extend(known.validate_python(search.options), evaluations - search.evaluations)
    except ValueError:
        return None
    usual = method.options()
    changed = {f.name: getattr(options, f.name) for f in fields(options)}
    stated = {name: v for name, v in changed.items() if name in search.options or v != getattr(usual, name)}
    document = search.model_dump(mode="json")
    return document | {"evaluations": evaluations, "options": stated}


def carried(
    old: Campaign, new: Campaign, store: MemoryStore, ahead: bool = False, violated: bool = False
) -> dict[int, Columns]:
    """The stored evaluations by the position of the stage that replays them; raises `CannotContinue`,
    `WouldLose` where other stages alone saw what bars "cleared".

    Not those of an estimate or of validation, which depend on all stages before them, unless the campaigns are the
    same. ahead: whether the new run begins also with those that an earlier one of their stage is missing for;
    violated: whether the verdict of the run is, where the store has no findings.
    """
    if not store.stages:
        raise CannotContinue("it ended before its first stage; run the campaign again")
    stages = [(p.kind, p.method) for p in plan(new)]
    if [(r.plan.kind, r.plan.method) for r in store.stages] != stages or [
        (p.kind, p.method) for p in plan(old)
    ] != stages:
        raise CannotContinue(
            "its stages were planned by another version of Clearance; run the campaign again", RefusalCode.OTHER_PLAN
        )
    kinds = {kind for kind, stage in declared().items() if not stage.partly(old)}
    if old != new:
        kinds -= {"estimate", *(kind for kind, stage in declared().items() if stage.of_findings)}
    if not same_sample(old, new):
        kinds -= {"certify"}
    found = {at: columns for at in range(len(stages)) if (columns := store.evaluations(at)) is not None}
    kept = {at: columns for at, columns in found.items() if stages[at][0] in kinds and len(columns.status)}
    if not any(declared()[stages[at][0]].of_findings for at in kept):
        again = [f.validation for f in store.findings if f.validation is not None]
        violated = violated or any(value <= old.criterion.threshold for case in again for value in case.values)
    _refuse_to_lose(old, store, kept.keys() | _made_again(old, new, store), ahead, violated)
    return kept


def _made_again(old: Campaign, new: Campaign, store: MemoryStore) -> set[int]:
    """The stages of which a part is stored, and of which the new run evaluates the same points to the same bits."""
    if old.scenario is None or store.sample_seed is None or not same_sample(old, new):
        return set()
    return {at for at, record in enumerate(store.stages) if declared()[record.plan.kind].partly(old)}


def _refuse_to_lose(old: Campaign, store: MemoryStore, kept: Collection[int], ahead: bool, violated: bool) -> None:
    replayed: list[Stored] = []
    others: list[Stored] = []
    for at, record in enumerate(store.stages):
        columns, waiting = store.evaluations(at), store.ahead(at)
        if columns is not None:
            (replayed if at in kept else others).append((record.plan, columns))
        if waiting is not None:
            (replayed if at in kept and ahead else others).append((record.plan, waiting.columns))
    threshold, again = old.criterion.threshold, [columns for _, columns in replayed]
    if why := lost(threshold, again, others):
        raise WouldLose(why)
    if violated and not any(violations(columns, threshold) for columns in again):
        raise WouldLose(MADE_AGAIN)
    sampled = all(at in kept for at, record in enumerate(store.stages) if declared()[record.plan.kind].independent)
    for at, record in enumerate(store.stages):
        if at not in kept and (why := unstored(old, record.result, again, sampled)):
            raise WouldLose(why)


def same_sample(old: Campaign, new: Campaign) -> bool:
    """Whether the independent sample of both is the same; else a new one is drawn, with another seed.

    A sample that is extended once its result is known does not have the bound of a fixed size.
    """
    then, now = ((c.stages.certify, c.stages.estimate, c.confidence, c.target_probability) for c in (old, new))
    return then == now


def refuse_other_code(new: Campaign, then: Versions, modules: dict[str, str] | None = None) -> None:
    """Raises `CannotContinue` if the code or packages of the run differ from this installation.

    `modules` are the digests of its modules, if stored. Fields that were not stored are not compared.
    """
    here, code, simulator = versions(new, opened.system(new)), identity.code(new), simulator_of(new)
    apart = differing(modules, code.modules) if modules else []
    others = differences(identity_of(then, simulator), identity_of(here, simulator), apart)
    if others:
        raise CannotContinue(other_code("it", others), RefusalCode.OTHER_CODE)


def preloaded(
    new: Campaign, evaluations: dict[int, Columns], seed: SampleSeed | None, ahead: dict[int, list[Ahead]] | None = None
) -> MemoryStore:
    """A store in memory that a run of the new campaign resumes from; ahead: those that an earlier one is missing for,
    of the same stages."""
    stages = [StageRecord(planned) for planned in plan(new)]
    chunks = {at: [columns] for at, columns in evaluations.items()}
    waiting = {at: columns for at, columns in (ahead or {}).items() if at in chunks}
    return MemoryStore(stages=stages, chunks=chunks, sample_seed=seed or SampleSeed.drawn(), waiting=waiting)
