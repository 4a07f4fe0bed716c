"""A slow simulator: USR1 makes it hang and refuse to end, USR2 has it start a helper in a session of its own."""

import json
import signal
import subprocess
import sys
import time


def hang(*_: object) -> None:
    """For ever, whoever asks it to end."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    while True:
        time.sleep(1.0)


def leak(*_: object) -> None:
    """A process that outlives this one unless somebody ends it."""
    subprocess.Popen(["sleep", "86396.5"], start_new_session=True, stdout=subprocess.DEVNULL)


signal.signal(signal.SIGUSR1, hang)
signal.signal(signal.SIGUSR2, leak)
for line in sys.stdin:
    given = json.loads(line)["parameters"]
    time.sleep(0.015)
    d = 0.3 + (given["a"] - 0.7) ** 2 + 2.0 * (given["b"] - 0.2) ** 2
    print(json.dumps({"results": {"d": d}}), flush=True)
