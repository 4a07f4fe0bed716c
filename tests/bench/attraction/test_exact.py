"""The exact check accepts a certificate made by hand, and none that was changed."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from tests.bench.attraction.exact import Certificate, projected, proved, semidefinite
from tests.bench.attraction.polynomials import Polynomial, of_gram

HALF = Fraction(1, 2)
FIELD: list[Polynomial] = [{(1,): -1, (3,): 1}]
"""x' = -x + x^3, whose region of attraction is |x| < 1."""
BASES = {"square": [(2,)], "positive": [(1,)], "multiplier": [(1,)], "decrease": [(1,), (2,)]}
BY_HAND = Certificate(
    v={(2,): Fraction(2)},
    positive=[[2 - HALF]],
    multiplier=[[Fraction(3)]],
    decrease=[[HALF, Fraction(0)], [Fraction(0), Fraction(2)]],
)
"""V = 2 x^2, s = 3 x^2: -dV/dt - x^2 / 2 - s (1 - V) = x^2 / 2 + 2 x^4."""


def test_a_certificate_by_hand_holds() -> None:
    assert proved(BY_HAND, FIELD, HALF, BASES)


@pytest.mark.parametrize(
    "change",
    [
        {"v": {(2,): Fraction(1)}},
        {"positive": [[Fraction(2)]]},
        {"multiplier": [[Fraction(3) + Fraction(1, 2**60)]]},
        {"decrease": [[HALF, Fraction(0)], [Fraction(0), Fraction(2) - Fraction(1, 2**60)]]},
    ],
)
def test_a_changed_one_does_not(change: dict[str, object]) -> None:
    assert not proved(BY_HAND._replace(**change), FIELD, HALF, BASES)


def test_an_identity_with_a_negative_multiplier_is_no_certificate() -> None:
    """V = x^2 / 4 has {V < 1} beyond the region of attraction, and s = -x^2 an identity."""
    v, s = {(2,): Fraction(1, 4)}, [[Fraction(-1)]]
    # -dV/dt = x^2 / 2 - x^4 / 2, and s (1 - V) = -x^2 + x^4 / 4
    rest = [[Fraction(3, 2) - Fraction(1, 8), Fraction(0)], [Fraction(0), Fraction(-3, 4)]]
    found = Certificate(v, [[Fraction(1, 8)]], s, rest)
    assert not proved(found, FIELD, Fraction(1, 8), BASES)
    assert not any(map(semidefinite, (s, rest)))


def test_semidefinite_matrices_are_told_from_others_to_the_last_digit() -> None:
    tiny = Fraction(1, 10**40)
    one = Fraction(1)
    assert semidefinite([[one, one], [one, one]])
    assert not semidefinite([[one, one], [one, one - tiny]])
    assert not semidefinite([[Fraction(0), tiny], [tiny, one]])
    assert semidefinite([[Fraction(0), Fraction(0)], [Fraction(0), tiny]])


def test_a_projected_gram_matrix_gives_the_polynomial_exactly() -> None:
    basis = [(0,), (1,), (2,)]
    target = {(0,): Fraction(1, 3), (1,): Fraction(2, 7), (2,): Fraction(5), (3,): Fraction(-1, 9), (4,): Fraction(2)}
    found = projected(target, basis, np.diag([0.3, 4.0, 2.0]))
    assert {m: c for m, c in of_gram(basis, found).items() if c} == target
    with pytest.raises(ValueError, match="monomials"):
        projected({(5,): Fraction(1)}, basis, np.eye(3))
