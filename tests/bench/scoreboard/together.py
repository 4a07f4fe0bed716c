"""Searches side by side, each in a process of its own, their points evaluated together: this fills the lanes of a
closed loop, of which a simulation alone takes as long as sixteen. A search gets the values that it would get alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import TypeVar

import numpy as np

from clearance.testing.searching import Function
from worker.engine.search.base import Floats

T = TypeVar("T")
_CONTEXT = get_context("fork")  # what is compiled and imported is there at once


def together(searches: Sequence[Callable[[Function], T]], function: Function) -> list[T | Exception]:
    """What each search returns or raises, in the given order; each is given a function that has these values."""
    found: list[T | Exception] = [RuntimeError("its process ended")] * len(searches)
    waiting: dict[Connection, int] = {}
    for number, search in enumerate(searches):
        waiting[_begun(search, [*waiting])] = number
    try:
        while waiting:
            requests = _requests(waiting, found)
            if requests:
                values = function(np.concatenate([*requests.values()]))
                ends = np.cumsum([len(points) for points in requests.values()])
                for connection, part in zip(requests, np.split(values, ends[:-1]), strict=True):
                    with suppress(ConnectionError):  # it died meanwhile, which is received next
                        connection.send(part)
    finally:
        for connection in waiting:
            connection.close()
    return found


def _requests(waiting: dict[Connection, int], found: list[T | Exception]) -> dict[Connection, Floats]:
    """The points of every search that goes on; what has ended is found, and waits no more."""
    requests: dict[Connection, Floats] = {}
    for connection, number in [*waiting.items()]:
        try:
            ended, content = connection.recv()
        except (EOFError, ConnectionError):
            ended, content = True, found[number]
        if ended:
            found[waiting.pop(connection)] = content
            connection.close()
        else:
            requests[connection] = content
    return requests


def _begun(search: Callable[[Function], T], others: Sequence[Connection]) -> Connection:
    ours, theirs = _CONTEXT.Pipe()
    _CONTEXT.Process(target=_search, args=(search, theirs, [ours, *others]), daemon=True).start()
    theirs.close()
    return ours


def _search(search: Callable[[Function], T], parent: Connection, of_the_parent: Sequence[Connection]) -> None:
    for connection in of_the_parent:  # or no search would notice that the parent has ended
        connection.close()

    def evaluated(points: Floats) -> Floats:
        parent.send((False, points))
        values: Floats = parent.recv()
        return values

    try:
        found: T | Exception = search(evaluated)
    except Exception as raised:
        found = raised
    with suppress(ConnectionError):  # nobody waits for it any more
        parent.send((True, found))
