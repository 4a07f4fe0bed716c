"""Whether a campaign can be run: validated against the catalogue, its limits and what it asks of the machine.

Start reading at `check`.
"""
