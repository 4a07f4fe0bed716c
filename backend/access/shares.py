"""How much each user has open at a time, and of that each session and token.

A user's limit is one for all sessions and tokens, so that more tokens do not give more. One of them gets at most four
fifths of it, so that a program that uses its whole share leaves the user's browser something.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from backend.db.access import Visitor


def of_one(most: int) -> int:
    """The part of a user's limit that one session or token may use."""
    return max(1, most * 4 // 5)


class Shares:
    """Counts what is open; used on one event loop."""

    def __init__(self, what: str, most: int) -> None:
        """what: such as "requests"; most: of a user."""
        self.what, self.most = what, most
        self._users: Counter[str] = Counter()
        self._keys: Counter[str] = Counter()

    def full(self, visitor: Visitor) -> str:
        """The limit that is reached for this visitor; empty if there is none."""
        if self._users[visitor.account] >= self.most:
            return f"{self.most} {self.what} of your sessions and tokens are open, which is the limit"
        if self._keys[visitor.key] >= of_one(self.most):
            return f"{of_one(self.most)} {self.what} of this session or token are open, which is the limit"
        return ""

    @contextmanager
    def entered(self, visitor: Visitor) -> Iterator[None]:
        counted = ((self._users, visitor.account), (self._keys, visitor.key))
        for counter, key in counted:
            counter[key] += 1
        try:
            yield
        finally:
            for counter, key in counted:
                counter[key] -= 1
                if not counter[key]:
                    del counter[key]
