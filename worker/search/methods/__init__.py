"""The search methods, one file each, found by presence; the contract is in `worker.search.base`."""
