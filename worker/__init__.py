"""The physics and the search. Start reading at `worker.systems.base`."""
