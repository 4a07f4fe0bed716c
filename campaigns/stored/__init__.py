"""What is stored of a run while it is executed: plans and states of stages, evaluations in columns, traces."""
