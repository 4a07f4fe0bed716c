"""Evaluates functional mock-up units (FMI 2.0 and 3.0, co-simulation) in slots."""

JOB = "CLEARANCE_FMU"
"""The environment variable that names the file of a slot's job."""
