"""The vocabulary of Clearance: campaigns, catalogue, results.

`spec` is the campaign itself, `catalogue` the components and methods it may name, `check` validates one against
the other, `load` reads YAML or JSON. Start reading at `spec.Campaign`.
"""

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
