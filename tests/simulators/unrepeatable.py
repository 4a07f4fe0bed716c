"""A program of JSON lines that does not repeat: with noise, or with a wrong result at every 200th evaluation."""

import json
import random
import sys


def main():
    how, chance = sys.argv[1], random.Random()
    for count, line in enumerate(sys.stdin, 1):
        p = json.loads(line)["parameters"]
        d = 10 - 3 * p["a"] - (p["b"] - 0.5) ** 2
        if how == "noise":
            d += chance.gauss(0, 0.5)
        elif count % 200 == 0:
            d = 0.5
        print(json.dumps({"results": {"d": d}}), flush=True)


if __name__ == "__main__":
    main()
