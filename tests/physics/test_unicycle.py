"""Case 1 as physics: published values, order of the integrator, closed forms, symmetry, two formulations agreeing.

Values: Srikanthakumar (tables 4.1, 5.1 to 5.3) as reconstructed; DOP853 on the same equations.
"""

from __future__ import annotations

import math
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.results.base import EXCLUDED, FAILED, OK
from clearance.testing.problems import Problem
from tests.bench import bench
from worker.engine.components.avoiders import potential_field
from worker.engine.components.obstacles import circle
from worker.engine.kernels.bind import plain
from worker.engine.reference.reference import Reference

CASE = load_file(library()["unicycle_static"])
PROBLEM = Problem(CASE)


def changed(compiled: bool = True, /, **scenario: object) -> Problem:
    """The case with parts of its scenario replaced."""
    document = CASE.document()
    document["scenario"] |= scenario
    document["stages"]["search"] = [{"method": "direct", "evaluations": 1}]
    return Problem(load_document(document), compiled)


def cost(problem: Problem, step: float | None = None, **values: float) -> float:
    batch, reasons = problem.system.simulate_vectors(
        problem.vector({k.replace("__", "."): v for k, v in values.items()})[None], step
    )
    assert batch.status[0] == OK, reasons
    return float(batch.costs[0, 0])


class TestPublished:
    """The three anchors to 2e-6 m, and the sweeps as far as they are printed."""

    @pytest.mark.parametrize(
        ("m", "J", "d_min"), [(5.0, 0.05, 0.9435642), (6.0, 0.06, 0.9417402), (4.0, 0.04, 0.9466278)]
    )
    def test_d_min_is_the_known_value(self, m: float, J: float, d_min: float) -> None:
        assert cost(PROBLEM, vehicle__m=m, vehicle__J=J) == pytest.approx(d_min, abs=2e-6)
        other = Reference(PROBLEM.system).simulate(PROBLEM.vector({"vehicle.m": m, "vehicle.J": J}))
        assert other.cost == pytest.approx(d_min, abs=1e-7)

    def test_rounds_to_the_published_nominal(self) -> None:
        assert round(cost(PROBLEM), 4) == 0.9436

    def test_over_mass_at_the_largest_inertia(self) -> None:
        found = [cost(PROBLEM, vehicle__m=m, vehicle__J=0.06) for m in (4, 4.5, 5, 5.5, 6)]
        assert found == pytest.approx([0.94535, 0.94389, 0.94287, 0.94218, 0.94174], abs=6e-6)

    def test_over_inertia_at_the_nominal_mass(self) -> None:
        found = [cost(PROBLEM, vehicle__J=J) for J in (0.04, 0.045, 0.05, 0.055, 0.06)]
        assert found == pytest.approx([0.94426, 0.94391, 0.94356, 0.94322, 0.94287], abs=6e-6)

    def test_falls_everywhere_with_mass_and_inertia(self) -> None:
        grid = np.linspace(0, 1, 15)
        points = np.array([(u, w) for u in grid for w in grid])
        table = PROBLEM.evaluate(points)[0].costs.reshape(15, 15)
        assert (np.diff(table, axis=0) < 0).all()
        assert (np.diff(table, axis=1) < 0).all()


class TestIntegrator:
    def test_order_is_four_where_nothing_switches(self) -> None:
        # Out of reach of the obstacle the right-hand side is smooth. 30 times the inertia slows the fastest pole from
        # 260 to about 9 rad/s, so that these steps lie in the asymptotic range.
        problem = changed(
            vehicle={"component": "unicycle", "parameters": {"m": 5.0, "J": 1.5}},
            obstacles=[{"component": "circle", "parameters": {"position": {"x": 60.0, "y": -60.0}}}],
            horizon=2.0,
            step=0.01,
        )
        ends = {}
        for step in (0.04, 0.02, 0.01):
            flown = problem.system.loop.simulate(problem.system.nominal[None], step, round(2.0 / step), traced=1)
            ends[step] = flown.trace[0, -1, :5]
        coarse, fine = np.abs(ends[0.04] - ends[0.02]), np.abs(ends[0.02] - ends[0.01])
        orders = np.log2(coarse / fine)
        assert orders == pytest.approx(np.full(5, 4.0), abs=0.3)

    @pytest.mark.parametrize(("m", "J"), [(5.0, 0.05), (6.0, 0.06), (4.0, 0.04)])
    def test_agrees_with_dop853(self, m: float, J: float) -> None:
        vector = PROBLEM.vector({"vehicle.m": m, "vehicle.J": J})
        assert Reference(PROBLEM.system).simulate(vector).cost == pytest.approx(
            cost(PROBLEM, vehicle__m=m, vehicle__J=J), abs=2e-6
        )

    def test_half_the_step_changes_less_than_a_micrometre(self) -> None:
        assert cost(PROBLEM, PROBLEM.system.step / 2) == pytest.approx(cost(PROBLEM), abs=1e-6)

    def test_too_long_a_step_does_not_pass_unseen(self) -> None:
        # At 10 ms RK4 is unstable for J = 0.04 kg m2: the turn rate grows until the envelope ends the flight.
        batch, reasons = PROBLEM.system.simulate_vectors(
            PROBLEM.vector({"vehicle.m": 4.0, "vehicle.J": 0.04})[None], 0.01
        )
        assert batch.status[0] == FAILED
        assert "the turn rate exceeds" in reasons[0]


class TestFormulations:
    def test_lockstep_equals_plain_python(self) -> None:
        slow = Problem(CASE, compiled=False)
        points = np.array([[0.5, 0.5], [0.0, 1.0], [0.31, 0.77]])
        assert slow.evaluate(points)[0].costs == pytest.approx(PROBLEM.evaluate(points)[0].costs, abs=1e-12)

    def test_states_equal_plain_python(self) -> None:
        slow = Problem(CASE, compiled=False)
        fast = PROBLEM.system.loop.simulate(PROBLEM.system.nominal[None], 0.005, 800, traced=1).trace
        assert slow.system.loop.simulate(PROBLEM.system.nominal[None], 0.005, 800, traced=1).trace == pytest.approx(
            fast, abs=1e-12
        )

    def test_bits_do_not_depend_on_the_batch(self) -> None:
        random = np.random.default_rng(7)
        points = random.random((53, 2))
        together = PROBLEM.evaluate(points)[0].costs
        alone = np.array([PROBLEM.evaluate(p[None])[0].costs[0] for p in points])
        order = random.permutation(len(points))
        assert alone.tobytes() == together.tobytes()
        assert PROBLEM.evaluate(points[order])[0].costs.tobytes() == together[order].tobytes()

    def test_a_failing_neighbour_leaves_the_bits_alone(self) -> None:
        good = PROBLEM.system.nominal
        bad = PROBLEM.vector({"vehicle.m": math.nan})
        batch, _ = PROBLEM.system.simulate_vectors(np.array([bad, good, bad]))
        assert batch.costs[1].tobytes() == PROBLEM.system.simulate_vectors(good[None])[0].costs[0].tobytes()

    def test_the_trace_shows_the_flight_that_was_counted(self) -> None:
        flown = PROBLEM.system.loop.simulate(PROBLEM.system.nominal[None], PROBLEM.system.step, 3000, traced=1)
        squares = ((flown.trace[0, :, :2] - [4.0, 4.0]) ** 2).sum(axis=1)
        i = int(squares.argmin())
        a, b, c = squares[i - 1 : i + 2]
        assert math.sqrt(b - 0.125 * (a - c) ** 2 / (a - 2 * b + c)) == pytest.approx(flown.costs[0, 0], abs=1e-14)


class TestSymmetry:
    """Rotating, mirroring or moving the whole scene changes no distance."""

    def scene(self, turn: float = 0.0, mirror: float = 1.0, shift: float = 0.0) -> Problem:
        c, s = math.cos(turn), math.sin(turn)

        def place(x: float, y: float) -> dict[str, float]:
            y *= mirror
            return {"x": c * x - s * y + shift, "y": s * x + c * y - shift}

        return changed(
            start={**place(0.0, 0.0), "theta": turn},
            goal=place(6.0, 7.0),
            obstacles=[{"component": "circle", "parameters": {"position": place(4.0, 4.0), "radius": 0.5}}],
        )

    @pytest.mark.parametrize(
        "scene", [{"turn": 2.1}, {"mirror": -1.0}, {"shift": 11.0}, {"turn": -0.7, "mirror": -1.0}]
    )
    def test_the_closest_approach_stays(self, scene: dict[str, float]) -> None:
        assert cost(self.scene(**scene)) == pytest.approx(cost(PROBLEM), abs=1e-9)

    def test_a_second_obstacle_out_of_reach_changes_nothing(self) -> None:
        circle = {"component": "circle", "parameters": {"position": {"x": 4.0, "y": 4.0}, "radius": 0.5}}
        far = {"component": "circle", "parameters": {"position": {"x": -40.0, "y": 4.0}, "radius": 0.5}}
        for obstacles in ([circle, far], [far, circle]):
            plain = changed(False, obstacles=obstacles, horizon=4.0)  # the closest approach comes at 3.1 s
            assert cost(plain) == pytest.approx(cost(PROBLEM), abs=1e-12)


class TestClosedForms:
    COASTING = dict.fromkeys(("K_p1", "K_i1", "K_d1", "K_p2", "K_i2", "K_d2"), 0.0)

    def test_without_control_it_coasts_on_a_circle(self) -> None:
        problem = changed(
            controller={"component": "pid_speed", "parameters": self.COASTING},
            start={"x": 1.0, "y": 0.0, "theta": math.pi / 2, "v": 2.0, "omega": 2.0},
            obstacles=[{"component": "circle", "parameters": {"position": {"x": 1.7, "y": 0.9}, "radius": 0.1}}],
        )
        # radius v/omega = 1 about the origin: the distance to a point outside is its distance less one
        assert cost(problem) == pytest.approx(math.hypot(1.7, 0.9) - 1.0, abs=1e-9)

    def test_power_of_the_force_is_the_rate_of_kinetic_energy(self) -> None:
        trace = PROBLEM.system.loop.simulate(PROBLEM.system.nominal[None], 0.005, 3000, traced=1).trace[0]
        seen = PROBLEM.system.loop.observe(trace, PROBLEM.system.nominal, 0.005)
        names = [s.name for s in PROBLEM.system.loop.signals]
        force, torque = seen[:, names.index("force")], seen[:, names.index("torque")]
        energy = 0.5 * 5.0 * trace[:, 3] ** 2 + 0.5 * 0.05 * trace[:, 4] ** 2
        power = force * trace[:, 3] + torque * trace[:, 4]
        work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1])) * 0.005])
        smooth = slice(400, None)  # after the first transients of the turn loop the trapezoid is accurate
        assert energy[smooth] - energy[400] == pytest.approx(work[smooth] - work[400], abs=2e-3 * energy.max())

    def test_force_is_the_gradient_of_the_potential(self) -> None:
        steer, p = plain(potential_field.steer), potential_field.PotentialField(5.0, 4.0, 2.0)
        bodies = [circle.Circle(4.0, 4.0, 0.5), circle.Circle(1.0, 3.0, 0.2)]
        seen_from = plain(circle.body)
        goal = potential_field.Goal(6.0, 7.0)

        def potential(x: float, y: float) -> float:
            total = 0.5 * p.k_att * ((goal.x - x) ** 2 + (goal.y - y) ** 2)
            for body in bodies:
                d = math.hypot(x - body.position_x, y - body.position_y) - body.radius
                if d <= p.d_0:
                    total += 0.5 * p.k_rep * (1 / d - 1 / p.d_0) ** 2
            return total

        h = 1e-6
        for x, y in [(3.0, 3.2), (2.0, 2.0), (0.4, 2.2), (5.0, 6.0), (2.6, 3.9), (-3.0, 8.0)]:
            around = tuple(seen_from(0.0, (), (x, y), body) for body in bodies)
            force, _ = steer(0.0, (x, y), (0.0, 0.0), goal, around, (), p)
            slope = [
                (potential(x + h, y) - potential(x - h, y)) / (2 * h),
                (potential(x, y + h) - potential(x, y - h)) / (2 * h),
            ]
            assert force == pytest.approx([-s for s in slope], rel=1e-6, abs=1e-6)


class TestFailures:
    """A flight that ends badly is a status with a reason, never a cost."""

    @pytest.mark.parametrize(
        "values",
        [
            {"vehicle.m": 0.0},
            {"vehicle.J": 0.0},
            {"vehicle.m": math.nan},
            {"controller.K_p1": math.inf},
            {"obstacles.0.position.x": math.nan},
            {"criterion.threshold": 0.5, "start.theta": math.nan},
            {"vehicle.J": 1e-6},
            {"avoider.k_att": -500.0},
        ],
    )
    def test_ends_as_failed_with_a_reason(self, values: dict[str, float]) -> None:
        batch, reasons = PROBLEM.system.simulate_vectors(PROBLEM.vector(values)[None])
        assert batch.status[0] == FAILED
        assert math.isnan(batch.costs[0, 0])
        assert "at t = " in reasons[0]

    def test_a_limit_of_the_envelope_is_named(self) -> None:
        batch, reasons = PROBLEM.system.simulate_vectors(PROBLEM.vector({"start.v": 2000.0})[None])
        assert batch.status[0] == FAILED
        assert reasons[0] == "the vehicle left the model's envelope at t = 0 s: the speed exceeds 1000 m/s"

    def test_a_start_inside_the_threshold_is_excluded(self) -> None:
        batch, reasons = PROBLEM.system.simulate_vectors(PROBLEM.vector({"start.x": 4.0, "start.y": 4.3})[None])
        assert batch.status[0] == EXCLUDED
        assert math.isnan(batch.costs[0, 0])
        assert "threshold of 0.5 m" in reasons[0]


@pytest.mark.skipif(shutil.which(os.environ.get("CXX", "g++")) is None, reason="a C++ compiler is needed")
def test_a_program_in_cpp_gives_the_same_costs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The yardstick of `make bench`: written by hand, nothing shared with the components."""
    monkeypatch.setattr(bench, "BUILD", tmp_path)
    cpp, _ = bench.build_cpp()
    vectors = PROBLEM.vectors(np.random.default_rng(1).random((32, PROBLEM.dimension)))
    costs = np.empty(32)
    bench.fly_cpp(cpp, PROBLEM, vectors, PROBLEM.system.counts(PROBLEM.system.step)[0], costs)
    assert costs == pytest.approx(PROBLEM.system.simulate_vectors(vectors)[0].costs[:, 0], abs=1e-11)
    assert (np.full(4, 2.2e-308) / 4.0 > 0.0).all(), (
        "loading the program leaves the arithmetic of this process as it was"
    )
