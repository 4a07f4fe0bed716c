"""Benchmarks: ratios measured in one run, printed and written to build/bench.json; never asserted."""
