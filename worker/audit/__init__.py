"""A second opinion on a verdict: does it follow from what the run stored? Start reading at `judge.audit`."""
