"""Potential field in space whose goal stays reachable next to an obstacle (GNRON).

    U_rep = 1/2 k_rep (1/d - 1/d_0)^2 g^n   for d <= d_0,   g = |goal - q|
    F = k_att (goal - q) + sum over obstacles of
        k_rep (1/d - 1/d_0) g^n / d^2 * normal  +  n/2 k_rep (1/d - 1/d_0)^2 g^(n-1) * unit vector to the goal

d is the distance from the obstacle's surface, normal the unit vector away from it: any number of obstacles of any
shape. Farther from the goal than s the attraction is conic: its force stays k_att s (2.7). Below d = 1 mm the
repulsion keeps its value at 1 mm.
Source: Ge and Cui, New potential functions for mobile robot path planning (2000); Srikanthakumar, equations 2.7 and
2.9. n is 0, 1, 2 or 3 (rounded); 0 is FIRAS (2.8). With n >= 1 the repulsion vanishes at the goal, which FIRAS does not
do; local minima remain.
"""

from __future__ import annotations

from dataclasses import replace

from worker.engine.components.avoiders import gnron
from worker.engine.physics.vectors import SpatialGoal

component = replace(gnron.component, name="gnron_3d", dimension=3, goal=SpatialGoal)
