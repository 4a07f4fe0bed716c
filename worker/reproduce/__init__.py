"""The published case studies, computed again beside what was published: tables, Monte Carlo runs, data of figures.

Source: S. Srikanthakumar, Optimisation-Based Verification Process of Obstacle Avoidance Systems for Unmanned Vehicles
(Loughborough). `published` says what a published result is, `robots` and `aircraft` hold them as data, `ours` computes,
`compare` judges, `render` writes. Start reading at `compare.reproduce`.
"""
