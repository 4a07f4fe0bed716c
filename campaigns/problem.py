"""What is wrong with a campaign: where it stands, what was given, and what is allowed or to do.

Start reading at `Problem`.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

MOST = 50
"""Problems told of one campaign; more help nobody."""


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a campaign: where, what was given, and what is allowed or to do."""

    field: str
    given: str
    message: str

    def __str__(self) -> str:
        given = f" (given: {self.given})" if self.given else ""
        return f"{self.field or 'campaign'}: {self.message}{given}"


class CampaignError(ValueError):
    """The campaign cannot be used; `problems` lists why, `source` says which file or request it came from."""

    def __init__(self, source: str, problems: Sequence[Problem]) -> None:
        self.source = source
        self.problems = list(problems[:MOST])
        if len(problems) > MOST:
            self.problems.append(Problem("", "", f"and {len(problems) - MOST} more problems"))
        super().__init__(f"{source}: " + "; ".join(map(str, self.problems)))


def shown(value: Any) -> str:
    """A given value in at most 120 characters."""
    try:
        text = json.dumps(value, default=str, ensure_ascii=False)
    except (TypeError, ValueError, RecursionError):
        text = type(value).__name__
    text = text.encode("utf-8", "backslashreplace").decode()
    return text if len(text) <= 120 else text[:117] + "..."
