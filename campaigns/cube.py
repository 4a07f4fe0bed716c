"""Converts between the unit cube and the parameters' units, bit-identical everywhere.

Fractions are of a parameter's range, 0 at its low bound.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def natural(shares: Floats, nominal: ArrayLike, low: ArrayLike, high: ArrayLike) -> Floats:
    """Fractions in the parameters' units: exact at the bounds and the nominal value, linear between them."""
    low, high = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    nominal = np.asarray(nominal, dtype=np.float64)
    values = np.where(shares == share(nominal, low, high), nominal, low + shares * (high - low))
    return np.asarray(np.where(shares <= 0.0, low, np.where(shares >= 1.0, high, values)))


def share(values: Floats, low: Floats, high: Floats) -> Floats:
    """Values in the parameters' units as fractions of their ranges."""
    return np.asarray((values - low) / (high - low))
