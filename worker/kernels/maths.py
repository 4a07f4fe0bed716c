"""The `kernel` decorator, and elementary functions without branches or libm, so that the lane loop vectorises.

Minimax polynomials of the Cephes library (S. L. Moshier): sin and cos on [-pi/4, pi/4] after Cody-Waite reduction in
two parts, atan on [-tan(pi/8), tan(pi/8)]. Every function keeps NaN. Errors are measured in tests/unit/test_maths.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

FLAGS: dict[str, Any] = {"fastmath": {"contract", "reassoc", "arcp", "nsz"}, "error_model": "numpy"}
"""Reordering and fused operations are allowed, assuming away NaN or infinity is not: a lost NaN is a lost failure."""

PI = 3.141592653589793
TWO_PI = 6.283185307179586
HALF_PI = 1.5707963267948966


def kernel(function: F) -> F:
    """Mark plain scalar Python on floats and tuples as a part of a compiled loop; it is always inlined."""
    compiled: F = njit(forceinline=True, **FLAGS)(function)
    return compiled


@kernel
def sincos(x: float) -> tuple[float, float]:
    """Sine and cosine of x [rad]; absolute error below 2e-15 for |x| <= 30, below 5e-12 for |x| <= 1e5."""
    q = np.floor(x * 0.6366197723675814 + 0.5)
    r = (x - q * 1.5707963267948966) - q * 6.123233995736766e-17
    z = r * r
    s = r + r * z * (
        -1.66666666666666307295e-1
        + z
        * (
            8.33333333332211858878e-3
            + z
            * (
                -1.98412698295895385996e-4
                + z * (2.75573136213857245213e-6 + z * (-2.50507477628578072866e-8 + z * 1.58962301576546568060e-10))
            )
        )
    )
    c = (
        1.0
        - 0.5 * z
        + z
        * z
        * (
            4.16666666666665929218e-2
            + z
            * (
                -1.38888888888730564116e-3
                + z
                * (
                    2.48015872888517045348e-5
                    + z
                    * (-2.75573141792967388112e-7 + z * (2.08757008419747316778e-9 + z * -1.13585365213876817300e-11))
                )
            )
        )
    )
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
    p = (
        ((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z
        - 1.228866684490136173410e2
    ) * z - 6.485021904942025371773e1
    q = (
        (((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z
        + 4.853903996359136964868e2
    ) * z + 1.945506571482613964425e2
    angle = offset + reduced + reduced * z * p / q
    angle = HALF_PI - angle if ay > ax else angle
    angle = PI - angle if x < 0.0 else angle
    angle = -angle if y < 0.0 else angle
    return angle + 0.0 * (x + y)  # a comparison with NaN is False: without this a NaN would end as an angle


@kernel
def clip(x: float, low: float, high: float) -> float:
    """x held within [low, high]; NaN stays NaN."""
    x = low if x < low else x
    return high if x > high else x


@kernel
def wrap(angle: float) -> float:
    """The angle in [-pi, pi) [rad]."""
    return angle - TWO_PI * np.floor((angle + PI) / TWO_PI)  # type: ignore[no-any-return]


@kernel
def norm2(x: float, y: float) -> float:
    """Length of the plane vector (x, y)."""
    return math.sqrt(x * x + y * y)
