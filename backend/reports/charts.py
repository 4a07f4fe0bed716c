"""Selects the figures of a report from the stored results."""

from __future__ import annotations

import math
from typing import NamedTuple

from markupsafe import Markup

from backend.reports import figures, plan_view, plot, words
from backend.reports.plot import Axes
from backend.reports.record import Record
from campaigns.claims import numbers
from campaigns.claims.spans import Spans
from campaigns.results.attraction import Section, TrimState
from campaigns.results.sample import Sample
from campaigns.results.slices import Curve

MOST_CURVES = 12
"""Those with the largest effects, and of these a page of paper holds no more."""
PROVED = "#009e73"
SIDE = 205
SECTION = "the proved region and simulated ends"


def drawn(record: Record) -> dict[str, object]:
    """Every figure by name; None or empty if there are no stored data for it."""
    timed = [case for case in record.cases if case.points("t", "separation")]
    return {
        "plan": plan_view.plan_view(record.cases, record.of) if record.cases else None,
        "plan_up": plan_view.up(record.cases),
        "plan_caption": plan_view.caption(record.cases, record.of) if record.cases else "",
        "separation": figures.separation(timed, record.of) if timed else None,
        "convergence": _convergence(record),
        "keys": [(title, colour) for colour, title, _ in _series(record)],
        "sensitivity": _sensitivity(record),
        "sensitivity_gaps": _gaps(record),
        "sensitivity_left_out": _symbols(record, [c for c in _curves(record) if c not in _shown(record)]),
        "through_worst": bool(_slices(record)),
        "tornado": _tornado(record),
        "tornado_left_out": _symbols(record, [c for c in _curves(record) if None in (c.costs[0], c.costs[-1])]),
        "histogram": _histogram(record),
        **_off(record),
    }


def _off(record: Record) -> dict[str, bool]:
    """The figures whose axis does not include the criterion because it is too far away; their captions state so."""
    limit = record.of.threshold
    if limit is None:
        return {"off": False, "sensitivity_off": False, "sample_off": False}
    found = [y for _, _, points in _series(record) for _, y in points]
    studied = [c for curve in _curves(record) for c in curve.costs if c is not None]
    stated = sample(record)
    edges = (stated.histogram.edges if stated is not None and stated.histogram is not None else []) or [limit]
    spread = edges[-1] - edges[0] or 1.0
    return {
        "off": bool(found) and figures.is_far(found, limit),
        "sensitivity_off": bool(studied) and not _holds(record, studied),
        "sample_off": not edges[0] - 2 * spread <= limit <= edges[-1] + 2 * spread,
    }


def _holds(record: Record, values: list[float]) -> bool:
    """Whether the criterion is near enough to these values to be on their axis."""
    low, high = plot.padded(values, 0.12)
    limit = record.of.threshold
    return limit is not None and low - 6 * (high - low) <= limit


def _series(record: Record) -> list[tuple[str, str, list[plot.Point]]]:
    """The convergence history of every search: colour, title, points."""
    found = []
    for series in record.evaluations.stages:
        if series.method is not None:
            steps = zip(series.improvements["index"], series.improvements["cost"], strict=True)
            points = [(index + 1.0, cost) for index, cost in steps]
            found.append((_colour(record, series.method), record.titled(series.method), points))
    return [row for row in found if row[2]]


def _colour(record: Record, method: str | None) -> str:
    look = record.looks.method(method or "")
    return plot.NOMINAL if look is None else look.colour


def _convergence(record: Record) -> Markup | None:
    series = _series(record)
    return figures.convergence(series, record.of) if series else None


def _curves(record: Record) -> list[Curve]:
    return [curve for result in record.every for curve in result.slices]


def _shown(record: Record) -> list[Curve]:
    """The curves of the figure in their order: if there are too many, those with gaps and those that vary most."""

    def effect(curve: Curve) -> float:
        known = [cost for cost in curve.costs if cost is not None]
        return max(known) - min(known) if len(known) == len(curve.costs) else math.inf

    curves = _curves(record)
    least = sorted(curves, key=effect)[: max(0, len(curves) - MOST_CURVES)]
    return [curve for curve in curves if curve not in least]


def _gaps(record: Record) -> int:
    """Evaluations of the curves that are shown which have no value."""
    through = _slices(record)
    shown = [c for curve in _shown(record) for c in (curve, through.get(curve.path)) if c is not None]
    return sum(cost is None for curve in shown for cost in curve.costs)


def _symbols(record: Record, curves: list[Curve]) -> Markup:
    """Parameters by their symbols, for a sentence."""
    return Markup(", ").join(words.symbol_html(record.symbol(curve.path), curve.path) for curve in curves)


def _slices(record: Record) -> dict[str, Curve]:
    """The curves through the worst case by path, if they were evaluated."""
    through = None if record.worst is None else record.worst.slices
    return {} if through is None else {curve.path: curve for curve in through.curves}


def _sensitivity(record: Record) -> list[tuple[Markup, str, Markup]]:
    """A small chart for each parameter: symbol, description, drawing."""
    curves, through = _shown(record), _slices(record)
    values = [c for curve in [*curves, *through.values()] for c in curve.costs if c is not None]
    if not values:
        return []
    near = [record.of.threshold] if record.of.threshold is not None and _holds(record, values) else []
    low, high = plot.padded([*values, *near], 0.1)
    found = []
    for curve in curves:
        about = _about(record, curve)
        svg = figures.sensitivity(curve, through.get(curve.path), about, (low, high), record.of)
        found.append((words.symbol_html(about.symbol, curve.path), about.text, svg))
    return found


def _about(record: Record, curve: Curve) -> figures.About:
    path = curve.path
    entry = record.entry(path)
    nominal, low, high = record.limits.get(path, (curve.values[0], curve.values[0], curve.values[-1]))
    return figures.About(
        symbol=record.symbol(path),
        text=record.words(path),
        unit=numbers.unit_in_print(entry.unit) if entry else "",
        nominal=nominal,
        low=low,
        high=high,
        nominal_cost=record.run.nominal_cost if path in record.limits else None,
    )


def _tornado(record: Record) -> Markup | None:
    nominal = record.run.nominal_cost
    bars = []
    for curve in _curves(record):
        low, high = curve.costs[0], curve.costs[-1]
        if nominal is not None and low is not None and high is not None:
            bars.append((_about(record, curve).symbol, low - nominal, high - nominal))
    bars.sort(key=lambda bar: -max(abs(bar[1]), abs(bar[2])))
    return figures.tornado(bars, record.of) if bars else None


def sample(record: Record) -> Sample | None:
    """The independent sample behind the statistical statement: that of certify, else of the first random search."""
    if record.certificate is not None:
        return record.certificate.sample
    searched = [result.sample for result in record.searched.values()]
    return next((s for s in searched if s is not None and s.upper_bound is not None), None)


def _histogram(record: Record) -> Markup | None:
    stated = sample(record)
    if stated is None or stated.histogram is None or not any(stated.histogram.counts):
        return None
    worst = None if record.worst is None else record.worst.granted
    return figures.histogram(stated.histogram.edges, stated.histogram.counts, record.of, record.run.nominal_cost, worst)


class Region(NamedTuple):
    """A result, and a small chart for every pair of states."""

    statement: Spans
    sections: list[Markup]


def attraction(record: Record) -> Region | None:
    """The region of a run, or why there is none; None if none was asked for."""
    of = next((result.attraction for result in record.every if result.attraction is not None), None)
    if of is None:
        return None
    return Region(of.statement, [_section(one, [of.states[k] for k in one.states]) for one in of.sections])


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
