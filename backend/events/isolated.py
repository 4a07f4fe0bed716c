"""What is reported is made part by part: one row that cannot be read keeps nothing of the others from the listeners."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import TypeVar

import sqlalchemy as sa

Part = TypeVar("Part")

_log = logging.getLogger(__name__)


class Isolated:
    """Makes parts, each in the log once if it cannot be made; an error of the database concerns them all."""

    def __init__(self) -> None:
        self._logged: set[str] = set()

    def made(self, what: str, make: Callable[[], list[Part]]) -> list[Part]:
        """This part; empty if it cannot be made."""
        try:
            return make()
        except sa.exc.SQLAlchemyError:
            raise
        except Exception:
            if what not in self._logged:
                self._logged.add(what)
                _log.exception("%s cannot be reported in the event streams", what)
            return []
