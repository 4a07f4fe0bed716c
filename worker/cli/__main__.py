"""`python -m worker.cli`: the command `clearance` where its script is not on the path."""

from worker.cli import main

if __name__ == "__main__":
    main()
