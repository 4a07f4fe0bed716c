"""An obstacle that extends farther than its declared reach is refused, at whatever values and instants it does."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product
from typing import Annotated, Any, NamedTuple

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from tests.given.at_night import nightly_but
from tests.given.case_campaigns import document as case1
from worker.engine.components.obstacles import circle
from worker.engine.kernels.component import Derived, Obstacle, Parameter, Rate, Reach, declared
from worker.engine.kernels.maths import kernel, norm2, sincos
from worker.engine.kernels.reaches import Reaches, sampled
from worker.engine.kernels.views import Body
from worker.engine.problem.problem import Problem
from worker.engine.reference.reference import Reference
from worker.engine.systems import optional
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.closed_loop.parts import Installed
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.running.catalogue import installed
from worker.running.catalogue.entries import component_entry
from worker.running.runs import reaches, runner
from worker.running.runs.store import MemoryStore

HORIZON = 2.0


class Post(NamedTuple):
    position_x: Annotated[float, Parameter("m", "Centre, x", -1e6, 1e6, name="position.x")]
    position_y: Annotated[float, Parameter("m", "Centre, y", -1e6, 1e6, name="position.y")]
    radius: Annotated[float, Parameter("m", "Radius", 0.0, 100.0)] = 0.4
    arm: Annotated[float, Parameter("m", "Distance of the disc from the centre", 0.0, 100.0)] = 0.0
    growth: Annotated[float, Parameter("m/s", "Growth of the radius", 0.0, 10.0)] = 0.0
    turn: Annotated[float, Parameter("rad/s", "Turn rate", -10.0, 10.0)] = 0.0


class Constants(NamedTuple):
    x: float
    y: float
    radius: float
    arm: float


@kernel
def disc(x: float, y: float, radius: float, q: Any, centre: Any) -> Body:
    d = norm2(q[0] - x, q[1] - y)
    per = 1.0 / (d + 1e-12)
    return Body(centre[0], centre[1], 0.0, 0.0, radius, d - radius, (q[0] - x) * per, (q[1] - y) * per)


@kernel
def derive(p: Post, trim: Any) -> tuple[float, ...]:
    return p.position_x, p.position_y, p.radius, p.arm


@kernel
def offset(t: float, o: Any, q: Any, p: Constants) -> Body:
    return disc(p.x + p.arm, p.y, p.radius, q, (p.x, p.y))


@kernel
def turning(t: float, o: Any, q: Any, p: Post) -> Body:
    s, c = sincos(p.turn * t)
    at = p.position_x, p.position_y
    return disc(at[0] + p.arm * c, at[1] + p.arm * s, p.radius, q, at)


@kernel
def growing(t: float, o: Any, q: Any, p: Post) -> Body:
    at = p.position_x, p.position_y
    return disc(*at, p.radius + p.growth * t, q, at)


@kernel
def late(t: float, o: Any, q: Any, p: Post) -> Body:
    """It grows only after the horizon, when flights are still simulated."""
    at = p.position_x, p.position_y
    return disc(*at, p.radius + (1.0 if t > 1.5 * HORIZON else 0.0), q, at)


@kernel
def in_a_corner(t: float, o: Any, q: Any, p: Post) -> Body:
    """Only where it is thin and has a long arm."""
    at = p.position_x, p.position_y
    return disc(*at, p.radius + (1.0 if p.radius < 0.31 and p.arm > 1.9 else 0.0), q, at)


@kernel
def between(t: float, o: Any, q: Any, p: Post) -> Body:
    """At no corner of the bounds, and not at the nominal values."""
    at = p.position_x, p.position_y
    return disc(*at, p.radius + (1.0 if 1.2 < p.arm < 1.8 else 0.0), q, at)


@kernel
def inflated(t: float, o: Any, q: Any, p: Post) -> Body:
    at = p.position_x, p.position_y
    return disc(*at, o[0], q, at)


@kernel
def wake(p: Post) -> tuple[float]:
    return (p.radius,)


@kernel
def inflate(t: float, o: Any, q: Any, v: Any, p: Post) -> tuple[float]:
    return (p.growth,)


RADIUS, ALL = Reach(("radius",)), Reach(("radius", "arm"), math.sqrt(2.0))
DERIVED = Derived(Constants, derive)
STATES: dict[str, Any] = {"states": 1, "wake": wake, "move": inflate, "body": inflated}
TOO_SMALL: dict[str, tuple[dict[str, Any], dict[str, float], dict[str, Any]]] = {
    "at the values of the campaign": ({"body": offset, "derived": DERIVED}, {"arm": 4.9}, {}),
    "at the end of a bound": ({"body": offset, "derived": DERIVED}, {}, {"arm": {"low": 0.0, "high": 2.0}}),
    "at a corner of the bounds": (
        {"body": in_a_corner}, {}, {"radius": {"low": 0.3, "high": 0.5}, "arm": {"low": 0.0, "high": 2.0}},
    ),
    "within the bounds": ({"body": between}, {"arm": 1.0}, {"arm": {"low": 0.5, "high": 2.0}}),
    "turning": ({"body": turning}, {"arm": 0.7, "turn": 0.3}, {}),
    "after the start": ({"body": growing}, {"growth": 0.1}, {}),
    "after the start, at a bound": ({"body": growing}, {}, {"growth": {"low": 0.0, "high": 0.1}}),
    "after the horizon": ({"body": late}, {}, {}),
    "in a state": (STATES, {"growth": 0.1}, {}),
    "in a state, at a bound": (STATES, {}, {"growth": {"low": 0.0, "high": 0.1}}),
}  # fmt: skip
"""What it is, what the campaign sets, and its bounds, by when its reach is too small."""
LARGE_ENOUGH: dict[str, tuple[dict[str, Any], dict[str, float], dict[str, Any]]] = {
    "alone": ({"body": offset, "derived": DERIVED}, {}, {"radius": {"low": 0.1, "high": 3.0}}),
    "an arm that is declared": (
        {"body": turning, "reach": ALL}, {"arm": 2.0, "turn": 0.3}, {"arm": {"low": 0.0, "high": 3.0}},
    ),
    "a state": (STATES, {}, {}),
    "no reach": ({"body": offset, "derived": DERIVED, "reach": None}, {"arm": 4.9}, {}),
}  # fmt: skip


def asked(values: Mapping[str, float], bounds: Mapping[str, Any]) -> Campaign:
    made = case1(scenario__horizon=HORIZON, scenario__step=0.02)
    made["scenario"]["guidance"] = {"period": 0.02}
    made["scenario"]["vehicle"]["parameters"] = {"J": 0.5}  # stable with that step
    made["stages"]["search"] = [{"method": "direct", "evaluations": 50}]
    at = {"position": {"x": 30.0, "y": -20.0}}
    made["scenario"]["obstacles"].append({"component": "post", "parameters": at | dict(values)})
    number = len(made["scenario"]["obstacles"]) - 1
    made["uncertain"] |= {f"obstacles.{number}.{name}": interval for name, interval in bounds.items()}
    made["criterion"] = {"component": "separation", "threshold": 0.1, "from_centre": True}
    return load_document(made)


@pytest.fixture
def known(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Installed:
    """What is installed, and an obstacle of this file."""
    fields: dict[str, Any] = {"reach": RADIUS, "rate": Rate(("turn",)), **request.param}
    post = Obstacle("post", "Post", 2, Post, **fields)
    described: Any = installed.catalogue()
    listed = described.model_copy(update={"components": [*described.components, component_entry(post, circle)]})
    every = installed.components() | {("obstacle", "post"): post}
    monkeypatch.setattr(installed, "components", lambda: every)
    monkeypatch.setattr(installed, "catalogue", lambda: listed)
    monkeypatch.setitem(installed._HOMES, id(post), (post, __name__))
    return Installed(every, listed)


def problem(campaign: Campaign, known: Installed) -> Problem:
    return Problem(campaign, ClosedLoop(campaign, known, Reference, compiled=False, lanes=1))


def rows(cases: Mapping[str, tuple[Any, Any, Any]]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize(
        ("known", "values", "bounds"), list(cases.values()), ids=list(cases), indirect=["known"]
    )


@rows(TOO_SMALL)
def test_a_run_is_refused_with_what_was_measured(
    known: Installed, values: dict[str, float], bounds: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    campaign = asked(values, bounds)
    monkeypatch.setattr(optional, "warm", lambda system: None)  # in plain Python there is nothing to compile
    with pytest.raises(CampaignUnusable) as raised:
        runner.execute(campaign, MemoryStore(), problem=problem(campaign, known))
    (found,) = raised.value.problems
    assert (found.field, found.given) == ("scenario.obstacles.1", "post")
    assert "extends to" in found.message
    assert "correct `reach`" in found.message


@rows(LARGE_ENOUGH)
def test_a_reach_that_is_large_enough_is_accepted(
    known: Installed, values: dict[str, float], bounds: dict[str, Any]
) -> None:
    campaign = asked(values, bounds)
    reaches.check(campaign, problem(campaign, known))
    assert list(reaches.excesses(campaign)) == []


@rows({name: row for name, row in TOO_SMALL.items() if row[0] is not STATES})
def test_it_is_found_without_a_simulation(known: Installed, values: dict[str, float], bounds: dict[str, Any]) -> None:
    assert [found.field for found in reaches.excesses(asked(values, bounds))] == ["scenario.obstacles.1"]


@kernel
def derive_from_trim(p: Post, trim: Any) -> tuple[float, ...]:
    return p.position_x, p.position_y, p.radius, trim.alpha


def test_constants_from_the_trim_of_the_vehicle_are_known_where_it_is() -> None:
    """In a run, and not by `clearance validate`, which does not solve for it."""

    class Trim(NamedTuple):
        alpha: float

    post = Obstacle("post", "Post", 2, Post, offset, derived=Derived(Constants, derive_from_trim), reach=RADIUS)
    values = dict.fromkeys((p.name for p in declared(Post)), 1.0)
    assert Reaches(post).exceeded(values) is None
    assert Reaches(post, Trim(0.0)).exceeded(values) is None
    found = Reaches(post, Trim(0.2)).exceeded(values)
    assert found is not None
    assert (found.reach, found.extent) == pytest.approx((1.0, 1.2))


SHIPPED = {name: c for (role, name), c in installed.components().items() if role == "obstacle"}


@pytest.mark.parametrize("name", nightly_but(("box", "cylinder", "sphere"), SHIPPED))
def test_shipped_obstacles_extend_no_farther_than_they_declare(name: str) -> None:
    """So that their campaigns need no check: at the corners of moderate values, and of all that they may have."""
    obstacle: Any = SHIPPED[name]
    assert obstacle.reach is not None
    parameters, measured = declared(obstacle.parameters), Reaches(obstacle)
    nominal = {p.name: min(max(3.0, p.low), p.high) if p.default is None else p.default for p in parameters}
    moderate = {p.name: (max(p.low, -7.3), min(p.high, 9.1)) for p in parameters}
    whole = {p.name: (p.low, p.high) for p in parameters}
    times = [] if obstacle.states else [(t, ()) for t in (0.0, 0.7, 3.0, 11.0, 60.0)]
    for bounds in (moderate, whole):
        for values in sampled(nominal, bounds):
            assert measured.exceeded(values, times or [(0.0, ())]) is None


def test_the_corners_of_a_few_bounds_are_all_checked_and_of_many_those_of_every_two() -> None:
    few = dict.fromkeys("abcde", (0.0, 1.0))
    found = [tuple(values.values()) for values in sampled(dict.fromkeys("abcde", 0.5), few)]
    assert set(product((0.0, 1.0), repeat=5)) <= set(found)
    many = {f"p{k}": (0.0, 1.0) for k in range(12)}
    pairs = [values for values in sampled(dict.fromkeys(many, 0.5), many) if list(values.values()).count(0.5) == 10]
    assert len(pairs) == 4 * math.comb(12, 2)
