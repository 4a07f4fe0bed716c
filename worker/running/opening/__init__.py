"""Creates the system that a campaign names, and its problem."""
