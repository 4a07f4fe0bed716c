"""The figures of a report over time and evaluations: separation, convergence, sensitivity, tornado, histogram.

Each function takes stored numbers and returns an SVG; the plan view is in `backend.reports.plan_view`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from backend.reports import plot, words
from backend.reports.declared_view import View
from backend.reports.plot import Axes, Point
from campaigns.claims import numbers
from campaigns.results import TraceHead
from campaigns.results.slices import Curve
from campaigns.results.trace import Closest
from campaigns.symbols import OF, is_path

WIDE = 654
"""Text width of a page, 173 mm [px at 96 dpi]."""
SEPARATION_HEIGHT = 240


@dataclass(frozen=True)
class Case:
    label: str
    colour: str
    head: TraceHead
    data: dict[str, list[float | None]]
    dash: str = ""
    view: View | None = None
    """What a simulator declares; None for a flight of the closed loop."""

    def points(self, x: str, y: str) -> list[Point]:
        """The rows of two columns in which both values are known."""
        pairs = zip(self.data.get(x, []), self.data.get(y, []), strict=False)
        return [(a, b) for a, b in pairs if a is not None and b is not None]

    @property
    def closest(self) -> Closest | None:
        return self.head.approach


@dataclass(frozen=True)
class Quantity:
    symbol: str
    unit: str
    threshold: float | None

    def formatted(self, value: float | None, decimals: int) -> str:
        return f"{numbers.fixed(value, decimals)} {self.unit}".strip()

    def decimals(self, values: Sequence[float | None], least: int) -> int:
        """The decimals, at least so many, with which each value is read on its own side of the threshold."""
        return least if self.threshold is None else numbers.decimals_beside(values, self.threshold, least)

    def plain(self, value: float | None) -> str:
        """A value of a sentence, read on its own side of the threshold."""
        if value is None or self.threshold is None:
            return numbers.plain(value)
        return numbers.plain(value, numbers.digits_beside(value, self.threshold))


def separation(cases: Sequence[Case], of: Quantity) -> Markup:
    """The criterion's value over time around the encounter, with the closest approaches."""
    curves = [case.points("t", "separation") for case in cases]
    lowest = min((y for curve in curves for _, y in curve), default=0.0)
    reach = 2.2 * max(of.threshold or 0.0, lowest)
    near = [t for curve in curves for t, y in curve if y <= reach] or [t for curve in curves for t, _ in curve]
    span = (min(near), max(near)) if len(near) > 2 else (0.0, 1.0)
    highest = max((y for curve in curves for t, y in curve if span[0] <= t <= span[1]), default=1.0)
    axes = Axes(WIDE, SEPARATION_HEIGHT, span, (min(0.0, lowest), 1.04 * highest))
    axes.tint(of.threshold)
    axes.frame("Time since start, s", 8)
    axes.criterion(of.threshold, f"Criterion, {numbers.exact(of.threshold)} {of.unit}")
    for case, curve in zip(cases, curves, strict=True):
        axes.line(curve, case.colour, 1.7, case.dash)
    approaches = [(case, case.closest) for case in cases]
    known = sorted(((case, c) for case, c in approaches if c is not None), key=lambda pair: pair[1].value)
    values = [closest.value for _, closest in known]
    decimals = of.decimals(values, numbers.decimals_for(values))
    used: list[float] = []
    for case, closest in known:
        time, value = closest.time, closest.value
        axes.dot(time, value, case.colour)
        at = _label(axes, value, of.threshold)
        while any(abs(at - other) < 12 for other in used):
            at += 12
        used.append(at)
        label = f"{case.label} {of.formatted(value, decimals)} at {numbers.fixed(time, 2)} s"
        axes.text(axes.x(time), at, label, colour=plot.BAD if case.colour == plot.WORST else plot.INK2, weight=500)
    return axes.svg("Separation over time, with the criterion")


def _label(axes: Axes, value: float, threshold: float | None) -> float:
    """The y position of the label of a closest approach [px]: below it, or below the criterion if that is too near."""
    room = 100.0 if threshold is None else axes.y(threshold) - axes.y(value)
    return axes.y(threshold) + 14 if threshold is not None and 0 <= room <= 44 else axes.y(value) + 16


def convergence(series: Sequence[tuple[str, str, list[Point]]], of: Quantity) -> Markup:
    """Best value so far over evaluations, by method: (colour, title, points)."""
    drawn = [row for row in series if row[2]]
    values = [y for _, _, points in drawn for _, y in points]
    most = max((x for _, _, points in drawn for x, _ in points), default=10.0)
    low, high = plot.padded(values)
    near = None if of.threshold is None or is_far(values, of.threshold) else of.threshold
    if near is not None:
        low, high = plot.padded([*values, near])
    axes = Axes(WIDE / 2 + 20, 200, (1.0, max(most * 1.1, 10.0)), (low, high), left=52, x_log=True)
    axes.tint(near)
    axes.frame("Evaluations of each method (log scale)")
    axes.criterion(near, f"Criterion, {numbers.exact(near)} {of.unit}", right=False)
    for colour, _, points in drawn:
        axes.line(points, colour, 1.5, step=True)
    for colour, _, points in drawn:
        axes.dot(*points[-1], colour, 3)
    return axes.svg(f"Best {of.symbol} so far by method")


def is_far(values: Sequence[float], threshold: float) -> bool:
    """Whether an axis that includes the criterion would flatten the steps to a line."""
    low, high = plot.padded(values)
    return not low - 3 * (high - low) <= threshold <= high + (high - low)


@dataclass(frozen=True)
class About:
    """A parameter as its figure names it: bounds and nominal value, and the nominal cost if it is known there."""

    symbol: str
    text: str
    unit: str
    nominal: float
    low: float
    high: float
    nominal_cost: float | None


def sensitivity(curve: Curve, other: Curve | None, about: About, y_range: Point, of: Quantity) -> Markup:
    """One parameter over its bounds, the others nominal and, if evaluated, the others at the worst case."""
    low, high = about.low, about.high
    axes = Axes(208, 112, (low, high), y_range, left=44, right=16, top=6, bottom=30)
    axes.tint(of.threshold)
    title = Markup("{}{}").format(words.svg_symbol(about.symbol), f", {about.unit}" if about.unit else "")
    axes.frame(title, 2.2, 4, x_marks=(low, about.nominal, high) if low < about.nominal < high else (low, high))
    axes.criterion(of.threshold, "")
    for shown, colour in ((curve, plot.NOMINAL), (other, plot.WORST)):
        if shown is not None:
            for part in _unbroken(shown):
                axes.line(part, colour, 1.5)
                if len(part) == 1:
                    axes.dot(*part[0], colour, 1.8)
    if about.nominal_cost is not None:
        axes.dot(about.nominal, about.nominal_cost, plot.NOMINAL, 2.8)
    return axes.svg(f"{of.symbol} over {about.symbol}")


def _unbroken(curve: Curve) -> list[list[Point]]:
    """The parts of a curve between evaluations without a value, which no line may bridge."""
    parts: list[list[Point]] = [[]]
    for x, y in zip(curve.values, curve.costs, strict=False):
        if y is None:
            parts.append([])
        else:
            parts[-1].append((x, y))
    return [part for part in parts if part]


def tornado(bars: Sequence[tuple[str, float, float]], of: Quantity) -> Markup:
    """Change from nominal at the low and the high bound of each parameter, largest first."""
    most = max((max(abs(a), abs(b)) for _, a, b in bars), default=1.0) or 1.0
    row = 22
    left = max([52.0, *(5.4 * len(symbol) for symbol, _, _ in bars if is_path(symbol) or OF in symbol)])
    axes = Axes(
        WIDE / 2 - 46, row * len(bars) + 44, (-1.3 * most, 1.3 * most), (0, 1), left=left, right=4, top=4, bottom=34
    )
    title = Markup("Change of {}, {}").format(words.svg_symbol(of.symbol), of.unit)
    axes.frame(title, 4, y_grid=False)
    bar = '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="10" fill="{}" fill-opacity="{}"/>'
    for i, (symbol, *changes) in enumerate(bars):
        top = 8 + i * row
        axes.text(4, top + 8.5, words.svg_symbol(symbol), "start", plot.INK, 500)
        for name, change in zip(("low", "high"), changes, strict=True):
            x0, x1 = sorted((axes.x(0), axes.x(change)))
            down = change < 0
            axes.add(bar, x0, top, max(1.0, x1 - x0), plot.WORST if down else plot.NOMINAL, 1 if down else 0.55)
            alone = (changes[0] < 0) != (changes[1] < 0) or abs(change) == max(map(abs, changes))
            if alone:
                axes.text(x0 - 4 if down else x1 + 4, top + 8.5, name, "end" if down else "start")
    axes.rule(axes.x(0), 2, axes.x(0), axes.height - axes.bottom, plot.INK, 1.2)
    return axes.svg(f"Change of {of.symbol} at the bounds of each parameter")


def histogram(
    edges: Sequence[float], counts: Sequence[int], of: Quantity, nominal: float | None, worst: float | None
) -> Markup:
    """The independent sample, with criterion, nominal and worst case if they are within the axis."""
    first, last = edges[0], edges[-1]
    spread = last - first or 1.0
    marks = [("Criterion", of.threshold, plot.INK, "5 4"), ("Worst found", worst, plot.WORST, "")]
    marks.append(("Nominal", nominal, plot.INK2, ""))
    near = [m for m in marks if m[1] is not None and first - 2 * spread <= m[1] <= last + 2 * spread]
    low = min([first, *(m[1] for m in near if m[1] is not None)]) - 0.04 * spread
    high = max([last, *(m[1] for m in near if m[1] is not None)]) + 0.04 * spread
    axes = Axes(WIDE / 2 + 30, 200, (low, high), (0, 1.02 * max(counts)), left=40, top=44)
    axes.frame(Markup("{}, {}").format(words.svg_symbol(of.symbol), of.unit), 5, 4)
    bar = '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}" fill-opacity="{}"/>'
    for a, b, n in zip(edges, edges[1:], counts, strict=False):
        bad = of.threshold is not None and b <= of.threshold
        height = axes.height - axes.bottom - axes.y(n)
        x0, x1 = axes.x(a), axes.x(b)
        axes.add(
            bar,
            x0 + 0.4,
            axes.y(n),
            max(0.8, x1 - x0 - 0.8),
            height,
            plot.WORST if bad else plot.NOMINAL,
            1 if bad else 0.7,
        )
    values = [m[1] for m in near]
    decimals = of.decimals(values, numbers.decimals_for(values))
    for i, (name, value, colour, dash) in enumerate(near):
        at = axes.x(value or 0.0)
        axes.rule(at, 8 + 12 * i, at, axes.height - axes.bottom, colour, 1.2, dash)
        left = at > axes.width / 2
        label = f"{name} {of.formatted(value, decimals)}"
        axes.text(at - 4 if left else at + 4, 12 + 12 * i, label, "end" if left else "start", colour, 500)
    return axes.svg(f"Histogram of {of.symbol} over the sample")


def within(low: float, high: float, nominal: float, worst: float | None) -> Markup:
    """The position of a value within its bounds, for a table row."""
    width = 96

    def x(value: float) -> float:
        return 5 + (width - 10) * (min(max(value, low), high) - low) / (high - low or 1)

    dot = '<circle cx="{:.1f}" cy="7" r="3.4" fill="{}"/>'
    form = (
        '<svg class="wi" viewBox="0 0 96 14" width="96" height="14" aria-hidden="true">'
        '<path d="M5 7H91M5 3.5v7M91 3.5v7" stroke="#c8d0d9" stroke-width="1.4"/>'
        '<path d="M{:.1f} 2v10" stroke="{}" stroke-width="1.8"/>{}</svg>'
    )
    mark = Markup("") if worst is None else Markup(dot).format(x(worst), plot.WORST)
    return Markup(form).format(x(nominal), plot.NOMINAL, mark)
