"""Sets the coefficients of how sure a search is, on the half for setting: `python -m tests.bench.scoreboard.fitted`.

[--seeds N] for 34 N landscapes. What it prints goes into `worker.evidence.verdicts.sureness` and, a second time, into
`worker.evidence.audit.sureness`.
"""

from __future__ import annotations

import os

import numpy as np

from tests.bench.scoreboard.__main__ import BUILD, parser
from tests.bench.scoreboard.bars import JUDGED
from tests.bench.scoreboard.cells import measured, versions
from tests.bench.scoreboard.parts import Request
from tests.bench.scoreboard.sureness import PART, statements
from worker.engine.search.base import Floats
from worker.evidence.verdicts.sureness import FEW, LOW, MODEL


def main() -> None:
    """Measure what is not stored, and print the coefficients."""
    asked = parser().parse_args()
    cells, file = PART.cells(Request("setting", (JUDGED,), asked.seeds)), BUILD / "scoreboard" / "setting.jsonl"
    rows = measured(cells, PART.measure, file, asked.processes or os.cpu_count() or 1, versions([JUDGED], PART.reach))
    for of, enough in (("few", LOW.enough), ("more", MODEL.enough)):
        chosen = [row for row in rows if (row.cell.dimension <= FEW) == (of == "few")]
        made = statements(chosen)
        counts = np.minimum([one.as_low for one in made], enough)
        constant, near = coefficients(np.log10(counts), np.array([one.lower for one in made]))
        print(f"{of} parameters, {len(chosen)} landscapes, {len(made)} statements: {constant:.3f}, near {near:.3f}")


def coefficients(near: Floats, lower: Floats) -> Floats:
    """The constant and the coefficient (2,) of a logistic regression, by Newton's method (Cox 1958)."""
    columns, found = np.stack([np.ones(len(near)), near], axis=1), np.zeros(2)
    for _ in range(50):
        chance = 1.0 / (1.0 + np.exp(-columns @ found))
        curvature = columns.T @ (columns * (chance * (1.0 - chance))[:, None])
        found = found + np.linalg.solve(curvature, columns.T @ (lower - chance))
    return found


if __name__ == "__main__":
    main()
