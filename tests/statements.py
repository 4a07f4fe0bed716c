"""Statements are compiled once for all SQLite databases of the tests, not once for each.

SQLAlchemy keeps compiled statements with their engine, by dialect, as it must where databases differ in version and
settings. A service has one engine; the tests have thousands, all of one version with the same settings.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from sqlalchemy import Engine, util

Key = tuple[Any, ...]


class Compiled:
    """What an engine's cache of compiled statements does, without the dialect, the first part of every key."""

    def __init__(self) -> None:
        self.kept: util.LRUCache[Key, Any] = util.LRUCache(5_000)

    def get(self, key: Key) -> Any:
        return self.kept.get(key[1:])

    def __setitem__(self, key: Key, compiled: Any) -> None:
        self.kept[key[1:]] = compiled

    def __len__(self) -> int:
        return len(self.kept)

    def __iter__(self) -> Iterator[Key]:
        return iter(self.kept)

    def clear(self) -> None:
        """An engine is cleared when its database's version is found: the others keep what they have."""


def share() -> None:
    """From now on for every new engine."""
    made, compiled = Engine.__init__, Compiled()

    def sharing(self: Engine, *arguments: Any, **settings: Any) -> None:
        made(self, *arguments, **settings)
        if self.dialect.name == "sqlite":
            self._compiled_cache = compiled  # type: ignore[assignment]

    Engine.__init__ = sharing  # type: ignore[method-assign]
