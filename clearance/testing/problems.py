"""The problem of a campaign, with access to its closed loop for tests."""

from __future__ import annotations

from campaigns import Campaign
from worker.engine.problem import problem
from worker.engine.systems.closed_loop.assemble import LANES
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.running.opening.opened import closed_loop


class Problem(problem.Problem):
    """A problem over the closed loop of its campaign; compiled flights unless `compiled` is False.

    In plain Python it has one lane: a wider loop simulates a whole block, whatever the number of vectors.
    """

    system: ClosedLoop

    def __init__(self, campaign: Campaign, compiled: bool = True, lanes: int | None = None) -> None:
        super().__init__(campaign, closed_loop(campaign, compiled, lanes or (LANES if compiled else 1)))

    def under(self, seed: int | None) -> Problem:
        """The problem under one realisation; itself for None."""
        one = Problem.__new__(Problem)
        problem.Problem.__init__(one, self.campaign, self.system.under(seed))
        return one
