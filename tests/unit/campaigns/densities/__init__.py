"""The densities of a campaign's distributions."""
