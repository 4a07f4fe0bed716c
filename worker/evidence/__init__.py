"""What may change a claim, but no number: verdicts and the independent audit."""
