"""Processes only the newest request."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from typing import Generic, TypeVar

Request = TypeVar("Request")
_log = logging.getLogger(__name__)


class Latest(Generic[Request]):
    """One thread that processes the newest request; requests superseded while it works are dropped.

    Responses therefore cannot arrive out of order, and there is no backlog.
    """

    def __init__(self, work: Callable[[Request], None]) -> None:
        self._work = work
        self._changed = threading.Condition()
        self._request_slot: list[Request] = []
        self._stopped = False
        threading.Thread(target=self._loop, name="what-if", daemon=True).start()

    def ask(self, request: Request) -> None:
        """Process this next, replacing the waiting request."""
        with self._changed:
            self._request_slot = [request]
            self._changed.notify()

    def stop(self) -> None:
        with self._changed:
            self._stopped = True
            self._changed.notify()

    def _loop(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._request_slot or self._stopped)
                if self._stopped:
                    return
                request = self._request_slot.pop()
            try:
                self._work(request)
            except Exception:
                _log.exception("a what-if flight failed")
