"""Slices through a worst case, and the distance to the boundary of a violation, on a known formula."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
import pytest

from campaigns.asked.allowance import RAY, SLICE
from campaigns.claims.spans import words
from campaigns.claims.stages.surroundings import BETWEEN, NOMINAL_BEYOND
from campaigns.results.base import EXCLUDED, FAILED, OK
from campaigns.results.finding import Boundary
from tests.given.case_campaigns import campaign, case1
from tests.given.sampled_stages import THRESHOLD, context, evaluate
from tests.given.stated_facts import facts
from worker.engine.search.base import Batch, Floats
from worker.engine.stages.parts import boundary
from worker.engine.stages.parts.base import drive
from worker.engine.stages.parts.context import Asking
from worker.engine.stages.parts.rays import Evaluated
from worker.engine.stages.parts.slices import slices

Result = TypeVar("Told")

WORST = np.array([0.0, 0.0])
"""Of d = threshold - 0.2 + u + v; nominal is (0.5, 0.5)."""

MOST = 2 * SLICE + 1 + RAY * (2 * 2 + 1)
"""Evaluations around a violation of two parameters."""


def located(
    worst: Floats, flown: Any = None, before: Sequence[Evaluated] = (), after: Sequence[Evaluated] = ()
) -> tuple[Boundary, int]:
    """The boundary by the driver with what is stored before and after, and its number of evaluations."""
    found, evaluations = driven(boundary.boundary(case1(), worst, before), flown)
    return found.described(case1(), after), evaluations


def driven(asking: Asking[Result], flown: Any = None) -> tuple[Result, int]:
    """The result of a request with the driver, and its number of evaluations."""
    result: list[Result] = []

    def search() -> Asking[str]:
        result.append((yield from asking))
        return "asked"

    done = drive(context(campaign(), flown or evaluate()), 0, search(), 10**6)
    return result[0], done.tally.evaluations


def steep(u: Floats) -> Floats:
    """Below the threshold where u < 0.2 or v > 0.9."""
    return np.asarray(THRESHOLD + np.minimum(u[:, 0] - 0.2, 0.9 - u[:, 1]))


def near(value: float) -> Any:
    """Within the tolerance of a boundary."""
    return pytest.approx(value, abs=1e-4)


def flown(function: Any, status: Any = None) -> Any:
    def evaluated(points: Floats) -> tuple[Batch, dict[int, str]]:
        codes = np.full(len(points), OK, dtype=np.uint8) if status is None else status(points).astype(np.uint8)
        return Batch(np.where(codes == OK, function(points), np.nan)[:, None], codes), {}

    return evaluated


def test_slices_pass_through_the_worst_case() -> None:
    point = np.array([0.123, 1.0])
    result, evaluations = driven(slices(case1(), point, 5))
    mass, inertia = result.curves
    assert evaluations == 6 + 5  # the second coordinate is on the grid already
    assert mass.values == pytest.approx([4.0, 4.246, 4.5, 5.0, 5.5, 6.0])
    assert mass.costs == pytest.approx([THRESHOLD - 0.2 + 1 + u for u in (0, 0.123, 0.25, 0.5, 0.75, 1)])
    assert inertia.values == pytest.approx([0.04, 0.045, 0.05, 0.055, 0.06])
    assert result.at == {"vehicle.m": pytest.approx(4.246), "vehicle.J": 0.06}
    assert mass.status == ["ok"] * 6


def test_distances_to_the_boundary() -> None:
    result, evaluations = located(np.array([0.1, 0.5]), flown(steep))
    rays = {(ray.path, ray.towards): ray for ray in result.rays}
    low, high = rays["vehicle.m", "low"], rays["vehicle.J", "high"]
    assert low.share == pytest.approx(0.3, abs=1e-5)
    assert low.value == pytest.approx(4.4, abs=2e-5)
    assert low.distance == pytest.approx(0.6, abs=2e-5)
    assert high.share == pytest.approx(0.4, abs=1e-5)
    assert high.value == pytest.approx(0.058, abs=2e-7)
    for ray in (low, high):
        assert ray.kind == "violation"
        assert ray.cost is not None
        assert ray.cost <= THRESHOLD
    for ray in (rays["vehicle.m", "high"], rays["vehicle.J", "low"]):
        assert (ray.share, ray.distance, ray.kind) == (None, None, None)
    assert result.line is not None
    assert result.line.way == pytest.approx(0.75, abs=1e-4)
    assert result.line.parameters is not None
    assert result.line.parameters["vehicle.m"] == pytest.approx(4.4, abs=1e-4)
    assert facts(result.statement) == ["vehicle.m", pytest.approx(4.4, abs=1e-4), 0.3, 0.75, boundary.SAMPLES]
    assert evaluations <= MOST


def test_a_violation_that_no_parameter_reaches_alone() -> None:
    result, _ = located(WORST)
    assert all(ray.share is None for ray in result.rays)
    assert result.line is not None
    assert result.line.way == pytest.approx(0.8, abs=1e-4)
    assert facts(result.statement) == [0.8, boundary.SAMPLES]


def test_a_failed_flight_ends_a_ray_and_an_excluded_one_does_not() -> None:
    def status(u: Floats) -> Floats:
        return np.where(u[:, 0] > 0.8, FAILED, np.where((u[:, 0] < 0.4) & (u[:, 0] > 0.3), EXCLUDED, OK))

    result, _ = located(WORST, flown(steep, status))
    rays = {(ray.path, ray.towards): ray for ray in result.rays}
    assert rays["vehicle.m", "high"].kind == "failure"
    assert rays["vehicle.m", "high"].share == pytest.approx(0.3, abs=1e-5)
    assert rays["vehicle.m", "high"].cost is None
    assert rays["vehicle.m", "low"].share == pytest.approx(0.3, abs=1e-5)
    assert facts(result.statement) == ["vehicle.m", near(4.4), 0.3, 0.6, boundary.SAMPLES, "vehicle.m", near(5.6), 0.3]


@pytest.mark.parametrize(
    ("everywhere", "violated", "crossed", "stated"),
    [
        (True, 0.2, 0.6, ["vehicle.m", near(4.4), 0.3, 0.6, boundary.SAMPLES, "vehicle.m", 4.75, 0.125]),
        (False, 0.2, 0.6, ["vehicle.m", near(4.4), 0.3, 0.6, boundary.SAMPLES, 0.25]),
        (True, -1.0, None, [boundary.SAMPLES, "vehicle.m", near(4.78), 0.11]),
    ],
    ids=["along a parameter", "on the line alone", "without a violation"],
)
def test_failures_before_a_violation_are_not_its_boundary(
    everywhere: bool, violated: float, crossed: float | None, stated: list[Any]
) -> None:
    """Evaluations fail in a slab, through which every ray to the violation goes, or the line alone."""

    def status(u: Floats) -> Floats:
        return np.where((u[:, 0] < 0.39) & (u[:, 0] > 0.31) & (everywhere | (u[:, 1] < 0.45)), FAILED, OK)

    result, evaluations = located(WORST, flown(lambda u: THRESHOLD + u[:, 0] - violated, status))
    low, line = next(ray for ray in result.rays if (ray.path, ray.towards) == ("vehicle.m", "low")), result.line
    assert line is not None
    for ray in (low, line):
        assert ray.kind == ("failure" if crossed is None else "violation")
        assert (ray.cost is None) is (crossed is None)
    assert line.way == pytest.approx(crossed or 0.22, abs=1e-4)
    assert facts(result.statement) == stated
    assert evaluations <= MOST


def test_a_violation_between_the_samples_of_a_ray_that_fails_is_its_boundary() -> None:
    def status(u: Floats) -> Floats:
        return np.where(u[:, 0] < 0.376, FAILED, OK)

    result, _ = located(np.array([0.3, 0.5]), flown(lambda u: THRESHOLD + u[:, 0] - 0.39, status))
    low = next(ray for ray in result.rays if (ray.path, ray.towards) == ("vehicle.m", "low"))
    assert (low.kind, low.share) == ("violation", near(0.11))
    assert low.cost is not None
    assert low.cost <= THRESHOLD


def test_a_nominal_flight_that_violates_has_no_distance() -> None:
    result, evaluations = located(WORST, flown(lambda u: np.zeros(len(u))))
    assert (result.rays, result.line) == ([], None)
    assert result.statement == NOMINAL_BEYOND
    assert evaluations == 1 + 5 * boundary.SAMPLES


def window(u: Floats) -> Floats:
    """Violates where 0.2 < u < 0.204, which no step meets, and where u < 0.07."""
    return np.asarray(THRESHOLD + np.where((np.abs(u[:, 0] - 0.202) < 0.002) | (u[:, 0] < 0.07), -0.1, 0.1))


def seen(*points: tuple[float, float], failed: bool = False) -> Evaluated:
    """Evaluations of the window that another stage has stored."""
    at = np.array(points)
    return Evaluated(at, np.full(len(at), np.nan) if failed else window(at), np.full(len(at), failed))


ALONE = seen((0.203, 0.5), (0.9, 0.9), (0.21, 0.5))
NEAREST = {
    "no step meets it": ((), (), 0.43),
    "stored before": ([ALONE], (), 0.296),
    "stored after the bisection": ((), [ALONE], 0.297),
    "beside the ray": ([seen((0.203, 0.5 + 1e-6))], [seen((0.203, 0.5 - 1e-9))], 0.43),
    "farther than the steps": ([seen((0.01, 0.5))], (), 0.43),
    "a failure is no violation": ([seen((0.3, 0.5), failed=True)], (), 0.43),
}
"""Stored before and after the bisection, and the fraction of the range to the nearest violation."""


@pytest.mark.parametrize("worst", [(0.0, 0.5), (0.0, 0.0)], ids=["along a parameter", "elsewhere"])
@pytest.mark.parametrize("name", NEAREST)
def test_no_stored_violation_on_a_ray_is_nearer_than_the_stated_one(name: str, worst: tuple[float, float]) -> None:
    before, after, share = NEAREST[name]
    result, evaluations = located(np.array(worst), flown(window), before, after)
    low = next(ray for ray in result.rays if (ray.path, ray.towards) == ("vehicle.m", "low"))
    assert (low.kind, low.share) == ("violation", near(share))
    assert low.parameters is not None
    assert (low.parameters["vehicle.m"], low.parameters["vehicle.J"]) == (near(4 + 2 * (0.5 - share)), 0.05)
    assert facts(result.statement)[:3] == ["vehicle.m", near(4 + 2 * (0.5 - share)), near(share)]
    if worst[1] == 0.5:
        assert result.line is not None
        assert result.line.way == near(2 * share)
    assert evaluations <= MOST


def test_a_stored_violation_on_a_slanted_line_to_the_finding_counts() -> None:
    result, _ = located(WORST, flown(window), [seen((0.203, 0.203))])
    assert result.line is not None
    assert result.line.way == near(2 * 0.296)


def test_the_nearest_failure_may_be_a_stored_one() -> None:
    result, _ = located(WORST, flown(lambda u: np.full(len(u), THRESHOLD + 1.0)), [seen((0.33, 0.5), failed=True)])
    low = next(ray for ray in result.rays if (ray.path, ray.towards) == ("vehicle.m", "low"))
    assert (low.kind, low.cost, low.share) == ("failure", None, pytest.approx(0.17, abs=2e-5))


@pytest.mark.parametrize("stored", [(), [ALONE]])
def test_a_sentence_on_the_nearest_violation_states_what_was_examined(stored: Sequence[Evaluated]) -> None:
    """Also where nothing violates when one parameter alone is varied."""
    clear = flown(lambda u: np.full(len(u), THRESHOLD + 1.0))
    for evaluated in (flown(window), clear):
        statement = located(WORST, evaluated, stored)[0].statement
        assert boundary.SAMPLES in facts(statement)
        assert BETWEEN in words(statement)


def test_fields_of_a_finding() -> None:
    (_, violation), most = driven(boundary.after(case1(), WORST, THRESHOLD - 0.2))
    assert violation is not None
    line = violation.described(case1()).line
    assert line is not None
    assert line.way == pytest.approx(0.8, abs=1e-4)
    assert most <= MOST
    (slices_, clear), evaluations = driven(boundary.after(case1(), WORST, THRESHOLD + 0.1))
    assert clear is None
    assert len(slices_.curves) == 2
    assert evaluations == 2 * 41
    (_, everywhere), most = driven(
        boundary.after(case1(), WORST, 0.0), flown(lambda u: np.where((u == 0.5).all(axis=1), 1, 0))
    )
    assert everywhere is not None
    assert all(ray.share is not None and ray.share < 2e-5 for ray in everywhere.described(case1()).rays)
    assert most <= MOST
