"""What is computed of the places of a path is, to the bit, what numpy computes of all of them at once."""

from __future__ import annotations

import numpy as np
import pytest

from worker.engine.systems.base import Floats
from worker.engine.systems.closed_loop import samples

NOWHERE = np.nan


def _places(count: int) -> Floats:
    """A random walk with some places at rest, and a corner."""
    random = np.random.default_rng(count)
    moved = random.normal(size=(count, 3)) * (random.uniform(size=(count, 1)) > 0.3)
    moved[count // 2 :] *= -3.0
    return np.ascontiguousarray(np.cumsum(moved, axis=0))


@pytest.mark.parametrize("count", [3, 4, 65, 5000])
def test_they_are_those_of_numpy(count: int) -> None:
    places, times = _places(count), np.linspace(0.0, 7.0, count)
    position, velocity = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.0, -1.1])
    seen = places - position - np.minimum(times, 4.0)[:, None] * velocity
    assert np.array_equal(samples.relative(places, times, position, velocity, 4.0), seen)
    assert np.array_equal(samples.ends(places), [places.min(axis=0), places.max(axis=0)])
    assert np.array_equal(samples.lengths(places), np.linalg.norm(places, axis=1))
    bent = np.linalg.norm(np.diff(seen, n=2, axis=0), axis=1)
    bent = np.concatenate([2.0 * bent[:1], bent, 2.0 * bent[-1:]])
    assert np.array_equal(samples.bends(seen), bent)
    begin, along = seen[:-1], np.diff(seen, axis=0)
    square = (along**2).sum(axis=1)
    at = np.clip(-(begin * along).sum(axis=1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    low = np.linalg.norm(begin + at[:, None] * along, axis=1) - 0.5 * np.maximum(bent[:-1], bent[1:])
    assert np.array_equal(samples.nearest(seen), low)


def test_no_chord_is_nearer_than_the_least_distance() -> None:
    places = _places(300)
    fine = np.concatenate([places[:-1] + share * np.diff(places, axis=0) for share in np.linspace(0.0, 1.0, 101)])
    true = np.linalg.norm(fine, axis=1).reshape(101, -1).min(axis=0)
    bent = samples.bends(places)
    chords = samples.nearest(places) + 0.5 * np.maximum(bent[:-1], bent[1:])
    assert (chords <= true + 1e-12).all()
    assert chords == pytest.approx(true, abs=1e-2)


def test_a_coordinate_that_is_no_number_stays_one() -> None:
    places = _places(9)
    places[4, 1] = NOWHERE
    assert np.array_equal(samples.ends(places), [places.min(axis=0), places.max(axis=0)], equal_nan=True)
    assert np.isnan(samples.nearest(places)).any()


@pytest.mark.parametrize("values", [[], [2.0], [3.0, 1.0, 2.0], [1.0, 0.0, 1.0, 0.0, 1.0], [5.0, NOWHERE, 4.0, 6.0]])
def test_the_smallest_are_in_order_and_of_equal_ones_the_first(values: list[float]) -> None:
    found, at = samples.least(np.array(values), 3)
    order = sorted((value, k) for k, value in enumerate(values) if value == value)[:3]
    assert [*zip(found, at, strict=True)][: len(order)] == order
    assert np.isnan(found[len(order) :]).all()


def test_the_smallest_of_many() -> None:
    values = np.random.default_rng(1).integers(0, 50, 2000).astype(float)
    found, at = samples.least(values, 17)
    assert np.array_equal(at, np.argsort(values, kind="stable")[:17])
    assert np.array_equal(found, values[at])
