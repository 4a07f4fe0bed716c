"""Systems that can be evaluated: `base` is the interface, `closed_loop` and `simulators` implement it."""
