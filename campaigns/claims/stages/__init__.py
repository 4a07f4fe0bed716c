"""Sentences of the results of stages, from the numbers that the engine gives: no word of them is code of a run."""
