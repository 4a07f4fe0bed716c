"""Published figures on BBOB beside those of the board: the best of all algorithms of the archive for every target.

COCO's reference algorithms (Hansen et al., COCO, Optimization Methods and Software 2021), as its package `cocopp` 2.9.1
has them: for each function and target the least expected running time of 31 algorithms of BBOB-2009, and of all until
2016. One that knew beforehand which of them suits a function and a target would have these figures; no algorithm does.
`python -m tests.bench.scoreboard.published` computes them again from the package, where it is installed.
"""

from __future__ import annotations

import tarfile
from pathlib import Path

import numpy as np

from tests.bench.scoreboard.bbob import BUDGETS, DIMENSIONS, FUNCTIONS, TARGETS
from tests.bench.scoreboard.parts import Table
from tests.bench.scoreboard.peers import FOLDER

ORACLES = {"best2009-bbob": "Best of 2009 for each target", "best09-16-bbob": "Best until 2016 for each target"}
TEXT = (
    "Published, for the same targets and other instances: for each function and target the least expected running time "
    "of 31 algorithms of BBOB-2009, and of all until 2016 (COCO's reference algorithms in `cocopp` 2.9.1, computed by "
    "`python -m tests.bench.scoreboard.published`). No algorithm has these figures: each is the best of many."
)
FIGURES = {
    "best2009-bbob": {
        2: (0.605, 0.801, 0.951), 5: (0.430, 0.505, 0.769), 10: (0.321, 0.431, 0.730), 20: (0.270, 0.361, 0.681)
    },
    "best09-16-bbob": {
        2: (0.775, 0.868, 0.964), 5: (0.558, 0.664, 0.794), 10: (0.524, 0.627, 0.776), 20: (0.446, 0.583, 0.726)
    },
}  # fmt: skip
"""Share of the targets by dimension, at `BUDGETS`."""
TITLES = tuple(ORACLES.values())
TABLE: Table = {
    f"{dimension} parameters @ {budget}": {ORACLES[name]: by[dimension][k] for name, by in FIGURES.items()}
    for dimension in DIMENSIONS
    for k, budget in enumerate(BUDGETS)
}


def shares(name: str, folder: Path = FOLDER / "cocopp" / "refalgs") -> dict[int, tuple[float, ...]]:
    """The share of the targets that the reference algorithm of this name reaches, from the package's archive."""
    with tarfile.open(folder / f"{name}.tar.gz") as archive:
        return {
            dimension: tuple(
                round(float(np.mean([_reached(times, budget * dimension) for times in of])), 3) for budget in BUDGETS
            )
            for dimension in DIMENSIONS
            if (of := [_times(archive, f"{name}/bbob-bestalg_f{f:02d}_d{dimension:02d}.dat") for f in FUNCTIONS])
        }


def _times(archive: tarfile.TarFile, member: str) -> list[tuple[float, float]]:
    """Expected running times and the targets that they reach, of one function."""
    file = archive.extractfile(member)
    assert file is not None
    rows = (line.split() for line in file.read().decode().splitlines() if not line.startswith("%"))
    return [(float(time), float(target)) for time, target, *_ in rows]


def _reached(times: list[tuple[float, float]], evaluations: int) -> float:
    best = [min((time for time, target in times if target <= t * (1 + 1e-9)), default=np.inf) for t in TARGETS]
    return float(np.mean(np.array(best) <= evaluations))


if __name__ == "__main__":
    for oracle in ORACLES:
        print(oracle, shares(oracle))
