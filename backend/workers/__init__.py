"""The workers: whether one is alive, and what each executes."""
