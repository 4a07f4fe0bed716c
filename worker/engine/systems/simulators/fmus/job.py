"""The job of a slot that evaluates an FMU: a file that `simulator` writes and `process` reads."""

from __future__ import annotations

from typing import Any, Literal, TypedDict


class Take(TypedDict):
    """The result that is computed, and how it follows from the samples of its variable."""

    name: str
    variable: str
    reference: int
    take: Literal["minimum", "maximum", "final", "first_crossing"]
    level: float | None
    direction: Literal["rising", "falling", "either"] | None


class Recorded(TypedDict):
    """What a trace records: the references of the variables by column, and the distance of two rows in points."""

    every: int
    columns: dict[str, int]


class Job(TypedDict):
    """Times in seconds; references are those of the variables in the model."""

    file: str
    sha256: str
    fmi: int
    identifier: str
    token: str
    name: str
    categories: list[str]
    start: float
    stop: float
    step: float
    steps: int
    tolerance: float | None
    reuse: str
    """`reset`, `instance` or `process`: how evaluations share a process."""
    set: list[tuple[str, int, Any]]
    """Type, reference and value of every variable that the descriptor fixes."""
    inputs: dict[str, int]
    """The reference of every parameter, by its name in the campaign."""
    trace: Recorded
    result: Take
