"""Component descriptions as a later version may write them, in a form that this one cannot read."""

from __future__ import annotations

from typing import Any

NEWER = "99.0"
FORMS: dict[str, dict[str, object]] = {
    "one more field": {"novel": 1},
    "an unknown value": {"frame": "body"},
    "a new role": {"role": "wind"},
}
"""What it may change in the description of a component."""


def in_form(document: dict[str, Any], form: str, version: str = NEWER) -> dict[str, Any]:
    """A catalogue, or the stored descriptions of a run, in that form and of that version."""
    first, *others = document["components"]
    return {**document, "version": version, "components": [first | FORMS[form], *others]}
