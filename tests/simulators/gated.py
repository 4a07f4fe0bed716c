"""A program of JSON lines that logs every evaluation it begins, and waits for a file before it answers later ones.

gated.py FOLDER FREE: appends `x y` to FOLDER/log; once the log has FREE lines, an answer waits for FOLDER/go.
"""

import json
import math
import os
import sys
import time

LINE = 64
"""Bytes of a line of the log."""


def separation(x, y):
    return math.sin(37.0 * x) + math.exp(y) / 3.0


def main():
    folder, free = sys.argv[1], int(sys.argv[2])
    log = os.open(os.path.join(folder, "log"), os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    for line in sys.stdin:
        given = json.loads(line)["parameters"]
        os.write(log, f"{given['x']!r} {given['y']!r}".ljust(LINE - 1).encode() + b"\n")
        if os.fstat(log).st_size > free * LINE:
            while not os.path.exists(os.path.join(folder, "go")):
                time.sleep(0.005)
        print(json.dumps({"results": {"separation": separation(given["x"], given["y"])}}), flush=True)


if __name__ == "__main__":
    main()
