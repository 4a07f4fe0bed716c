"""The `kernel` decorator, and elementary functions without branches or libm calls, so that the lane loop vectorises.

sin and cos: minimax polynomials of the Cephes library (S. L. Moshier) on [-pi/4, pi/4] after Cody-Waite reduction in
two parts. atan: a polynomial in x^2 through Chebyshev nodes on [-tan(pi/8), tan(pi/8)]; the rational function of Cephes
has fewer terms, but division throughput limits a wide loop. Every function propagates NaN. Errors are measured in
tests/unit/engine/kernels/test_maths.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numba import config

from worker.engine.kernels import jit
from worker.engine.kernels.bind import plain
from worker.engine.kernels.numba_internals import FLAGS, inlined

jit.refuse(bool(config.DISABLE_JIT))  # type: ignore[attr-defined]

F = TypeVar("F", bound=Callable[..., Any])

PI = 3.141592653589793
TWO_PI = 6.283185307179586
HALF_PI = 1.5707963267948966


def kernel(function: F) -> F:
    """Mark scalar Python code on floats and tuples as part of a compiled loop; it is always inlined.

    A call from Python runs the plain form: compiling a wrapper that unpacks dozens of parameters for every kernel would
    take half of the compile time of a loop.
    """
    return inlined(function, plain, **FLAGS)  # type: ignore[no-any-return]


@kernel
def sincos(x: float) -> tuple[float, float]:
    """Sine and cosine of x [rad]; absolute error below 2e-15 for |x| <= 30, below 5e-12 for |x| <= 1e5."""
    q = np.floor(x * 0.6366197723675814 + 0.5)
    r = (x - q * 1.5707963267948966) - q * 6.123233995736766e-17
    z = r * r
    s = 2.75573136213857245213e-6 + z * (-2.50507477628578072866e-8 + z * 1.58962301576546568060e-10)
    s = 8.33333333332211858878e-3 + z * (-1.98412698295895385996e-4 + z * s)
    s = r + r * z * (-1.66666666666666307295e-1 + z * s)
    c = -2.75573141792967388112e-7 + z * (2.08757008419747316778e-9 + z * -1.13585365213876817300e-11)
    c = -1.38888888888730564116e-3 + z * (2.48015872888517045348e-5 + z * c)
    c = 1.0 - 0.5 * z + z * z * (4.16666666666665929218e-2 + z * c)
    m = q - 4.0 * np.floor(q * 0.25)
    odd = (m == 1.0) | (m == 3.0)
    sine = c if odd else s
    cosine = s if odd else c
    sine = -sine if m >= 2.0 else sine
    cosine = -cosine if (m == 1.0) | (m == 2.0) else cosine
    return sine, cosine


@kernel
def atan2(y: float, x: float) -> float:
    """Angle of (x, y) in [-pi, pi] [rad] for finite arguments; absolute error below 1e-15; atan2(0, 0) is 0."""
    ax = abs(x)
    ay = abs(y)
    larger = ax if ax > ay else ay
    smaller = ay if ax > ay else ax
    upper = smaller > 0.41421356237309503 * larger
    above = smaller - larger if upper else smaller
    below = smaller + larger if upper else larger
    reduced = above / (below + 1e-300)
    offset = 0.7853981633974483 if upper else 0.0
    z = reduced * reduced
    p = -0.050854071801228175 + z * (0.039230436304980514 + z * -0.01917539771849316)
    p = -0.06664510493724213 + z * (0.05858140715312468 + z * p)
    p = -0.09090904575108247 + z * (0.07692183122146765 + z * p)
    p = -0.14285714284665557 + z * (0.1111111101518004 + z * p)
    p = -0.3333333333333333 + z * (0.19999999999995516 + z * p)
    angle = offset + reduced + reduced * z * p
    angle = HALF_PI - angle if ay > ax else angle
    angle = PI - angle if x < 0.0 else angle
    angle = -angle if y < 0.0 else angle
    return angle + 0.0 * (x + y)  # propagates NaN, which the comparisons above lose


@kernel
def clip(x: float, low: float, high: float) -> float:
    """x limited to [low, high]; NaN stays NaN."""
    x = low if x < low else x
    return high if x > high else x


@kernel
def whole(x: float) -> float:
    """The nearest whole number; NaN stays NaN."""
    return np.floor(x + 0.5)  # type: ignore[no-any-return]


@kernel
def wrap(angle: float) -> float:
    """The angle in [-pi, pi) [rad]."""
    return angle - TWO_PI * np.floor((angle + PI) / TWO_PI)  # type: ignore[no-any-return]


@kernel
def norm2(x: float, y: float) -> float:
    """Length of the plane vector (x, y)."""
    return math.sqrt(x * x + y * y)


GOLDEN = np.uint64(0x9E3779B97F4A7C15)
FIRST = np.uint64(0xBF58476D1CE4E5B9)
SECOND = np.uint64(0x94D049BB133111EB)
BITS_11, BITS_27, BITS_30 = np.uint64(11), np.uint64(27), np.uint64(30)
BITS_31, BITS_32, LOW_32 = np.uint64(31), np.uint64(32), np.uint64(0xFFFFFFFF)
MANTISSA, ONE = 0x000FFFFFFFFFFFFF, 0x3FF0000000000000
INSTANT = 1e-12
"""Tolerance for rounding when an instant is compared with the time [s]."""


@kernel
def scramble(z: Any) -> Any:
    """The finaliser of SplitMix64: a bijection on 64 bits; each input bit flips half of the output bits on average."""
    z = (z ^ (z >> BITS_30)) * FIRST
    z = (z ^ (z >> BITS_27)) * SECOND
    return z ^ (z >> BITS_31)


@kernel
def random_bits(seed: float, stream: float, count: float) -> Any:
    """64 random bits that depend only on three integers (magnitudes below 2^52): no state, any order of calls.

    SplitMix64 (Steele, Lea, Flood 2014) used as a counter-based generator: a key from seed and stream, then the count.
    """
    key = scramble(np.uint64(np.int64(seed)) * GOLDEN + GOLDEN)
    key = scramble(key ^ (np.uint64(np.int64(stream)) * SECOND + FIRST))
    return scramble(key + np.uint64(np.int64(count)) * GOLDEN)


@kernel
def uniform(seed: float, stream: float, count: float) -> float:
    """A uniform sample on [0, 1), in steps of 2^-53."""
    bits = random_bits(seed, stream, count)
    return np.float64(np.int64(bits >> BITS_11)) * 1.1102230246251565e-16


@kernel
def normals(seed: float, stream: float, count: float) -> tuple[float, float]:
    """Two independent standard normal samples (Box and Muller 1958), at most 6.8 in magnitude."""
    bits = random_bits(seed, stream, count)
    above = (np.float64(np.int64(bits >> BITS_32)) + 0.5) * 2.3283064365386963e-10
    turn = np.float64(np.int64(bits & LOW_32)) * 2.3283064365386963e-10
    radius = math.sqrt(-2.0 * log(above))
    s, c = sincos(TWO_PI * turn)
    return radius * c, radius * s


@kernel
def log(x: float) -> float:
    """Natural logarithm of a normal positive number; relative error below 1e-15 away from 1, absolute 1e-16 near 1.

    The series of fdlibm (Sun Microsystems, e_log.c) on [sqrt(1/2), sqrt(2)).
    """
    bits = np.float64(x).view(np.int64)
    exponent = np.float64((bits >> 52) - 1023)
    m = np.int64((bits & MANTISSA) | ONE).view(np.float64)
    high = m > 1.4142135623730951
    f = (0.5 * m if high else m) - 1.0
    exponent = exponent + 1.0 if high else exponent
    s = f / (2.0 + f)
    z = s * s
    w = z * z
    odd = z * (
        6.666666666666735130e-01
        + w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01))
    )
    even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01))
    half = 0.5 * f * f
    tail = s * (half + odd + even) + exponent * 1.90821492927058770002e-10
    return exponent * 6.93147180369123816490e-01 - ((half - tail) - f) + 0.0 * x


@kernel
def sample_number(t: float, period: float) -> float:
    """The number of periods that have ended by t, which is the index of the current sample."""
    return np.floor((t + INSTANT) / period)  # type: ignore[no-any-return]


@kernel
def onset(t: float, at: float, over: float) -> float:
    """0 before `at`, then a linear ramp to 1 over `over` [s]; a step if `over` is 0."""
    return clip((t + INSTANT - at) / (over + 1e-15), 0.0, 1.0)
