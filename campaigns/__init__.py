"""The vocabulary of Clearance: campaigns, catalogue, results.

`spec` is the campaign itself, `catalogue` the components and methods it may name, `check` validates one against
the other, `load` reads YAML or JSON. Start reading at `spec.Campaign`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from campaigns.asked.load import CampaignError, Problem, library, load_file, load_text
    from campaigns.asked.spec import Campaign
    from campaigns.catalogue import Catalogue
    from campaigns.checked.check import check

__all__ = [
    "Campaign",
    "CampaignError",
    "Catalogue",
    "Problem",
    "check",
    "library",
    "load_file",
    "load_text",
]


def __getattr__(name: str) -> Any:
    """Load all names when the first is used: a process that needs one small module of the folder loads no other.

    By statements that import, which tell the code that a run uses.
    """
    if name not in __all__:
        raise AttributeError(f"module 'campaigns' has no attribute {name!r}")
    from campaigns.asked.load import CampaignError, Problem, library, load_file, load_text
    from campaigns.asked.spec import Campaign
    from campaigns.catalogue import Catalogue
    from campaigns.checked.check import check

    found = (Campaign, CampaignError, Catalogue, Problem, check, library, load_file, load_text)
    globals().update(zip(__all__, found, strict=True))
    return globals()[name]
