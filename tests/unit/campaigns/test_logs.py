"""The log: JSON objects, and one line a minute of what is repeated."""

from __future__ import annotations

import io
import json
import logging
from collections.abc import Iterator

import pytest

from campaigns import logs


class Log:
    """A logger in the form of JSON, on a clock that stands."""

    def __init__(self) -> None:
        self.now, self._stream = 0.0, io.StringIO()
        self.logger = logging.getLogger("clearance.test_logs")
        handler = logs.handler({"CLEARANCE_LOG": "json"}, "")
        assert isinstance(handler, logging.StreamHandler)
        handler.setStream(self._stream)
        self.logger.handlers, self.logger.propagate = [handler], False
        self.logger.setLevel(logging.INFO)

    def times(self, number: int) -> str:
        """What ends the line of a repeated message."""
        return f"({number} times since the last line)"

    def lines(self) -> list[dict[str, str]]:
        """What was logged since the last call."""
        found = [json.loads(line) for line in self._stream.getvalue().splitlines()]
        self._stream.seek(0)
        self._stream.truncate()
        return found


@pytest.fixture
def log(monkeypatch: pytest.MonkeyPatch) -> Iterator[Log]:
    made = Log()
    monkeypatch.setattr(logs, "monotonic", lambda: made.now)
    monkeypatch.setattr(logs, "present", {"worker": "w"})
    yield made
    made.logger.handlers = []


def test_a_line_is_an_object_with_what_is_known(log: Log) -> None:
    log.logger.info("a %s\nin lines", "message", extra={"run": "R-0001", "address": "10.0.0.1"})
    try:
        raise ValueError("wrong")
    except ValueError:
        log.logger.exception("failed")
    first, second = log.lines()
    assert first.pop("time").startswith("20")
    message = {"message": "a message\nin lines", "level": "INFO", "logger": "clearance.test_logs"}
    assert first == message | {"run": "R-0001", "address": "10.0.0.1", "worker": "w"}
    assert second["error"].endswith("ValueError: wrong")


def test_a_repeated_error_is_one_line_a_minute_with_its_number(log: Log) -> None:
    for _ in range(100):
        log.logger.error("database away")
    log.logger.error("another one")
    for _ in range(2):
        log.logger.info("a run")
    assert [line["message"] for line in log.lines()] == ["database away", "another one", "a run", "a run"]
    log.now += logs.PERIOD
    log.logger.error("database away")
    [line] = log.lines()
    assert line["message"].startswith("database away (100 times")


def test_numbers_of_tasks_and_addresses_in_memory_make_no_other_message(log: Log) -> None:
    text = "Task exception was never retrieved\nfuture: <Task finished name='Task-%d' coro=<seen() at 0x7f%x>>"
    for number in range(2 * logs.MOST):
        log.logger.error(text, number, 4096 + number)
    [line] = log.lines()
    assert line["message"] == text % (0, 4096)
    log.now += logs.PERIOD
    log.logger.error(text, 7, 7)
    [line] = log.lines()
    assert line["message"] == f"{text % (7, 7)} {log.times(2 * logs.MOST)}"


def test_an_unknown_form_is_refused() -> None:
    with pytest.raises(ValueError, match="CLEARANCE_LOG"):
        logs.handler({"CLEARANCE_LOG": "xml"}, "")
