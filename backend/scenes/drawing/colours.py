"""Colours of values, as on the pages: viridis (S. van der Walt and N. Smith, matplotlib 1.5; CC0), a part of it.

The lowest values contrast most with the background in both themes; values remain distinguishable with colour blindness
and in grey. The pages' version is `frontend/src/run/space/colours.ts`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

VIRIDIS = np.array(
    [
        (68, 1, 84),
        (72, 36, 117),
        (65, 68, 135),
        (53, 95, 141),
        (42, 120, 142),
        (33, 145, 140),
        (34, 168, 132),
        (68, 191, 112),
        (122, 209, 81),
        (189, 223, 38),
        (253, 231, 37),
    ],
    dtype=np.float64,
)
"""The scale in steps of a tenth."""

PART = {False: (0.0, 0.58), True: (1.0, 0.41)}
"""The part of the scale used from lowest to highest value, in the light and in the dark theme."""


def colours(fractions: ArrayLike, dark: bool) -> NDArray[np.uint8]:
    """Red, green, blue (..., 3) for fractions (...) of the value range, 0 for the lowest; clipped to the range."""
    start, end = PART[dark]
    at = (start + np.clip(np.asarray(fractions, dtype=np.float64), 0.0, 1.0) * (end - start)) * (len(VIRIDIS) - 1)
    known = np.arange(len(VIRIDIS))
    return np.stack([np.interp(at, known, VIRIDIS[:, k]) for k in range(3)], axis=-1).round().astype(np.uint8)


def gradient(dark: bool, steps: int = 8) -> str:
    """The scale as a CSS background from left (lowest) to right; the highest values stand out."""
    found = colours(1.0 - np.linspace(0.0, 1.0, steps + 1), dark)
    return f"linear-gradient(90deg,{','.join(f'rgb({r},{g},{b})' for r, g, b in found.tolist())})"
