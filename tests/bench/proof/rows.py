"""Affine numbers of order 2 (Taylor models with a polynomial of degree 2) with outward rounding.

A number is a row of a table,

    centre, rest, size | linear 0..n-1 | products i<=j | frame 0.. | fresh 0.. | cross i k

for every value  centre + sum(linear_i e_i) + sum(product_ij e_i e_j) + sum(frame_k f_k) + sum(fresh_k g_k) +
sum(cross_ik e_i f_k) + r  with all e, f, g in [-1, 1] and |r| <= rest. e: the uncertain parameters, kept for the whole
flight; f: the symbols that re-enter at every step; g: those born in it. size bounds the magnitudes and serves for
rounding alone. Every operation adds ULPS of the magnitudes that entered it to `rest`, three times what rounding to
nearest needs in any order, fused or not: a row holds the real result, and the rounded one as flown. What cannot be
bounded has rest = inf.
Stolfi and de Figueiredo, Self-validated numerical methods (1997); Makino and Berz, Taylor models (2003).
"""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

from worker.engine.kernels.cached import cached

jit = partial(cached, error_model="numpy", nogil=True, fastmath={"contract", "reassoc", "nsz"})
ULPS = 2e-15
UP = 1.0 + 4e-14
"""Covers the rounding of a sum of up to 250 positive terms, and of what is computed from it."""
TINY = 1e-290
"""Covers underflow."""
LINEAR = 3


class Shape(NamedTuple):
    """Where the parts of a row begin."""

    n: int
    products: int
    frame: int
    fresh: int
    cross: int
    used: int
    width: int


def shape(n: int, frame: int, fresh: int, crossed: bool) -> Shape:
    """n parameters, symbols that re-enter, symbols born in a step, and whether e_i f_k are kept."""
    at = [LINEAR + n]
    for more in (n * (n + 1) // 2, frame, fresh, n * frame if crossed else 0):
        at.append(at[-1] + more)
    return Shape(n, at[0], at[1], at[2], at[3], at[4], (at[4] + 7) // 8 * 8)


@jit
def constant(w, o, c):
    w[o, :] = 0.0
    w[o, 0] = c
    w[o, 2] = abs(c)


@jit
def parameter(w, o, i, low, high):
    """The i-th uncertain parameter on [low, high]."""
    w[o, :] = 0.0
    c = 0.5 * (low + high)
    w[o, 0] = c
    w[o, LINEAR + i] = 0.5 * (high - low) * UP
    w[o, 2] = (abs(c) + w[o, LINEAR + i]) * UP
    w[o, 1] = ULPS * w[o, 2]


@jit
def copy(w, o, x):
    for j in range(w.shape[1]):
        w[o, j] = w[x, j]


@jit
def radii(w, x, s):
    """The radius of the linear part in the parameters, and of all the rest."""
    a = 0.0
    for j in range(LINEAR, s.products):
        a += abs(w[x, j])
    b = 0.0
    for j in range(s.products, s.used):
        b += abs(w[x, j])
    return a * UP + TINY, (b + w[x, 1]) * UP + TINY


@jit
def parts(w, x, s):
    """As `radii`, in three: linear, frame, all the rest."""
    a = 0.0
    for j in range(LINEAR, s.products):
        a += abs(w[x, j])
    f = 0.0
    for j in range(s.frame, s.fresh):
        f += abs(w[x, j])
    b = 0.0
    for j in range(s.products, s.frame):
        b += abs(w[x, j])
    for j in range(s.fresh, s.used):
        b += abs(w[x, j])
    return a * UP + TINY, f * UP + TINY, (b + w[x, 1]) * UP + TINY


@jit
def bounds(w, x, s):
    """The range of a row."""
    a, b = radii(w, x, s)
    r = (a + b) * UP + ULPS * abs(w[x, 0])
    return w[x, 0] - r, w[x, 0] + r


@jit
def lin1(w, o, a, x, k):
    """o = a x + k"""
    for j in range(w.shape[1]):
        w[o, j] = a * w[x, j]
    w[o, 0] += k
    m = abs(a) * abs(w[x, 2]) + abs(k)
    w[o, 2] = m * UP
    w[o, 1] = abs(a) * abs(w[x, 1]) * UP + ULPS * m + TINY


@jit
def lin2(w, o, a, x, b, y, k):
    """o = a x + b y + k"""
    rest = abs(a) * w[x, 1] + abs(b) * w[y, 1]
    m = abs(a) * w[x, 2] + abs(b) * w[y, 2] + abs(k)
    for j in range(w.shape[1]):
        w[o, j] = a * w[x, j] + b * w[y, j]
    w[o, 0] += k
    w[o, 2] = m * UP
    w[o, 1] = rest * UP + ULPS * m + TINY


@jit
def lin3(w, o, a, x, b, y, c, z, k):
    """o = a x + b y + c z + k"""
    rest = abs(a) * w[x, 1] + abs(b) * w[y, 1] + abs(c) * w[z, 1]
    m = abs(a) * w[x, 2] + abs(b) * w[y, 2] + abs(c) * w[z, 2] + abs(k)
    for j in range(w.shape[1]):
        w[o, j] = a * w[x, j] + b * w[y, j] + c * w[z, j]
    w[o, 0] += k
    w[o, 2] = m * UP
    w[o, 1] = rest * UP + ULPS * m + TINY


@jit
def combine(w, o, x, q, k1, k2, k3, k4):
    """o = x + q (k1 + 2 k2 + 2 k3 + k4)"""
    rest = w[x, 1] + q * (w[k1, 1] + 2.0 * w[k2, 1] + 2.0 * w[k3, 1] + w[k4, 1])
    m = w[x, 2] + q * (w[k1, 2] + 2.0 * w[k2, 2] + 2.0 * w[k3, 2] + w[k4, 2])
    for j in range(w.shape[1]):
        w[o, j] = w[x, j] + q * (w[k1, j] + 2.0 * (w[k2, j] + w[k3, j]) + w[k4, j])
    w[o, 2] = m * UP
    w[o, 1] = rest * UP + ULPS * m + TINY


@jit
def mul(w, o, x, y, s):
    """o = x y; o is neither x nor y."""
    c, d = w[x, 0], w[y, 0]
    lx, fx, gx = parts(w, x, s)
    ly, fy, gy = parts(w, y, s)
    rest = abs(c) * w[y, 1] + abs(d) * w[x, 1] + lx * gy + ly * gx + (fx + gx) * (fy + gy)
    if s.used == s.cross:
        rest += lx * fy + ly * fx
    gx += fx
    gy += fy
    for j in range(w.shape[1]):
        w[o, j] = c * w[y, j] + d * w[x, j]
    w[o, 0] = c * d
    at = s.products
    for i in range(s.n):
        a, b = w[x, LINEAR + i], w[y, LINEAR + i]
        w[o, at] += a * b
        at += 1
        for j in range(i + 1, s.n):
            w[o, at] += a * w[y, LINEAR + j] + b * w[x, LINEAR + j]
            at += 1
    if s.used > s.cross:
        at = s.cross
        for i in range(s.n):
            a, b = w[x, LINEAR + i], w[y, LINEAR + i]
            for j in range(s.frame, s.fresh):
                w[o, at] += a * w[y, j] + b * w[x, j]
                at += 1
    m = (abs(c) + lx + gx) * (abs(d) + ly + gy)
    w[o, 2] = m * UP
    w[o, 1] = rest * UP + 2.0 * ULPS * m + TINY


@jit
def expand(w, o, x, f0, f1, f2, extra, s):
    """o = f(x) from value, slope and curvature at the centre of x, and a bound on all else; o may be x."""
    l, f, g = parts(w, x, s)
    rest = abs(f1) * w[x, 1] + extra
    crossed = s.used > s.cross
    for j in range(s.products, s.frame):
        w[o, j] = f1 * w[x, j]
    for j in range(s.cross, w.shape[1]):
        w[o, j] = f1 * w[x, j]
    at = s.products
    across = s.cross
    for i in range(s.n):
        a = w[x, LINEAR + i]
        w[o, at] += 0.5 * f2 * a * a
        at += 1
        for j in range(i + 1, s.n):
            w[o, at] += f2 * a * w[x, LINEAR + j]
            at += 1
        if crossed:
            for j in range(s.frame, s.fresh):
                w[o, across] += f2 * a * w[x, j]
                across += 1
    for j in range(LINEAR, s.products):
        w[o, j] = f1 * w[x, j]
    for j in range(s.frame, s.cross):
        w[o, j] = f1 * w[x, j]
    q = f + g
    w[o, 0] = f0 + 0.25 * f2 * q * q  # the square of what is not linear in e lies in [0, q^2]
    rest += abs(f2) * (l * g + 0.25 * q * q)
    if not crossed:
        rest += abs(f2) * l * f
    g += f
    r = l + g
    m = abs(f0) + abs(f1) * r + abs(f2) * r * r + extra
    w[o, 2] = m * UP
    w[o, 1] = rest * UP + 2.0 * ULPS * m + TINY


@jit
def interval(w, o, low, high):
    """o = anything in [low, high]; rest = inf if this is no interval."""
    w[o, :] = 0.0
    if low <= high:
        w[o, 0] = 0.5 * (low + high)
        w[o, 1] = 0.5 * (high - low) * UP + ULPS * (abs(low) + abs(high)) + TINY
        w[o, 2] = (abs(w[o, 0]) + w[o, 1]) * UP
    else:
        w[o, 1] = math.inf
        w[o, 2] = math.inf


@jit
def chord(w, o, x, slope, low, high):
    """o = slope x + anything in [low, high]"""
    m = abs(slope) * w[x, 2] + abs(low) + abs(high)
    rest = abs(slope) * w[x, 1]
    for j in range(LINEAR, w.shape[1]):
        w[o, j] = slope * w[x, j]
    w[o, 0] = slope * w[x, 0] + 0.5 * (low + high)
    w[o, 2] = m * UP
    w[o, 1] = (rest + 0.5 * (high - low)) * UP + 2.0 * ULPS * m + TINY


@jit
def square(w, o, x, s):
    c = w[x, 0]
    expand(w, o, x, c * c, 2.0 * c, 2.0, 0.0, s)


@jit
def born(w, x, k, s):
    """The rest of a row becomes fresh symbol k, so that what follows can cancel it."""
    w[x, s.fresh + k] = w[x, 1]
    w[x, 1] = 0.0
