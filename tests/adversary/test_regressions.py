"""A finding of a baseline is "fixed" only if nothing that the run knows in its basin violates; truth by dense lines.

Vehicles with other avoidance, and functions with wells of which some are raised: the findings of the earlier one are
cases of its violations. The truth is a line to each stored violation, of any stage and whether listed or not: "fixed"
is wrong if the criterion falls along one of them without a rise.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.results.base import OK
from campaigns.results.regression import FindingChange, Standing
from clearance.cli import invoke
from clearance.testing.problems import Problem as Flown
from tests.adversary.classes import MASSES, avoider, campaign, circle
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import Floats
from worker.engine.systems.simulators.declared.function import Declaration, Output, Parameter, Settings
from worker.running.catalogue.files import PythonFunction
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

STEPS = 60
"""Points between a case and a violation."""
Cost = Callable[[Floats], Floats]


def counted(day: int, night: int) -> list[Any]:
    """Campaigns by day and by night."""
    return [day, pytest.param(night, marks=[pytest.mark.nightly, pytest.mark.timeout(1800)])]


def changed_avoidance(random: np.random.Generator) -> tuple[dict[str, Any], Floats, Cost]:
    """A campaign whose baseline violated in several places, and the points of these."""
    gain, y = float(random.uniform(2.0, 5.0)), float(random.uniform(3.3, 4.7))
    uncertain = MASSES | {"obstacles.0.position.x": {"low": 3.3, "high": 4.7}}
    made = campaign(
        "changed avoidance", random, frozenset(), scenario__obstacles=[circle(4.0, y)], uncertain=uncertain,
        scenario__avoider=avoider(gain), stages__certify={"samples": 60},
    ).document  # fmt: skip
    before = flights(made)
    points = random.random((400, 3))
    threshold = float(np.quantile(before(points), random.uniform(0.05, 0.5)))
    points = random.permutation(points[before(points) <= threshold])[:4]
    parts = {"parts": {"obstacles.0": "circle"}}
    made["baseline"] = baseline(Flown(load_document(made)), points, before, threshold) | parts
    made["scenario"]["avoider"] = avoider(gain * float(random.uniform(0.9, 3.0)))
    made["criterion"] = made["criterion"] | {"threshold": threshold}
    return made, points, flights(made)


def flights(document: dict[str, Any]) -> Cost:
    problem = Flown(load_document(document))

    def costs(points: Floats) -> Floats:
        batch, _ = problem.system.simulate_vectors(problem.vectors(points), problem.system.step)
        return np.where(batch.status == OK, batch.costs[:, 0], np.inf)

    return costs


def raised_wells(random: np.random.Generator) -> tuple[dict[str, Any], Floats, Cost, Problem]:
    """A function with wells, some of which no longer violate; the baseline has a case in each."""
    n, count = int(random.integers(2, 4)), int(random.integers(2, 7))
    centres, widths = random.uniform(0.1, 0.9, (count, n)), random.uniform(0.05, 0.2, count)
    depths = random.uniform(0.6, 1.0, count)

    def costs(points: Floats, depths: Floats) -> Floats:
        apart = ((points[:, None, :] - centres) ** 2).sum(axis=-1)
        tilt = 0.1 * points.sum(axis=-1)
        return np.asarray(1.0 + tilt - (depths * np.exp(-0.5 * apart / widths**2)).sum(axis=-1))

    after = depths * random.choice([random.uniform(0.0, 0.4), random.uniform(0.4, 0.9), 1.0], count)
    names = [f"x{k}" for k in range(n)]

    def function(**x: Floats) -> Floats:
        return costs(np.stack([x[name] for name in names], axis=-1), after)

    declaration = Declaration(
        "wells", "wells", "", {name: Parameter(0.0, 1.0) for name in names}, {"value": Output()},
        Settings(vectorized=True, isolated=False),
    )  # fmt: skip
    made = {
        "name": "raised wells",
        "simulator": {"name": "wells", "parameters": dict.fromkeys(names, 0.5)},
        "uncertain": {f"simulator.{name}": {"low": 0.0, "high": 1.0} for name in names},
        "criterion": {"result": "value", "threshold": 0.5},
        "stages": {
            "search": [{"method": "direct", "evaluations": 300}, {"method": "sqp", "evaluations": 200}],
            "certify": {"samples": 59},
            "validate": {"neighbours": 10, "evaluations": int(random.choice([300, 30_000, 30_000]))},
        },
        "seed": int(random.integers(1, 2**31)),
    }
    python = PythonFunction(declaration, {}, function)
    known = catalogue().model_copy(update={"simulators": [python.entry]})
    points = np.clip(centres + 0.7 * widths[:, None] * random.uniform(-1, 1, (count, n)), 0.0, 1.0)
    points = points[costs(points, depths) <= 0.5][:5]
    asked = load_document(made)
    problem = Problem(asked, opened.simulated(asked, python, known))
    if len(points):
        made["baseline"] = baseline(problem, points, lambda p: costs(p, depths), 0.5) | {"repeats": {"count": 1}}
        problem = Problem(load_document(made), problem.system)
    return made, points, lambda p: costs(p, after), problem


def baseline(problem: Problem, points: Floats, costs: Cost, threshold: float) -> dict[str, Any]:
    cases = [
        {"label": f"F{k}", "parameters": problem.named(point), "cost": float(costs(point[None, :])[0])}
        for k, point in enumerate(points, 1)
    ]
    return {"run": "R-0001", "digest": "0" * 64, "threshold": threshold, "cases": cases}


def ran(document: dict[str, Any], at_most: int, problem: Problem | None = None) -> tuple[list[FindingChange], Floats]:
    """The changes of the baseline's findings, and all stored violations (m, n)."""
    document["stages"]["findings"] = {"at_most": at_most}
    asked, store = load_document(document), MemoryStore()
    if problem is not None:
        problem = Problem(asked, problem.system)
    execute(asked, store, threads=1, problem=problem)
    assert store.verdict is not None
    assert store.verdict.regression is not None
    stored = [found for at in range(len(store.stages)) if (found := store.evaluations(at)) is not None]
    threshold = document["criterion"]["threshold"]
    violates = [(c.status == OK) & (c.costs[:, 0] <= threshold) for c in stored]
    cases = [case for case in store.verdict.regression.cases if case.before is not None]
    return cases, np.concatenate([c.points[rows] for c, rows in zip(stored, violates, strict=True)])


def falls(start: Floats, violations: Floats, costs: Cost) -> bool:
    """Whether the criterion falls from here to any of these without a rise."""
    for ends in np.array_split(violations, len(violations) // 500 + 1):
        lines = start + np.linspace(0.0, 1.0, STEPS)[None, :, None] * (ends - start)[:, None, :]
        along = costs(lines.reshape(-1, len(start))).reshape(len(ends), STEPS)
        if not (np.diff(along, axis=1) > 1e-6).any(axis=1).all():
            return True
    return False


def fixed(cases: list[FindingChange], violations: Floats, points: Floats, costs: Cost) -> int:
    """How many are fixed; asserts that they are."""
    found = [case for case in cases if case.standing is Standing.FIXED]
    for case in found:
        start = points[int(str(case.before)[1:]) - 1]
        assert case.margin is not None
        assert case.margin > 0, case.text
        assert not falls(start, violations, costs), case.text
    return len(found)


@pytest.mark.nightly  # by day the same of a function, below
@pytest.mark.parametrize("count", counted(1, 40))
def test_a_vehicle_has_nothing_fixed_that_falls_to_a_violation_without_a_rise(count: int) -> None:
    several = violating = 0
    for seed in range(count):
        document, points, costs = changed_avoidance(np.random.default_rng([20_261_124, 8, seed]))
        cases, violations = ran(document, 1 + seed % 8)
        several += fixed(cases, violations, points, costs)
        violating += bool(len(violations))
    assert several or count < 40, "no attack had anything that is fixed"
    assert count < 40 or violating >= count / 4, violating


@pytest.mark.parametrize("count", counted(3, 120))
def test_a_function_has_nothing_fixed_that_falls_to_a_violation_without_a_rise(count: int) -> None:
    standings: list[Standing] = []
    beside = 0
    for seed in range(count):
        document, points, costs, problem = raised_wells(np.random.default_rng([20_261_125, 8, seed]))
        if not len(points):
            continue
        cases, violations = ran(document, 1 + seed % 8, problem)
        beside += fixed(cases, violations, points, costs) * bool(len(violations))
        standings += [case.standing for case in cases]
    assert count < 40 or beside > count / 10, "hardly any finding is fixed while another one violates"
    assert count < 40 or {Standing.UNRESOLVED, Standing.BETTER, Standing.SAME} < {*standings}


@pytest.mark.nightly
@pytest.mark.timeout(600)
@pytest.mark.parametrize(("seed", "at_most", "allowance"), [(0, 2, 200), (2, 1, 20_000), (7, 1, 20_000)])
def test_the_audit_finds_the_same_standings(seed: int, at_most: int, allowance: int, tmp_path: Path) -> None:
    """Unresolved, fixed, the same and better."""
    document, _, _ = changed_avoidance(np.random.default_rng([20_261_124, 8, seed]))
    document["stages"]["findings"] = {"at_most": at_most}
    document["stages"]["validate"] = {"neighbours": 10, "evaluations": allowance}
    (tmp_path / "campaign.json").write_text(json.dumps(document))
    invoke(["run", str(tmp_path / "campaign.json"), "--out", str(tmp_path / "out")])
    assert invoke(["audit", str(tmp_path / "out")]) == 0
