"""The vocabulary of Clearance: campaigns, catalogue, results.

`spec` is the campaign itself, `catalogue` the components and methods it may name, `check` validates one against
the other, `load` reads YAML or JSON. Start reading at `spec.Campaign`.
"""

from __future__ import annotations

import importlib
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
_HOMES = {
    "Campaign": "campaigns.asked.spec",
    "Catalogue": "campaigns.catalogue",
    "check": "campaigns.checked.check",
}
"""The module of each name that is not in `campaigns.asked.load`."""


def __getattr__(name: str) -> Any:
    """Load a name with its module when it is first used: a process that needs one small module loads no other."""
    if name not in __all__:
        raise AttributeError(f"module 'campaigns' has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES.get(name, "campaigns.asked.load")), name)
