"""What is asked of a campaign and what is simulated for it. Start reading at `problem`."""
