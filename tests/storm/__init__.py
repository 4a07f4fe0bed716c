"""Storms: real processes are hurt on purpose while runs go on, and what was lost, repeated or left behind is counted.

`make faults` runs all of it and prints one table; some of it is in `make nightly`.
"""
