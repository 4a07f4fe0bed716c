"""Several running searches that share one budget: whose turn it is, they decide who use this."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import TypeVar

import numpy as np

from worker.engine.search.base import Batch, Ended, Floats, Parallel, Several, Space


class Member:
    """A search: in whose name its evaluations are, and the points (m, n) that it requests, none before it is ready."""

    def __init__(self, name: str, dimension: int, search: Parallel | None = None) -> None:
        self.name, self.search = name, search
        self.requested: Floats = np.empty((0, dimension))
        self.used = 0
        self.lowest = np.inf

    def advance(self, batch: Batch | None) -> bool:
        """Go on with the values of the requested points, without any begin; returns whether it requests more."""
        assert self.search is not None
        try:
            request = next(self.search) if batch is None else self.search.send(batch)
            assert isinstance(request, np.ndarray)
            self.requested = request.copy()
        except StopIteration:
            self.close()
        return self.search is not None

    def close(self) -> None:
        """End it."""
        if self.search is not None:
            self.search.close()
        self.search = None


M = TypeVar("M", bound=Member)


def taking_turns(
    space: Space,
    members: Sequence[M],
    turn: Callable[[Collection[M]], Sequence[M]],
    tell: Callable[[M, Batch], None],
    enough: int,
) -> Parallel:
    """Run the members until none is left to take a turn.

    turn: the members whose turn it is, given those whose points are being evaluated; tell: passes a member its values.
    enough: requested points in slots from which no further member gets a turn.
    """
    try:
        return (
            yield from (
                _in_slots(space, members, turn, tell, enough) if space.slots else _in_batches(space, turn, tell)
            )
        )
    finally:
        for member in members:
            member.close()


def _in_batches(
    space: Space, turn: Callable[[Collection[M]], Sequence[M]], tell: Callable[[M, Batch], None]
) -> Parallel:
    """One request has the points of every member whose turn it is."""
    while chosen := turn(()):
        for member in chosen:
            space.attribute(member.name, len(member.requested))
        if len(chosen) == 1:
            tell(chosen[0], (yield chosen[0].requested))
            continue
        batch = yield np.concatenate([member.requested for member in chosen])
        for member, own in zip(chosen, batch.split([len(member.requested) for member in chosen]), strict=True):
            tell(member, own)
    return Ended("members", "every member has ended")


def _in_slots(
    space: Space,
    members: Sequence[M],
    turn: Callable[[Collection[M]], Sequence[M]],
    tell: Callable[[M, Batch], None],
    enough: int,
) -> Parallel:
    """Each member continues when its own points have ended; others get a turn while the slots have too little to do."""
    pending: dict[int, M] = {}
    while True:
        request = Several([])
        while sum(len(member.requested) for member in pending.values()) < enough:
            chosen = turn(pending.values())
            if not chosen:
                break
            for member in chosen:
                space.attribute(member.name, len(member.requested))
                pending[members.index(member)] = member
                request.groups.append((members.index(member), member.requested))
        if not pending:
            return Ended("members", "every member has ended")
        batch = yield request
        tell(pending.pop(request.answered), batch)
