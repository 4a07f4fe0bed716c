"""Functions of affine numbers: value, slope, curvature at the centre, a bound on the third derivative.

The declared errors of sine, cosine and arctangent (5e-15, 4e-15) cover those of the product's polynomials as well.
"""

from __future__ import annotations

import math

from tests.bench.proof.rows import (
    UP,
    bounds,
    chord,
    constant,
    copy,
    expand,
    interval,
    jit,
    lin1,
    lin2,
    lin3,
    mul,
    radii,
)

PI = 3.141592653589793


@jit
def sincos(w, os, oc, x, s):
    """os = sin x, oc = cos x; oc and os are not x."""
    c = w[x, 0]
    l, g = radii(w, x, s)
    r = l + g
    if not (r < 1.5 and abs(c) < 1e4):
        interval(w, os, -1.0, 1.0)
        interval(w, oc, -1.0, 1.0)
        return
    a, b = math.sin(c), math.cos(c)
    extra = r * r * r / 6.0 + 5e-15 + 2e-16 * abs(c)
    expand(w, os, x, a, b, -a, extra, s)
    expand(w, oc, x, b, -a, -b, extra, s)


@jit
def recip(w, o, x, s):
    c = w[x, 0]
    low, high = bounds(w, x, s)
    if not (low > 0.0 or high < 0.0):
        interval(w, o, 1.0, 0.0)
        return
    near = low if low > 0.0 else -high
    r = 0.5 * (high - low)
    i = 1.0 / c
    expand(w, o, x, i, -i * i, 2.0 * i * i * i, r * r * r * abs(i * i * i) / near * UP, s)


@jit
def root(w, o, x, s):
    c = w[x, 0]
    low, high = bounds(w, x, s)
    if not low > 0.0:
        if high >= 0.0 and low <= high:
            interval(w, o, 0.0, math.sqrt(high) * UP)  # of a value that cannot be negative
        else:
            interval(w, o, 1.0, 0.0)
        return
    r = 0.5 * (high - low)
    q = math.sqrt(c)
    extra = r * r * r / (16.0 * low * low * math.sqrt(low)) * UP
    if extra > q:
        interval(w, o, math.sqrt(low) / UP, math.sqrt(high) * UP)
        return
    expand(w, o, x, q, 0.5 / q, -0.25 / (q * c), extra, s)


@jit
def angle(w, o, x, y, a, b, periodic, s):
    """o = atan2(y, x), up to whole turns if `periodic`; a, b: two rows to work in.

    With z the centre and A + iB = ((x, y) - z) / z the angle is arg z + B - A B + ..., and its third derivatives are at
    most 2 / (1 - |A + iB|)^3.
    """
    p, q = w[x, 0], w[y, 0]
    rr = p * p + q * q
    if not rr > 0.0:
        interval(w, o, 1.0, 0.0)
        return
    lin2(w, a, p / rr, x, q / rr, y, 0.0)
    w[a, 0] = 0.0
    lin2(w, b, -q / rr, x, p / rr, y, 0.0)
    w[b, 0] = 0.0
    la, ga = radii(w, a, s)
    lb, gb = radii(w, b, s)
    t = math.sqrt((la + ga) * (la + ga) + (lb + gb) * (lb + gb)) * UP
    arg = math.atan2(q, p)
    arc = math.asin(t) * UP + 1e-14 if t < 0.9 else math.inf
    if (not periodic and abs(arg) + arc > 3.14159265358979) or not t < 0.9:
        known = w[x, 1] < math.inf and w[y, 1] < math.inf
        interval(w, o, -3.141592653589794 if known else 1.0, 3.141592653589794 if known else 0.0)  # any angle
        return
    left = 1.0 - t
    mul(w, o, a, b, s)
    lin2(w, o, -1.0, o, 1.0, b, arg)
    w[o, 1] += (t * t * t * UP / (3.0 * left * left * left) + 4e-15) * UP
    w[o, 2] += w[o, 1]
    if not w[o, 1] < arc:
        interval(w, o, arg - arc, arg + arc)


@jit
def absolute(w, o, x, s):
    low, high = bounds(w, x, s)
    if low >= 0.0:
        copy(w, o, x)
    elif high <= 0.0:
        lin1(w, o, -1.0, x, 0.0)
    elif low < 0.0 and high > 0.0:
        slope = (high + low) / (high - low)
        slope = min(1.0, max(-1.0, slope))
        top = max(high - slope * high, -low - slope * low)
        chord(w, o, x, slope, 0.0, top * UP)
    else:
        interval(w, o, 1.0, 0.0)


@jit
def largest(w, o, x, y, a, s):
    """o = max(x, y); a: a row to work in."""
    lin2(w, a, 1.0, x, -1.0, y, 0.0)
    low, high = bounds(w, a, s)
    if low >= 0.0:
        copy(w, o, x)
    elif high <= 0.0:
        copy(w, o, y)
    else:
        absolute(w, a, a, s)
        lx, hx = bounds(w, x, s)
        ly, hy = bounds(w, y, s)
        lin3(w, o, 0.5, x, 0.5, y, 0.5, a, 0.0)
        low, high = bounds(w, o, s)
        if high - low > max(hx, hy) - max(lx, ly):
            interval(w, o, max(lx, ly), max(hx, hy))


@jit
def _firas(g, d_0):
    return (d_0 - g) / (d_0 * g * g * g)


@jit
def firas(w, o, x, d_0, s):
    """o = (1/g - 1/d_0) / g^2 for g <= d_0, else 0: convex and falling; g must stay above 1 mm."""
    low, high = bounds(w, x, s)
    if not low > 2e-3:
        interval(w, o, 1.0, 0.0)
    elif low >= d_0:
        constant(w, o, 0.0)
    elif high <= d_0:
        g = w[x, 0]
        r = 0.5 * (high - low)
        f0 = (d_0 - g) / (d_0 * g * g * g)
        f1 = (2.0 * g - 3.0 * d_0) / (d_0 * g * g * g * g)
        f2 = (12.0 * d_0 - 6.0 * g) / (d_0 * g * g * g * g * g)
        third = (60.0 - 24.0 * low / d_0) / (low * low * low * low * low * low)
        slack = 1e-14 * (1.0 + abs(1.0 / g)) * (1.0 / (g * g * g) + r / (g * g * g * g) + r * r / (g * g * g * g * g))
        expand(w, o, x, f0, f1, f2, (third * r * r * r / 6.0 + slack) * UP, s)
    elif low < d_0:
        top = _firas(low, d_0)
        slope = -top / (high - low)
        upper = max(top - slope * low, -slope * high)
        g = d_0
        if slope < -1.0 / (d_0 * d_0 * d_0 * d_0):
            a, b = low, d_0
            for _ in range(50):  # where the derivative equals the slope; any point between serves
                g = 0.5 * (a + b)
                if (2.0 * g - 3.0 * d_0) / (d_0 * g * g * g * g) < slope:
                    a = g
                else:
                    b = g
            d = (2.0 * g - 3.0 * d_0) / (d_0 * g * g * g * g) - slope
            lower = _firas(g, d_0) - slope * g - abs(d) * (high - low)
        else:
            lower = -slope * d_0
        room = 1e-14 * (abs(upper) + abs(lower) + top + abs(slope) * high)
        chord(w, o, x, slope, lower - room, upper + room)
    else:
        interval(w, o, 1.0, 0.0)


@jit
def limited(w, o, x, low, high, a, b, s):
    """o = x within [low, high]; a, b: rows to work in; o is not x."""
    lo, hi = bounds(w, x, s)
    if lo >= low and hi <= high:
        copy(w, o, x)
        return
    constant(w, b, low)
    largest(w, o, x, b, a, s)
    if bounds(w, o, s)[1] <= high:
        return
    if bounds(w, o, s)[0] >= high:
        constant(w, o, high)
        return
    constant(w, b, high)
    lin2(w, a, 1.0, o, -1.0, b, 0.0)
    absolute(w, a, a, s)
    lin3(w, o, 0.5, o, 0.5, b, -0.5, a, 0.0)


@jit
def hull(w, o, x, y, a, s):
    """o = x or y: their mean and half their difference; a: a row to work in."""
    lin2(w, a, 0.5, x, -0.5, y, 0.0)
    low, high = bounds(w, a, s)
    lin2(w, o, 0.5, x, 0.5, y, 0.0)
    w[o, 1] += max(abs(low), abs(high)) * UP if low <= high else math.inf
    w[o, 2] += w[o, 1]


@jit
def chosen(w, o, c, x, y, a, s):
    """o = x if c > 0 else y; a: a row to work in."""
    low, high = bounds(w, c, s)
    if low > 0.0:
        copy(w, o, x)
    elif high <= 0.0:
        copy(w, o, y)
    else:
        hull(w, o, x, y, a, s)


@jit
def frozen(w, o, wanted, push, rate, low, high, a, s):
    """o = 0 where `wanted` is beyond its limits in the direction of `push`, else rate; a: a row to work in."""
    from_, to = bounds(w, wanted, s)
    least, most = bounds(w, push, s)
    above, below = to > high, from_ < low
    never = not ((above and most > 0.0) or (below and least < 0.0)) and from_ <= to and least <= most
    always = (from_ > high and least > 0.0) or (to < low and most < 0.0)
    constant(w, o, 0.0)
    if never:
        copy(w, o, rate)
    elif not always:
        hull(w, o, rate, o, a, s)


@jit
def wrapped(w, o, x, s):
    """o = x less the multiple of 2 pi that puts it into [-pi, pi)."""
    low, high = bounds(w, x, s)
    first = math.floor((low - 1e-14 + PI) / (2.0 * PI))
    last = math.floor((high + 1e-14 + PI) / (2.0 * PI))
    if first == last:
        lin1(w, o, 1.0, x, -2.0 * PI * first)
    elif low <= high:
        interval(w, o, -PI - 1e-15, PI + 1e-15)
    else:
        interval(w, o, 1.0, 0.0)
