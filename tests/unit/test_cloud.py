"""A run's parameter space: positions of evaluations, picking by a click, texts on a repeated evaluation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from backend.scenes.cloud import words as cloud_words
from backend.scenes.cloud.evaluations import NO_VALUE, Axis, Cloud, Evaluation, met, place, places

MASS = Axis("vehicle.m", "kg", 4.0, 6.0, "vehicle.m")
VALUE = Axis("d_min", "m", 0.5, 1.5)


def one(mass: float, cost: float | None, status: str = "ok") -> Evaluation:
    return Evaluation("2 · search · direct", 7, status, cost, {"vehicle.m": mass})


class Limits:
    """As much of a setting as the words need."""

    quantity, unit, threshold, decimals = "d_min", "m", 1.0, 3
    clears = True


def test_positions_are_fractions_of_the_ranges() -> None:
    cloud = Cloud([one(4.0, 0.5), one(5.5, 1.5), one(6.0, None, "failed")], {}, 3, 1, 0)
    assert places(cloud, [MASS, None, VALUE]).tolist() == [
        [0.0, 0.5, 0.0],
        [0.75, 0.5, 1.0],
        [1.0, 0.5, NO_VALUE],
    ]
    assert MASS.title == "vehicle.m [kg]"
    assert place([VALUE, VALUE, MASS], {}, 1.0) == [0.5, 0.5, NO_VALUE]
    flat = Axis("d_min", "m", 0.9, 0.9)
    assert place([flat, None, None], {}, 0.9) == [0.5, 0.5, 0.5]
    assert place([flat, None, None], {}, None)[0] == NO_VALUE
    assert places(Cloud([], {}, 0, 0, 0), [MASS, None, VALUE]).shape == (0, 3)


def test_the_range_is_of_what_has_a_value() -> None:
    assert Cloud([one(4.0, None, "failed")], {"nominal": ({}, None)}, 1, 1, 0).range is None
    assert Cloud([one(4.0, 1.2)], {"F1": ({}, 0.3)}, 1, 0, 0).range == (0.3, 1.2)


def test_a_click_meets_the_point_nearest_on_the_screen() -> None:
    points = np.array([[0.0, 0.0, 10.0], [0.5, 0.0, 10.0], [0.0, 0.0, 20.0], [0.0, 0.0, -5.0]])
    eye = (0.0, 0.0, 0.0)
    assert met(points, eye, (0.0, 0.0, 1.0)) == 0, (
        "the one behind it is hidden by it, and one behind the eye is not met"
    )
    assert met(points, eye, (0.05, 0.0, 1.0)) == 1
    assert met(points, eye, (0.0, 0.004, 1.0)) == 0
    assert met(points, eye, (0.0, 0.5, 1.0)) is None
    assert met(points, (0.0, 0.0, 30.0), (0.0, 0.0, -2.0)) == 2
    assert met(np.empty((0, 3)), eye, (0.0, 0.0, 1.0)) is None


@pytest.mark.parametrize(
    ("stored", "answer", "said"),
    [
        (one(5.0, 0.75), {"cost": 0.75, "status": "ok", "reason": ""}, "Bit-identical."),
        (one(5.0, 0.75), {"cost": 0.7500000000000001, "status": "ok", "reason": ""}, "differ by 1.11e-16"),
        (one(5.0, 0.75), {"cost": None, "status": "failed", "reason": "it fell"}, "Not identical. it fell"),
        (
            one(5.0, None, "failed"),
            {"cost": None, "status": "failed", "reason": "it fell"},
            "Identical: failed. it fell",
        ),
        (one(5.0, None, "failed"), {"cost": 0.7, "status": "ok", "reason": ""}, "Not identical."),
    ],
)
def test_stored_and_repeated_values_are_shown_side_by_side(
    stored: Evaluation, answer: dict[str, Any], said: str
) -> None:
    words = cloud_words.outcome(stored, answer, Limits())  # type: ignore[arg-type]
    assert said in words
    assert "Stage 2 · search · direct, evaluation 7 (from 0)" in words
    for value in (stored.cost, answer["cost"]):
        assert value is None or repr(value) in words


def test_the_legend_counts_everything() -> None:
    drawn = [one(4.0, 0.5), one(4.5, 1.0), one(5.0, 2.5), one(5.0, None, "failed"), one(5.0, None, "timeout")]
    words = cloud_words.legend(Cloud(drawn, {}, 20, 4, 3), Limits(), dark=False)  # type: ignore[arg-type]
    for text in ("5 of 20 evaluations", "failed: 2 of 4.", "excluded: 0 of 3.", "1 m: 2 of those drawn", "left:25.00%"):
        assert text in words
    assert "0.500" in words
    assert "2.500 m" in words
    none = cloud_words.legend(Cloud([], {}, 0, 0, 0), Limits(), dark=False)  # type: ignore[arg-type]
    assert "No evaluation has a value yet." in none
    high = cloud_words.legend(Cloud([one(4.0, 0.2)], {}, 1, 0, 0), Limits(), dark=True)  # type: ignore[arg-type]
    assert "criterion 1 m: not below any of them" in high
