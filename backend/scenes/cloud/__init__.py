"""The parameter space in place of the flights: a run's evaluations as points."""
