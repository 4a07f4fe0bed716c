"""The parameter space, shown instead of the flights: a run's evaluations as points."""
