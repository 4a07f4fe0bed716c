"""Every component: documented, limited, and robust within its limits.

On the plain form, which needs no compiler; `test_compiled` holds the compiled form to it.
"""

from __future__ import annotations

import numpy as np
import pytest

from campaigns.asked.load import load_document
from campaigns.results.base import OK
from clearance.testing import ComponentContract
from clearance.testing.problems import Problem
from clearance.testing.rates import turns_as_declared
from clearance.testing.scenes import entry, own, problem
from worker.engine.kernels.bind import plain
from worker.engine.kernels.component import Component, Criterion, Environment, Fault, Obstacle, Vehicle, declared
from worker.running.catalogue.installed import catalogue, components

EACH = pytest.mark.parametrize("component", components().values(), ids=lambda c: f"{c.role}-{c.name}")


SOME = pytest.mark.parametrize(
    "component",
    [pytest.param(c, id=f"{c.role}-{c.name}", marks=pytest.mark.nightly if k % 3 else ())
     for k, c in enumerate(components().values())],
)  # fmt: skip
"""By day a third, for what takes several flights of each; every one is simulated and meets a NaN."""


def contract(tested: Component) -> ComponentContract:
    """The checks of this component."""

    class Contract(ComponentContract):
        component = tested

    return Contract()


def test_there_are_components_of_every_kind() -> None:
    assert {role for role, _ in components()} >= {"vehicle", "controller", "avoider", "obstacle", "criterion"}
    assert len(catalogue().components) == len(components())


@EACH
def test_it_is_documented(component: Component) -> None:
    contract(component).test_it_is_documented()


@EACH
def test_its_names_can_be_written_in_a_campaign(component: Component) -> None:
    contract(component).test_its_names_can_be_written_in_a_campaign()


@EACH
def test_its_parameters_have_unit_text_and_limits(component: Component) -> None:
    contract(component).test_its_parameters_have_unit_text_and_limits()


VEHICLES = [c for (role, _), c in components().items() if role == "vehicle"]
CRITERIA = [c for (role, _), c in components().items() if role == "criterion"]


@pytest.mark.parametrize("criterion", CRITERIA, ids=lambda c: c.name)
def test_a_criterion_declares_which_end_is_worse(criterion: Criterion) -> None:
    named = [p.name for p in declared(criterion.parameters)]
    assert entry(criterion).worse == criterion.worse
    assert entry(criterion).of == criterion.of
    assert (entry(criterion).dimension is None) == (set(criterion.sample) == {2, 3})
    assert "threshold" not in [p.name for p in entry(criterion).parameters]
    if criterion.worse == "low":
        assert named[0] == "threshold"
        assert criterion.excluded is not None
    else:
        assert "threshold" not in named


@pytest.mark.by_day(1)
@pytest.mark.parametrize("criterion", [c for c in CRITERIA if c.worse == "high"], ids=lambda c: c.name)
def test_a_further_criterion_does_not_change_the_deciding_one(criterion: Criterion) -> None:
    beside = problem(criterion, compiled=False)
    document = beside.campaign.document() | {"objectives": []}
    alone = Problem(load_document(document), compiled=False)
    points = np.random.default_rng(5).random((21, 1))
    batch, _ = beside.evaluate(points)
    assert batch.costs.shape == (21, 2)
    assert batch.costs[:, 0].tobytes() == alone.evaluate(points)[0].costs[:, 0].tobytes()
    # Its sign is turned, so that every column is minimised.
    assert (batch.costs[:, 1] <= 0.0).all()


@pytest.mark.parametrize("vehicle", VEHICLES, ids=lambda v: v.name)
def test_a_vehicle_declares_its_states_and_limits(vehicle: Vehicle) -> None:
    assert len({s.name for s in vehicle.states}) == len(vehicle.states)
    assert all(limit.text and not limit.text.endswith(".") for limit in vehicle.limits)
    flown = problem(vehicle, compiled=False)
    x = flown.system.loop.part("initial")(flown.system.loop.extend(flown.system.nominal))
    assert len(x) >= len(vehicle.states)
    assert flown.system.loop.part("envelope")(0.0, x, flown.system.loop.extend(flown.system.nominal)) == 0.0


@pytest.mark.by_day(23)
@EACH
def test_it_turns_no_faster_than_it_declares(component: Component) -> None:
    contract(component).test_it_turns_no_faster_than_it_declares()


TURNING = [c for c in components().values() if isinstance(c, Obstacle) and c.moving and not c.states]


@pytest.mark.parametrize("obstacle", TURNING, ids=lambda o: o.name)
def test_a_rate_that_is_declared_too_low_is_found(obstacle: Obstacle) -> None:
    flown, parameters, rate = problem(obstacle, compiled=False), own(obstacle), entry(obstacle).rate
    assert rate is not None
    if rate.times and len(rate.legs) != 2:  # a single leg never turns
        with pytest.raises(AssertionError, match="it turns by"):
            turns_as_declared(flown, parameters, rate.model_copy(update={"times": 0.4 * rate.times}))


@pytest.mark.by_day(23)
@EACH
def test_it_can_be_simulated_with_the_first_other_components_that_fit(component: Component) -> None:
    contract(component).test_it_can_be_simulated_with_the_first_other_components_that_fit()


@pytest.mark.by_day(8)
@SOME
def test_within_its_limits_nothing_crashes_and_nothing_is_hidden(component: Component) -> None:
    contract(component).test_within_its_limits_nothing_crashes_and_nothing_is_hidden()


@pytest.mark.by_day(23)
@EACH
def test_a_nan_fails_the_simulation_or_changes_nothing(component: Component) -> None:
    contract(component).test_a_nan_fails_the_simulation_or_changes_nothing()


def test_a_far_obstacle_does_not_fail_a_flight() -> None:
    obstacle = components()["obstacle", "circle"]
    flown = problem(obstacle, compiled=False)
    vector = flown.vector({"obstacles.0.position.x": 1e6, "obstacles.0.position.y": 1e6})
    batch, reasons = flown.system.simulate_vectors(vector[None, :])
    assert batch.status[0] == OK, reasons


BUILDING = [
    c
    for c in components().values()
    if (isinstance(c, Environment) and not c.draws) or (isinstance(c, Fault) and c.path == "actuator")
    if c.switches and c.derived is None
]


@pytest.mark.parametrize("component", BUILDING, ids=lambda c: f"{c.role}-{c.name}")
def test_what_builds_up_declares_from_when_its_effect_is_whole(component: Environment | Fault) -> None:
    """Nothing that comes later is larger, and what takes time to build up is not whole at once."""
    p = component.parameters(
        *(
            p.default + 1.0 + 0.5 * k if p.unit == "s" and p.default < 1e3 else 1.0 + 0.1 * k
            for k, p in enumerate(declared(component.parameters))
        )
    )
    instants = component.switches(p, 100.0)

    def effect(t: float) -> float:
        if isinstance(component, Environment):
            return float(np.linalg.norm(plain(component.blow)(t, None, None, (0.0,) * component.states, p)[0]))
        return abs(plain(component.kernel)(t, 3.0, (0.5,) * component.states, p)[0] - 3.0)

    times = np.arange(0.0, max(instants) + 2.0, 0.01)
    effects = np.array([effect(t) for t in times])
    assert effects.max() > 0.0
    whole = instants[component.whole]
    assert effect(whole + 1e-6) == pytest.approx(effects.max(), rel=1e-6)
    early = effects[times < whole - 0.1]
    assert component.whole == 0 or early.max() < 0.999 * effects.max()
