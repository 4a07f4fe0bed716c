"""The version of Clearance, as `pyproject.toml` states it."""

VERSION = "0.1.0"
