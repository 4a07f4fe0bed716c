"""How likely findings are, and the most likely violation, again from the stored points; a folder states both."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from campaigns.densities.joint import Joint, joint
from campaigns.densities.likelihood import Rows, likelihood, most_likely
from campaigns.results.base import Described
from campaigns.results.likelihood import MostLikely
from worker.evidence.audit import limits
from worker.evidence.audit.parts import OMIT, Finding, changed, made
from worker.evidence.audit.recompute import Run

Part = TypeVar("Part", bound=Described)


def likely(run: Run, findings: list[Finding]) -> tuple[list[Finding], MostLikely]:
    """The findings with their likelihood, and the most likely violation; nothing of a service's record, or of an
    earlier version's that states neither."""
    stated = [*run.claims["findings"], {"likelihood": run.claims.get("most_likely_violation")}]
    if (run.reworded or "run" in run.claims) and not any(one.get("likelihood") for one in stated):
        return findings, OMIT
    of = replace(joint(run.campaign, run.bounds), by_scores=run.written < limits.ALIKE and _by_scores(stated))
    points = [np.array(recorded["point"]) for recorded in run.claims["findings"]]
    known = [f._replace(likelihood=_stated(run, likelihood(of, at))) for f, at in zip(findings, points, strict=True)]
    return known, _violation(run, of)


def _by_scores(stated: list[Any]) -> bool:
    """Whether the record of an earlier version states what that version computed: a service computes the likelihoods of
    stored runs when it is asked, so that records of theirs may state what later versions do."""
    *findings, violation = [one.get("likelihood") or {} for one in stated]
    case = violation.get("case") or {}
    measured = [one.get("density") is not None for one in (*findings, case.get("likelihood") or {})]
    return any(measured) or not case


def _violation(run: Run, of: Joint) -> MostLikely:
    nominal = {path: run.known[path][1] for path in run.bounds}
    rows = (run.rows(k) for k in range(len(run.plan)))
    stored = (Rows(k, 0, points, costs[:, None], status) for k, (points, costs, status) in enumerate(rows))
    found = _stated(run, most_likely(run.threshold, of, nominal, stored, run.unit))
    if found.case is None:
        return found
    case = changed(found.case, likelihood=_stated(run, found.case.likelihood), realisation=OMIT)
    return changed(found, case=case)


def _stated(run: Run, part: Part) -> Part:
    """What the record must state of it, defaults too; sentences of other templates are not made again."""
    numbers = {name: getattr(part, name) for name in type(part).model_fields if name != "statement"}
    return made(type(part), **numbers, statement=OMIT if run.reworded else part.statement)
