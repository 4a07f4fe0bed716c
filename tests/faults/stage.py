"""A process that carries out one stage on a cluster, for the fault tests: stage.py DATABASE CLAIM FOLDER COUNT.

It evaluates COUNT points of `gated` for a claimed run, or resumes that.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from backend.db.engine import connect
from backend.db.queue import Claim
from backend.db.store import RunStore
from campaigns.asked.load import load_document
from campaigns.stored.records import StagePlan
from tests.simulators import package
from worker.engine.problem.evaluate import InProcess
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.base import drive, once
from worker.engine.stages.parts.context import Context
from worker.engine.systems import optional
from worker.engine.systems.base import Floats
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.simulator import Opening

OPENING = Opening({"simulator.x": 0.5, "simulator.y": 0.45}, "separation")


def points(count: int) -> Floats:
    """Points of the unit cube."""
    return np.random.default_rng(3).random((count, 2))


def problem_of(folder: Path) -> Problem:
    """The problem of the two basins, with the simulator of this folder in their place."""
    return Problem(load_document(package.campaign()), CommandSimulator(read(folder), OPENING))


def carry_out(database: str, claim: Claim, folder: Path, count: int) -> None:
    """The stage, from its beginning or from where another process left it."""
    problem, engine = problem_of(folder), connect(database)
    store = RunStore(engine, claim)
    store.plan([StagePlan("search", "direct", 1000)])
    store.begin(0)
    try:
        drive(Context(problem.campaign, problem, InProcess(problem), store), 0, once(points(count), ""), 1000)
    finally:
        optional.close(problem.system)
        engine.dispose()


if __name__ == "__main__":
    carry_out(sys.argv[1], Claim(**json.loads(sys.argv[2])), Path(sys.argv[3]), int(sys.argv[4]))
