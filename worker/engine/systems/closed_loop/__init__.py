"""The closed loop of components as a system: simulation, noise realisations, traces, and avoider fields."""
