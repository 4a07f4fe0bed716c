"""Runs a program and ends with all that it started: guard.py MEMORY GRACE DIED PARENT CONTROL FOLDER PROGRAM...

It adopts what the program starts (PR_SET_CHILD_SUBREAPER, prctl(2)), also what left the session or cleared its
environment, and outlives its parent, as it is in no process group of it. When the parent has ended, or has written to
CONTROL (a pipe; -1: none), what runs is asked to end and, after GRACE [s], killed; so is what is left DIED [s] after
the program. Then, without a parent, FOLDER (if one is given) is removed, also where the parent has ended before
anything began. A process and not a function between fork and exec, which could deadlock in a parent with threads;
without site-packages and further modules, it starts in milliseconds. Linux only.
"""

import ctypes
import os
import resource
import select
import sys
import time

PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
SIGHUP, SIGINT, SIGKILL, SIGUSR1, SIGTERM, SIGCHLD = 1, 2, 9, 10, 15, 17
SIGNALS = range(1, 65)
END, KILL, SHOW = b"e", b"k", b"s"
"""What the parent writes: end and wait, kill at once, have the program write where it is."""
PLACE = "clearance-place-"
"""How the name of a folder of ours begins, which has those of the slots."""
STUCK = 10.0
"""Time after which a process that not even SIGKILL has ended is left to the kernel [s]."""
OFTEN, SELDOM = 0.005, 1.0
"""Time between two looks at what has ended: while all is to end, and before [s]."""

LIBC = ctypes.CDLL(None)


def main() -> None:
    memory, parent, control = (int(word) for word in (sys.argv[1], *sys.argv[4:6]))
    LIBC.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    try:
        owner = os.pidfd_open(parent)
    except OSError:
        orphaned()
        os._exit(1)
    if os.getppid() != parent:  # the parent died before the line above
        orphaned()
        os._exit(1)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    guard = os.getpid()
    program = os.fork()
    if program == 0:
        become(memory, guard)
    for number in (SIGHUP, SIGINT, SIGTERM):
        LIBC.signal(number, ctypes.c_void_p(1))  # ignored: it ends when the parent or the program has
    LIBC.signal(SIGCHLD, None)
    for descriptor in {int(name) for name in os.listdir("/proc/self/fd")} - {owner, control}:
        try:  # noqa: SIM105 (contextlib takes milliseconds)
            os.close(descriptor)
        except OSError:  # that of the listing
            pass
    guarded(program, owner, control)


def become(memory: int, guard: int) -> None:
    """Set limits and signals, and become the program."""
    os.setsid()
    LIBC.prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0)
    if os.getppid() != guard:
        os._exit(1)
    if memory:
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    for number in SIGNALS:
        # What a parent ignores, programs ignore too: after `nohup` or `&`, or on a node, PX4 would not end when asked.
        LIBC.signal(number, None)
    try:
        os.execvp(sys.argv[7], sys.argv[7:])
    except OSError as error:
        sys.stderr.write(f"{sys.argv[7]} cannot be started: {error.strerror}\n")
        sys.stderr.flush()
        os._exit(127)


def guarded(program: int, owner: int, control: int) -> None:
    """Wait until the program has ended or is to end, end what is left, and end as the program did."""
    died = os.pidfd_open(program)
    waiting = select.poll()
    for descriptor in {died, owner, control} - {-1}:
        waiting.register(descriptor, select.POLLIN)
    left = Left(program)
    grace, patience = float(sys.argv[2]), float(sys.argv[3])
    while left.reap():
        ready = {descriptor for descriptor, _ in waiting.poll(1000 * SELDOM)}
        word = os.read(control, 1) if control in ready else b""
        if word == SHOW:
            signal(program, SIGUSR1)
            continue
        if died in ready:
            break
        if owner in ready or control in ready:
            patience = 0.0 if word == KILL else grace
            break
    left.end(patience)
    waiting.unregister(died)
    if owner in dict(waiting.poll(0)):
        orphaned()
    leave(left.status)


def orphaned() -> None:
    """Remove the folder, if there is one, and with that of the last slot the folder that has those of all."""
    if not sys.argv[6]:
        return
    import shutil

    folder, place = sys.argv[6], os.path.dirname(sys.argv[6])
    shutil.rmtree(folder, ignore_errors=True)
    if not os.path.basename(place).startswith(PLACE):
        return
    try:
        empty = not any(entry.is_dir() for entry in os.scandir(place))
    except OSError:  # another guard was faster
        return
    if empty:
        shutil.rmtree(place, ignore_errors=True)


class Left:
    """What runs below this process; `status` is that of the program, once it has ended."""

    def __init__(self, program: int) -> None:
        self.program, self.status, self.any = program, -1, True

    def reap(self) -> bool:
        """Take the ends of children, also of those that were adopted; whether the program still runs."""
        while self.any:
            try:
                found, status = os.waitpid(-1, os.WNOHANG)
            except ChildProcessError:
                self.any = False
                break
            if found == 0:
                break
            if found == self.program:
                self.status = status
        return self.any and self.status < 0

    def end(self, patience: float) -> None:
        """End all: with SIGTERM and, after this time [s] or at once, SIGKILL."""
        until = time.monotonic() + patience
        if self.reap() and not patience:
            signal(self.program, SIGKILL)  # mostly there is nothing else, and nothing to look for
            time.sleep(OFTEN / 10)
            self.reap()
        elif patience and self.status < 0:
            signal(self.program, SIGTERM)  # alone at first: it may end the others in order
        broadcast = False
        while self.any and (left := until - time.monotonic()) > 0.0:
            runs = self.reap()
            if not broadcast and (not runs or left < patience / 2):
                broadcast = True
                self.signal(SIGTERM)
            time.sleep(OFTEN)
        while self.any and time.monotonic() < until + STUCK:
            self.signal(SIGKILL)
            time.sleep(OFTEN / 10)
            self.reap()

    def signal(self, number: int) -> None:
        for found in below(os.getpid()):
            signal(found, number)


def signal(process: int, number: int) -> None:
    try:  # noqa: SIM105
        os.kill(process, number)
    except OSError:
        pass


def below(process: int) -> list[int]:
    """All descendants of a process."""
    children: dict[int, list[int]] = {}
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/stat", "rb", buffering=0) as file:
                parent = int(file.read(4096).rpartition(b")")[2].split()[1])
        except OSError:
            continue
        children.setdefault(parent, []).append(int(entry))
    found: list[int] = []
    front = [process]
    while front:
        front = [child for parent in front for child in children.get(parent, [])]
        found += front
    return found


def leave(status: int) -> None:
    """End as a process with this status did."""
    if status >= 0 and os.WIFSIGNALED(status):
        LIBC.signal(os.WTERMSIG(status), None)
        os.kill(os.getpid(), os.WTERMSIG(status))
    os._exit(os.WEXITSTATUS(status) if status >= 0 else 1)


if __name__ == "__main__":
    main()
