"""Sets limits and signals of a process and becomes the program: launch.py MEMORY PARENT PROGRAM ARGUMENTS...

It runs without site-packages, so that it starts in milliseconds, and in place of a function between fork and exec,
which could deadlock in a parent with threads. Linux only: the process dies with the thread that started it.
"""

import ctypes
import os
import resource
import sys

PR_SET_PDEATHSIG = 1
SIGKILL = 9  # the module signal takes a third of the time in which this program starts
SIGNALS = range(1, 65)


def main() -> None:
    memory, parent = int(sys.argv[1]), int(sys.argv[2])
    libc = ctypes.CDLL(None)
    libc.prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0)
    if os.getppid() != parent:  # the parent died before the line above
        os._exit(1)
    if memory:
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for signal in SIGNALS:
        # What a parent ignores, programs ignore too: after `nohup` or `&`, or on a node, PX4 would not end when asked.
        libc.signal(signal, None)
    try:
        os.execvp(sys.argv[3], sys.argv[3:])
    except OSError as error:
        sys.stderr.write(f"{sys.argv[3]} cannot be started: {error.strerror}\n")
        sys.exit(127)


main()
