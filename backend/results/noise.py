"""The noise realisations of stored evaluations and findings that drew one of their own, by their seeds.

The certify stage draws one for every evaluation of its sample, the baseline stage repeats those of its findings.
"""

from __future__ import annotations

import sqlalchemy as sa

from backend.db.tables import Finding, Stage
from campaigns import Campaign
from campaigns.results.baseline import BaselineResult
from campaigns.results.draws import of_draws


def drawn(reader: sa.Connection, run_id: int, campaign: Campaign) -> dict[int, list[int]]:
    """The seeds of the leading evaluations of a stage that each drew one, {position: seeds}.

    A certify stage reports their number when it ends. Until then it has drawn at least the requested number before it
    starts its grid; without noise a realisation has no effect.
    """
    query = sa.select(Stage.position, Stage.kind, Stage.result, Stage.evaluations)
    query = query.where(Stage.run_id == run_id, Stage.kind.in_(("certify", "baseline")))
    certify = campaign.stages.certify
    found = {}
    for row in reader.execute(query).all():
        if row.kind == "certify":
            begun = certify.samples if certify is not None and certify.grid is not None else row.evaluations
            count = begun if row.result is None else int(row.result.get("drawn_realisations") or 0)
            found[row.position] = of_draws(campaign.seed, 0, min(count, row.evaluations)).tolist()
        elif row.result is not None:
            found[row.position] = BaselineResult.model_validate(row.result).seeds
    return found


def seeds(reader: sa.Connection, run_id: int) -> dict[str, int]:
    """The seeds of the findings that drew a realisation of their own, by label."""
    rows = reader.execute(sa.select(Finding.label, Finding.validation).where(Finding.run_id == run_id)).all()
    found = {row.label: (row.validation or {}).get("realisation") for row in rows}
    return {label: int(seed) for label, seed in found.items() if seed is not None}
