"""Certified regions of attraction of the reversed Van der Pol oscillator beside the simulated one.

`PYTHONPATH=build/clarabel python -m tests.bench.attraction [ROUNDS]` prints a table; it ends with 1 if a certificate
does not hold in rational arithmetic. The solver: `pip install --no-deps --target build/clarabel clarabel`.
"""

from __future__ import annotations

import sys
import time
from fractions import Fraction
from importlib.util import find_spec

import numpy as np

from tests.bench.attraction import truth
from tests.bench.attraction.exact import certificate, proved
from tests.bench.attraction.iteration import Loop, grown, linear, multiplier
from tests.bench.attraction.polynomials import Polynomial, added
from tests.bench.attraction.program import Program, fixed

VAN_DER_POL: list[Polynomial] = [{(0, 1): -1}, {(1, 0): 1, (2, 1): 1, (0, 1): -1}]
"""x' = -y, y' = x + (x^2 - 1) y."""
LADDER = ((2, 1), (4, 2), (6, 3))
"""Degrees of V, and half of the multiplier's; each begins with the V of the one before."""
BACK = (1.0, 0.9999, 0.999, 0.99, 0.95)
"""Fractions of the level that are tried, because rounding needs room."""
EXACT_MARGIN = Fraction(1, 2**24)


def main() -> int:
    if find_spec("clarabel") is None:
        print("clarabel is not installed: pip install --no-deps --target build/clarabel clarabel")
        return 1
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    true, failed = truth.of_limit_cycle(VAN_DER_POL, (2.0, 0.0)), 0
    print(f"simulated region: {true:.4f}")
    print("| degree of V | of s | rounds | area found | area proved | of the simulated one | s |")
    print("|---|---|---|---|---|---|---|")
    v = linear(Loop(VAN_DER_POL, 2))
    for degree, half in LADDER:
        began, loop = time.perf_counter(), Loop(VAN_DER_POL, degree, half)
        every = list(grown(loop, rounds, v))
        v = max(every, key=truth.area)
        proved_area = exactly(loop, v)
        failed += proved_area is None
        shown = "none | none" if proved_area is None else f"{proved_area:.4f} | {proved_area / true:.2%}"
        took = time.perf_counter() - began
        print(f"| {degree} | {2 * half} | {len(every)} | {truth.area(v):.4f} | {shown} | {took:.0f} |", flush=True)
    return int(failed > 0)


def exactly(loop: Loop, v: Polynomial) -> float | None:
    """The area of the largest region {V < level} whose certificate holds exactly."""
    for level in BACK:
        scaled = {m: c / level for m, c in v.items()}
        found, positive = multiplier(loop, scaled, 1.0), _positive(loop, scaled)
        if found is None or positive is None:
            continue
        program, _, x = found
        grams = {"multiplier": program.gram(x, 0), "decrease": program.gram(x, 1), "positive": positive}
        rounded = certificate(scaled, grams, loop.field, EXACT_MARGIN, loop.bases)
        if proved(rounded, loop.field, EXACT_MARGIN, loop.bases):
            return truth.area(rounded.v)
    return None


def _positive(loop: Loop, v: Polynomial) -> np.ndarray | None:
    """The Gram matrix of V - margin |x|^2."""
    program = Program()
    program.is_squares(fixed(added((1.0, v), (-1.0, loop.size))), loop.bases["positive"])
    found = program.solved()
    return None if found is None else program.gram(found[1], 0)


if __name__ == "__main__":
    sys.exit(main())
