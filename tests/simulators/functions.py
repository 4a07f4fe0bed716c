"""A decorated function of whole batches: two basins."""

from __future__ import annotations

from typing import Any

import numpy as np

import clearance
from tests.simulators import isolated, two_basins
from tests.simulators.isolated import PARAMETERS, RESULTS


@clearance.simulator(parameters=PARAMETERS, results=RESULTS, isolated=False, vectorized=True)
def together(x: Any, y: Any) -> dict[str, Any]:
    """Two basins, a batch at a time."""
    if np.any(y > isolated.OUTSIDE):
        raise clearance.Excluded("starts  outside\nthe range")
    return {"separation": np.where(y > two_basins.BROKEN, np.nan, two_basins.separation(x, y)), "effort": x}
