"""A campaign run in this process, without a service: its progress, interruption, failures and files of results."""

RESULT = "result.json"
"""The file that makes a folder one with the results of `clearance run --out`."""
