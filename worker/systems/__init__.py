"""What can be evaluated: the seam is `base`, the closed loop of components is one of the systems behind it."""
