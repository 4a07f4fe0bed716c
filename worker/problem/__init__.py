"""What is asked of a campaign: ranges, distributions, threshold, criteria. Start reading at `problem`."""
