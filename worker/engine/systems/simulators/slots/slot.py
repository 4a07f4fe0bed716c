"""One warm process that evaluates, with its pipes: what it was sent, what it answered, what it wrote last.

A slot never blocks and decides nothing: `pool` asks it. Its process leads a session of its own; everything that it
started is killed with it, also what left the session, which its environment gives away.
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

from worker.engine.systems.simulators.slots.given import original
from worker.engine.systems.simulators.slots.outcome import Limits, Request
from worker.engine.systems.simulators.slots.program import Program, framed, identified, line, unframed, unlined

LAUNCH = Path(__file__).with_name("launch.py")
TAG = "CLEARANCE_SLOT"
LAST = 8192
"""Bytes of its output that are stored."""
SHOWN = 400
CHUNK = 1 << 16


class Slot:
    """A process; `number` is its place in the pool, `generation` how many had it before."""

    def __init__(self, program: Program, limits: Limits, number: int, generation: int) -> None:
        self.limits = limits
        self.number = number
        self.tag = f"{os.getpid()}-{id(self):x}-{generation}"
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
        self._start(program.placed(number))

    def _start(self, program: Program) -> None:
        child_reads, self.writes = os.pipe()
        self.reads, child_writes = os.pipe()
        self.logs, child_logs = os.pipe()
        self._begun: mmap.mmap | None = None
        environment = {**original(os.environ), **program.environment, TAG: self.tag, "PYTHONUNBUFFERED": "1"}
        Path(program.folder).mkdir(parents=True, exist_ok=True)
        prefix = [sys.executable, "-S", "-E", str(LAUNCH), str(self.limits.memory), str(os.getpid())]
        opened = [child_reads, child_writes, child_logs]
        passed: tuple[int, ...] = ()
        if self.lines:
            command, streams = list(program.command), (child_reads, child_writes)
        else:
            shared = os.memfd_create("begun")
            os.ftruncate(shared, 8)
            self._begun = mmap.mmap(shared, 8)
            opened.append(shared)
            command = [*program.command[:2], str(child_reads), str(child_writes), str(shared), *program.command[2:]]
            streams, passed = (subprocess.DEVNULL, child_logs), (child_reads, child_writes, shared)
        try:
            self.process = subprocess.Popen(
                prefix + command, stdin=streams[0], stdout=streams[1], stderr=child_logs, pass_fds=passed,
                start_new_session=True, env=environment, cwd=program.folder,
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
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.process.pid, signal.SIGUSR1)
            select.select([self.logs], [], [], 0.05)

    def kill(self) -> int:
        """Kill it and all that it started; returns its exit code, negative for a signal."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        code = self.process.wait()
        self.read_output()
        _sweep(self.tag)
        pipes = {os.readlink(f"/proc/self/fd/{pipe}") for pipe in (self.reads, self.logs) if not self._at_end(pipe)}
        for descriptor in (self.reads, self.writes, self.logs, self.death):
            os.close(descriptor)
        self.ended.update((self.reads, self.logs))
        if pipes:
            _kill_writers(pipes)
        return code

    def _at_end(self, pipe: int) -> bool:
        """Whether nothing can be written to a pipe any more."""
        self._chunks(pipe)
        return pipe in self.ended

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


def _sweep(tag: str) -> None:
    """Kill what left the session and still carries the tag; looked for again while there was any, which may have
    started more meanwhile."""
    sought, killed = f"{TAG}={tag}".encode(), set[str]()
    while True:
        found = {entry for entry in os.listdir("/proc") if entry.isdigit() and _carries(entry, sought)} - killed
        if not found:
            return
        killed |= found
        for entry in found:
            with contextlib.suppress(OSError):
                os.kill(int(entry), signal.SIGKILL)


def _kill_writers(pipes: set[str]) -> None:
    """Kill what still can write to these pipes: it was started by the process, and has cleared its environment."""
    for entry in filter(str.isdigit, os.listdir("/proc")):
        if int(entry) != os.getpid() and any(_writes(entry, number, pipes) for number in _descriptors(entry)):
            with contextlib.suppress(OSError):
                os.kill(int(entry), signal.SIGKILL)


def _descriptors(entry: str) -> list[str]:
    try:
        return os.listdir(f"/proc/{entry}/fd")
    except OSError:
        return []


def _writes(entry: str, number: str, pipes: set[str]) -> bool:
    """A process that this one has just forked may have the end for reading until it becomes its program."""
    try:
        if os.readlink(f"/proc/{entry}/fd/{number}") not in pipes:
            return False
        information = Path(f"/proc/{entry}/fdinfo/{number}").read_text(encoding="ascii")
    except OSError:
        return False
    flags = next((line.split()[1] for line in information.splitlines() if line.startswith("flags:")), "0")
    return int(flags, 8) & os.O_ACCMODE != os.O_RDONLY


def _carries(entry: str, sought: bytes) -> bool:
    try:
        with open(f"/proc/{entry}/environ", "rb", buffering=0) as file:  # of every process, each time one is replaced
            found = file.readall()
    except OSError:
        return False
    return sought in found and sought in found.split(b"\0")
