"""A stored evaluation that drew its own noise is simulated again with that noise."""

from __future__ import annotations

import httpx
import numpy as np

from backend.db.engine import read
from backend.results.noise import drawn
from backend.runs.service import number
from backend.scenes.base.progress import Progress
from backend.scenes.base.setting import load
from backend.scenes.panel.sample import _sample
from campaigns import Campaign, library, load_file
from campaigns.results.draws import of_draws
from campaigns.results.stage import Reevaluated
from campaigns.stages.baseline import BaselineResult
from campaigns.stored.records import Columns, StagePlan
from clearance.testing.problems import Problem
from tests import results
from tests.given.finished_runs import Work
from tests.given.service import Service
from tests.given.shipped_runs import shipped
from tests.given.submissions import submit

PLAN = [StagePlan("nominal", None, 1), StagePlan("certify", None, 3)]
POINTS = np.array([[0.1, 0.2, 0.4], [0.5, 0.5, 0.5], [0.9, 0.3, 0.7]])
DRAWN = 2
"""The third evaluation is of a grid, under the realisations that the campaign states."""


def test_a_stored_evaluation_is_simulated_again_under_its_own_noise(simulating: Service) -> None:
    problem = Problem(load_file(library()["unicycle_noise"]))
    with simulating.signed_in() as client:
        run = number(shipped(simulating, client, "unicycle_noise"))
        work = Work(simulating, PLAN)
        seed = work.store.sample_seed.value
        seeds = of_draws(seed, 0, DRAWN)
        own, _ = problem.evaluate(POINTS[:DRAWN], seeds=seeds)
        grid, _ = problem.evaluate(POINTS[DRAWN:])
        costs = np.concatenate([own.costs, grid.costs])
        work.nominal()
        work.store.begin(1)
        work.store.append(1, 0, Columns(POINTS, costs, np.zeros(3, np.uint8), np.ones(3), {}))
        document = problem.campaign.document()
        with read(simulating.engine) as reader:
            assert drawn(reader, run, problem.campaign)[1].tolist() == of_draws(seed, 0, 3).tolist()
            document["stages"]["certify"] = {"samples": 1, "grid": {"points": 2}}
            before = drawn(reader, run, Campaign.model_validate(document))
            assert {position: found.tolist() for position, found in before.items()} == {1: [seeds[0]]}, (
                "while the stage runs: what was requested is drawn before the grid"
            )
        worst = problem.named(POINTS[0])
        cost = float(costs[0, 0])
        case = results.validation("F1", cost, realisation=int(seeds[0]))
        known = {"point": POINTS[0].tolist(), "methods": [], "validation": case}
        finding = results.finding("F1", cost, 0.1, worst, **known)
        work.store.finish(1, results.certified(DRAWN), 1.0, findings=[finding])
        with read(simulating.engine) as reader:
            setting = load(reader, run)
            progress = Progress(setting, run)
            progress.look(reader)
            _, sampled = _sample(reader, run, setting)
        answer = client.get(f"/api/v1/runs/R-{run:04d}/evaluations").json()["stages"]
        shown = next(stage for stage in answer if stage["kind"] == "certify")
        assert shown["index"] == [0, 1, 2]
        assert shown["seeds"] == [one.seed for one in sampled] == [*seeds, None]
        assert progress.seeds == {"F1": int(seeds[0])}
        for index in range(3):
            values = {path: column[index] for path, column in shown["parameters"].items()}
            asked = {"parameters": values, "seed": shown["seeds"][index]}
            again = client.post(f"/api/v1/runs/R-{run:04d}/flights", json=asked).json()
            assert again["cost"] == shown["cost"][index] == costs[index, 0], f"evaluation {index}, bit by bit"
            assert index >= DRAWN or again["trace"]["realisation"]["seed"] == seeds[index]
    stated = simulating.app.state.live.simulate(setting.document, setting.digest, worst, 100)
    assert stated["cost"] != costs[0, 0], "under the stated noise it is another flight"


def test_the_findings_of_a_baseline_keep_their_noise(service: Service, client: httpx.Client) -> None:
    run = number(submit(client))
    work = Work(service, [StagePlan("baseline", None, 3), StagePlan("search", "monte_carlo", 100)])
    work.store.begin(0)
    work.store.append(0, 0, Columns(POINTS[:, :2], np.ones((3, 1)), np.zeros(3, np.uint8), np.ones(3), {}))
    cases = [Reevaluated(label=f"F{k}", index=k, realisation=seed) for k, seed in enumerate((7, 4, None))]
    work.store.finish(0, BaselineResult(run="R-0001", cases=cases, drawn_realisations=2), 1.0)
    work.search(0, 100, stage=1)
    stages = client.get(f"/api/v1/runs/R-{run:04d}/evaluations").json()["stages"]
    assert [stage["seeds"] for stage in stages] == [[7, 4, None], []]
