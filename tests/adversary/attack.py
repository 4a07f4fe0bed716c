"""Runs one attack: the outcome, and whether it claims too much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from campaigns import check
from campaigns.asked.load import CampaignError, load_document
from campaigns.results.base import OK
from campaigns.results.finding import Finding
from campaigns.results.verdict import Verdict
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
    """Run it, and hold the verdict against what it may be, against every evaluation that the run has stored, and its
    headline against every integration of the findings."""
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
    wrong = wrong or _headline(conclusion, store.findings, Problem(asked))
    return Outcome(given, conclusion.verdict, conclusion.reason, wrong)


def _headline(conclusion: Verdict, findings: Sequence[Finding], problem: Problem) -> str:
    """What is wrong with the value that a violated verdict states: it must be the mildest one of a case that every
    integration has below the threshold, and of several such cases the lowest."""
    if conclusion.verdict != "violated" or conclusion.worst is None:
        return "" if conclusion.verdict != "violated" else "violated by nothing"
    mildest = []
    for finding in findings:
        case = finding.validation
        assert case is not None
        values = [finding.cost, case.cost, *(v.cost for v in (case.half_step, case.integrator) if v is not None)]
        if any(v is None or v > problem.threshold for v in values):
            continue
        most = max(v for v in values if v is not None)
        if not (finding.granted == most or (case.agrees and most - finding.granted <= (case.allowed or 0.0))):
            return f"{finding.label} grants {finding.granted}, and its integrations have {values}"
        mildest.append(finding.granted)
        if case.half_step is not None and not problem.realisations.random:
            vector = problem.vectors(np.array(finding.point)[None, :])
            again = float(problem.system.simulate_vectors(vector, problem.system.step / 2)[0].costs[0, 0])
            if again != case.half_step.cost:
                return f"{finding.label} has {case.half_step.cost} at half the step, and then {again}"
    stated = {conclusion.worst.cost, conclusion.values["worst"], conclusion.worst.margin + problem.threshold}
    if not mildest or any(abs(value - min(mildest)) > 1e-12 for value in stated):
        return f"it states {stated}, and every integration grants {mildest}"
    return ""
