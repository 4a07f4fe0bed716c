"""Worker, guard and child killed within a stage of each kind; that the stage ran is looked up after the blow."""

from __future__ import annotations

from tests.storm.faults.base import Fault
from tests.storm.faults.processes import family

NAMES = {
    "nominal": "killed in the nominal case",
    "baseline": "killed in the cases of the baseline",
    "sensitivity": "killed in the sensitivity",
    "direct": "killed in the first search",
    "monte_carlo": "killed in the second search",
    "validate": "killed while findings are confirmed",
    "certify": "killed in the sample of a simulator",
}

FAULTS = {name: Fault(family, at, "slots") for at, name in NAMES.items()}
