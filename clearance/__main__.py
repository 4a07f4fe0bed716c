"""The command `clearance`, also `python -m clearance`: readies its process, then `clearance.cli` takes over."""

from clearance import starting  # first: an interrupt ends the process while the others are loaded

# isort: split
from worker.running.processes import blas as blas  # next: before numpy is loaded

# isort: split
from campaigns import heap  # next: loading is not interrupted

# isort: split
from clearance import cli

heap.loaded()


def main() -> None:
    """Run the command line and exit."""
    cli.load()
    starting.over()
    cli.main()


if __name__ == "__main__":
    main()
