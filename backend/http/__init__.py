"""Shared by all endpoints: reading requests, dependencies, and writing responses, errors and pages."""
