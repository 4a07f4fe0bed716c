"""`python -m tests.bench`: see `tests.bench.bench`."""

from tests.bench.bench import main

main()
