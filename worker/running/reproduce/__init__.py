"""Reproduces the published case studies: tables, Monte Carlo runs and figure data, next to the published values.

Source: S. Srikanthakumar, Optimisation-Based Verification Process of Obstacle Avoidance Systems for Unmanned Vehicles
(Loughborough). `published` defines a published result, `robots` and `aircraft` hold the data, `ours` computes,
`compare` compares, `render` writes. Start reading at `compare.reproduce`.
"""
