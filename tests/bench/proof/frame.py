"""The frame: everything of a state that is no polynomial of the parameters, enclosed by as many symbols as states.

Lohner, Einschliessung der Loesung gewoehnlicher Anfangs- und Randwertaufgaben (1988): orthogonal directions, longest
generator first. Here they are orthogonal in the metric of what errors do later, from a backward sweep of the nominal
flight (`weights`). Soundness does not rest on it: what the subtraction leaves is added to the remainders.
"""

from __future__ import annotations

import math

import numpy as np

from tests.bench.proof.rows import LINEAR, TINY, UP, jit


@jit
def reframed(w, x0, n, s, g, metric, back):
    """Rows x0..x0+n-1 get n new frame symbols. metric: coordinates z = metric x; back: its inverse, as computed."""
    count = s.used - s.frame
    columns = count + n
    total = 0.0
    for i in range(n):
        for j in range(count):
            g[i, j] = w[x0 + i, s.frame + j]
        for j in range(n):
            g[i, count + j] = 0.0
        g[i, count + i] = w[x0 + i, 1]
        for j in range(s.frame, s.used):
            w[x0 + i, j] = 0.0
    z = np.zeros((n, columns))
    for i in range(n):
        for k in range(n):
            m = metric[i, k]
            if m != 0.0:
                for j in range(columns):
                    z[i, j] += m * g[k, j]
    lengths = np.zeros(columns)
    for i in range(n):
        for j in range(columns):
            lengths[j] += z[i, j] * z[i, j]
    size = np.zeros(n)
    for i in range(n):
        for j in range(columns):
            size[i] += abs(g[i, j])
    q = np.zeros((n, n))
    part = np.zeros(columns)
    way = np.zeros(n)
    for j in range(columns):
        total += math.sqrt(lengths[j])
    for k in range(n):
        best = 0
        for j in range(columns):
            if lengths[j] > lengths[best]:
                best = j
        norm = math.sqrt(lengths[best])
        if not norm > 1e-18 * total:
            break
        for i in range(n):
            q[k, i] = z[i, best] / norm
        for j in range(k):  # once more orthogonal
            dot = 0.0
            for i in range(n):
                dot += q[k, i] * q[j, i]
            for i in range(n):
                q[k, i] -= dot * q[j, i]
        norm = 0.0
        for i in range(n):
            norm += q[k, i] * q[k, i]
        norm = 1.0 / math.sqrt(norm)
        part[:] = 0.0
        for i in range(n):
            q[k, i] *= norm
            for j in range(columns):
                part[j] += q[k, i] * z[i, j]
        r = 0.0
        for j in range(columns):
            r += abs(part[j])
        for i in range(n):
            way[i] = 0.0
            for j in range(n):
                way[i] += back[i, j] * q[k, j]
        lengths[:] = 0.0
        for i in range(n):
            v = q[k, i]
            for j in range(columns):
                z[i, j] -= v * part[j]
                lengths[j] += z[i, j] * z[i, j]
                g[i, j] -= way[i] * part[j]
            size[i] += abs(way[i]) * r
            w[x0 + i, s.frame + k] = way[i] * r * UP
    for i in range(n):
        r = 0.0
        for j in range(columns):
            r += abs(g[i, j])
        w[x0 + i, 1] = r * UP + 2e-14 * size[i] + TINY
        m = abs(w[x0 + i, 0]) + w[x0 + i, 1]
        for j in range(LINEAR, s.used):
            m += abs(w[x0 + i, j])
        w[x0 + i, 2] = m * UP


def weights(jacobians, scale, last, floor):  # type: ignore[no-untyped-def]
    """Per step the metric and its inverse: how much an error of the state matters until step `last`.

    jacobians (steps, n, n) of the nominal flight's steps; scale (n,): how much of each state matters in itself at every
    step; floor: the least share of the largest weight.
    """
    steps, n, _ = jacobians.shape
    gram = np.diag(scale**2)
    metric, back = np.empty((2, steps, n, n))
    for i in reversed(range(steps)):
        # the metric of step i serves the frame at its end
        lengths = np.sqrt(np.diag(gram))
        unit = gram / np.outer(lengths, lengths) + floor * np.eye(n)
        metric[i] = np.linalg.cholesky(unit).T * lengths
        back[i] = np.linalg.inv(metric[i])
        gram = jacobians[i].T @ gram @ jacobians[i] + np.diag(scale**2) if i < last else np.diag(scale**2)
    return metric, back
