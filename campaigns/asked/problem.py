"""A problem of a campaign: its location, what was given, and what is allowed or to be done."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

MOST = 50
"""The largest number of problems reported for one campaign."""

LONGEST = 120
"""The largest number of characters shown of a given value."""

_WRITER = json.JSONEncoder(default=str, ensure_ascii=False)


@dataclass(frozen=True)
class Problem:
    """One problem of a campaign: where, what was given, and what is allowed or to be done."""

    field: str
    given: str
    message: str

    def __str__(self) -> str:
        value = f" (given: {self.given})" if self.given else ""
        return f"{self.field or 'campaign'}: {self.message}{value}"


class CampaignError(ValueError):
    """The campaign cannot be used; `problems` lists why, `source` is the file or request."""

    def __init__(self, source: str, problems: Sequence[Problem], found: int | None = None) -> None:
        """found: the total number of problems, if only the first ones are given."""
        self.source = source
        self.problems = list(problems[:MOST])
        more = (len(problems) if found is None else found) - len(self.problems)
        if more > 0:
            self.problems.append(Problem("", "", f"and {more} more problems"))
        super().__init__(f"{source}: " + "; ".join(map(str, self.problems)))


def shown(value: Any) -> str:
    """A given value in at most 120 characters; of a large one only the beginning is written out."""
    text = ""
    try:
        for piece in _WRITER.iterencode(value):
            text += piece
            if len(text) > LONGEST:
                break
    except (TypeError, ValueError, RecursionError):
        text = type(value).__name__
    text = text.encode("utf-8", "backslashreplace").decode()
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."
