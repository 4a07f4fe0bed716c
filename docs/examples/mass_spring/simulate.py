"""A mass on a spring between two walls: a program that reads one JSON file and writes another."""

import json
import math
import sys

parameters, results = sys.argv[1:]
with open(parameters, encoding="utf-8") as file:
    p = json.load(file)
frequency = math.sqrt(p["stiffness"] / p["mass"])
clearance = 0.5 - abs(p["velocity"]) / frequency
with open(results, "w", encoding="utf-8") as file:
    json.dump({"clearance": clearance}, file)
