"""Evaluations, findings and traces of a run."""
