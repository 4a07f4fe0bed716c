"""Case 1 with changes, for tests that need their own campaign or problem."""

from __future__ import annotations

import copy
from functools import cache
from typing import Any

from campaigns import Campaign, library, load_file
from campaigns.asked.load import load_document
from clearance.testing.problems import Problem

CASE1 = load_file(library()["unicycle_static"]).document()


def document(**changes: Any) -> dict[str, Any]:
    """Case 1 as a document; `scenario__step=0.01` changes that value, None for a last key removes it."""
    made: dict[str, Any] = copy.deepcopy(CASE1)
    for place, value in changes.items():
        *above, last = place.split("__")
        held: Any = made
        for key in above:
            held = held[int(key)] if isinstance(held, list) else held[key]
        if isinstance(held, list):
            held[int(last)] = value
        else:
            held[last] = value
    return made


def nested(values: dict[str, Any]) -> dict[str, Any]:
    """Dotted names as nested mappings."""
    made: dict[str, Any] = {}
    for name, value in values.items():
        *above, last = name.split(".")
        held = made
        for key in above:
            held = held.setdefault(key, {})
        held[last] = value
    return made


def campaign(**changes: Any) -> Campaign:
    """Case 1 as a campaign, with changes as in `document`."""
    return load_document(document(**changes))


def searching(*searches: dict[str, Any], **changes: Any) -> Campaign:
    """Case 1 with these search stages, few neighbours and a coarse sensitivity: quick to run."""
    stages = {
        "sensitivity": {"points": 5},
        "search": list(searches),
        "validate": {"neighbours": 20, "evaluations": 20_000},
    }
    return campaign(stages=stages, **changes)


@cache
def case1() -> Problem:
    """Case 1 as a problem."""
    return Problem(campaign())
