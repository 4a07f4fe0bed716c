"""Reviewers' sign-offs of a run's results."""
