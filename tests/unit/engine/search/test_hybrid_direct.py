"""Hybrid DIRECT: DIRECT's points first, then SQP from its best centre, then from the others."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from campaigns.codes import StopCode
from campaigns.results.base import EXCLUDED, FAILED
from clearance.testing.searching import run
from tests.given.ended_searches import ending
from tests.given.functions_with_minima import on_unit_cube
from worker.engine.search.base import Ended, Floats
from worker.engine.search.methods import direct, direct_l, hybrid_direct
from worker.engine.search.methods.hybrid_direct import method


def corner(x: Floats) -> Floats:
    """Falls to a corner, which no centre of a rectangle ever reaches."""
    return np.asarray(1.0 + (x * [1.0, 2.0]).sum(axis=1))


@pytest.mark.parametrize("biased", [False, True])
def test_it_begins_with_directs_points(biased: bool) -> None:
    f = on_unit_cube("Branin", 1)
    plain = run(direct_l.method if biased else direct.method, f, 2, 10_000, options={"iterations": 15})
    hybrid = run(method, f, 2, 10_000, options={"iterations": 15, "biased": biased})
    assert plain.text is not None
    assert hybrid.text is not None
    assert len(hybrid.batches) > len(plain.batches)
    for mine, his in zip(hybrid.batches, plain.batches, strict=False):
        assert np.array_equal(mine, his)
    code, values = ending(hybrid.text)
    assert (code, values["centres"]) == (StopCode.MEMBERS, 5)
    assert ending(values["direct"]) == ending(plain.text) == (StopCode.ITERATIONS, {"iterations": 15})
    assert hybrid.lowest < plain.lowest


def test_the_best_centre_goes_first_and_alone_then_the_others_side_by_side() -> None:
    f = on_unit_cube("Branin", 1)
    plain = run(direct.method, f, 2, 10_000, options={"iterations": 10})
    hybrid = run(method, f, 2, 10_000, options={"iterations": 10, "centres": 4})
    after = hybrid.batches[len(plain.batches) :]
    best = plain.points[np.argmin(np.concatenate(plain.values))]
    assert np.array_equal(after[0][0], best)
    assert len(after[0]) == 5  # a point and its four neighbours
    together = next(b for b in after if len(b) > 5)
    assert len(together) == 3 * 5
    centres = {p.tobytes() for p in plain.points}
    assert all(start.tobytes() in centres for start in together[::5])
    starts = [m.start for m in hybrid.minima]
    assert starts[0] is not None
    assert np.array_equal(starts[0], best)
    assert len(starts) == 4


def test_it_reaches_a_corner_exactly() -> None:
    hybrid = run(method, corner, 2, 1000, options={"iterations": 20, "centres": 1})
    assert hybrid.lowest == 1.0
    assert hybrid.minima[0].point.tolist() == [0.0, 0.0]
    assert run(direct.method, corner, 2, 1000).lowest > 1.0


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_direct_uses_no_more_than_its_share_of_the_budget(share: float) -> None:
    f = on_unit_cube("Hartman 6", 1)
    hybrid = run(method, f, 6, 2000, options={"share": share, "centres": 1})
    plain = run(direct.method, f, 6, 2000)
    same = 0
    while np.array_equal(hybrid.batches[same], plain.batches[same]):
        same += 1
    spent = sum(map(len, plain.batches[:same]))
    assert spent <= share * 2000 < spent + len(plain.batches[same])
    assert len(hybrid.batches[same]) == 13


def test_both_of_two_symmetric_basins_are_reported() -> None:
    def two(x: Floats) -> Floats:
        return np.asarray(np.minimum(((x - 0.25) ** 2).sum(axis=1), ((x - 0.75) ** 2).sum(axis=1)))

    hybrid = run(method, two, 2, 1000)
    ends = {tuple(np.round(m.point, 3)) for m in hybrid.minima}
    assert ends == {(0.25, 0.25), (0.75, 0.75)}


@pytest.mark.parametrize("status", [FAILED, EXCLUDED])
def test_it_never_descends_from_a_point_without_a_value(status: int) -> None:
    f = on_unit_cube("excluded region", 2)
    hybrid = run(method, f, 3, 4000, status=status)
    assert hybrid.minima
    for m in hybrid.minima:
        assert m.start is not None
        assert np.isfinite(f(m.start[None, :])[0])
    assert f.gap(hybrid.lowest) < 1e-6


def test_it_reports_that_no_centre_has_a_value() -> None:
    hybrid = run(method, lambda x: np.full(len(x), np.nan), 2, 10_000, options={"iterations": 5})
    code, values = ending(hybrid.text)
    assert code == StopCode.NO_VALUE
    assert ending(values["direct"]) == (StopCode.ITERATIONS, {"iterations": 5})
    assert hybrid.minima == []


@pytest.mark.parametrize("options", [{"differences": "forward"}, {"gradients": 1}, {"centres": 1}, {"smallest": 0.05}])
def test_options_of_the_descents_and_of_direct(options: dict[str, Any]) -> None:
    f = on_unit_cube("Hartman 3", 1)
    hybrid = run(method, f, 3, 5000, options=options)
    assert hybrid.text is not None
    if "smallest" in options:
        code, values = ending(ending(hybrid.text)[1]["direct"])
        assert (code, values["smallest"]) == (StopCode.RESOLUTION, 0.05)
    if "gradients" in options:
        assert {m.text.code for m in hybrid.minima if isinstance(m.text, Ended)} == {StopCode.ITERATIONS}
        assert all(isinstance(m.text, Ended) for m in hybrid.minima)
    else:
        assert f.gap(hybrid.lowest) < 1e-6
    if "centres" in options:
        assert len(hybrid.minima) == 1
    assert hybrid_direct.Options().epsilon == direct.Options().epsilon
