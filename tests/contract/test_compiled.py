"""Every component compiled: robust within its limits, and equal to plain Python.

Several share a closed loop, so that fewer are compiled; avoiders that are in none have their own, by night.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns import check
from campaigns.asked.load import load_document
from campaigns.results.base import OK
from clearance.testing.flights import as_in_plain_python, in_any_order, no_number_shows, unbreakable
from clearance.testing.scenes import own, problem, scene
from tests.contract.hands import published, together
from worker.engine.kernels.component import Component
from worker.running.catalogue.installed import catalogue, components

Components = tuple[Component, ...]

SCENES = together()


def name(component: Component) -> str:
    return f"{component.role}-{component.name}"


def number(k: int, component: Component) -> str:
    """The tests of one scene stay on one core, others take the other scenes; tests/conftest.py reads the number."""
    return f"{k}-{name(component)}"


BY_DAY = (0, len(SCENES) - 1)
"""Scenes whose loop is compiled by day: one in the plane, one in space."""


def marks(k: int, component: Component | None = None) -> Any:
    """By day some loops; where a component is given, with the parameters of their avoider alone."""
    return () if k in BY_DAY and component in (None, SCENES[k][0]) else pytest.mark.nightly


EACH_SCENE = pytest.mark.parametrize(
    "among",
    [pytest.param(s, id=number(k, s[0]), marks=marks(k)) for k, s in enumerate(SCENES)],
)

FIRST = {name(c): k for k, s in reversed(list(enumerate(SCENES))) for c in s}
"""The first scene that a component is in: a vehicle is in several."""

ONCE = [(k, s, c) for k, s in enumerate(SCENES) for c in s if FIRST[name(c)] == k]
"""Every component once, with the number and the others of its scene."""

EACH = pytest.mark.parametrize(
    ("among", "component"), [pytest.param(s, c, id=number(k, c), marks=marks(k)) for k, s, c in ONCE]
)
ONE_OF_EACH_LOOP = pytest.mark.parametrize(
    ("among", "component"),
    [pytest.param(s, c, id=number(k, c), marks=marks(k, c)) for k, s, c in ONCE],
)

ALONE = pytest.mark.parametrize("component", [c for c in components().values() if name(c) not in FIRST], ids=name)


def test_every_component_is_in_a_scene() -> None:
    elsewhere = {f"avoider-{avoider}" for avoider in published()}
    assert {name(c) for s in SCENES for c in s} | elsewhere == set(map(name, components().values()))


@EACH_SCENE
def test_they_can_be_simulated_together(among: Components) -> None:
    assert check(load_document(scene(*among).document), catalogue()) == []
    batch, reasons = problem(*among).evaluate(np.array([[0.0], [0.5], [1.0]]))
    assert batch.status.tolist() == [OK] * 3, reasons


@ONE_OF_EACH_LOOP  # by day more components in plain Python: tests/contract/test_components.py
def test_within_its_limits_nothing_crashes_and_nothing_is_hidden(among: Components, component: Component) -> None:
    unbreakable(problem(*among), own(component, among), 384)
    in_any_order(problem(*among), own(component, among), 96)


@EACH
def test_a_nan_fails_the_simulation_or_changes_nothing(among: Components, component: Component) -> None:
    no_number_shows(problem(*among), own(component, among))


@ONE_OF_EACH_LOOP
def test_it_agrees_with_plain_python(among: Components, component: Component) -> None:
    as_in_plain_python(problem(*among), problem(*among, compiled=False), own(component, among), 3)


@pytest.mark.nightly
@ALONE
def test_alone_it_never_crashes_and_agrees_with_plain_python(component: Component) -> None:
    batch, reasons = problem(component).evaluate(np.array([[0.0], [0.5], [1.0]]))
    assert batch.status.tolist() == [OK] * 3, reasons
    unbreakable(problem(component), own(component), 384)
    in_any_order(problem(component), own(component), 96)
    no_number_shows(problem(component), own(component))
    as_in_plain_python(problem(component), problem(component, compiled=False), own(component), 16)
