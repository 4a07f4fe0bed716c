"""Criteria other than separation against closed forms for known motions, and against traces.

A vehicle made for this drifts along a straight line, and rolls and pulls as its parameters say.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from campaigns import Campaign, check, library, load_file
from campaigns.asked.load import load_document
from campaigns.results.base import FAILED, OK
from clearance.testing.problems import Problem
from tests.given.reference_in_python import PlainReference
from tests.physics.drifting import AVOIDER, CONTROLLER, VEHICLE
from tests.physics.scenes import uncompiled
from worker.engine.kernels.layout import Parts
from worker.engine.systems.closed_loop.assemble import Loop
from worker.engine.systems.closed_loop.trace import trace
from worker.running.catalogue.installed import catalogue, components

CASE = load_file(library()["unicycle_static"])
HORIZON = 10.0


FAR = {"obstacles.0.position.x": 1e5, "obstacles.0.position.y": 0.0, "obstacles.0.position.z": 0.0}


def flown(criterion: str, step: float = 0.01, horizon: float = HORIZON, **given: float) -> float:
    """The value of a criterion, in its own sign, of one flight; parameters with `__` for the dot."""
    known = components()
    objective: Any = known["criterion", criterion]
    parts = Parts(
        VEHICLE,
        CONTROLLER,
        AVOIDER,
        (known["obstacle", "sphere"],),  # type: ignore[arg-type]
        known["criterion", "separation"],  # type: ignore[arg-type]
        objectives=(objective,),
    )
    loop = Loop(parts, lanes=1, compiled=False)
    values = {"criterion.threshold": 1.0, **FAR} | {k.replace("__", "."): v for k, v in given.items()}
    defaults = {f"{s.prefix}.{p.name}": p.default for s in loop.sections for p in s.parameters}
    assert values.keys() <= defaults.keys()
    vector = np.array(list((defaults | values).values()))
    result = loop.simulate(vector[None].astype(float), step, round(horizon / step))
    assert result.status[0] == 0.0
    return float(-result.costs[0, 1])


class TestGoalMiss:
    def test_straight_past_the_goal_it_is_the_distance_across(self) -> None:
        # The goal is abeam between two steps: at the steps alone the distance would be 2e-5 m more.
        for x in (4.0, 4.003, 4.005, 4.0071):
            assert flown("goal_miss", goal__x=x, goal__y=0.6, goal__z=0.8) == pytest.approx(1.0, abs=1e-9)

    @pytest.mark.parametrize("x", [0.002, 0.0045, 9.9955, 9.998])
    def test_nor_within_the_first_or_the_last_step(self, x: float) -> None:
        assert flown("goal_miss", goal__x=x, goal__y=0.01) == pytest.approx(0.01, abs=1e-9)

    def test_a_flight_that_does_not_get_there_misses_by_what_is_left(self) -> None:
        assert flown("goal_miss", goal__x=13.0, goal__y=4.0) == pytest.approx(5.0, abs=1e-9)

    def test_a_vehicle_that_moves_away_misses_by_its_initial_distance(self) -> None:
        assert flown("goal_miss", goal__x=-3.0, goal__y=4.0) == pytest.approx(5.0, abs=1e-12)

    def test_through_the_goal_it_is_nothing(self) -> None:
        assert flown("goal_miss", goal__x=5.0) == pytest.approx(0.0, abs=1e-6)
        assert flown("goal_miss", goal__x=5.0037) == pytest.approx(0.0, abs=1e-6)

    def test_it_does_not_end_with_the_flight(self) -> None:
        assert flown("goal_miss", goal__x=2.0, goal__y=1.0, horizon=3.0) == pytest.approx(
            flown("goal_miss", goal__x=2.0, goal__y=1.0), abs=1e-12
        )


class TestTimeToGoal:
    def test_straight_at_the_goal_it_is_exact(self) -> None:
        for x in (5.0, 5.0037, 7.77777):
            found = flown("time_to_goal", goal__x=x, objectives__0__radius=0.5)
            assert found == pytest.approx(x - 0.5, abs=1e-12)

    def test_faster_is_sooner(self) -> None:
        assert flown("time_to_goal", vehicle__vx=4.0, goal__x=7.0) == pytest.approx(1.5, abs=1e-12)

    @pytest.mark.parametrize("across", [0.3, 0.6, 0.9])
    def test_past_the_goal_it_is_of_second_order_in_the_step(self, across: float) -> None:
        exact = 5.0037 - math.sqrt(1.0 - across**2)
        given = {"goal__x": 5.0037, "goal__y": across, "objectives__0__radius": 1.0}
        coarse, fine = (abs(flown("time_to_goal", step=step, **given) - exact) for step in (0.04, 0.01))
        # The chord of a curve of curvature c over a step h is off by at most c h^2 / 8.
        curvature = across**2 / math.sqrt(1.0 - across**2)
        assert coarse <= curvature * 0.04**2 / 8 * 1.1
        assert fine <= curvature * 0.01**2 / 8 * 1.1

    def test_never_there_it_is_the_horizon(self) -> None:
        assert flown("time_to_goal", goal__x=5.0, goal__y=1.001) == HORIZON
        assert flown("time_to_goal", goal__x=-5.0) == HORIZON
        assert flown("time_to_goal", goal__x=50.0, horizon=4.0) == 4.0

    def test_there_from_the_start_it_is_nothing(self) -> None:
        assert flown("time_to_goal", goal__x=0.5) == 0.0
        assert flown("time_to_goal", goal__x=1.0) == 0.0

    def test_only_the_first_time_counts(self) -> None:
        # It passes through the sphere: 3.5 s, independent of later motion.
        assert flown("time_to_goal", goal__x=4.5) == pytest.approx(3.5, abs=1e-12)
        assert flown("time_to_goal", goal__x=4.5, horizon=4.0) == pytest.approx(3.5, abs=1e-12)

    def test_at_the_last_step_it_is_still_there(self) -> None:
        assert flown("time_to_goal", goal__x=5.0, horizon=4.0) == pytest.approx(4.0, abs=1e-12)


class TestPeakBank:
    @pytest.mark.parametrize("bank", [0.7, -0.7])
    def test_it_is_the_amplitude_to_either_side(self, bank: float) -> None:
        # A sine of 1.3 rad/s at 0.04 s: at the steps alone it would miss up to 2e-4 rad.
        given = {"vehicle__bank": bank, "vehicle__rate": 1.3}
        assert flown("peak_bank", step=0.04, **given) == pytest.approx(0.7, abs=1e-6)

    def test_level_flight_has_none(self) -> None:
        assert flown("peak_bank") == 0.0

    def test_a_growing_bank_peaks_at_the_end(self) -> None:
        given = {"vehicle__bank": 1.0, "vehicle__rate": 0.1}
        assert flown("peak_bank", **given) == pytest.approx(math.sin(1.0), abs=1e-9)

    def test_a_commanded_turn_banks_as_commanded(self) -> None:
        # The goal is behind: the heading error stays at its bound of 0.4 rad, of which the autopilot banks 1.2. Its
        # integral lets go of the overshoot slowly: 2 % are left.
        made = load_file(library()["uav_moving_criteria"]).document()
        made["scenario"] |= {"goal": {"x": -2000.0, "y": 0.0, "z": 0.0}, "horizon": 6.0}
        made["scenario"]["obstacles"][0]["parameters"] |= {"position.x": 1e5, "position.y": 1e5}
        problem = uncompiled(load_document(made))
        seen = trace(problem.system, "turn", {})
        names = [c.name for c in seen.columns]
        roll = np.abs(seen.data[:, names.index("roll")])
        batch, _ = problem.evaluate(problem.nominal_point[None])
        peak = -batch.costs[0, [c.name for c in problem.results].index("peak_bank")]
        assert roll[-20:] == pytest.approx(1.2 * 0.4, rel=0.03)
        assert roll.max() <= peak < roll.max() + 1e-4
        assert 0.48 < peak < 0.52


class TestPeakCommand:
    def test_a_jump_is_not_overshot(self) -> None:
        given = {"controller__pull": 3.0, "objectives__0__s_1": 2.0}
        assert flown("peak_command", **given) == 1.5

    def test_the_largest_fraction_counts(self) -> None:
        given = {"controller__pull": -3.0, "controller__push": 40.0}
        assert flown("peak_command", **given, objectives__0__s_1=2.0, objectives__0__s_2=100.0) == 1.5
        assert flown("peak_command", **given, objectives__0__s_1=2.0, objectives__0__s_2=10.0) == 4.0
        assert flown("peak_command", **given, objectives__0__s_1=0.0, objectives__0__s_2=80.0) == 0.5

    def test_by_itself_it_is_the_first_input_in_its_unit(self) -> None:
        assert flown("peak_command", controller__pull=-3.0, controller__push=40.0) == 3.0


def several(*objectives: dict[str, Any], **scenario: Any) -> Campaign:
    """Case 1 with further criteria."""
    made = CASE.document()
    made["objectives"] = list(objectives)
    made["scenario"] |= scenario
    return load_document(made)


THREE = (
    {"component": "goal_miss"},
    {"component": "time_to_goal", "parameters": {"radius": 0.5}},
    {"component": "peak_command", "parameters": {"s_1": 10.0, "s_2": 2.0}},
)
POINTS = np.random.default_rng(4).random((35, 2))


class TestTogether:
    def test_the_criterion_that_decides_keeps_every_bit(self) -> None:
        alone = Problem(CASE).evaluate(POINTS)[0].costs
        assert alone.shape == (35, 1)
        together = Problem(several(*THREE)).evaluate(POINTS)[0].costs
        assert together.shape == (35, 4)
        assert together[:, 0].tobytes() == alone[:, 0].tobytes()

    def test_each_is_what_it_is_alone_in_any_order(self) -> None:
        def costs(*objectives: dict[str, Any]) -> Any:
            return uncompiled(several(*objectives, horizon=5.0)).evaluate(POINTS[:1])[0].costs

        wide = {"component": "time_to_goal", "parameters": {"radius": 3.0}}  # which it is in before 5 s
        three = (THREE[0], wide, THREE[2])
        together, turned = costs(*three), costs(*three[::-1])
        assert together[:, 1:] == pytest.approx(turned[:, :0:-1], rel=1e-12)
        assert -together[0, 2] < 5.0
        for k, objective in enumerate(three):
            assert costs(objective)[:, 1] == pytest.approx(together[:, 1 + k], rel=1e-12)

    def test_they_agree_with_the_trace(self) -> None:
        problem = Problem(several(*THREE))
        seen = trace(problem.system, "nominal", {})
        data = {c.name: seen.data[:, k] for k, c in enumerate(seen.columns)}
        to_goal = np.hypot(data["x"] - 6.0, data["y"] - 7.0)
        share = np.maximum(np.abs(data["force"]) / 10.0, np.abs(data["torque"]) / 2.0)
        _, miss, time, peak = -problem.evaluate(problem.nominal_point[None])[0].costs[0]
        assert miss == pytest.approx(to_goal.min(), abs=1e-5)
        first = int(np.argmax(to_goal <= 0.5))
        assert data["t"][first - 1] < time <= data["t"][first]
        assert peak == pytest.approx(share.max(), rel=1e-12)
        assert seen.meta.closest is not None
        assert seen.meta.closest.value == pytest.approx(data["separation"].min(), abs=1e-5)

    def test_half_the_step_hardly_changes_them(self) -> None:
        problem = Problem(several(*THREE))
        vectors = problem.vectors(POINTS[:8])
        one, half = (problem.system.simulate_vectors(vectors, step)[0].costs for step in (0.005, 0.0025))
        assert half[:, 0] == pytest.approx(one[:, 0], abs=1e-5)
        assert half[:, 1] == pytest.approx(one[:, 1], abs=1e-4)
        assert half[:, 2] == pytest.approx(one[:, 2], abs=1e-4)

    def test_the_other_integrator_confirms_the_one_that_decides(self) -> None:
        problem = Problem(several(*THREE, horizon=4.0))
        vector = problem.vectors(POINTS[:1])[0]
        found = PlainReference(problem.system).simulate(vector)
        assert found.cost == pytest.approx(problem.system.simulate_vectors(vector[None])[0].costs[0, 0], abs=1e-6)

    def test_a_failed_simulation_has_no_values(self) -> None:
        problem = Problem(several(*THREE))
        vector = problem.vectors(POINTS[:3])
        vector[1, problem.paths["controller.K_p1"]] = -1e6
        batch, reasons = problem.system.simulate_vectors(vector)
        assert batch.status.tolist() == [OK, FAILED, OK], reasons
        assert np.isnan(batch.costs[1]).all()
        assert np.isfinite(batch.costs[[0, 2]]).all()

    def test_of_realisations_the_worst_of_each_counts(self) -> None:
        noise = [{"component": "sensor_noise", "parameters": {"sigma": 0.05, "period": 0.1}}]
        beside = {"x": 2.2, "y": 2.6, "theta": 1.0, "v": 1.0}  # where the obstacle's seen position matters
        given: dict[str, Any] = {"faults": noise, "guidance": {"period": 0.1}, "start": beside, "horizon": 1.5}

        def evaluated(seeds: list[int], combine: str = "worst") -> Any:
            problem = uncompiled(several(*THREE, **given, realisations={"seeds": seeds, "combine": combine}))
            return problem.evaluate(POINTS[:1])[0].costs

        costs = np.array([evaluated([seed]) for seed in (3, 1, 8)])
        worst, mean = evaluated([3, 1, 8]), evaluated([3, 1, 8], "mean")
        assert worst.tobytes() == costs.min(axis=0).tobytes()
        assert mean == pytest.approx(costs.mean(axis=0), rel=1e-14)
        assert all(len(set(row)) > 1 for row in costs.argmin(axis=0)), "the worst of two come from different flights"

    def test_their_parameters_may_be_uncertain(self) -> None:
        made = several(*THREE).document()
        made["uncertain"] = {"objectives.1.radius": {"low": 0.2, "high": 1.0}, "goal.x": {"low": 5.9, "high": 6.1}}
        made["stages"]["search"] = [{"method": "direct", "evaluations": 1}]
        problem = Problem(load_document(made))
        k = [r.path for r in problem.ranges].index("objectives.1.radius")
        points = np.full((2, 2), 0.5)
        points[:, k] = [0.0, 1.0]
        costs = problem.evaluate(points)[0].costs
        assert costs[0, 2] < costs[1, 2], "a smaller radius is reached later"
        assert costs[0, [0, 1, 3]].tolist() == costs[1, [0, 1, 3]].tolist()


class TestCheck:
    def statement(self, **changes: Any) -> list[tuple[str, str]]:
        made = CASE.document() | changes
        return [(p.field, p.message) for p in check(load_document(made), catalogue())]

    def test_what_is_worse_when_high_cannot_decide(self) -> None:
        criterion = {"component": "goal_miss", "threshold": 1.0}
        [(field, message)] = self.statement(criterion=criterion)
        assert field == "criterion.component"
        assert "worse when high" in message
        assert "separation" in message

    def test_none_is_given_twice(self) -> None:
        [(field, message)] = self.statement(objectives=[{"component": "goal_miss"}, {"component": "goal_miss"}])
        assert field == "objectives.1.component"
        assert "already given" in message
        assert self.statement(objectives=[{"component": "separation"}])[0][0] == "objectives.0.component"
        radii = [{"component": "time_to_goal", "parameters": {"radius": r}} for r in (0.5, 1.0)]
        assert self.statement(objectives=radii) == []

    def test_an_unknown_one_and_one_of_another_dimension(self) -> None:
        assert self.statement(objectives=[{"component": "goal_mis"}])[0][0] == "objectives.0.component"
        [(field, message)] = self.statement(objectives=[{"component": "peak_bank"}])
        assert field == "objectives.0.component"
        assert "has 3 dimensions" in message

    def test_a_heading_is_not_a_goal_that_can_be_missed(self) -> None:
        made = load_file(library()["uav_aca"]).document() | {"objectives": [{"component": "goal_miss"}]}
        [problem] = check(load_document(made), catalogue())
        assert problem.field == "objectives.0.component"
        assert "follows a path and has no goal" in problem.message

    def test_its_parameters_are_checked_against_their_limits(self) -> None:
        wrong = {"component": "time_to_goal", "parameters": {"radius": -1.0}}
        assert self.statement(objectives=[wrong])[0][0] == "objectives.0.parameters.radius"
