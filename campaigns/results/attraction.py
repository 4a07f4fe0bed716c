"""The region of attraction of the closed loop about its trim: certificate, volumes and sections."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Annotated, Literal, Self

from pydantic import Field

from campaigns.certificates.exact import Certificate, Exact
from campaigns.certificates.polynomials import Polynomial, degree
from campaigns.claims.stages.attraction import Facts
from campaigns.documented import UNLESS_NONE
from campaigns.results.base import Described, Result
from campaigns.results.sample import Count

NoAttractionWhy = Literal["solver", "unstable", "no_region", "rounding"]


class Dyadic(Result):
    """Exact numbers: whole numbers over 2^bits."""

    bits: Annotated[int, Field(ge=0, le=4096)]
    numbers: list[str]

    @classmethod
    def of(cls, values: Sequence[Fraction]) -> Self:
        bits = max((value.denominator.bit_length() - 1 for value in values), default=0)
        return cls(bits=bits, numbers=[str(int(value * 2**bits)) for value in values])

    def values(self) -> list[Fraction]:
        return [Fraction(int(number), 2**self.bits) for number in self.numbers]


class StoredPolynomial(Result):
    """A polynomial: the powers of the variables in each term, and its coefficients."""

    powers: list[list[Annotated[int, Field(ge=0, le=16)]]]
    coefficients: Dyadic

    @classmethod
    def of(cls, p: Polynomial) -> Self:
        terms = sorted((m, c) for m, c in p.items() if c != 0)
        return cls(powers=[list(m) for m, _ in terms], coefficients=Dyadic.of([c for _, c in terms]))

    def polynomial(self) -> Polynomial:
        return dict(zip(map(tuple, self.powers), self.coefficients.values(), strict=True))


class StoredCertificate(Result):
    """What proves the region {V(y) < 1}, where the deviations x = T y.

    Gram matrices by their upper triangles, row by row, on monomials of rising degree.
    """

    coordinates: Dyadic
    """T, row by row."""
    v: StoredPolynomial
    positive: list[Dyadic]
    """Of V - |y|^2 / 2^24, and of V - c x^2 for every limited state, where 1 / c is at most its limit squared."""
    multiplier: Dyadic
    """Of s, a sum of squares."""
    decrease: Dyadic
    """Of -dV/dt - |y|^2 / 2^24 - s (1 - V)."""

    @classmethod
    def of(cls, matrix: list[list[Fraction]], found: Certificate) -> Self:
        return cls(
            coordinates=Dyadic.of([c for row in matrix for c in row]),
            v=StoredPolynomial.of(found.v),
            positive=[_upper(gram) for gram in found.positive],
            multiplier=_upper(found.multiplier),
            decrease=_upper(found.decrease),
        )

    def matrix(self) -> list[list[Fraction]]:
        """T; ValueError if it is not square."""
        values = self.coordinates.values()
        n = round(len(values) ** 0.5)
        if n * n != len(values):
            raise ValueError("not a square matrix")
        return [values[n * i : n * (i + 1)] for i in range(n)]

    def certificate(self) -> Certificate:
        """The certificate in the form that the exact check reads; ValueError if a triangle is incomplete."""
        positive = [_full(gram) for gram in self.positive]
        return Certificate(self.v.polynomial(), positive, _full(self.multiplier), _full(self.decrease))


def _upper(gram: Exact) -> Dyadic:
    return Dyadic.of([c for i, row in enumerate(gram) for c in row[i:]])


def _full(stored: Dyadic) -> Exact:
    values = stored.values()
    n = round(((8 * len(values) + 1) ** 0.5 - 1) / 2)
    if n * (n + 1) != 2 * len(values):
        raise ValueError("not a triangle")
    left = iter(values)
    upper = {(i, k): next(left) for i in range(n) for k in range(i, n)}
    return [[upper[min(i, k), max(i, k)] for k in range(n)] for i in range(n)]


class TrimState(Result):
    """A state of the polynomial model."""

    name: str
    symbol: str
    unit: str
    trim: float
    limit: float | None
    """The largest deviation from the trim for which the model applies."""
    reach: float | None = None
    """How far the region reaches from the trim along this state alone."""


class HeldReference(Result):
    """A reference that is held at the trim."""

    text: str
    value: float
    unit: str


class NoAttraction(Described):
    """Why no region is stated."""

    why: NoAttractionWhy


class Section(Result):
    """The region in the plane of two states, the others at trim: distances from the trim at even angles, where each
    state is relative to its reach."""

    states: list[Count]
    proved: list[float]
    simulated: list[float | None]
    """Up to where the loop returns in simulation, at every third angle; null where no end was met."""


class Attraction(Described):
    """A region from which the polynomial model of the loop returns to its trim, proved, and what is measured next to
    it."""

    states: list[TrimState]
    held: list[HeldReference]
    flow: list[StoredPolynomial]
    """dx/dt of the deviations."""
    degree: Count = 0
    """Of V."""
    proof: Annotated[StoredCertificate | None, UNLESS_NONE] = None
    refused: Annotated[NoAttraction | None, UNLESS_NONE] = None
    fraction: float | None = None
    """Measured: its volume relative to that from which the loop returns in simulation."""
    simulated: list[float | None] = []
    """Measured: how far along the rays that compare the volumes the loop returns, in y; null where no end was met."""
    contradicting: Count = 0
    """Measured: rays on which the loop did not return from inside the region."""
    difference: float | None = None
    """Measured: the largest difference between model and loop in any dx/dt, on each ray at a point of the region and at
    its boundary, relative to its largest there."""
    sections: list[Section] = []

    def facts(self) -> Facts:
        """What its statement says."""
        return Facts(
            references=[(one.text, one.value, one.unit) for one in self.held],
            model=max(degree(p.polynomial()) for p in self.flow),
            degree=self.degree,
            states=[(one.symbol, one.limit, one.unit) for one in self.states],
            rays=len(self.simulated),
            contradicting=self.contradicting,
            fraction=self.fraction,
            difference=self.difference or 0.0,
        )
