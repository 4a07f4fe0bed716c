"""Turns a library that calls back for every evaluation into a generator that yields batches.

The library runs on a stack of its own in the same thread (greenlet): to go from one to the other takes 2 us, where
waking another thread takes 50 us or more. A library whose state belongs to a thread gets one of its own; the two take
turns, so they never run at the same time.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator
from concurrent.futures import Future
from contextlib import suppress
from queue import SimpleQueue
from typing import Any, TypeVar

import numpy as np
from greenlet import getcurrent, greenlet

from worker.engine.search.base import Batch, Floats

T = TypeVar("T")
Ask = Callable[[Floats], Batch]


class Abandoned(BaseException):
    """Raised in the library when the driver closes the generator; not caught by `except Exception`."""


def called_back(run: Callable[[Ask], T]) -> Generator[Floats, Batch, T]:
    """Run `run(ask)` and yield the points (m, n) that it requests; returns the result of `run`.

    When the generator is closed, `ask` raises `Abandoned`, now and ever after, and the library ends before close
    returns. The generator stays in the thread that began it.
    """
    abandoned = False

    def ask(points: Floats) -> Batch:
        if abandoned:
            raise Abandoned
        answer: Batch = library.parent.switch(points)
        return answer

    library: Any = greenlet(lambda: run(ask))
    try:
        step = library.switch()
        while not library.dead:
            answer = yield step
            library.parent = getcurrent()  # whoever drives the generator now
            step = library.switch(answer)
        result: T = step
        return result
    finally:
        abandoned = True
        if not library.dead:
            library.parent = getcurrent()
            with suppress(Abandoned, Exception):
                library.throw(Abandoned)


def called_back_in_thread(run: Callable[[Ask], T]) -> Generator[Floats, Batch, T]:
    """Run a library as `called_back` does, in a thread to which its state belongs, such as the random stream of
    NLopt."""
    requests: SimpleQueue[Floats | Future[T]] = SimpleQueue()
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
        ended: Future[T] = Future()
        try:
            ended.set_result(run(ask))
        except BaseException as error:
            ended.set_exception(error)
        requests.put(ended)

    thread = threading.Thread(target=work, name="search", daemon=True)
    thread.start()
    try:
        while True:
            request = requests.get()
            if isinstance(request, Future):
                return request.result()
            answers.put((yield request))
    finally:
        # An interrupt may come at any time: the thread ends whether it is waiting for an answer or about to ask.
        abandoned.set()
        answers.put(nothing)
        thread.join()
