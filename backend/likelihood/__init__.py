"""The most likely violation of a run, and its sample under other distributions."""
