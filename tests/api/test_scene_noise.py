"""A 3D view repeats a flight that drew its own noise with that noise."""

from __future__ import annotations

import numpy as np

from backend.db.engine import read
from backend.runs.service import number
from backend.scenes.base.flight import from_live
from backend.scenes.base.noise import STATED, WHOLE, Noise, draws
from backend.scenes.base.progress import Progress
from backend.scenes.base.setting import load
from backend.scenes.cloud.evaluations import load as cloud_of
from backend.scenes.panel.sampled import _sample
from campaigns import library, load_file
from campaigns.stored.records import Columns, StagePlan
from clearance.testing.problems import Problem
from tests import results
from tests.api.finished import Work
from tests.api.server import Service
from tests.api.shipped import shipped
from worker.engine.stages.parts.seeds import of_draws

PLAN = [StagePlan("nominal", None, 1), StagePlan("certify", None, 3)]
POINTS = np.array([[0.1, 0.2, 0.4], [0.5, 0.5, 0.5], [0.9, 0.3, 0.7]])
DRAWN = 2
"""The third evaluation is of a grid, under the realisations that the campaign states."""


def test_a_stored_evaluation_is_compared_with_a_flight_under_its_own_noise(simulating: Service) -> None:
    problem = Problem(load_file(library()["unicycle_noise"]))
    seeds = of_draws(problem.campaign.seed, 0, DRAWN)
    own, _ = problem.evaluate(POINTS[:DRAWN], seeds=seeds)
    grid, _ = problem.evaluate(POINTS[DRAWN:])
    costs = np.concatenate([own.costs, grid.costs])
    with simulating.signed_in() as client:
        run = number(shipped(simulating, client, "unicycle_noise"))
        work = Work(simulating, PLAN)
        work.nominal()
        work.store.begin(1)
        work.store.append(1, 0, Columns(POINTS, costs, np.zeros(3, np.uint8), np.ones(3), {}))
        with read(simulating.engine) as reader:
            assert draws(reader, run, problem.campaign.document()) == {1: WHOLE}, "while the stage runs"
        asked = {"stages": {"certify": {"samples": 1, "grid": {"points": 2}}}}
        with read(simulating.engine) as reader:
            assert draws(reader, run, asked) == {1: 1}, "what was asked for is drawn before the grid"
        worst = problem.named(POINTS[0])
        cost = float(costs[0, 0])
        case = results.validation("F1", cost, realisation=int(seeds[0]))
        known = {"point": POINTS[0].tolist(), "methods": [], "validation": case}
        finding = results.finding("F1", cost, 0.1, worst, **known)
        work.store.finish(1, results.certified(DRAWN), 1.0, findings=[finding])
        with read(simulating.engine) as reader:
            setting = load(reader, run)
            cloud = cloud_of(reader, run, setting, None)
            progress = Progress(setting, run)
            progress.look(reader)
            _, sampled = _sample(reader, run, setting)
    noise = [one.noise for one in sorted(cloud.drawn, key=lambda one: one.index)]
    assert noise == [one.noise for one in sampled] == [Noise(draw=0), Noise(draw=1), STATED]
    assert progress.seeds == {"F1": int(seeds[0])}
    for one in cloud.drawn:
        again = simulating.app.state.live.simulate(setting.document, setting.digest, one.parameters, 100, one.noise)
        assert again["cost"] == one.cost, f"evaluation {one.index}, bit by bit"
        flight = from_live(again)
        assert flight is not None
        assert flight.seed == (seeds[one.index] if one.index < DRAWN else again["meta"]["realisation"]["seed"])
    stated = simulating.app.state.live.simulate(setting.document, setting.digest, worst, 100)
    assert stated["cost"] != costs[0, 0], "under the stated noise it is another flight"
