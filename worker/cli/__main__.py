"""`python -m worker.cli`: the command `clearance` as earlier versions were started. See `worker.__main__`."""

from worker.cli import main

if __name__ == "__main__":
    main()
