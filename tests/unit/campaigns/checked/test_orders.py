"""Values of one component that do not go together are refused, within bounds as well: crossed limits and bad physics.

Second formulation: the inertia matrix by its eigenvalues; every pair of a lower and an upper limit by its names.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from campaigns import Campaign, check, library, load_file
from campaigns.asked.load import load_document
from campaigns.asked.spec import Part
from campaigns.catalogue import ComponentEntry, OrderEntry
from campaigns.checked import orders
from campaigns.checked.check import simulation_problems
from worker.running.catalogue.installed import catalogue

COMPONENTS = catalogue().components
PART = Part(component="any")


def pairs() -> Iterator[tuple[ComponentEntry, str, str]]:
    """Every lower and upper limit of one quantity, by their names, whose own limits let them cross."""
    for entry in COMPONENTS:
        known = {p.name: p for p in entry.parameters}
        for low in known:
            for word, other in (("min", "max"), ("low", "high"), ("lower", "upper"), ("least", "greatest")):
                high = re.sub(rf"(^|[_.]){word}($|[_.])", rf"\1{other}\2", low)
                if high != low and high in known and known[low].high > known[high].low:
                    yield entry, low, high


def problems(name: str, part: str, uncertain: Any = None, **values: float) -> list[str]:
    """What is refused of a case of the library with other parameters of one part, such as vehicle."""
    document: Any = load_file(library()[name]).document()
    scenario = document["scenario"]
    where = scenario["environment"][0] if part == "environment.0" else scenario[part]
    where["parameters"] |= values
    for path, (low, high) in (uncertain or {}).items():
        document["uncertain"][f"{part}.{path}"] = {"low": low, "high": high}
    document["stages"]["search"] = [{"method": "direct", "evaluations": 10}]
    return [str(p) for p in check(load_document(document), catalogue()) if p.field.endswith(".parameters")]


def test_every_pair_of_limits_that_may_cross_is_declared() -> None:
    found = [(entry.name, low, high) for entry, low, high in pairs()]
    assert {name for name, _, _ in found} == {"autopilot_bank_to_turn", "autopilot_wings_level", "pi_anti_windup"}
    declared = [(e.name, *o.low, *o.high) for e in COMPONENTS for o in e.orders if len(o.low) == len(o.high) == 1]
    assert declared == found


def test_every_order_is_of_parameters_and_holds_at_the_defaults() -> None:
    ordered = [entry for entry in COMPONENTS if entry.orders]
    assert len(ordered) >= 6
    for entry in ordered:
        bounds = {f"x.{p.name}": (p.default, p.default) for p in entry.parameters if p.default is not None}
        assert list(orders.broken([("x", "", entry, PART)], bounds)) == []


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("uav_static", "u_min", "u_max"), ("uav_moving_bank", "u_min", "u_max"), ("pioneer_moving", "u_low", "u_high")],
)
def test_crossed_limits_of_an_autopilot_are_refused(name: str, low: str, high: str) -> None:
    def refused(uncertain: Any = None, **values: float) -> list[str]:
        return problems(name, "controller", uncertain, **values)

    assert refused(**{low: 1.5, high: 1.5}) == []
    assert refused({high: (1.5, 2.0)}, **{low: 1.5, high: 1.6}) == []
    sentence = f"scenario.controller.parameters: {low} <= {high} must hold for all values: lower {low} or raise {high}"
    assert refused(**{low: 1.6, high: 1.5}) == [f"{sentence} (given: {low} 1.6, {high} 1.5)"]
    corner = refused({high: (1.4, 2.0)}, **{low: 1.5, high: 1.6})
    assert corner == [f"{sentence} (given: {low} 1.5, {high} 1.4 to 2)"]


def test_inertia_that_no_body_has_is_refused() -> None:
    random = np.random.default_rng(3)
    for _ in range(40):
        x, z = random.uniform(0.05, 0.2, 2)
        xz = random.uniform(-0.2, 0.2)
        least = np.linalg.eigvalsh([[x, -xz], [-xz, z]])[0]
        found = problems("uav_static", "vehicle", I_xx=float(x), I_zz=float(z), I_xz=float(xz))
        assert [text.partition(" must")[0] for text in found] == (
            [] if least > 0.0 else ["scenario.vehicle.parameters: I_xz² < I_xx I_zz"]
        )
    singular = {"I_xx": 0.25, "I_zz": 1.0, "I_xz": 0.5}
    assert problems("uav_static", "vehicle", **singular)
    for bounds, refused in (((-0.13, 0.1), True), ((-0.1, 0.13), True), ((-0.1, 0.1), False)):
        assert bool(problems("uav_static", "vehicle", {"I_xz": bounds})) == refused
    assert problems("uav_static", "vehicle", {"I_zz": (0.1, 0.2)}, I_xz=0.1)


def test_noise_that_is_held_too_long_for_its_gusts_is_refused() -> None:
    def refused(uncertain: Any = None, **values: float) -> bool:
        return bool(problems("uav_moving_gusts", "environment.0", uncertain, **values))

    assert not refused(V=18.0, h=18.0, period=0.1)
    assert refused(V=18.0, h=17.9, period=0.1)
    assert refused(V=18.0, h=50.0, period=0.3)
    assert refused({"V": (10.0, 51.0)}, V=18.0, h=50.0, period=0.1)
    assert not refused({"V": (10.0, 49.0)}, V=18.0, h=50.0, period=0.1)


def test_ground_that_is_steeper_than_a_wall_is_refused() -> None:
    entry = next(c for c in COMPONENTS if c.name == "ground_slope")
    random = np.random.default_rng(4)
    for x, y in random.uniform(-1.0, 1.0, (200, 2)):
        found = list(orders.broken([("s", "s", entry, PART)], {"s.x": (x, x), "s.y": (y, y)}))
        assert found or np.hypot(x, y) <= 1.0
        assert not found or max(abs(x), abs(y)) > np.sqrt(0.5)


def test_a_stored_run_with_such_values_can_still_be_simulated() -> None:
    document: Any = load_file(library()["uav_static"]).document()
    document["scenario"]["controller"]["parameters"] |= {"u_min": 21.0, "u_max": 20.0}
    stored: Campaign = load_document(document)
    assert check(stored, catalogue())
    assert simulation_problems(stored, catalogue()) == []


@pytest.mark.parametrize(
    ("order", "text"),
    [
        (OrderEntry(low=["u_min"], high=["u_max"], text=""), "u_min <= u_max"),
        (OrderEntry(low=["a", "b"], high=["c"], text="", times=0.1, equal=False), "a b < 0.1 c"),
        (OrderEntry(low=["x", "x"], high=[], text="", times=0.5), "x² <= 0.5"),
        (OrderEntry(low=["x"], high=[], text=""), "x <= 1"),
        (OrderEntry(low=[], high=["c"], text="", times=100.0), "1 <= 100 c"),
    ],
)
def test_an_order_is_written_as_an_inequality(order: OrderEntry, text: str) -> None:
    assert str(order) == text
