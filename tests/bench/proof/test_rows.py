"""A member of the operands gives a member of the result: in exact fractions where the operation is rational."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from tests.bench.proof.flight import run
from tests.bench.proof.frame import reframed
from tests.bench.proof.rows import LINEAR, shape
from tests.bench.proof.traced import ON_ROWS, Row, Tape, choose, program

pytestmark = pytest.mark.nightly  # compiles for a minute, and no page or command rests on it

FRAME, FRESH = 3, 2
S = shape(2, FRAME, FRESH, True)
EXACT = {
    "sum": (lambda x, y: x * 0.75 + y - 0.125, lambda x, y: x * Fraction(3, 4) + y - Fraction(1, 8)),
    "product": (lambda x, y: x * y, lambda x, y: x * y),
    "square": (lambda x, y: x * x, lambda x, y: x * x),
    "size": (lambda x, y: abs(x), lambda x, y: abs(x)),
}
CLOSE = {
    "quotient": (lambda x, y: y / (x * x + 2.0), lambda x, y: y / (x * x + 2.0)),
    "root": (lambda x, y: ON_ROWS["sqrt"](x * x + y * y + 0.5), lambda x, y: math.sqrt(x * x + y * y + 0.5)),
    "sine": (lambda x, y: ON_ROWS["sincos"](x)[0], lambda x, y: math.sin(x)),
    "cosine": (lambda x, y: ON_ROWS["sincos"](x)[1], lambda x, y: math.cos(x)),
    "angle": (lambda x, y: ON_ROWS["atan2"](y, x), lambda x, y: math.atan2(y, x)),
    "limit": (lambda x, y: ON_ROWS["clip"](x, -0.5, 0.75), lambda x, y: min(max(x, -0.5), 0.75)),
    "decision": (lambda x, y: choose(x > y, x, 2.0), lambda x, y: x if x > y else 2.0),
    "whole turns": (lambda x, y: ON_ROWS["wrap"](4.0 * x), lambda x, y: math.remainder(4.0 * x, 2.0 * math.pi)),
    "repulsion": (
        lambda x, y: ON_ROWS["firas"](abs(x) + 0.01, 1.0, 1.5),
        lambda x, y: max(0.0, (1.0 / (abs(x) + 0.01) - 1.0 / 1.5) / (abs(x) + 0.01) ** 2),
    ),
    "integrator": (
        lambda x, y: ON_ROWS["saturated"](x, -0.5, 0.5, y, y)[1],
        lambda x, y: 0.0 if (x > 0.5 and y > 0.0) or (x < -0.5 and y < 0.0) else y,
    ),
}


def table(rng: np.random.Generator, count: int) -> Any:
    """Two random rows at the top of a table."""
    w = np.zeros((count + 4, S.width))
    for x in (0, 1):
        spread = 10.0 ** rng.uniform(-8, 0)
        w[x, 0] = rng.normal()
        w[x, LINEAR : S.used] = rng.normal(size=S.used - LINEAR) * spread / S.used
        w[x, 1] = rng.random() * spread / S.used
        w[x, 2] = np.abs(w[x, : S.used]).sum() * 1.001
    return w


def symbols(rng: np.random.Generator) -> tuple[Any, Any]:
    """Values of the symbols: a corner, or within."""
    e, f = rng.uniform(-1, 1, 2), rng.uniform(-1, 1, FRAME + FRESH)
    return (np.sign(e), np.sign(f)) if rng.random() < 0.5 else (e, f)


def member(row: Any, e: Any, f: Any, pick: float) -> Fraction:
    """The exact value of a row for these symbols; `pick` of its remainder."""
    terms = [(row[0], 1.0), (row[1], pick)]
    terms += [(row[LINEAR + i], e[i]) for i in range(2)]
    total = sum((Fraction(a) * Fraction(b) for a, b in terms), Fraction(0))
    pairs = [(i, j) for i in range(2) for j in range(i, 2)]
    total += sum(Fraction(row[S.products + k]) * Fraction(e[i]) * Fraction(e[j]) for k, (i, j) in enumerate(pairs))
    total += sum(Fraction(row[S.frame + k]) * Fraction(f[k]) for k in range(FRAME + FRESH))
    crossed = [(i, k) for i in range(2) for k in range(FRAME)]
    return total + sum(Fraction(row[S.cross + j]) * Fraction(e[i]) * Fraction(f[k]) for j, (i, k) in enumerate(crossed))


def outside(form: Any, truth: Any, rng: np.random.Generator, slack: float) -> tuple[int, int]:
    """How many of the members are outside of the result's row, and how many were bounded."""
    tape = Tape()
    x, y = tape.new(), tape.new()
    codes, constants, out, count, _ = program(tape, 2, [form(x, y)])
    bad = checked = 0
    for _ in range(60):
        w = table(rng, count)
        run(w, codes, constants, S.fresh, S)
        for _ in range(6 if math.isfinite(w[out[0], 1]) else 0):
            e, f = symbols(rng)
            a, b = (member(w[k], e, f, float(rng.choice([-1, 1]))) for k in (0, 1))
            value = truth(a, b) if slack == 0.0 else truth(float(a), float(b))
            off = abs(Fraction(value) - member(w[out[0]], e, f, 0.0))
            bad += off > Fraction(w[out[0], 1]) + Fraction(slack) * Fraction(w[out[0], 2])
            checked += 1
    return bad, checked


@pytest.mark.parametrize("name", EXACT)
def test_members_in_exact_arithmetic(name: str) -> None:
    form, truth = EXACT[name]
    bad, checked = outside(form, truth, np.random.default_rng(3), 0.0)
    assert bad == 0
    assert checked > 300


@pytest.mark.parametrize("name", CLOSE)
def test_a_form_contains_the_values_of_its_function(name: str) -> None:
    form, truth = CLOSE[name]
    bad, checked = outside(form, truth, np.random.default_rng(4), 4e-15)
    assert bad == 0
    assert checked > 200


def test_a_row_that_claims_less_is_found_out() -> None:
    """The check itself: a product without its mixed terms has members outside."""
    bad, _ = outside(lambda x, y: x + y, lambda x, y: x * y, np.random.default_rng(3), 0.0)
    assert bad > 300


def test_a_frame_holds_what_it_replaces() -> None:
    """Over every choice of the old symbols the new row can reach the value: |value - polynomial| <= its radius."""
    rng = np.random.default_rng(5)
    for _ in range(50):
        w = table(rng, 2)
        before = w.copy()
        metric = rng.normal(size=(2, 2)) + 3.0 * np.eye(2)
        reframed(w, 0, 2, S, np.zeros((2, S.used - S.frame + 2)), metric, np.linalg.inv(metric))
        direction = rng.normal(size=2)
        for _ in range(10):
            e, f = symbols(rng)
            old = [member(before[k], e, f, float(rng.choice([-1, 1]))) for k in (0, 1)]
            off = sum(
                Fraction(d) * (old[k] - member(w[k], e, np.zeros(FRAME + FRESH), 0.0)) for k, d in enumerate(direction)
            )
            radius = sum(
                abs(sum(Fraction(d) * Fraction(w[k, S.frame + j]) for k, d in enumerate(direction)))
                for j in range(FRAME)
            ) + sum(abs(Fraction(d)) * Fraction(w[k, 1]) for k, d in enumerate(direction))
            assert abs(off) <= radius


def test_an_unknown_decision_is_refused() -> None:
    with pytest.raises(TypeError):
        bool(Row(Tape(), 0))
