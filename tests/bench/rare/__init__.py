"""The estimate of rare violations on problems of known probability: `python -m tests.bench.rare`."""
