"""The processes of a worker: supervisor, child, live simulations, memory limits."""
