"""Capsules: one file with one finding, and everything that evaluating it again needs."""
