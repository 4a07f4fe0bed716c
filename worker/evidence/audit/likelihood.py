"""How likely findings are, and the most likely violation, again from the stored points; a folder states both."""

from __future__ import annotations

from typing import Any

import numpy as np

from campaigns.densities.joint import Joint, joint
from campaigns.densities.likelihood import Rows, likelihood, most_likely
from worker.evidence.audit.recompute import Run, Tree


def likely(run: Run, findings: list[Tree]) -> Tree:
    """The findings with their likelihood, and the most likely violation; nothing of a service's record, or of an
    earlier version's that states neither."""
    stated = [*run.claims["findings"], {"likelihood": run.claims.get("most_likely_violation")}]
    if (run.reworded or "run" in run.claims) and not any(one.get("likelihood") for one in stated):
        return {}
    of = joint(run.campaign, run.bounds)
    points = [np.array(recorded["point"]) for recorded in run.claims["findings"]]
    known = [f | {"likelihood": _stated(run, likelihood(of, at))} for f, at in zip(findings, points, strict=True)]
    return {"findings": known, "most_likely_violation": _violation(run, of)}


def _violation(run: Run, of: Joint) -> Tree:
    nominal = {path: run.known[path][1] for path in run.bounds}
    rows = (run.rows(k) for k in range(len(run.plan)))
    stored = (Rows(k, 0, points, costs[:, None], status) for k, (points, costs, status) in enumerate(rows))
    made = most_likely(run.threshold, of, nominal, stored, run.unit)
    found = _stated(run, made)
    if made.case is not None:
        found["case"] = made.case.model_dump(exclude={"realisation", "likelihood"})
        found["case"]["likelihood"] = _stated(run, made.case.likelihood)
    return found


def _stated(run: Run, made: Any) -> Tree:
    """What the record must state of it; sentences of other templates are not made again."""
    numbers: Tree = made.model_dump(exclude={"statement", "text"})
    return numbers if run.reworded else numbers | {"statement": made.statement}
