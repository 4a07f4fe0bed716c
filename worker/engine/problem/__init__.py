"""A campaign as a problem: ranges, distributions, threshold, criteria."""
