"""The densities of a campaign's distributions, and what follows from them for evaluations that are stored."""
