"""The log of a service or worker: lines of text, or of JSON with CLEARANCE_LOG=json; a repeated one once a minute."""

from __future__ import annotations

import json
import logging
import re
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from time import monotonic

PERIOD = 60.0
"""Time in which the same warning or error is one line [s]."""
MOST = 1000
"""Different messages that are remembered."""
FIELDS = ("run", "stage", "worker", "address", "status")
"""What a line of JSON states besides, where it is known."""
VARIABLE = "CLEARANCE_LOG"

OWN = re.compile(r"\bTask-\d+|\b0x[0-9a-fA-F]+")
"""What differs in otherwise equal messages: numbers of tasks, addresses in memory."""

present: dict[str, str | Callable[[], str] | None] = {}
"""The fields that this process is occupied with now, such as its run; a function is asked when a line is written."""


class Repeats(logging.Filter):
    """Passes the first of equal warnings, and after a minute the next one with their number."""

    def __init__(self) -> None:
        super().__init__()
        self._seen: dict[tuple[str, int, str], tuple[float, int]] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        if record.levelno < logging.WARNING:
            return True
        text, at = record.getMessage(), monotonic()
        key = (record.name, record.levelno, OWN.sub("", text))
        since, count = self._seen.get(key, (-PERIOD, 0))
        if at - since < PERIOD:
            self._seen[key] = since, count + 1
            return False
        if len(self._seen) >= MOST:
            self._seen.clear()
        self._seen[key] = at, 0
        if count:
            record.msg, record.args = f"{text} ({count + 1} times since the last line)", None
        return True


class Json(logging.Formatter):
    """One object a line."""

    def format(self, record: logging.LogRecord) -> str:
        line: dict[str, str | int] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname,
            "logger": record.name,
            "message": record.getMessage(),
        }
        now = {name: value() if callable(value) else value for name, value in present.items()}
        known = {**now, **record.__dict__}
        line |= {name: known[name] for name in FIELDS if known.get(name) not in (None, "")}
        if record.exc_info:
            line["error"] = self.formatException(record.exc_info)
        return json.dumps(line, default=str)


def handler(environment: Mapping[str, str], text: str) -> logging.Handler:
    """A handler that writes to standard error. text: the format of lines that are not JSON.

    Raises `ValueError` for an unknown form.
    """
    form = environment.get(VARIABLE, "text") or "text"
    if form not in ("text", "json"):
        raise ValueError(f"{VARIABLE} is text or json, given {form!r}")
    found = logging.StreamHandler()
    found.setFormatter(Json() if form == "json" else logging.Formatter(text))
    found.addFilter(Repeats())
    return found


def set_up(environment: Mapping[str, str], text: str) -> None:
    """Have this process log by such a handler."""
    logging.basicConfig(level=logging.INFO, handlers=[handler(environment, text)])
