"""The noise realisations of stored evaluations and findings that drew one of their own, by their seeds.

Which stages draw them is in their declarations (`campaigns.stages`).
"""

from __future__ import annotations

import numpy as np
import sqlalchemy as sa
from numpy.typing import NDArray

from backend.db.continuation import sample_seed
from backend.db.tables import Finding, Stage
from campaigns import Campaign
from campaigns.results.draws import of_draws
from campaigns.stages.found import declared, stage_result

Seeds = NDArray[np.int64]
NONE: Seeds = np.array([], dtype=np.int64)


def drawn(reader: sa.Connection, run_id: int, campaign: Campaign) -> dict[int, Seeds]:
    """The seeds of the leading evaluations of a stage that each drew one, {position: seeds}.

    A stage reports their number when it ends.
    """
    drawing = {kind: stage.draws for kind, stage in declared().items() if stage.draws is not None}
    query = sa.select(Stage.position, Stage.kind, Stage.result, Stage.evaluations)
    query = query.where(Stage.run_id == run_id, Stage.kind.in_(drawing))
    found: dict[int, Seeds] = {}
    drawn_at_launch = sample_seed(reader, run_id)
    seed = campaign.seed if drawn_at_launch is None else drawn_at_launch.value
    for row in reader.execute(query).all():
        result = None if row.result is None else stage_result(row.result)
        count = drawing[row.kind](campaign, row.evaluations) if result is None else result.drawn
        known = None if result is None else result.seeds
        leading = min(count, row.evaluations)
        found[row.position] = of_draws(seed, 0, leading) if known is None else np.array(known, np.int64)
    return found


def seeds(reader: sa.Connection, run_id: int) -> dict[str, int]:
    """The seeds of the findings that drew a realisation of their own, by label."""
    rows = reader.execute(sa.select(Finding.label, Finding.validation).where(Finding.run_id == run_id)).all()
    found = {row.label: (row.validation or {}).get("realisation") for row in rows}
    return {label: int(seed) for label, seed in found.items() if seed is not None}
