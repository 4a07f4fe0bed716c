"""Regions of attraction: of a loop whose region is known, and of the shipped loops."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.certificates import exact
from campaigns.certificates.coordinates import transformed
from campaigns.certificates.polynomials import Polynomial, of_gram
from campaigns.certificates.rays import contradicting, directions, drawn, fraction, radii, volume
from tests.bench.attraction.truth import VAN_DER_POL, area_of_limit_cycle, exactly
from worker.engine.attraction import region
from worker.engine.attraction.rounding import projected
from worker.engine.attraction.simulated import Simulation, difference, measured
from worker.engine.systems import optional
from worker.engine.systems.base import CampaignUnusable, PolynomialLoop
from worker.running.opening import opened


@cache
def loop_of(name: str) -> PolynomialLoop:
    found = optional.about_trim(opened.system(load_file(library()[name])))
    assert found is not None
    return found


@pytest.mark.nightly
def test_van_der_pol_within_two_percent_of_the_simulated_region() -> None:
    flow = [exactly(p) for p in VAN_DER_POL]
    found = region.found(flow, {}, 6)
    assert not isinstance(found, str)
    assert exact.wrong(found.certificate, *transformed(flow, {}, found.matrix)) == ""
    turned = abs(np.linalg.det(np.array(found.matrix, dtype=float)))
    area = turned * volume(radii(found.certificate.v, directions(2, 2000)), 2)
    true = area_of_limit_cycle(VAN_DER_POL, (2.0, 0.0))
    assert true == pytest.approx(13.72, abs=0.01)
    assert 0.98 * true < area < true


@pytest.mark.parametrize("name", ["unicycle_static", "pioneer_moving"])
def test_the_polynomials_of_a_shipped_loop_are_its_own_equations(name: str) -> None:
    """As the compiled kernels evaluate them, up to nine tenths of the limits."""
    loop = loop_of(name)
    ends = np.array([10.0 if limit is None else 0.9 * limit for limit in loop.limits])
    points = np.random.default_rng(1).uniform(-ends, ends, (200, 4))
    assert difference(list(loop.flow), points, loop.rates(points)) < 1e-12
    changed = [{m: 1.001 * float(c) for m, c in p.items()} for p in loop.flow]
    assert difference(changed, points, loop.rates(points)) == pytest.approx(1e-3, rel=0.1)
    assert np.abs(loop.rates(np.zeros((1, 4)))).max() < 1e-12


def test_beyond_its_limits_a_loop_has_other_equations() -> None:
    loop = loop_of("pioneer_moving")
    beyond = np.array([[1.1 * (loop.limits[0] or 0.0), 0.0, 0.0, 0.0]])
    assert difference(list(loop.flow), beyond, loop.rates(beyond)) > 1e-3


@pytest.mark.nightly
def test_the_pioneers_region_is_proved_and_its_simulations_return() -> None:
    loop = loop_of("pioneer_moving")
    flow, limits = list(loop.flow), {k: limit for k, limit in enumerate(loop.limits) if limit is not None}
    found = region.found(flow, limits, 2)
    assert not isinstance(found, str)
    bounds = {k: exact.coefficient(limit) for k, limit in limits.items()}
    assert exact.wrong(found.certificate, *transformed(flow, bounds, found.matrix)) == ""
    of, made = drawn(found.certificate.v, found.matrix), measured(found, Simulation(flow, loop.returns))
    assert contradicting(of.certified, made.simulated) == 0
    assert 0.05 < (fraction(of.certified, made.simulated, 4) or 0.0) < 0.5
    assert all(reach <= limit for reach, limit in zip(of.reach, limits.values(), strict=False))
    for pair, certified in of.sections.items():
        assert (made.sections[pair] >= 0.99 * certified[::3]).all()


def test_a_simulation_that_leaves_contradicts_a_region() -> None:
    """Of x' = -x + x^3 beyond 1, with a ring of radius 2 as the region."""
    flow: list[Polynomial] = [{(1,): Fraction(-1), (3,): Fraction(1)}]
    rays, certified = np.array([[1.0], [-1.0]]), np.array([2.0, 2.0])
    simulation = Simulation(flow, lambda starts, *_: np.abs(starts[:, 0]) < 1.0)
    assert contradicting(certified, simulation.radii(rays, certified)) == 2
    ended = simulation.radii(rays, np.array([0.5, 0.9]))
    assert ended == pytest.approx([1.0, 1.0], rel=0.02)
    assert contradicting(np.array([0.5, 0.9]), ended) == 0
    assert np.isinf(Simulation(flow, lambda starts, *_: np.ones(len(starts), bool)).radii(rays, certified)).all()


def test_an_unstable_loop_has_no_region() -> None:
    assert region.found([{(1,): Fraction(1)}], {0: 1.0}, 2) == "unstable"
    assert region.found([{(1,): Fraction(0), (3,): Fraction(-1)}], {0: 1.0}, 2) == "unstable"


def test_a_linear_loop_is_certified_up_to_its_limit() -> None:
    found = region.found([{(1,): Fraction(-1)}], {0: math.pi}, 2)
    assert not isinstance(found, str)
    assert drawn(found.certificate.v, found.matrix).reach == pytest.approx([math.pi], rel=0.02)


def test_model_and_loop_are_compared_at_the_boundary_too() -> None:
    """They differ most where the deviations are largest: random points inside miss a part of it."""
    flow: list[Polynomial] = [{(1,): Fraction(-1)}]
    found = region.found(flow, {0: math.pi}, 2)
    assert not isinstance(found, str)
    made = measured(found, Simulation(flow, lambda starts, *_: np.ones(len(starts), bool)))
    (reach,) = drawn(found.certificate.v, found.matrix).reach
    assert np.abs(made.points).max() == pytest.approx(reach)
    rates = -made.points + 0.01 * made.points**3
    assert difference(flow, made.points, rates) == pytest.approx(0.01 * reach**3 / np.abs(rates).max())


def test_without_integral_gains_there_is_no_trim() -> None:
    document = load_file(library()["pioneer_moving"]).document()
    document["scenario"]["controller"]["parameters"]["K_4"] = 0.0
    with pytest.raises(CampaignUnusable, match="K_3"):
        optional.about_trim(opened.system(load_document(document)))


def test_a_projected_gram_matrix_gives_the_polynomial_exactly() -> None:
    basis = [(0,), (1,), (2,)]
    target = {
        (0,): Fraction(1, 2**70),
        (1,): Fraction(2),
        (2,): Fraction(5),
        (3,): Fraction(-1, 2**90),
        (4,): Fraction(2),
    }
    found = projected(target, basis, np.diag([0.3, 4.0, 2.0]))
    assert {m: c for m, c in of_gram(basis, found).items() if c} == target
    assert all(c.denominator & (c.denominator - 1) == 0 for row in found for c in row)
    with pytest.raises(ValueError, match="monomials"):
        projected({(5,): Fraction(1)}, basis, np.eye(3))
