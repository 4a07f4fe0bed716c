"""The verdict of a run: evidence, the checks that must hold, and the sentences."""
