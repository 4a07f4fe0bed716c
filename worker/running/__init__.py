"""What changes neither a number nor a claim: runs, processes, and what is installed."""
