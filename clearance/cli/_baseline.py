"""`clearance run --baseline`: the campaign with the findings of a folder of results, or of a stored run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError, refusing
from clearance.cli._where import existing_url_of, reading, stored_run

if TYPE_CHECKING:
    from campaigns import Campaign
    from campaigns.catalogue import Catalogue

LONGEST = 120
"""Characters of the name of a baseline."""


def compared(campaign: Campaign, baseline: str, data: Path, database: str) -> tuple[Campaign, str]:
    """The campaign with its baseline, and the sentence that states it; raises `WrongInputError`.

    baseline: a folder of `clearance run --out`, R-0001, or label:KEY=VALUE. If no run has the label, the campaign is
    unchanged, and the sentence states so.
    """
    from backend.db.engine import migrate
    from campaigns.checked.units import differing, fixed
    from campaigns.results.baselines import CannotCompare, with_baseline
    from clearance.cli.replay import of_folder
    from worker.running.catalogue.installed import catalogue

    with refusing(CannotCompare):
        if stored_run(baseline) is None and Path(baseline).is_dir():
            recorded = of_folder(Path(baseline))
            name = baseline[-LONGEST:]
            then = _components(Path(baseline))
            units = "" if then is None else differing(recorded.campaign, then, campaign, catalogue())
            values = None if then is None else fixed(recorded.campaign, then)
            made = with_baseline(campaign, name, recorded.campaign, recorded.findings, units, values)
            return made, f"Baseline: {name}."
        from backend.db import baselines

        url = existing_url_of(data, database)
        migrate(url)
        with reading(url) as reader:
            found = baselines.resolved(reader, campaign, baseline, catalogue())
        return found.campaign, found.sentence


def _components(folder: Path) -> Catalogue | None:
    from campaigns.unreadable import UNREADABLE
    from clearance.local.results import components_of

    try:
        return components_of(folder)
    except UNREADABLE as error:
        why = f"its components cannot be read ({' '.join(str(error).split())[:200]})"
        raise WrongInputError(f"{folder} cannot be the baseline: {why}", RefusalCode.UNREADABLE) from None
