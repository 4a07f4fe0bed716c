"""How a worker lives: supervisor, child processes, live simulations, memory bounds. Start reading at `supervisor`."""
