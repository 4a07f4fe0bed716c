"""Certified regions of attraction of the reversed Van der Pol oscillator beside the simulated one.

`python -m tests.bench.attraction` prints a table; it ends with 1 if a region is not certified in rational arithmetic.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from campaigns.certificates import exact
from campaigns.certificates.coordinates import transformed
from campaigns.certificates.polynomials import exactly
from campaigns.certificates.rays import directions, radii, volume
from tests.bench.attraction.truth import VAN_DER_POL, area_of_limit_cycle
from worker.engine.attraction import region

RAYS = 2_000


def main() -> int:
    flow, failed = [exactly(p) for p in VAN_DER_POL], 0
    true = area_of_limit_cycle(VAN_DER_POL, (2.0, 0.0))
    print(f"simulated region: {true:.4f}")
    print("| degree of V | area proved | of the simulated one | s |")
    print("|---|---|---|---|")
    for degree in (2, 4, 6):
        began, found = time.perf_counter(), region.found(flow, {}, degree)
        took = time.perf_counter() - began
        if isinstance(found, str) or exact.wrong(found.certificate, *transformed(flow, {}, found.matrix)):
            failed += 1
            print(f"| {degree} | none | none | {took:.1f} |")
            continue
        turned = abs(np.linalg.det(np.array(found.matrix, dtype=float)))
        area = turned * volume(radii(found.certificate.v, directions(2, RAYS)), 2)
        print(f"| {degree} | {area:.4f} | {area / true:.2%} | {took:.1f} |", flush=True)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
