"""Runs one attack: the outcome, and whether it claims too much."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from campaigns import check
from campaigns.asked.load import CampaignError, load_document
from campaigns.results.base import OK
from clearance.testing.problems import Problem
from tests.adversary import classes, later
from tests.adversary.classes import Attack
from tests.audited import audited
from worker.engine.systems.base import CampaignUnusable
from worker.running.catalogue.installed import catalogue
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

CLASSES = (*classes.CLASSES, *later.CLASSES)


@dataclass(frozen=True)
class Outcome:
    """What became of an attack: the verdict or `refused`, with its sentence, and what is wrong with it, if anything."""

    attack: Attack
    verdict: str
    sentence: str
    wrong: str = ""


def made(kind: int, seed: int) -> Attack:
    """Attack number `seed` of a class."""
    return CLASSES[kind](np.random.default_rng([20_261_120, kind, seed]))


def attack(given: Attack) -> Outcome:
    """Run it, and hold the verdict against what it may be and against every evaluation that the run has stored."""
    store = MemoryStore()
    try:
        asked = load_document(given.document)
        if problems := check(asked, catalogue()):
            raise CampaignUnusable(problems)
        conclusion = execute(asked, store, threads=1)
    except (CampaignError, CampaignUnusable) as refused:
        wrong = "" if "refused" in given.may else "it was refused"
        return Outcome(given, "refused", str(refused), wrong)
    audited(store, asked)
    threshold = Problem(asked).threshold
    columns = [store.evaluations(at) for at in range(len(store.stages))]
    costs = np.concatenate([c.costs[c.status == OK, 0] for c in columns if c is not None])
    wrong = ""
    if conclusion.verdict not in given.may:
        wrong = f"{conclusion.verdict} is none of {', '.join(sorted(given.may))}"
    if conclusion.verdict == "cleared" and (costs <= threshold).any():
        wrong = f"cleared with {int((costs <= threshold).sum())} stored violations"
    return Outcome(given, conclusion.verdict, conclusion.reason, wrong)
