"""A stored trace without its data: columns and header."""

from __future__ import annotations

from typing import Annotated, Literal

from campaigns.documented import UNLESS_EMPTY
from campaigns.results.base import Result, Status, Values
from campaigns.results.scene import Scene


class TraceColumn(Result):
    """One column of a trace."""

    name: str
    symbol: str
    unit: str
    group: Literal["time", "pose", "state", "command", "separation", "signal"]
    """`signal`: any quantity that a simulator returns over time."""
    text: Annotated[str, UNLESS_EMPTY] = ""
    """One line on a signal; omitted if it has none."""


class Closest(Result):
    """The closest approach of a trace, refined between its rows."""

    time: float
    """[s]"""
    row: int = 0
    value: float
    """The criterion's value."""
    position: list[float]
    """[m]"""
    speed: float | None = None
    """[m/s]"""
    obstacle: int
    obstacle_position: list[float]
    """[m]"""


class TraceObstacle(Result):
    """An obstacle in its initial state."""

    component: str = ""
    title: str = ""
    position: list[float]
    """[m]"""
    radius: float = 0.0
    """[m]"""
    free_radius: float | None = None
    """Of the disc around its centre that must stay clear [m]; null if the criterion is not a disc."""
    moving: bool = False


class Realisation(Result):
    """Which noise realisation a stored trace shows, of how many."""

    seed: int
    seeds: int
    combine: str
    cost: float | None
    """Of the realisation shown."""


class TraceHead(Result):
    """The header of a trace: everything besides its columns."""

    frame: Literal["enu", "ned"] = "enu"
    vehicle: str = ""
    obstacles: list[TraceObstacle] = []
    start: list[float] = []
    goal: list[float] = []
    threshold: float | None = None
    parameters: Values = {}
    """Of the uncertain parameters, and of those that were changed."""
    closest: Closest | None = None
    status: Status = Status.OK
    reason: str = ""
    cost: float | None = None
    values: dict[str, float | None] = {}
    """{name: value} of every criterion in its own sign."""
    realisation: Realisation | None = None
    """Null without noise."""
    scene: Annotated[Scene | None, UNLESS_EMPTY] = None
    """What the columns of a simulator's trace are positions of; omitted if it does not declare this."""

    @property
    def approach(self) -> Closest | None:
        """The closest approach of an evaluation that ended ok; how near a failed one came is no value of it."""
        return self.closest if self.status == Status.OK else None
