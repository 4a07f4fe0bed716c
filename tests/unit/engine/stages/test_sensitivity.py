"""Sensitivity indices against functions whose indices are known in closed form; designs that cannot be computed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns import CampaignError
from campaigns.claims.stages.surroundings import NO_VARIANCE, few_decide, no_index
from campaigns.results.base import OK
from campaigns.results.indices import MorrisStudy, SobolStudy
from campaigns.stages.plan import plan
from campaigns.stages.sensitivity import SensitivityResult
from clearance.testing.problems import Problem
from tests.given.sampled_stages import asked, context, evaluate
from worker.engine.search.base import Batch, Floats
from worker.engine.stages import sensitivity
from worker.engine.stages.sensitivity import FEW
from worker.running.runs.store import MemoryStore

THREE: dict[str, Any] = {
    "vehicle.m": {"low": 4, "high": 6}, "vehicle.J": {"low": 0.04, "high": 0.06}, "avoider.k_rep": {"plus_minus": 1},
}  # fmt: skip
"""In the order of the axes: vehicle.m, avoider.k_rep, vehicle.J (small letters first)."""


def flown(function: Any) -> Any:
    def evaluated(points: Floats) -> tuple[Batch, dict[int, str]]:
        return Batch(function(points)[:, None], np.full(len(points), OK, dtype=np.uint8)), {}

    return evaluated


def ran(function: Any, study: dict[str, Any], **changes: Any) -> SensitivityResult:
    campaign = asked({"sensitivity": {"points": 3} | study}, uncertain=changes.pop("uncertain", THREE), **changes)
    run = context(campaign, flown(function), Problem(campaign))
    found = sensitivity.run(run, 0).result
    assert isinstance(run.store, MemoryStore)
    stored = run.store.evaluations(0)
    assert stored is not None
    assert len(stored.status) == next(p.planned for p in plan(campaign) if p.kind == "sensitivity")
    return found


def shares_of(found: SensitivityResult) -> SobolStudy:
    assert found.sobol is not None
    return found.sobol


def effects_of(found: SensitivityResult) -> MorrisStudy:
    assert found.morris is not None
    return found.morris


def ishigami(u: Floats) -> Floats:
    x = np.pi * (2 * u - 1)
    return np.asarray(np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0]))


def test_the_sobol_indices_of_ishigami() -> None:
    # Closed form with a = 7, b = 0.1: Sobol and Levitan (1999).
    found = shares_of(ran(ishigami, {"sobol": {"samples": 4096}}))
    assert found.indices is not None
    paths = [row.path for row in found.indices]
    assert paths == [r.path for r in Problem(asked({}, uncertain=THREE)).ranges]
    assert [row.first for row in found.indices] == pytest.approx([0.3139, 0.4424, 0.0], abs=0.02)
    assert [row.total for row in found.indices] == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.02)
    assert all(row.total_confidence is not None and 0 < row.total_confidence < 0.1 for row in found.indices)
    assert (found.samples, found.evaluations, found.failed, found.excluded) == (4096, 4096 * 5, 0, 0)
    assert found.text.startswith(f"largest total indices: {paths[0]}: 0.5")


def test_the_effects_of_a_plane_and_of_a_product() -> None:
    found = effects_of(ran(lambda u: 3 * u[:, 0] - 2 * u[:, 1], {"morris": {"trajectories": 10}}))
    rows = found.indices
    assert rows is not None
    assert [row.mu for row in rows] == pytest.approx([3, -2, 0])
    assert [row.mu_star for row in rows] == pytest.approx([3, 2, 0])
    assert [row.sigma for row in rows] == pytest.approx([0, 0, 0], abs=1e-12)
    assert found.evaluations == 10 * 4
    rows = effects_of(ran(lambda u: u[:, 0] * u[:, 1], {"morris": {"trajectories": 50, "levels": 8}})).indices
    assert rows is not None
    assert rows[0].sigma is not None
    assert rows[0].sigma > 0.1  # an interaction
    assert rows[2].mu_star == 0


def test_the_distributions_weight_the_indices() -> None:
    narrow = {"low": 4, "high": 6, "distribution": {"kind": "truncated_normal", "mean": 5, "deviation": 0.05}}
    uncertain = THREE | {"vehicle.m": narrow}
    found = shares_of(ran(lambda u: u.sum(axis=1), {"sobol": {"samples": 1024}}, uncertain=uncertain))
    assert found.indices is not None
    shares = {row.path: row.first for row in found.indices}
    assert shares["vehicle.m"] == pytest.approx(0.025**2 / (0.025**2 + 2 / 12), abs=0.005)
    assert shares["vehicle.J"] == pytest.approx(0.5, abs=0.03)


def test_correlations_are_ignored_and_the_result_states_it() -> None:
    correlations = [{"between": ["vehicle.m", "vehicle.J"], "value": 0.9}]
    found = shares_of(ran(lambda u: u.sum(axis=1), {"sobol": {"samples": 1024}}, correlations=correlations))
    assert found.indices is not None
    assert [row.first for row in found.indices] == pytest.approx([1 / 3] * 3, abs=0.03)
    assert found.text.endswith("; correlations are ignored")


def test_the_indices_depend_on_no_unit() -> None:
    def scaled(scale: float) -> list[float]:
        found = shares_of(ran(lambda u: scale * u.sum(axis=1), {"sobol": {"samples": 64}}))
        assert found.indices is not None
        return [row.first for row in found.indices]

    for scale in (1e-300, 1e-13, 1e200):
        assert scaled(scale) == pytest.approx(scaled(1.0), rel=1e-6)


@pytest.mark.parametrize("beside", [0.0, 1e-9], ids=["constant", "lost in rounding"])
def test_a_base_sample_that_does_not_vary_has_no_indices(beside: float) -> None:
    """A corner that evaluations of some designs meet, but not of their base sample; never is every index zero."""
    total = 0
    for seed in range(8):
        found = ran(
            lambda u: ((u[:, 0] > 0.93) & (u[:, 1] > 0.93)) + beside * u[:, 2], {"sobol": {"samples": 64}}, seed=seed
        )
        study = shares_of(found)
        assert study.indices is None or any(row.total for row in study.indices)
        total += study.statement == few_decide(FEW, 2 * 64)
    assert total


def test_where_few_evaluations_decide_there_are_no_indices() -> None:
    """A corner of 0.1 % of the box: total indices were stated as 0 ± 0 where 0.97 is true."""
    few, more = 0, 0
    for seed in range(4):
        corner = ran(lambda u: (u[:, 0] < 0.0316) & (u[:, 1] < 0.0316), {"sobol": {"samples": 1024}}, seed=seed)
        few += shares_of(corner).indices is None
        corner = ran(lambda u: (u[:, 0] < 0.1) & (u[:, 1] < 0.1), {"sobol": {"samples": 1024}}, seed=seed)
        more += shares_of(corner).indices is not None
    assert (few, more) == (4, 4)


def test_an_index_that_few_evaluations_decide_has_no_interval() -> None:
    """A hole met by 0.25 % beside a slope: half of the variance was stated as 0 ± 0."""
    found = shares_of(
        ran(lambda u: 3 + 3 * u[:, 2] - 20 * ((u[:, 0] < 0.05) & (u[:, 1] < 0.05)), {"sobol": {"samples": 1024}})
    )
    assert found.indices is not None
    decided = [row.total_confidence is not None for row in found.indices]
    assert decided == [False, False, True]
    assert all(row.first_confidence != 0 and row.total_confidence != 0 for row in found.indices)


def test_a_constant_has_no_indices() -> None:
    found = ran(lambda u: np.full(len(u), 0.7), {"sobol": {"samples": 8}, "morris": {"trajectories": 4}})
    assert shares_of(found).indices is None
    assert shares_of(found).statement == NO_VARIANCE
    rows = effects_of(found).indices
    assert rows is not None
    assert all(row.mu_star == 0 for row in rows)


@pytest.mark.parametrize("kind", ["failing", "excluded"])
def test_a_design_with_flights_that_are_missing_is_not_computed(kind: str) -> None:
    study = {"points": 3, "sobol": {"samples": 64}, "morris": {"trajectories": 10}}
    lost: Any = {kind: lambda x: x[:, 0] > 0.9}
    found = sensitivity.run(context(asked({"sensitivity": study}), evaluate(**lost)), 0).result
    for part in (shares_of(found), effects_of(found)):
        missing = part.failed if kind == "failing" else part.excluded
        assert missing > 0
        assert part.indices is None
        assert part.statement == no_index(missing, part.evaluations)
    assert found.curves[0].status.count("ok") == 2


def test_nothing_is_computed_that_was_not_asked_for() -> None:
    found = ran(lambda u: u.sum(axis=1), {})
    assert (found.morris, found.sobol, found.points) == (None, None, 3)


def test_the_seed_decides_the_design() -> None:
    study = {"sobol": {"samples": 64}, "morris": {"trajectories": 4}}
    one, same, other = (ran(ishigami, study, seed=seed) for seed in (1, 1, 2))
    assert one == same
    assert one.morris != other.morris
    assert one.sobol != other.sobol


@pytest.mark.parametrize(
    ("study", "message"),
    [
        ({"sobol": {"samples": 100}}, "Sobol points are balanced for powers of two only; give 64 or 128"),
        ({"morris": {"levels": 5}}, "multiple of 2"),
        ({"morris": {"trajectories": 1}}, "of at least 2"),
        ({"fast": {}}, "unknown key"),
    ],
)
def test_settings_that_make_no_sense(study: dict[str, Any], message: str) -> None:
    with pytest.raises(CampaignError, match=message):
        asked({"sensitivity": study})
