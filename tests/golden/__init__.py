"""Regression values, pinned to the last digit that other machines reproduce, with explanations."""
