"""How often the interval of a re-weighted estimate has the exact probability: `python -m tests.bench.moved`.

Cases of `tests.given.moved_distributions`, 1,000 samples each, and 60 pairs of regions at random, 100 samples each.
"""

from __future__ import annotations

import numpy as np

from tests.given.moved_distributions import PAIRS, SINGLE, coverage, random_pairs

SAMPLES, RANDOM, OF_RANDOM, SEED = 1000, 60, 100, 20261
LEAST = 50
"""Fewer estimates of a case, the others being refused, give no fraction."""


def main() -> None:
    for name, case in (SINGLE | PAIRS).items():
        found = coverage(case, range(SAMPLES))
        print(
            f"{name}: {case.draws} draws, P {case.exact:.3%}, {found.made} made, held by {found.held:.1%} (below P "
            f"{found.below:.1%}, above {found.above:.1%}), mean width {found.width:.4f}",
            flush=True,
        )
    of_pairs = [coverage(case, range(OF_RANDOM)) for case in random_pairs(RANDOM, SEED)]
    held = np.array([one.held for one in of_pairs if one.made >= LEAST])
    print(f"{len(held)} pairs at random: held by {held.min():.1%} at least, {np.mean(held):.1%} in the mean")


if __name__ == "__main__":
    main()
