"""How likely the findings of a run in this process are, and its most likely violation."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from campaigns import Campaign
from campaigns.densities.joint import joint
from campaigns.densities.likelihood import Rows, likelihood, most_likely
from campaigns.results import Finding
from campaigns.results.draws import of_draws
from campaigns.results.likelihood import Likelihood, LikelyFinding, MostLikely
from worker.running.runs.store import MemoryStore


class Likelihoods(NamedTuple):
    """Of each finding by its label, and the most likely violation; without a nominal case nothing is known."""

    findings: dict[str, Likelihood]
    violation: MostLikely | None

    def text(self, label: str) -> str:
        """The clause on a finding; empty where no likelihood is stated."""
        of = self.findings.get(label)
        return "" if of is None or of.density is None else of.text

    def stated(self, finding: Finding) -> Finding:
        """The finding with its likelihood, if that is known."""
        of = self.findings.get(finding.label)
        return finding if of is None else LikelyFinding.model_validate(vars(finding) | {"likelihood": of})


def likelihoods(campaign: Campaign, store: MemoryStore, unit: str) -> Likelihoods:
    """unit: of the deciding criterion."""
    first = store.stages[0].result if store.stages else None
    nominal = first.at_nominal.parameters if first is not None and first.at_nominal is not None else {}
    if not nominal.keys() >= campaign.uncertain.keys():
        return Likelihoods({}, None)
    of = joint(campaign, {path: one.interval(nominal[path]) for path, one in campaign.uncertain.items()})
    findings = {found.label: likelihood(of, np.array(found.point)) for found in store.findings}
    return Likelihoods(findings, most_likely(campaign.criterion.threshold, of, nominal, _rows(campaign, store), unit))


def _rows(campaign: Campaign, store: MemoryStore) -> Iterator[Rows]:
    for position, record in enumerate(store.stages):
        columns, result = store.evaluations(position), record.result
        if columns is None:
            continue
        seed = campaign.seed if store.sample_seed is None else store.sample_seed.value
        drawn = 0 if result is None else result.drawn
        known = None if result is None else result.seeds
        seeds = of_draws(seed, 0, drawn).tolist() if known is None else known
        yield Rows(position, 0, columns.points, columns.costs, columns.status, seeds)
