"""A program of JSON lines that does what its parameter `do` says; what a simulator may do wrong, by number."""

import json
import os
import signal
import subprocess
import sys
import time

HELD = []


def leak():
    while True:
        HELD.append(bytearray(10_000_000))


def much():
    for _ in range(100_000):
        sys.stderr.write("y" * 999 + "\n")
    return {"d": 1.0}


class Answer(Exception):
    """An answer other than results."""


def answer(**fields):
    raise Answer(fields)


def line(text):
    raise Answer(text)


def grandchild():
    subprocess.Popen(["setsid", "sleep", os.environ["MARK"]])
    time.sleep(0.1)
    os._exit(3)


ACTS = {
    "right": lambda: {"d": 1.5},
    "segfault": lambda: os.kill(os.getpid(), signal.SIGSEGV),
    "hang": lambda: time.sleep(1e6),
    "spin": lambda: pow(3, 10**10),
    "leak": leak,
    "exit code": lambda: os._exit(3),
    "killed": lambda: os.kill(os.getpid(), signal.SIGKILL),
    "not a number": lambda: {"d": float("nan")},
    "infinite": lambda: {"d": float("inf")},
    "missing key": lambda: {"e": 1.0},
    "wrong type": lambda: {"d": "near"},
    "boolean": lambda: {"d": True},
    "no object": lambda: [1.0],
    "100 MB of output": much,
    "garbage": lambda: print("garbage \x00\xff", flush=True) or {"d": 1.0},
    "long answer": lambda: {"d": 1.0, "text": "x" * 40_000_000},
    "deeply nested": lambda: print('{"a":' * 100_000 + "1" + "}" * 100_000, flush=True) or {"d": 1.0},
    "nan as C writes it": lambda: line('{"results": {"d": nan}}'),
    "inf as C writes it": lambda: line('{"results": {"d": -inf}}'),
    "single quotes": lambda: line("{'results': {'d': 1.0}}"),
    "cut off": lambda: line('{"results": {"d": 1.0'),
    "an error cut off": lambda: line('{"error": "no lice'),
    "not UTF-8": lambda: line(b'{"error": "\xff"}'),
    "results nested too deeply": lambda: line('{"results":' * 100_000),
    "two in a line": lambda: line('{"results": {"d": 1.0}}{"results": {"d": 2.0}}'),
    "a result twice": lambda: line('{"results": {"d": -5, "d": 50}}'),
    "results twice": lambda: line('{"results": {"d": -5}, "results": {"d": 50}}'),
    "a log line in braces": lambda: print("{debug} error: none", flush=True) or {"d": 1.0},
    "error": lambda: {"d": 1 / 0},
    "excluded": lambda: answer(excluded="starts  inside\nthe zone"),
    "excluded without a reason": lambda: answer(excluded=True),
    "excluded with results": lambda: answer(excluded="starts inside", results={"d": -1.0}),
    "excluded with an error": lambda: answer(excluded="starts inside", error="no licence"),
    "not excluded": lambda: answer(excluded=None, results={"d": 1.0}),
    "grandchild": grandchild,
    "early end": lambda: sys.exit(0),
}


def main():
    for line in sys.stdin:
        act = list(ACTS)[int(json.loads(line)["parameters"]["do"])]
        print(f"working on {act}", file=sys.stderr, flush=True)
        try:
            found = {"results": ACTS[act]()}
        except ZeroDivisionError as error:
            found = {"error": str(error)}
        except Answer as other:
            (found,) = other.args
        if isinstance(found, bytes):
            sys.stdout.buffer.write(found + b"\n")
            sys.stdout.flush()
        else:
            print(found if isinstance(found, str) else json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
