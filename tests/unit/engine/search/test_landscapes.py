"""Random landscapes of the score board: their minimum, their halves, and that a value depends on its point alone."""

from __future__ import annotations

from dataclasses import fields
from typing import get_args

import numpy as np
import pytest

from tests.given.landscapes import HALVES, KINDS, Half, Landscape, landscape

BOTH: tuple[Half, ...] = get_args(Half)
NUMBERS = range(2 * len(KINDS))


@pytest.fixture(scope="module", params=BOTH)
def made(request: pytest.FixtureRequest) -> list[Landscape]:
    return [landscape(number, request.param) for number in NUMBERS]


def test_the_minimum_is_at_the_stated_point_and_nothing_lower_is_found(made: list[Landscape]) -> None:
    random = np.random.default_rng(1)
    for one in made:
        n, span = one.dimension, abs(one.target - one.minimum)
        assert one(one.minimiser[None, :])[0] == pytest.approx(one.minimum, abs=1e-9 * span)
        assert ((one.minimiser >= 0.0) & (one.minimiser <= 1.0)).all()
        sample = random.random((4000, n))
        best = sample[np.nanargmin(one(sample))]
        for centre in (one.minimiser, best):  # descent by random steps of every size
            for size in np.repeat(10.0 ** -np.arange(0.5, 9.0, 0.5), 2):
                points = np.clip(centre + size * random.standard_normal((40, n)), 0.0, 1.0)
                points = np.concatenate([points, centre[None, :]])
                centre = points[np.nanargmin(one(points))]
            assert one(centre[None, :])[0] >= one.minimum - 1e-9 * span, one.name


def test_the_target_is_above_the_minimum_and_rare(made: list[Landscape]) -> None:
    points = {n: np.random.default_rng(2).random((4000, n)) for n in {one.dimension for one in made}}
    for one in made:
        values = one(points[one.dimension])
        reached = float((values <= one.target).mean())
        assert one.minimum < one.target
        assert reached < 0.03, f"{one.name}: {reached:.3f} of random points reach the target"
        if one.volume is not None:
            assert reached == pytest.approx(one.volume, abs=4 * np.sqrt(one.volume / 4000))
        assert np.isnan(values).any() == (one.kind == "failing regions")
        assert np.isnan(values).mean() < 0.8


def test_a_value_depends_on_its_point_alone(made: list[Landscape]) -> None:
    for one in made:
        points = np.random.default_rng(3).random((16, one.dimension))
        rows = [one(point[None, :])[0] for point in points]
        np.testing.assert_array_equal(one(points), rows)
        np.testing.assert_array_equal(one(points[::-1])[::-1], rows)


def test_a_number_makes_the_same_landscape_again() -> None:
    points = np.full((1, landscape(3, "judging").dimension), 0.3)
    assert landscape(3, "judging")(points) == landscape(3, "judging")(points)
    assert landscape(3, "judging").minimum == landscape(3, "judging").minimum


def test_the_halves_share_neither_seeds_nor_constants() -> None:
    setting, judging = (HALVES[half] for half in BOTH)
    for field in fields(setting):
        ours, others = (np.ravel(getattr(half, field.name)).tolist() for half in (setting, judging))
        assert not set(ours) & set(others), field.name
    for number in NUMBERS:
        one, other = (landscape(number, half) for half in BOTH)
        assert one.kind == other.kind
        assert one.minimum != other.minimum


def test_every_dimension_from_two_to_twenty_parameters_is_met() -> None:
    met = {landscape(number, half).dimension for number in range(100) for half in BOTH}
    assert min(met) == 2
    assert max(met) == 20
    assert len(met) >= 9
