"""Resumes an earlier search: its stored evaluations are replayed, and only the rest is evaluated.

With larger budgets a method continues where it ended. What validation evaluated depends on all of it and is made again,
and so is an independent sample that is no longer the one that was asked for: where these alone found a violation, the
search is not resumed.
"""

from __future__ import annotations

from pathlib import Path

from campaigns import Campaign
from campaigns.identity.identity import differences, identity_of, simulator_of
from campaigns.sample_seed import SampleSeed
from campaigns.stages.plan import plan
from clearance.function.result import Evaluations, Interrupted
from clearance.local.citation import Earlier
from clearance.local.results import read_folder, refuse_other_document, versions_of, violated
from worker.engine.problem.problem import Problem
from worker.running.runs.continuation import Budget, CannotContinue, WouldLose, carried, preloaded, raised, same_sample
from worker.running.runs.provenance import versions
from worker.running.runs.store import MemoryStore


def earlier(resume: object) -> Earlier:
    """What `resume` is: a result, an interrupt, or a folder that a result was saved in."""
    name = "an earlier search"
    if isinstance(resume, Interrupted):
        resume, name = resume.evaluations, "an interrupted search"
    if isinstance(resume, Evaluations):
        origin = resume.origin
        ran = origin.store.versions or versions(origin.campaign, origin.problem.system)
        return Earlier(name, origin.campaign, origin.store, ran)
    if isinstance(resume, (str, Path)):
        folder = Path(resume)
        try:
            campaign, kept = read_folder(folder)
            refuse_other_document(folder, campaign)
            return Earlier(str(folder), campaign, kept, versions_of(folder), violated(folder))
        except CannotContinue as error:
            raise ValueError(f"resume: {folder}: {error}") from None
    raise TypeError(f"resume must be a result, an interrupted search or the folder of one, given {resume!r:.60}")


def extended(document: dict[str, object], then: Campaign, now: Campaign) -> dict[str, object]:
    """The document with the options by which each method continues under its larger budget."""
    found = []
    for old, new in zip(then.stages.search, now.stages.search, strict=False):
        if old.evaluations == new.evaluations:
            continue
        changed = raised(old, Budget(new.evaluations, more=False))
        if changed is None:
            raise ValueError(
                f"resume: {new.method} cannot go from {old.evaluations:,} to {new.evaluations:,} evaluations; "
                "give it the budget that it had, or search again without resume"
            )
        found.append(changed)
    made = {str(search["method"]): search for search in found}
    stages = document["stages"]
    assert isinstance(stages, dict)
    searches = [made.get(search["method"], search) for search in stages["search"]]
    return document | {"stages": stages | {"search": searches}}


def store(campaign: Campaign, problem: Problem, before: Earlier, seed: SampleSeed | None) -> MemoryStore:
    """The store that the search resumes from; raises ValueError if the evaluations are of something else.

    seed: of a new sample, if one is stated.
    """
    for name in ("simulator", "uncertain", "correlations", "criterion", "seed"):
        if getattr(campaign, name) != getattr(before.campaign, name):
            raise ValueError(f"resume: the earlier search had another {name}; give the same arguments")
    kept = before.store
    try:
        columns = carried(before.campaign, campaign, kept, ahead=True, violated=before.violated)
    except WouldLose as error:
        raise ValueError(f"resume: {before.name}: {error.why}; search again without resume") from None
    except CannotContinue:
        listed = ", ".join(s.method or s.kind for s in plan(before.campaign))
        raise ValueError(f"resume: the earlier search had other stages: {listed}") from None
    simulator = simulator_of(campaign)
    here = versions(campaign, problem.system)
    apart = differences(identity_of(before.versions, simulator), identity_of(here, simulator))
    if apart:
        raise ValueError(f"resume: its evaluations cannot be used: {'; '.join(apart)}")
    if not same_sample(before.campaign, campaign):
        return preloaded(campaign, columns, seed, kept.waiting)
    if seed is not None and (kept.sample_seed is None or kept.sample_seed.value != seed.value):
        raise ValueError("resume: the independent sample of the earlier search has another seed; leave sample_seed out")
    return preloaded(campaign, columns, kept.sample_seed, kept.waiting)
