"""Numbers pinned to the last digit that other machines reproduce, each with the reason why it is what it is."""
