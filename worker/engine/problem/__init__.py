"""A campaign as a problem: ranges, distributions, threshold, criteria. Start reading at `problem`."""
