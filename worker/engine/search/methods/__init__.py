"""The search methods, one file each, discovered automatically; their interface is `worker.engine.search.base`."""
