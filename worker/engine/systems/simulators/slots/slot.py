"""One warm process that evaluates, with its pipes: what it was sent, what it answered, what it wrote last.

A slot decides nothing: `pool` asks it. Its process is the child of a guard, which ends everything that it started with
it, and does so also when this process is killed.
"""

from __future__ import annotations

import contextlib
import mmap
import os
import select
import signal
import subprocess
import sys
import time
from collections import deque
from pathlib import Path

from worker.engine.systems.simulators.slots import marks
from worker.engine.systems.simulators.slots.given import original
from worker.engine.systems.simulators.slots.guard import END, KILL, SHOW
from worker.engine.systems.simulators.slots.marks import MARK, mark
from worker.engine.systems.simulators.slots.outcome import Limits, Request
from worker.engine.systems.simulators.slots.program import Program, framed, identified, line, unframed, unlined

GUARD = Path(__file__).with_name("guard.py")
PATIENCE = 2.0
"""Time that a program has to end in when it is asked to [s]."""
LAST = 8192
"""Bytes of its output that are stored."""
SHOWN = 400
CHUNK = 1 << 16


def guarded(control: int, memory: int = 0, grace: float = PATIENCE, died: float = 0.0, folder: str = "") -> list[str]:
    """The begin of a command line of which everything ends when this process ends or writes to `control`, or -1.

    memory: of each process [bytes]; grace, died: what is left so long after it was asked to end, or after the end of
    the program, is killed [s]; folder: is removed if this process ends.
    """
    words = (GUARD, memory, grace, died, os.getpid(), control, folder)
    return [sys.executable, "-S", "-E", *map(str, words)]


class Slot:
    """A process; `number` is its place in the pool, `generation` how many had it before."""

    def __init__(self, program: Program, limits: Limits, number: int, generation: int) -> None:
        self.limits = limits
        self.number = number
        self.mark = mark(f"{id(self):x}-{generation}")
        self.lines = program.protocol == "lines"
        self.ids = self.lines and program.ids
        """Whether a request has an id, which is the number of its job."""
        self.waiting: deque[int] = deque()
        """The jobs that it was sent and has not answered, oldest first."""
        self.since = time.monotonic()
        """When the oldest of them began, or the process."""
        self.served = 0
        self.rests = 0.0
        """Until when it gets no further request, by the monotonic clock [s]."""
        self.ready = self.lines
        self.retire = False
        self.ended: set[int] = set()
        """The pipes that nothing more can arrive on."""
        self._unsent, self._answers, self._last = bytearray(), bytearray(), bytearray()
        placed = program.placed(number)
        self._own_folder = os.path.abspath(placed.folder) if placed.folder != program.folder else ""
        """The folder that is the slot's alone."""
        self._start(placed)

    def _start(self, program: Program) -> None:
        child_reads, self.writes = os.pipe()
        self.reads, child_writes = os.pipe()
        self.logs, child_logs = os.pipe()
        self._begun: mmap.mmap | None = None
        environment = {**original(os.environ), **program.environment, MARK: self.mark, "PYTHONUNBUFFERED": "1"}
        Path(program.folder).mkdir(parents=True, exist_ok=True)
        controlled, self._control = os.pipe()
        guard = guarded(controlled, self.limits.memory, folder=self._own_folder)
        opened = [child_reads, child_writes, child_logs, controlled]
        passed: tuple[int, ...] = (controlled,)
        if self.lines:
            command, streams = list(program.command), (child_reads, child_writes)
        else:
            shared = os.memfd_create("begun")
            os.ftruncate(shared, 8)
            self._begun = mmap.mmap(shared, 8)
            opened.append(shared)
            command = [*program.command[:2], str(child_reads), str(child_writes), str(shared), *program.command[2:]]
            streams, passed = (subprocess.DEVNULL, child_logs), (*passed, child_reads, child_writes, shared)
        try:
            self.process = subprocess.Popen(
                [*guard, *command], stdin=streams[0], stdout=streams[1],
                stderr=child_logs, pass_fds=passed, start_new_session=True, env=environment, cwd=program.folder,
            )  # fmt: skip
        finally:
            for descriptor in opened:
                os.close(descriptor)
        self.death = os.pidfd_open(self.process.pid)
        for descriptor in (self.writes, self.reads, self.logs):
            os.set_blocking(descriptor, False)

    @property
    def begun(self) -> int | None:
        """How many evaluations it has begun; None if the process does not report it."""
        return None if self._begun is None else int.from_bytes(self._begun[:8], "little")

    @property
    def unsent(self) -> bool:
        return bool(self._unsent)

    @property
    def due(self) -> float | None:
        """When it must have answered, or be ready, by the monotonic clock [s]; None while it has nothing to do."""
        if not self.ready:
            return self.since + self.limits.start
        return self.since + self.limits.timeout if self.waiting else None

    def send(self, job: int, request: Request) -> None:
        """Send a job; `flush` writes what the pipe does not take at once."""
        if not self.waiting:
            self.since = time.monotonic()
        self.waiting.append(job)
        request = identified(request, job) if self.ids else request
        self._unsent += line(request) if self.lines else framed(request)
        self.flush()

    def flush(self) -> None:
        try:
            while self._unsent:
                del self._unsent[: os.write(self.writes, self._unsent)]
        except BlockingIOError:
            pass
        except BrokenPipeError:
            self._unsent.clear()

    def receive(self) -> list[object]:
        """The messages that have arrived; raises ValueError (TooLong) for what cannot be one."""
        chunks = self._chunks(self.reads)
        self._answers += b"".join(chunks)
        if not self.lines:
            return unframed(self._answers, self.limits.answer)
        if len(self._answers) <= self.limits.answer and not any(b"\n" in chunk for chunk in chunks):
            return []  # a long line is looked through once, not again with each part of it
        found, other = unlined(self._answers, self.limits.answer)
        self._keep(other)
        return list(found)

    def read_output(self) -> None:
        if self.logs in self.ended:
            return
        for chunk in self._chunks(self.logs):
            self._keep(chunk)

    def last_words(self) -> str:
        """The end of what it wrote since its last answer."""
        self.read_output()
        text = bytes(self._last[-SHOWN:]).decode(errors="replace").strip()
        return "".join(c if c.isprintable() or c == "\n" else "?" for c in text)

    def forget_output(self) -> None:
        self._last.clear()

    def where_it_hangs(self) -> None:
        """Have it write where it is, to its output; only Python of ours can."""
        if self.lines or not self.ready:
            return
        self._tell(SHOW)
        select.select([self.logs], [], [], 0.05)

    def end(self) -> None:
        """Ask it and all that it started to end; what is left after a while is killed."""
        self._tell(END)

    def kill(self) -> int:
        """Kill it and all that it started, or wait until they have ended if they were asked to; returns its exit code,
        negative for a signal."""
        died = self.process.poll()
        self._tell(KILL)
        code = self.process.wait()
        self.read_output()
        if died == -signal.SIGKILL:  # perhaps not the program, but its guard was killed
            marks.end(self.mark)
        for descriptor in (self.reads, self.writes, self.logs, self.death, self._control):
            os.close(descriptor)
        self.ended.update((self.reads, self.logs))
        return code

    def _tell(self, word: bytes) -> None:
        with contextlib.suppress(BrokenPipeError):
            os.write(self._control, word)

    def _chunks(self, descriptor: int) -> list[bytes]:
        """The bytes that a pipe has now, 16 chunks at most."""
        found: list[bytes] = []
        with contextlib.suppress(BlockingIOError):
            while len(found) < 16:
                chunk = os.read(descriptor, CHUNK)
                if not chunk:
                    self.ended.add(descriptor)
                    break
                found.append(chunk)
        return found

    def _keep(self, output: bytes) -> None:
        self._last += output
        del self._last[:-LAST]
