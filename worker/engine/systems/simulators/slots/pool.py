"""Slots side by side: hands out evaluations, and replaces a process that died, hung, leaked or served long enough.

One thread owns all processes (they die with the thread that started them) and waits on their pipes and on their deaths.
Whatever an evaluation does, it comes to an `Outcome`, and no other is lost.
"""

from __future__ import annotations

import contextlib
import os
import selectors
import signal
import threading
import time
import traceback
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass

from worker.engine.systems.simulators.declared.excluded import misstated, stated
from worker.engine.systems.simulators.slots.outcome import Kind, Limits, Outcome, Request, Slots
from worker.engine.systems.simulators.slots.program import Program, TooLong, misidentified
from worker.engine.systems.simulators.slots.slot import Slot

AHEAD = 8
"""So many evaluations wait in a slot's pipe while they are shorter than `SHORT`: otherwise the pipe dominates."""
SHORT = 0.002
"""[s]"""
UNASKED = "its process wrote an answer that nothing had asked for: earlier results may be those of other points"
HARMLESS = "its process wrote an answer that nothing had asked for; no result is affected, as each has its request's id"
NEVER = "; it has never answered: does it flush its standard output after every answer?"
PAUSE = 0.02
"""Time from the first answer of a process of JSON lines to its second request [s]: an answer too many, which would be
taken for that of the second request, arrives meanwhile."""
FAILED_STARTS = 3
"""After so many starts in a row that failed, what waits is answered with the reason."""


@dataclass(frozen=True)
class _Job:
    request: Request
    future: Future[Outcome]


class SlotPool(Slots):
    """`slots` processes of one program."""

    def __init__(self, program: Program, slots: int, limits: Limits | None = None) -> None:
        self.program = program
        self.limits = limits or Limits()
        self.size = slots
        self.starts = 0
        self._jobs: dict[int, _Job] = {}
        self._next = 1  # 0 is what a program may send that reads no id
        self._waiting: deque[int] = deque()
        self._lock = threading.Lock()
        self._failed_starts = 0
        self._answered = False
        """Whether any process has answered."""
        self._unasked = ""
        """What the next evaluation fails with, after an answer while nothing waited for one."""
        self._mean = 1.0
        self._stop = False
        self._ended = "cancelled"
        """Why what was left at the end has no answer."""
        self._slots: list[Slot] = []
        self._vacant: list[int] = []
        """Numbers of the slots whose process ended before it evaluated anything; they start when there is work."""
        self._selector = selectors.DefaultSelector()
        self._woken, self._wakes = os.pipe()
        for descriptor in (self._woken, self._wakes):
            os.set_blocking(descriptor, False)
        self._selector.register(self._woken, selectors.EVENT_READ, None)
        self._thread = threading.Thread(target=self._loop, name="slots", daemon=True)
        self._thread.start()

    def submit(self, request: Request) -> Future[Outcome]:
        future: Future[Outcome] = Future()
        with self._lock:
            if self._stop:
                raise RuntimeError(f"the slots are closed: {self._ended}")
            self._jobs[self._next] = _Job(request, future)
            self._waiting.append(self._next)
            self._next += 1
            self._wake()
        return future

    def close(self) -> None:
        with self._lock:
            self._stop = True
            self._wake()
        self._thread.join()
        with self._lock:
            if self._wakes >= 0:
                os.close(self._woken)
                os.close(self._wakes)
            self._woken = self._wakes = -1

    def _wake(self) -> None:
        """Wake the thread of the pool; the caller holds the lock, so that the pipe is not closed meanwhile."""
        if self._wakes >= 0:
            with contextlib.suppress(BlockingIOError):  # a full pipe wakes it too
                os.write(self._wakes, b"x")

    def _loop(self) -> None:
        try:
            for number in range(self.size):
                self._start(number)
            while not self._stop:
                self._turn()
        except OSError as error:  # no descriptors, processes or disk left
            self._ended = f"its processes cannot be started: {error.strerror}"
        except Exception as error:
            self._ended = f"the slots ended by {type(error).__name__}: {error}; this is a fault of Clearance"
            traceback.print_exc()
        finally:
            with self._lock:
                self._stop = True
            for slot in self._slots:
                slot.end()
            for slot in self._slots:
                self._unregister(slot)
                slot.kill()
            for job in list(self._jobs):
                self._finish(job, Outcome("not started", reason=self._ended))
            self._selector.close()

    def _turn(self) -> None:
        """Fill vacant slots if there is work, hand out, replace what is due, wait for the next event, handle it."""
        if self._waiting:
            if self._unasked:
                self._fail_next()
            while self._vacant:
                self._start(self._vacant.pop())
        for slot in list(self._slots):
            self._hand_out(slot)
        now, replaced = time.monotonic(), False
        for slot in list(self._slots):
            if slot.retire and not slot.waiting:
                self._replace(slot, "retired")
                replaced = True
            elif slot.due is not None and slot.due <= now:
                self._replace(slot, "late")
                replaced = True
        if replaced and self._waiting:
            return  # a process of JSON lines is ready at once, without an event to wait for
        due = [s.due for s in self._slots if s.due is not None]
        if self._waiting:
            due += [s.rests for s in self._slots if s.rests > now]
        wait = None if not due else max(0.0, min(due) - time.monotonic())
        for key, _ in self._selector.select(wait):
            if key.data is None:
                with contextlib.suppress(BlockingIOError):
                    os.read(self._woken, 4096)
            elif key.data in self._slots:
                self._handle(key.data, key.fd)

    def _hand_out(self, slot: Slot) -> None:
        depth = AHEAD if self._mean < SHORT else 1
        recycle = self.limits.recycle
        while slot.ready and not slot.retire and len(slot.waiting) < depth and slot.rests <= time.monotonic():
            with self._lock:
                job = self._waiting.popleft() if self._waiting else None
            if job is None:
                break
            slot.send(job, self._jobs[job].request)
            if recycle and slot.served + len(slot.waiting) >= recycle:
                slot.retire = True
        self._watch_writes(slot)

    def _handle(self, slot: Slot, descriptor: int) -> None:
        """Handle one event of a slot: output, an answer, room to write, or its death."""
        if descriptor == slot.logs:
            slot.read_output()
        elif descriptor == slot.writes:
            slot.flush()
            self._watch_writes(slot)
        elif self._receive(slot) and descriptor == slot.death:
            self._replace(slot, "died")
            return
        if slot in self._slots and descriptor in slot.ended and descriptor in self._selector.get_map():
            self._selector.unregister(descriptor)  # closed pipes stay readable for ever

    def _receive(self, slot: Slot) -> bool:
        """Take its answers, also those that it wrote just before it died; False where it was replaced over one."""
        try:
            messages = slot.receive()
        except TooLong:
            self._replace(slot, f"its answer is longer than {self.limits.answer} bytes")
            return False
        except (ValueError, RecursionError) as error:
            self._replace(slot, f"its answer is not JSON: {error}")
            return False
        if slot.lines and (wrong := self._astray(slot, messages)):
            self._replace(slot, wrong)
            return False
        for message in messages:
            if not slot.ready:
                slot.ready, slot.since, self._failed_starts = True, time.monotonic(), 0
            elif slot.waiting:
                if slot.ids and (wrong := misidentified(message, slot.waiting[0])):
                    self._replace(slot, wrong)
                    return False
                self._answer(slot, message)
                if slot.lines and not _is_answer(message):  # the answer itself may follow, and is not the next one's
                    self._replace(slot, "retired")
                    return False
        return True

    def _astray(self, slot: Slot, messages: Sequence[object]) -> str:
        """Why these objects of a process of JSON lines cannot be the answers that are waited for; empty if they can, or
        if nothing is waited for and they are no answers."""
        if not slot.waiting:
            if not any(map(_is_answer, messages)):
                return ""
            self._unasked = HARMLESS if slot.ids else UNASKED
            return self._unasked
        if len(messages) <= len(slot.waiting):
            return ""
        expected = len(slot.waiting)
        requests = "request" if expected == 1 else "requests"
        return f"it wrote {len(messages)} JSON objects in answer to {expected} {requests}"

    def _fail_next(self) -> None:
        """A surplus answer is noticed only while no request waits: the next request fails, so that it is reported."""
        with self._lock:
            job = self._waiting.popleft() if self._waiting else None
        if job is not None:
            why, self._unasked = self._unasked, ""
            self._finish(job, Outcome("wrong answer", None, why))

    def _answer(self, slot: Slot, message: object) -> None:
        now = time.monotonic()
        duration = now - slot.since
        self._mean += 0.1 * (duration - self._mean)
        slot.served += 1
        self._answered = True
        if slot.lines and slot.served == 1:
            slot.rests = now + PAUSE
        job = slot.waiting.popleft()
        slot.since = now
        fields = message if isinstance(message, dict) else {}
        if fields.get("retire") is True:
            slot.retire = True
        if "error" in fields:
            outcome = Outcome("error", None, str(fields["error"]), slot.last_words(), duration)
        elif fields.get("excluded") not in (None, False):
            wrong = misstated(fields)
            kind: Kind = "wrong answer" if wrong else "excluded"
            outcome = Outcome(kind, None, wrong or stated(fields["excluded"]), duration=duration)
        else:
            outcome = Outcome("ok", message, duration=duration)
        slot.forget_output()
        self._finish(job, outcome)

    def _replace(self, slot: Slot, why: str) -> None:
        """Replace the process; the evaluation at fault is answered, those behind it return to the head of the queue."""
        if why == "late":
            slot.where_it_hangs()
        self._unregister(slot)
        code = slot.kill()
        jobs = list(slot.waiting)
        if not slot.ready:
            self._failed_start(slot, code, why)
        elif jobs and why != "retired" and not (why == "died" and slot.begun is not None and slot.begun <= slot.served):
            self._finish(jobs.pop(0), self._blame(slot, code, why))
        with self._lock:
            self._waiting.extendleft(reversed(jobs))
        self._slots.remove(slot)
        if slot.served:
            self._start(slot.number)
        else:
            self._vacant.append(slot.number)

    def _blame(self, slot: Slot, code: int, why: str) -> Outcome:
        duration = time.monotonic() - slot.since
        if why == "late":
            reason = f"no answer within {self.limits.timeout:g} s"
            if slot.lines and not self._answered:
                reason += NEVER
            return Outcome("timeout", None, reason, slot.last_words(), duration)
        kind, reason = ("crash", _death(code)) if why == "died" else ("wrong answer", why)
        return Outcome(kind, None, reason, slot.last_words(), duration)  # type: ignore[arg-type]

    def _failed_start(self, slot: Slot, code: int, why: str) -> None:
        """Three in a row are not bad luck: everything that waits is answered with the reason."""
        self._failed_starts += 1
        if self._failed_starts < FAILED_STARTS:
            return
        self._failed_starts = 0
        reason = (
            f"it was not ready within {self.limits.start:g} s"
            if why == "late"
            else f"it ended while starting, {_death(code)}"
        )
        with self._lock:
            waiting, self._waiting = list(self._waiting), deque()
        for job in waiting:
            self._finish(job, Outcome("not started", None, reason, slot.last_words()))

    def _start(self, number: int) -> None:
        self.starts += 1
        slot = Slot(self.program, self.limits, number, self.starts)
        for descriptor in (slot.reads, slot.logs, slot.death):
            self._selector.register(descriptor, selectors.EVENT_READ, slot)
        self._slots.append(slot)

    def _unregister(self, slot: Slot) -> None:
        for descriptor in (slot.reads, slot.logs, slot.death, slot.writes):
            if descriptor in self._selector.get_map():
                self._selector.unregister(descriptor)

    def _watch_writes(self, slot: Slot) -> None:
        watched = slot.writes in self._selector.get_map()
        if slot.unsent and not watched:
            self._selector.register(slot.writes, selectors.EVENT_WRITE, slot)
        elif watched and not slot.unsent:
            self._selector.unregister(slot.writes)

    def _finish(self, job: int, outcome: Outcome) -> None:
        with self._lock:
            done = self._jobs.pop(job, None)
        if done is not None and done.future.set_running_or_notify_cancel():
            done.future.set_result(outcome)


def _is_answer(message: object) -> bool:
    return isinstance(message, dict) and any(key in message for key in ("results", "error", "excluded"))


def _death(code: int) -> str:
    """`killed by SIGSEGV`, `exit code 3`."""
    if code >= 0:
        return f"its process ended with exit code {code}"
    try:
        return f"its process was killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"its process was killed by signal {-code}"
