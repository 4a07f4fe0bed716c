"""The closed loop of components: realisations of noise, traces, and the field of an avoider."""
