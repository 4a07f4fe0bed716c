"""A mass on a spring between two walls: a program that reads one JSON file and writes another.

The third file is for the trace; it is the null device unless a trace is requested.
"""

import json
import math
import os
import sys

parameters, results, trace = sys.argv[1:]
with open(parameters, encoding="utf-8") as file:
    p = json.load(file)
frequency = math.sqrt(p["stiffness"] / p["mass"])
clearance = 0.5 - abs(p["velocity"]) / frequency
with open(results, "w", encoding="utf-8") as file:
    json.dump({"clearance": clearance}, file)
if trace != os.devnull:
    times = [k * 2 * math.pi / frequency / 200 for k in range(201)]
    distances = [0.5 - abs(p["velocity"] / frequency * math.sin(frequency * t)) for t in times]
    with open(trace, "w", encoding="utf-8") as file:
        json.dump({"time": times, "distance": distances}, file)
