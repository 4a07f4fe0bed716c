"""The probability of rare violations by importance sampling over their modes, and the alarm for modes not known.

It draws in standard normal space and knows nothing of simulators. Start reading at `estimate.estimated`.
"""
