"""Public falsification problems, ported from their papers: the cost is the robustness of a requirement.

An input violates the requirement where its cost is at or below 0. Inputs are piecewise constant in time, one parameter
of the unit cube for each piece. Start reading at `PROBLEMS`.
"""

from tests.given.falsification.aircraft import PROBLEMS as AIRCRAFT
from tests.given.falsification.problem import Falsification
from tests.given.falsification.transmission import PROBLEMS as TRANSMISSION
from tests.given.falsification.vehicles import PROBLEMS as VEHICLES

PROBLEMS: dict[str, Falsification] = VEHICLES | TRANSMISSION | AIRCRAFT

__all__ = ["PROBLEMS", "Falsification"]
