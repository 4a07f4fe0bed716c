"""Small charts as inline SVG: axes with round ticks, lines, marks, text; independent of the data model.

The colours are those of the light theme, since a report is printed on white.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from markupsafe import Markup, escape

from campaigns.claims.numbers import fixed, plain

INK, INK2, INK3, GRID, AXIS = "#15202b", "#435061", "#5d6a7b", "#e9ecf0", "#8793a1"
NOMINAL, WORST, OBSTACLE, BAD = "#77838f", "#d55e00", "#0072b2", "#a33c00"

Point = tuple[float, float]


def linear_ticks(low: float, high: float, about: float) -> list[float]:
    """About `about` round numbers within a range."""
    if not high > low or about < 1:
        return [low]
    raw = (high - low) / about
    power = 10.0 ** math.floor(math.log10(raw))
    step = next((m for m in (1, 2, 2.5, 5) if m * power >= raw * 0.999), 10) * power
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [float(f"{i * step:.12g}") for i in range(first, last + 1)]


def log_ticks(low: float, high: float) -> list[float]:
    return [10.0**k for k in range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)]


def tick_decimals(ticks: Sequence[float]) -> int:
    """Number of decimals needed to distinguish adjacent ticks."""
    gaps = [b - a for a, b in itertools.pairwise(ticks) if b > a]
    if not gaps:
        return 0 if not ticks or ticks[0] == 0 else max(0, 3 - math.floor(math.log10(abs(ticks[0]))))
    decimals = max(0, -math.floor(math.log10(min(gaps)) + 1e-9))
    scaled = min(gaps) * 10.0**decimals
    return decimals + (abs(scaled - round(scaled)) > 1e-6)


def padded(values: Iterable[float], air: float = 0.06) -> tuple[float, float]:
    """A range around the values with padding on both sides; never empty."""
    finite = [v for v in values if math.isfinite(v)]
    if not finite:
        return 0.0, 1.0
    low, high = min(finite), max(finite)
    reach = (high - low) * air or abs(high) * 0.05 or 1.0
    return low - reach, high + reach


@dataclass
class Axes:
    """A drawing with a plot area; methods take x and y in the units of the data."""

    width: float
    height: float
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    left: float = 44
    right: float = 10
    top: float = 10
    bottom: float = 34
    x_log: bool = False
    parts: list[Markup] = field(default_factory=list)

    def x(self, value: float) -> float:
        low, high = self.x_range
        share = (
            math.log(max(value, low) / low) / math.log(high / low) if self.x_log else (value - low) / (high - low or 1)
        )
        return self.left + share * (self.width - self.left - self.right)

    def y(self, value: float) -> float:
        low, high = self.y_range
        return self.height - self.bottom - (value - low) / (high - low or 1) * (self.height - self.bottom - self.top)

    def add(self, form: str, *values: object) -> None:
        """Append a piece of SVG; the values are escaped."""
        self.parts.append(Markup(form).format(*values))

    def text(
        self, x: float, y: float, words: object, anchor: str = "middle", colour: str = INK3, weight: int = 400
    ) -> None:
        """Text at a position [px], with a white outline, so that it is readable on lines."""
        form = (
            '<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="{}" font-weight="{}" paint-order="stroke" '
            'stroke="#fff" stroke-width="3" stroke-linejoin="round">{}</text>'
        )
        self.parts.append(Markup(form).format(x, y, anchor, colour, weight, words))

    def rule(self, x0: float, y0: float, x1: float, y1: float, colour: str, width: float = 1, dash: str = "") -> None:
        form = '<path d="M{:.1f} {:.1f}L{:.1f} {:.1f}" stroke="{}" stroke-width="{}" fill="none"{}/>'
        dashed = Markup(' stroke-dasharray="{}"').format(dash) if dash else ""
        self.add(form, x0, y0, x1, y1, colour, width, dashed)

    def frame(
        self,
        x_title: object,
        about_x: float = 6,
        about_y: float = 5,
        y_grid: bool = True,
        x_marks: Sequence[float] = (),
    ) -> None:
        """Grid, ticks (`x_marks` where given) and the title of x; the title of y is above, as on the pages."""
        if y_grid:
            ticks = linear_ticks(*self.y_range, about_y)
            for tick in ticks:
                self.rule(self.left, self.y(tick), self.width - self.right, self.y(tick), GRID)
                words = fixed(tick, tick_decimals(ticks)) if len(ticks) > 1 else plain(tick)
                self.text(self.left - 6, self.y(tick) + 3.4, words, "end")
        foot = self.height - self.bottom
        self.rule(self.left, foot, self.width - self.right, foot, AXIS)
        marks = x_marks or (log_ticks(*self.x_range) if self.x_log else linear_ticks(*self.x_range, about_x))
        for mark in marks:
            self.rule(self.x(mark), foot, self.x(mark), foot + 4, AXIS)
            words = plain(mark) if self.x_log or x_marks else fixed(mark, tick_decimals(marks))
            self.text(self.x(mark), foot + 14, words)
        middle = (self.left + self.width - self.right) / 2
        self.text(middle, self.height - 4, x_title, colour=INK2)

    def line(
        self, points: Sequence[Point], colour: str, width: float = 1.5, dash: str = "", step: bool = False
    ) -> None:
        """A line through points in the units of the data; `step` holds each value until the next."""
        if len(points) < 2:
            return
        path = [f"M{self.x(points[0][0]):.1f} {self.y(points[0][1]):.1f}"]
        for a, b in points[1:]:
            path.append(f"H{self.x(a):.1f}V{self.y(b):.1f}" if step else f"L{self.x(a):.1f} {self.y(b):.1f}")
        dashed = Markup(' stroke-dasharray="{}"').format(dash) if dash else ""
        form = '<path d="{}" stroke="{}" stroke-width="{}" fill="none" stroke-linejoin="round" clip-path="url(#{})"{}/>'
        self.add(form, "".join(path), colour, width, self.clip, dashed)

    def dot(self, x: float, y: float, colour: str, radius: float = 3.4) -> None:
        form = '<circle cx="{:.1f}" cy="{:.1f}" r="{}" fill="{}" stroke="#fff" stroke-width="1.3"/>'
        self.add(form, self.x(x), self.y(y), radius, colour)

    def tint(self, value: float | None) -> None:
        """Shade the violating side of the criterion, if there is one; call it first."""
        if value is None or not self.y_range[0] <= value <= self.y_range[1]:
            return
        at, foot = self.y(value), self.height - self.bottom
        tint = '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}" fill-opacity="0.055"/>'
        self.add(tint, self.left, at, self.width - self.left - self.right, foot - at, WORST)

    def criterion(self, value: float | None, words: str, right: bool = True) -> None:
        if value is None or not self.y_range[0] <= value <= self.y_range[1]:
            return
        at = self.y(value)
        self.rule(self.left, at, self.width - self.right, at, INK, 1.1, "5 4")
        if words:
            place = self.width - self.right - 4 if right else self.left + 4
            self.text(place, at - 4, words, "end" if right else "start", INK, 500)

    @property
    def clip(self) -> str:
        """The id of the clip path; areas of the same size share an id."""
        return f"c{self.width:.0f}-{self.height:.0f}-{self.left:.0f}-{self.right:.0f}-{self.top:.0f}-{self.bottom:.0f}"

    def svg(self, label: str) -> Markup:
        """The drawing; `label` is its accessible description."""
        area = Markup(
            '<clipPath id="{}"><rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/></clipPath>'
        ).format(
            self.clip,
            self.left,
            self.top,
            self.width - self.left - self.right,
            self.height - self.top - self.bottom,
        )
        body = Markup("").join([area, *self.parts])
        form = (
            '<svg class="ch" viewBox="0 0 {0:.0f} {1:.0f}" width="{0:.0f}" height="{1:.0f}" role="img" '
            'aria-label="{2}">{3}</svg>'
        )
        return Markup(form).format(self.width, self.height, escape(label), body)
