"""Draws the sections of a region of attraction: the certified boundary, and how far the loop returns in simulation."""

from __future__ import annotations

import math
from typing import NamedTuple

from markupsafe import Markup

from backend.reports import plot
from backend.reports.plot import Axes
from backend.reports.record import Record
from campaigns.claims import numbers
from campaigns.claims.spans import Spans
from campaigns.results.attraction import Section, TrimState

PROVED = "#009e73"
SIDE = 205
SECTION = "the proved region and simulated ends"


class Stated(NamedTuple):
    """A result, and a small chart for every pair of states."""

    statement: Spans
    sections: list[Markup]


def stated(record: Record) -> Stated | None:
    """The region of a run, or why there is none; None if none was asked for."""
    of = next((result.attraction for result in record.every if result.attraction is not None), None)
    if of is None:
        return None
    return Stated(of.statement, [_section(one, [of.states[k] for k in one.states]) for one in of.sections])


def _section(section: Section, states: list[TrimState]) -> Markup:
    proved = _points(section.proved, states)
    simulated = _points(section.simulated, states)
    xs, ys = zip(*proved, *simulated, strict=True)
    axes = Axes(SIDE, SIDE, plot.padded(xs), plot.padded(ys), left=46)
    x, y = (f"{state.symbol}, {numbers.unit_in_print(state.unit)}" for state in states)
    axes.frame(x, about_x=3, about_y=4)
    axes.line([*proved, proved[0]], PROVED, 1.8)
    for point in simulated:
        axes.dot(*point, plot.NOMINAL, 2.2)
    axes.text(axes.left, 8, y, "start", plot.INK2)
    return axes.svg(f"{y} over {x}: {SECTION}")


def _points(radii: list[float] | list[float | None], states: list[TrimState]) -> list[plot.Point]:
    """The points of a boundary in the units of the states; rays without an end have none."""
    found = []
    for k, r in enumerate(radii):
        if r is not None:
            angle = 2.0 * math.pi * k / len(radii)
            directions = math.cos(angle), math.sin(angle)
            a, b = (s.trim + r * (s.reach or 0.0) * f for s, f in zip(states, directions, strict=True))
            found.append((a, b))
    return found
