"""An obstacle that moves is known to move, whatever it declares, and without a rate nothing is known of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from campaigns.checked.turning import unfollowed
from campaigns.claims.spans import words
from tests.given.case_campaigns import campaign
from worker.engine.components.obstacles import circle, cooperative_circle
from worker.engine.kernels.component import Obstacle
from worker.engine.kernels.maths import kernel
from worker.running.catalogue.entries import component_entry
from worker.running.catalogue.installed import catalogue


@kernel
def shaken(t: float, o: tuple[()], q: tuple[float, float], p: circle.Circle) -> Any:
    x = p.position_x + 0.1 * (t - t // 1.0)
    return circle.body(0.0, o, q, p._replace(position_x=x))


@kernel
def handed_on(t: float, o: tuple[()], q: tuple[float, float], p: circle.Circle) -> Any:
    return circle.body(t, o, q, p)


@kernel
def by_another_name(now: float, o: tuple[()], q: tuple[float, float], p: circle.Circle) -> Any:
    later = [now for _ in range(1)]
    return circle.body(later[0], o, q, p)


@kernel
def without_names(*arguments: Any) -> Any:
    return shaken(*arguments)


def made(**changes: Any) -> Obstacle:
    return replace(circle.component, **changes)


@pytest.mark.parametrize("body", [shaken, handed_on, by_another_name, without_names])
def test_a_body_that_reads_the_time_moves(body: Callable[..., Any]) -> None:
    found = component_entry(made(body=body), circle)
    assert found.moving
    assert found.rate is None
    assert not component_entry(circle.component, circle).moving


def test_one_with_states_moves_and_its_rate_is_unknown_if_it_declares_none() -> None:
    own = replace(cooperative_circle.component, moving=False, rate=None)
    found = component_entry(own, cooperative_circle)
    assert found.moving
    assert found.rate is None
    assert component_entry(cooperative_circle.component, cooperative_circle).rate is not None


def test_an_undeclared_motion_bars_cleared() -> None:
    known, entry = catalogue(), component_entry(made(body=shaken), circle)
    changed = known.model_copy(update={"components": [entry if c.name == "circle" else c for c in known.components]})
    assert "obstacle 1 (Circle)" in words(unfollowed(campaign(), changed))
    assert not unfollowed(campaign(), known)
