"""The exact check accepts a certificate made by hand, and none that was changed."""

from __future__ import annotations

from fractions import Fraction

import pytest

from campaigns.certificates.coordinates import inverted, product, transformed
from campaigns.certificates.exact import (
    IDENTITY,
    NEGATIVE,
    SHAPE,
    SIZE,
    Certificate,
    coefficient,
    semidefinite,
    wrong,
)
from campaigns.certificates.polynomials import Polynomial
from campaigns.results.attraction import Dyadic, StoredCertificate

HALF, LEAST = Fraction(1, 2), Fraction(1, 2**60)
FLOW: list[Polynomial] = [{(1,): Fraction(-1), (3,): Fraction(1)}]
"""x' = -x + x^3, whose region of attraction is |x| < 1."""
LIMITS: list[Polynomial] = [{(2,): Fraction(2)}]
"""2 x^2 < 1."""
BY_HAND = Certificate(
    v={(2,): Fraction(2)},
    positive=[[[2 - HALF]], [[Fraction(0)]]],
    multiplier=[[Fraction(3)]],
    decrease=[[HALF, Fraction(0)], [Fraction(0), Fraction(2)]],
)
"""V = 2 x^2, s = 3 x^2: -dV/dt - x^2 / 2 - s (1 - V) = x^2 / 2 + 2 x^4."""


def test_a_certificate_by_hand_holds() -> None:
    assert wrong(BY_HAND, FLOW, LIMITS, HALF) == ""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"v": {(2,): Fraction(1)}}, IDENTITY),
        ({"v": {(2,): Fraction(2), (4,): LEAST}}, SIZE),
        ({"v": {(2,): Fraction(2), (1,): LEAST}}, IDENTITY),
        ({"v": {}}, SHAPE),
        ({"v": {(2, 0): Fraction(2)}}, SHAPE),
        ({"v": {(1000,): Fraction(2)}}, SHAPE),
        ({"positive": [[[2 - HALF]], [[LEAST]]]}, IDENTITY),
        ({"positive": [[[2 - HALF]]]}, SHAPE),
        ({"multiplier": [[Fraction(3) + LEAST]]}, IDENTITY),
        ({"multiplier": []}, IDENTITY),
        ({"decrease": [[HALF, Fraction(0)], [Fraction(0), Fraction(2) - LEAST]]}, IDENTITY),
        ({"decrease": [[HALF]]}, SIZE),
    ],
)
def test_a_changed_one_does_not(change: dict[str, object], said: str) -> None:
    assert said == wrong(BY_HAND._replace(**change), FLOW, LIMITS, HALF)


def test_of_another_loop_or_limit_it_does_not_hold() -> None:
    assert wrong(BY_HAND, [{(1,): Fraction(-1), (3,): 1 + LEAST}], LIMITS, HALF) == IDENTITY
    assert wrong(BY_HAND, FLOW, [{(2,): 2 + LEAST}], HALF) == IDENTITY
    assert wrong(BY_HAND, FLOW, LIMITS, HALF - LEAST) == IDENTITY
    assert wrong(BY_HAND, FLOW, LIMITS, Fraction(0))


def test_an_identity_with_a_negative_multiplier_is_no_certificate() -> None:
    """V = x^2 / 4 has {V < 1} beyond the region of attraction, and s = -x^2 an identity."""
    v, s = {(2,): Fraction(1, 4)}, [[Fraction(-1)]]
    # -dV/dt = x^2 / 2 - x^4 / 2, and s (1 - V) = -x^2 + x^4 / 4
    rest = [[Fraction(3, 2) - Fraction(1, 8), Fraction(0)], [Fraction(0), Fraction(-3, 4)]]
    found = Certificate(v, [[[Fraction(1, 8)]]], s, rest)
    assert wrong(found, FLOW, [], Fraction(1, 8)) == NEGATIVE
    assert not any(map(semidefinite, (s, rest)))


def test_semidefinite_matrices_are_distinguished_from_others_to_the_last_digit() -> None:
    tiny = Fraction(1, 10**40)
    one = Fraction(1)
    assert semidefinite([[one, one], [one, one]])
    assert not semidefinite([[one, one], [one, one - tiny]])
    assert not semidefinite([[Fraction(0), tiny], [tiny, one]])
    assert semidefinite([[Fraction(0), Fraction(0)], [Fraction(0), tiny]])


def test_a_limit_is_never_wider_than_stated() -> None:
    for limit in (3.141592653589793, 1000.0, 0.8, 1e-3):
        assert 0 <= coefficient(limit) * Fraction(limit) ** 2 - 1 < Fraction(1, 1000)


def test_coordinates_are_exact_both_ways() -> None:
    matrix = [[Fraction(2), Fraction(-7, 64)], [Fraction(0), Fraction(1, 4)]]
    one = [[Fraction(1), Fraction(0)], [Fraction(0), Fraction(1)]]
    assert product(matrix, inverted(matrix)) == one
    flow: list[Polynomial] = [{(0, 1): Fraction(1)}, {(1, 1): Fraction(3)}]
    inside, limits = transformed(flow, {0: Fraction(1)}, matrix)
    assert transformed(inside, {}, inverted(matrix))[0] == flow
    assert limits == [{(2, 0): Fraction(4), (1, 1): Fraction(-7, 16), (0, 2): Fraction(49, 4096)}]
    with pytest.raises(StopIteration):
        inverted([[Fraction(1), Fraction(1)], [Fraction(1), Fraction(1)]])


def test_what_is_stored_is_read_as_it_was() -> None:
    stored = StoredCertificate.of([[Fraction(1, 4)]], BY_HAND)
    again = StoredCertificate.model_validate_json(stored.model_dump_json())
    assert (again.matrix(), again.certificate()) == ([[Fraction(1, 4)]], BY_HAND)
    assert Dyadic.of([Fraction(3, 8), Fraction(-1)]) == Dyadic(bits=3, numbers=["3", "-8"])
    with pytest.raises(ValueError, match="triangle"):
        stored.model_copy(update={"decrease": Dyadic(bits=0, numbers=["1", "2"])}).certificate()
