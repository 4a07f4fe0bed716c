"""`python -m tests.bench.component_costs [campaign ...]`: cost of faults and environments, and which vectorise.

Each is put alone into the loop of a library campaign, at a magnitude at which it does something. Cost is the ratio to
the bare loop in one run; wide and scalar count the instructions on whole registers and on single numbers, libm calls
are none where the lane loop vectorises (a power in a constant of the flight is not in it). Prints a table, writes
build/component_costs.json.
"""

from __future__ import annotations

import json
import re
import sys
from typing import Any

import numpy as np

from campaigns import Campaign, library, load_file
from campaigns.asked.load import load_document
from clearance.testing.problems import Problem
from tests.bench.bench import BUILD, interleaved
from worker.engine.kernels.component import Environment, Fault
from worker.running.catalogue.installed import components

BATCH = 128
FLYING = {
    "sensor_noise": {"sigma": 0.1, "sigma_v": 0.1},
    "navigation_noise": {"sigma": 0.1, "sigma_psi": 0.01, "sigma_u": 0.1},
    "missed_detection": {"probability": 0.1},
    "dryden_gusts": {"W": 7.7},
    "bearing_range_error": {"db": 0.01, "dr": 0.1},
}


def main() -> None:
    """Measure all requested loops, print and write the results."""
    BUILD.mkdir(exist_ok=True)
    found = {name: measure(load_file(library()[name])) for name in sys.argv[1:] or ["unicycle_static"]}
    (BUILD / "component_costs.json").write_text(json.dumps(found, indent=2) + "\n")
    for campaign, rows in found.items():
        print(f"\n{campaign:<24}{'cost':>6}{'wide':>8}{'scalar':>8}  libm")
        for name, row in rows.items():
            print(f"{name:<24}{row['cost']:6.2f}{row['wide']:8d}{row['scalar']:8d}  {', '.join(row['libm']) or '-'}")


def measure(campaign: Campaign) -> dict[str, dict[str, Any]]:
    """Cost and instructions by component; the first two rows are the bare loop, and that with sampled guidance."""
    known = [c for c in components().values() if isinstance(c, (Fault, Environment))]
    period = campaign.scenario.guidance.period or 10 * campaign.scenario.step
    problems = {"(none)": loop(campaign, None, 0.0), "(none, sampled)": loop(campaign, None, period)}
    for part in known:
        late = isinstance(part, Fault) and part.path == "guidance"
        problems[part.name] = loop(campaign, part, period if late else campaign.scenario.guidance.period)
    if campaign.scenario.guidance.period:
        problems["(none)"] = problems["(none, sampled)"]
    vectors = {name: np.repeat(problem.system.nominal[None], BATCH, axis=0) for name, problem in problems.items()}
    work = [(lambda n=name: problems[n].system.simulate_vectors(vectors[n]), BATCH) for name in problems]
    seconds = dict(zip(problems, interleaved(work, repeats=25), strict=True))
    sampled = {"guidance_delay", "(none, sampled)"}
    return {
        name: {"cost": s / seconds["(none, sampled)" if name in sampled else "(none)"]} | instructions(problems[name])
        for name, s in seconds.items()
    }


def loop(campaign: Campaign, part: Fault | Environment | None, period: float) -> Problem:
    """The campaign's loop with one fault or part of the environment and no other."""
    document = campaign.document()
    scenario: dict[str, Any] = document["scenario"] | {"faults": [], "environment": [], "guidance": {"period": period}}
    if part is not None:
        given: dict[str, Any] = {"component": part.name, "parameters": FLYING.get(part.name, {})}
        if isinstance(part, Fault) and part.path == "actuator":
            vehicle: Any = components()["vehicle", campaign.scenario.vehicle.component]
            given["on"] = vehicle.inputs[-1].name
        scenario["environment" if isinstance(part, Environment) else "faults"] = [given]
    document["scenario"] = scenario
    document["uncertain"] = {"start.x": {"plus_minus": 1e-3}}
    document["stages"]["search"] = [{"method": "direct", "evaluations": 1}]
    return Problem(load_document(document))


def instructions(problem: Problem) -> dict[str, Any]:
    """Counts over the machine code of the compiled loop, which must have been run."""
    code = problem.system.loop.assembly()
    return {
        "wide": len(re.findall("%zmm|%ymm", code)),
        "scalar": len(re.findall(r"\bv\w+sd\b", code)),
        "libm": sorted(set(re.findall(r"\b(sin|cos|tan|atan2|exp|log|pow|floor|fmod)\b", code))),
    }


if __name__ == "__main__":
    main()
