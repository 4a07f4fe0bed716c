"""Units of what two campaigns have in common, and the code of their criterion: numbers of one mean the same in the
other only if they are equal."""

from __future__ import annotations

import math

from campaigns.asked.criteria import deciding
from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.checked.check import parameters
from campaigns.checked.lists import Listed, matched, renamed
from campaigns.checked.texts import unit

CRITERION = "its criterion"


def differing(then: Campaign, before: Catalogue, now: Campaign, here: Catalogue) -> str:
    """The first unit of the criterion or of a common parameter that differs, of those that either campaign varies, as a
    clause; empty if none.

    A criterion of the operator's own must also be computed by the same code: of a changed one, a case may look fixed.
    """
    code = _other_code(then, before, here)
    if code:
        return code
    was, is_ = _units(then, before), _units(now, here)
    parts = matched(_listed(then, before), _listed(now, here))
    for name in [CRITERION, *sorted(was.keys() - {CRITERION})]:
        there = name if name == CRITERION else renamed(name, parts)
        if there is None or name not in was or not (name in then.uncertain or there in {CRITERION, *now.uncertain}):
            continue
        if unit(was[name]) != unit(is_.get(there, was[name])):
            return f"{name} is in {was[name] or 'no unit'}, here it is in {is_[there] or 'no unit'}"
    return ""


def fixed(then: Campaign, before: Catalogue) -> dict[str, float]:
    """The values of the parameters that a campaign does not vary, by path."""
    known = parameters(then, before).items()
    return {path: value for path, (_, value) in known if path not in then.uncertain and math.isfinite(value)}


def _units(campaign: Campaign, catalogue: Catalogue) -> dict[str, str]:
    found = {path: entry.unit for path, (entry, _) in parameters(campaign, catalogue).items()}
    decides = deciding(campaign, catalogue)
    return found if decides is None else {CRITERION: decides.unit, **found}


def _listed(campaign: Campaign, catalogue: Catalogue) -> Listed:
    return Listed.of(campaign, {path: value for path, (_, value) in parameters(campaign, catalogue).items()})


def _other_code(then: Campaign, before: Catalogue, here: Catalogue) -> str:
    """That the code of the criterion has changed, as a clause; empty if not, or if either is unknown."""
    name = "" if then.simulator is not None else then.criterion.component
    was, is_ = before.component("criterion", name), here.component("criterion", name)
    if was is None or is_ is None or not was.computed_by or not is_.computed_by or was.computed_by == is_.computed_by:
        return ""
    return (
        f"the file of its criterion {name} has changed since; a comparison needs the same criterion, so run this "
        "campaign without a baseline first"
    )
