"""The command `clearance`, also `python -m clearance`: readies its process, then `clearance.cli` takes over."""

from worker.running.processes import blas as blas  # first: before numpy is loaded

# isort: split
from campaigns import heap  # next: loading is not interrupted

# isort: split
from clearance.cli import main

heap.loaded()

if __name__ == "__main__":
    main()
