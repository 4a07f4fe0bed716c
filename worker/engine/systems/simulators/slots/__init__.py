"""Evaluates a simulator in processes of its own, so that whatever it does costs one evaluation. Start at `pool`."""
