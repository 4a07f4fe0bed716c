"""Generates the code that connects the components of a scenario to the loop."""
