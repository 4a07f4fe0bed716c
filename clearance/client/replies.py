"""What a service has answered to a request."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any

BUSY = (429, 502, 503, 504)


@dataclass(frozen=True)
class Reply:
    """An answer; status 0: there was none, and content is the reason."""

    status: int
    phrase: str
    headers: Mapping[str, str]
    content: bytes

    @property
    def problem(self) -> Mapping[str, Any]:
        """The problem document; empty if there is none or it is incomplete."""
        if not str(self.headers.get("content-type", "")).startswith("application/problem+json"):
            return {}
        try:
            document = json.loads(self.content)
        except ValueError:
            return {}
        return document if isinstance(document, dict) else {}

    @property
    def retry_after(self) -> float | None:
        """Seconds, from either form of the header (RFC 9110, 10.2.3)."""
        header = str(self.headers.get("retry-after", "")).strip()
        if header.isascii() and header.isdigit():
            return float(header)
        try:
            return max(0.0, (parsedate_to_datetime(header) - datetime.now(UTC)).total_seconds())
        except (ValueError, TypeError):
            return None

    @property
    def again(self) -> bool:
        """Whether the same request may be answered later: nothing was answered, or the service is busy."""
        final = self.problem and self.retry_after is None  # such as a report that cannot be printed
        return self.status == 0 or (self.status in BUSY and not final)

    @property
    def message(self) -> str:
        """What was answered, in words."""
        if self.status == 0:
            return self.content.decode(errors="replace")
        return str(self.problem.get("detail") or f"it responded with {self.status}")
