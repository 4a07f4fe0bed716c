"""Certified regions of attraction of the reversed Van der Pol oscillator beside the simulated one.

`python -m tests.bench.attraction` prints a table and writes build/attraction.json; it ends with 1 if a region is not
certified in rational arithmetic.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from campaigns.certificates import exact
from campaigns.certificates.coordinates import transformed
from campaigns.certificates.rays import directions, radii, volume
from tests.bench.attraction.truth import VAN_DER_POL, area_of_limit_cycle, exactly
from worker.engine.attraction import region

RAYS = 2_000
OUT = Path("build/attraction.json")


def simulated() -> float:
    """The area of the region within which the oscillator returns."""
    return area_of_limit_cycle(VAN_DER_POL, (2.0, 0.0))


def proved(degree: int) -> float | None:
    """The area certified with a V of this degree; None if there is none."""
    flow = [exactly(p) for p in VAN_DER_POL]
    found = region.found(flow, {}, degree)
    if isinstance(found, str) or exact.wrong(found.certificate, *transformed(flow, {}, found.matrix)):
        return None
    turned = abs(np.linalg.det(np.array(found.matrix, dtype=float)))
    return float(turned * volume(radii(found.certificate.v, directions(2, RAYS)), 2))


def main() -> int:
    true, rows = simulated(), list[dict[str, Any]]()
    print(f"simulated region: {true:.4f}")
    print("| degree of V | area proved | of the simulated one | s |")
    print("|---|---|---|---|")
    for degree in (2, 4, 6):
        began, area = time.perf_counter(), proved(degree)
        took, share = time.perf_counter() - began, None if area is None else area / true
        rows.append({"degree": degree, "area": area, "share": share, "seconds": took})
        stated = "none | none" if area is None or share is None else f"{area:.4f} | {share:.2%}"
        print(f"| {degree} | {stated} | {took:.1f} |", flush=True)
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text(json.dumps({"simulated": true, "proved": rows}, indent=2) + "\n", encoding="utf-8")
    return int(any(row["area"] is None for row in rows))


if __name__ == "__main__":
    sys.exit(main())
