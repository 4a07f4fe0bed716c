"""`clearance.search`: the worst case of a Python function, from the arguments of the call to the result as arrays."""
