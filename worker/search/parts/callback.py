"""Turns a library that calls back for every evaluation into a generator that yields batches.

The library runs in its own thread; it and the generator take turns, so they never run at the same time.
Start reading at `called_back`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator
from queue import SimpleQueue
from typing import TypeVar

import numpy as np

from worker.search.base import Batch, Floats

T = TypeVar("T")
Ask = Callable[[Floats], Batch]


class Abandoned(BaseException):
    """Raised inside the library's thread when the driver closes it; not caught by `except Exception`."""


class _Raised:
    def __init__(self, error: BaseException) -> None:
        self.error = error


class _Returned:
    def __init__(self, value: object) -> None:
        self.value = value


def called_back(run: Callable[[Ask], T]) -> Generator[Floats, Batch, T]:
    """Run `run(ask)` in a thread and yield the points (m, n) that it requests; returns the result of `run`.

    When the generator is closed, `ask` raises `Abandoned` in the thread and the thread ends before close returns.
    """
    requests: SimpleQueue[Floats | _Raised | _Returned] = SimpleQueue()
    answers: SimpleQueue[Batch] = SimpleQueue()
    nothing = Batch(np.empty((0, 0)), np.empty(0, dtype=np.uint8))
    abandoned = threading.Event()

    def ask(points: Floats) -> Batch:
        requests.put(points)
        answer = nothing if abandoned.is_set() else answers.get()
        if abandoned.is_set():
            raise Abandoned
        return answer

    def work() -> None:
        try:
            requests.put(_Returned(run(ask)))
        except BaseException as error:
            requests.put(_Raised(error))

    thread = threading.Thread(target=work, name="search", daemon=True)
    thread.start()
    try:
        while True:
            request = requests.get()
            if isinstance(request, _Returned):
                return request.value  # type: ignore[return-value]
            if isinstance(request, _Raised):
                raise request.error
            answers.put((yield request))
    finally:
        # An interrupt may come at any time: the thread ends whether it is waiting for an answer or about to ask.
        abandoned.set()
        answers.put(nothing)
        thread.join()
