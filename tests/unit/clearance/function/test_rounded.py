"""Functions that return rounded values: a margin below the step of their values clears nothing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import clearance
from campaigns.codes import CheckCode
from campaigns.rules import RULES
from tests.audited import audited
from tests.given.at_night import nightly_but
from tests.given.corrupted_records import Folder
from tests.given.forgeries import accepted
from worker.engine.stages.parts.grid import grid
from worker.engine.systems.base import Floats
from worker.evidence.audit.grids import step

RANDOM = np.random.default_rng(1).random(3000)
VALUES: dict[str, tuple[Floats, float]] = {
    "not rounded": (RANDOM, 0.0),
    "one decimal": (np.round(10 * RANDOM) / 10, 0.1),
    "one decimal, cut": (np.floor(10 * RANDOM) * 0.1, 0.1),
    "one decimal, less a radius": (np.round(10 * RANDOM) / 10 - 0.337, 0.1),
    "fortieths": (np.round(40 * RANDOM) / 40, 0.025),
    "whole numbers": (np.round(50 * RANDOM), 1.0),
    "single precision": (np.maximum(0.3, RANDOM).astype(np.float32).astype(np.float64), 2.0**-25),
    "large, one decimal": (np.round(1e6 * RANDOM, 1), 0.1),
    "large": (1e9 * RANDOM, 0.0),
    "yes or no": (np.round(RANDOM), 1.0),
    "whole metres from 2 to 4": (2.0 + np.round(2.0 * RANDOM), 1.0),
    "four that are not rounded": (RANDOM[:4], 0.0),
    "three, each a few times": (np.round(2.0 * RANDOM[:50]), 0.0),
    "one that is met once": (np.append(np.full(59, 100.0), 0.3), 0.0),
    "two that differ by rounding": (np.append(np.ones(50), np.full(50, 1.0 + 2.0**-52)), 0.0),
    "levels": (np.array([0.3, 0.7, 1.7])[np.round(2.0 * RANDOM).astype(int)], 0.4),
    "whole pixels": (20.7 / np.round(20.7 / (1.98 + 3.0 * RANDOM)), 20.7 / 9 - 20.7 / 10),
    "decibels of whole counts": (10.0 * np.log10(1.0 + np.floor(12.0 * RANDOM)), 10.0 * np.log10(2.0)),
    "sides of whole metres": (np.hypot(np.round(9.0 * RANDOM), np.round(9.0 * RANDOM[::-1])), 1.0),
    "written pixels": (np.round(20.7 / np.round(20.7 / (1.98 + 3.0 * RANDOM)), 2), 0.23),
    "one decimal beyond a jump": (np.where(RANDOM < 0.1, 0.7, np.round(1.0 + RANDOM, 1)), 0.1),
    "a plateau": (np.maximum(0.5, 3.0 * RANDOM), 0.0),
    "two plateaus": (np.where(RANDOM < 0.1, 0.3, np.maximum(0.5, 3.0 * RANDOM)), 0.0),
    "the corner again and again": (np.append(RANDOM + 1.0, np.ones(900)), 0.0),
    "a few points again and again": (np.append(RANDOM + 1.0, np.repeat(1.0 + RANDOM.min() * RANDOM[:4], 90)), 0.0),
    "decibels, each a few times": (10.0 * np.log10(1.0 + np.floor(12.0 * RANDOM[:60])), 0.0),
    "tenths of a foot": (np.round(30 * RANDOM, 1) * 0.3048, 0.03048),
    "tenths of a kilometre per hour": (np.round(100 * RANDOM, 1) / 3.6, 0.1 / 3.6),
    "thirds": (np.round(30 * RANDOM) / 3, 1 / 3),
    "bins of 0.15": (np.round(5 * RANDOM / 0.15) * 0.15, 0.15),
    "six that are not rounded": (RANDOM[:6], 0.0),
    "one value": (np.full(9, 0.4), 0.0),
    "the lowest of many is not rounded": (np.where(RANDOM.min() + 1e-9 > RANDOM, RANDOM, np.round(RANDOM, 1)), 0.0),
    "the highest of few is not rounded": (np.minimum(np.round(20 * RANDOM) / 10, 1.987), 0.1),
    "significant digits": (-np.array([float(f"{x:.3g}") for x in 20 * RANDOM]), 0.1),
    "a margin of six digits": (1200.0 - np.array([float(f"{x:.6g}") for x in 1100 * RANDOM]), 0.01),
}
WAYS: dict[str, Callable[[Floats], Floats]] = {
    "rounded": lambda d: np.round(10 * d) / 10,
    "rounded up": lambda d: np.ceil(10 * d) / 10,
    "of a foot": lambda d: np.round(10 * d / 0.3048) * 0.03048,
    "written": lambda d: np.array([float(f"{x:.1f}") for x in d]),
    "of whole pixels": lambda d: 8.97 / np.round(8.97 / d),
    "to quarters": lambda d: np.round(4 * d) / 4,
    "single": lambda d: np.maximum(d, 0.3).astype(np.float32),
}
[RULE] = [one for one in RULES if one.code == CheckCode.RESOLUTION]
THRESHOLDS = dict.fromkeys(WAYS, 0.88) | {"of a foot": 0.84, "to quarters": 0.7, "single": 0.3}


def distance(x: Floats, y: Floats) -> Floats:
    return 0.86 + 0.9 * ((x - 0.37) ** 2 + (y - 0.37) ** 2)


def searched(way: Callable[[Floats], Floats], threshold: float, lower: float = 0.0) -> clearance.Result:
    def rounded(x: Floats, y: Floats) -> Floats:
        return way(distance(x, y) - lower)

    bounds, nominal = {"x": (0.0, 1.0), "y": (0.0, 1.0)}, {"x": 0.9, "y": 0.9}
    return clearance.search(
        rounded, bounds, threshold, vectorized=True, budget=500, validation=4000, certify=100, seed=1, nominal=nominal
    )


@pytest.mark.parametrize("name", VALUES)
def test_the_step_of_values_is_found_twice(name: str) -> None:
    values, expected = VALUES[name]
    assert grid(values) == step(values, any_step=True) == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("name", nightly_but(("rounded", "of whole pixels", "to quarters", "single"), WAYS))
def test_a_margin_below_the_step_of_the_values_is_not_cleared(name: str, tmp_path: Path) -> None:
    found = searched(WAYS[name], THRESHOLDS[name], 0.57 if name == "single" else 0.0)
    assert [c.title for c in found.verdict.checks if c.standing == "fails"] == [RULE.title]
    found.save(tmp_path / "out")
    audited(tmp_path / "out")
    folder = Folder(tmp_path / "out")
    folder.result["checks"] = [check for check in folder.result["checks"] if check["name"] != "resolution"]
    folder.result["verdict"] = "cleared"
    assert not accepted(folder)


@pytest.mark.parametrize(("way", "threshold"), [(WAYS["rounded"], 0.8), (lambda d: d, 0.85)])
def test_a_margin_of_a_step_or_values_without_one_are_cleared(
    way: Callable[[Floats], Floats], threshold: float, tmp_path: Path
) -> None:
    found = searched(way, threshold)
    assert found.verdict == "cleared"
    found.save(tmp_path / "out")
    audited(tmp_path / "out")
