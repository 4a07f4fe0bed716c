"""The command `clearance`, also `python -m worker`: readies its process, then `worker.cli` reads the command line."""

from __future__ import annotations

from worker.processes import blas as blas  # first: before numpy is loaded

# isort: split
from campaigns import heap  # next: loading is not interrupted

# isort: split
from worker.cli import main

heap.loaded()

if __name__ == "__main__":
    main()
