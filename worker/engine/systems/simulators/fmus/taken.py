"""What a result takes from the samples of a variable: an extreme, the last value, or the first crossing of a level."""

from __future__ import annotations

import math

from worker.engine.systems.simulators.fmus.job import Take


class NotTaken(ValueError):
    """The samples do not give the result; the message gives the reason."""


class Taken:
    """One result while a simulation runs: `see` every sample in the order of time, then `value`."""

    def __init__(self, stated: Take) -> None:
        self.variable = stated["variable"]
        self._take = stated["take"]
        self._level = stated["level"]
        self._direction: str = stated["direction"] or "either"
        self._least, self._most = math.inf, -math.inf
        self._last: tuple[float, float] | None = None
        self._crossed: float | None = None

    def see(self, time: float, value: float) -> None:
        if not math.isfinite(value):
            raise NotTaken(f"the variable {self.variable} is {value} at t = {time:g} s")
        if self._level is not None and self._crossed is None and self._last is not None:
            self._crossed = _crossing(self._last, (time, value), self._level, self._direction)
        self._last = (time, value)
        self._least = min(self._least, value)
        self._most = max(self._most, value)

    def value(self) -> float:
        assert self._last is not None
        if self._take == "first_crossing":
            if self._crossed is None:
                raise NotTaken(self._never(self._last[0]))
            return self._crossed
        return {"minimum": self._least, "maximum": self._most, "final": self._last[1]}[self._take]

    def _never(self, end: float) -> str:
        how = "" if self._direction == "either" else f" while {self._direction}"
        return (
            f"the variable {self.variable} does not cross {self._level:g}{how} until t = {end:g} s;"
            f" it stays within [{self._least:g}, {self._most:g}]"
        )


def _crossing(before: tuple[float, float], after: tuple[float, float], level: float, direction: str) -> float | None:
    """The time at which the straight line between two samples reaches the level, coming from one side; or None."""
    (t0, x0), (t1, x1) = before, after
    rises, falls = x0 < level <= x1, x0 > level >= x1
    if (rises and direction != "falling") or (falls and direction != "rising"):
        return t0 + (t1 - t0) * (level - x0) / (x1 - x0)
    return None
