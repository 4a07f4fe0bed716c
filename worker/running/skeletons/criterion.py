"""My criterion: the smallest distance to any obstacle's surface over the trajectory.

    d_min = min over t <= T and obstacles of d(t),   clear when d_min > threshold

A simulation that starts at or inside the threshold is excluded: it would show nothing.
Source: none, an example; replace this line by your own source. This text is the help page of the component.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Criterion, Parameter
from worker.engine.kernels.maths import kernel


class MyCriterion(NamedTuple):
    # A criterion that decides has `threshold` first: its value must stay above it.
    threshold: Annotated[float, Parameter("m", "Distance that must be kept", -1e3, 1e6, symbol="d_0")]


@kernel
def sample(t: float, q: Any, v: Any, x: Any, u: Any, body: Any, p: MyCriterion) -> tuple[float]:
    # One channel for each obstacle at one instant, from the true position q, velocity v, state x and inputs u.
    return (body.gap,)


@kernel
def value(lowest: Any, p: MyCriterion) -> float:
    # From the lowest value of each channel over time.
    nearest = lowest[0]
    for each in lowest:
        nearest = each if each < nearest else nearest
    return nearest  # type: ignore[no-any-return]


@kernel
def excluded(first: Any, p: MyCriterion) -> bool:
    # Whether the channels at the start make the simulation meaningless.
    return value(first, p) <= p.threshold


component = Criterion(
    name="my_criterion",
    title="My criterion",
    quantity="d_min",
    unit="m",
    parameters=MyCriterion,
    sample={2: sample, 3: sample},
    value=value,
    excluded=excluded,
    measured_to="surface",
    over="searched",  # a distance to a surface has kinks; "refined" suits smooth channels, "steps" those that jump
)
