"""What a user has open counts together, and one session or token gets four fifths of it."""

from __future__ import annotations

import contextlib

from backend.access.shares import Shares
from backend.db.access import Visitor


def token(number: int, owner: str = "ada") -> Visitor:
    return Visitor(f"ci-{number}", "token", f"key-{number}", owner)


def test_more_tokens_do_not_give_more() -> None:
    shares = Shares("streams", 5)
    with contextlib.ExitStack() as stack:
        for number in range(5):
            assert not shares.full(token(number))
            stack.enter_context(shares.entered(token(number)))
        assert "5 streams of your" in shares.full(token(9))
        assert not shares.full(token(9, "bea"))
    assert not shares.full(token(9))


def test_one_token_leaves_the_others_something() -> None:
    shares = Shares("streams", 5)
    with contextlib.ExitStack() as stack:
        for _ in range(4):
            stack.enter_context(shares.entered(token(1)))
        assert "4 streams of this" in shares.full(token(1))
        assert not shares.full(token(2))
