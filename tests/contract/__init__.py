"""What every component and every method must keep, whoever adds it: found by presence, like themselves."""
