"""An avoider's demands on a grid in scene coordinates: colours, arrows and legend."""

from __future__ import annotations

import html
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backend.scenes.base.axes import Axes, Floats
from backend.scenes.base.setting import Setting
from backend.scenes.drawing.world import Frame
from backend.scenes.panel import tables
from campaigns.stored.replies import FieldReply

PLACES = 1600
"""Approximate number of grid positions."""
EVERY = 4
"""Spacing of arrows in cells."""
MARGIN = 0.1
"""Margin of the plane around the scene's box, as a fraction of the longer side."""
NARROWEST = 0.35
"""Minimum ratio of its shorter to its longer side."""
DECADES = 100.0
"""Range of the colour scale: this factor above and below the typical magnitude."""
OPACITY = 150
"""Opacity, of 255."""


@dataclass(frozen=True)
class Grid:
    columns: int
    rows: int
    cell: float
    """Side of a cell [m]."""
    middle: tuple[float, float]

    @classmethod
    def over(cls, frame: Frame) -> Grid:
        wide, deep = (float(side) for side in frame.sides[:2])
        longest = max(wide, deep, 1e-3) * (1 + 2 * MARGIN)
        wide, deep = (max(side + 2 * MARGIN * longest, NARROWEST * longest) for side in (wide, deep))
        cell = float(np.sqrt(wide * deep / PLACES))
        middle = float(frame.middle[0]), float(frame.middle[1])
        return cls(max(2, round(wide / cell)), max(2, round(deep / cell)), cell, middle)

    @property
    def places(self) -> Floats:
        """The centres of the cells (rows, columns, 2), y and x increasing."""
        x, y = (
            middle + self.cell * (np.arange(count) - (count - 1) / 2)
            for middle, count in zip(self.middle, (self.columns, self.rows), strict=True)
        )
        return np.stack(np.meshgrid(x, y), axis=-1)


@dataclass(frozen=True, eq=False)
class Slice:
    """The demands on a grid in scene coordinates (rows, columns, 3), NaN if undefined."""

    grid: Grid
    demand: Floats
    own: Floats | None
    height: float
    time: float
    kind: str
    unit: str
    memory: int

    @property
    def magnitude(self) -> Floats:
        """The length of the demands (rows, columns)."""
        found: Floats = np.linalg.norm(self.demand, axis=-1)
        return found

    @property
    def ends(self) -> tuple[float, float] | None:
        """The range of the colour scale, which ignores the few large values near a singularity."""
        known = self.magnitude[np.isfinite(self.magnitude) & (self.magnitude > 0)]
        if known.size == 0:
            return None
        low, middle, high = (float(end) for end in np.quantile(known, (0.01, 0.5, 0.99)))
        return max(low, middle / DECADES), min(high, middle * DECADES)

    def shares(self) -> Floats:
        """Position on the logarithmic scale (rows, columns); 0 if all are equal or undefined."""
        ends = self.ends
        if ends is None or ends[1] < ends[0] * (1 + 1e-6):
            return np.zeros(self.magnitude.shape)
        with np.errstate(divide="ignore"):
            found: Floats = np.log(self.magnitude / ends[0]) / np.log(ends[1] / ends[0])
        return np.nan_to_num(np.clip(found, 0.0, 1.0))


def read(answer: FieldReply, grid: Grid, axes: Axes) -> Slice:
    rows = [row or (np.nan,) * 3 for row in answer["demand"]]
    demand = axes.drawn(np.array(rows, dtype=np.float64)).reshape(grid.rows, grid.columns, 3)
    own = None if answer["own"] is None else axes.drawn(np.array(answer["own"], dtype=np.float64))
    height = float(axes.drawn(np.array(answer["place"], dtype=np.float64))[2])
    return Slice(grid, demand, own, height, answer["time"], answer["kind"], answer["unit"], answer["memory"])


def picture(found: Slice, dark: bool) -> NDArray[np.uint8]:
    """Red, green, blue, opacity (rows, columns, 4); transparent if undefined. Large demands stand out."""
    opacity = np.where(np.isfinite(found.magnitude), OPACITY, 0).astype(np.uint8)
    return np.concatenate([colours(1.0 - found.shares(), dark), opacity[..., None]], axis=-1)


def arrows(found: Slice) -> Floats:
    """Arrows (n, 2, 3) of equal length in the demand's direction, centred on every few cells."""
    grid, first = found.grid, EVERY // 2
    places = grid.places[first::EVERY, first::EVERY].reshape(-1, 2)
    demand = found.demand[first::EVERY, first::EVERY].reshape(-1, 3)
    size = np.linalg.norm(demand, axis=1)
    there = np.isfinite(size) & (size > 0)
    middle = np.column_stack([places, np.full(len(places), found.height)])[there]
    half = 0.38 * EVERY * grid.cell * demand[there] / size[there, None]
    return np.stack([middle - half, middle + half], axis=1)


def legend(found: Slice, title: str, setting: Setting, dark: bool) -> str:
    magnitude, unit = found.magnitude, found.unit
    known = magnitude[np.isfinite(magnitude)]
    name = str(setting.document["scenario"]["avoider"]["component"]).replace("_", " ")
    where = "over the plane" if setting.planar else f"at the height of {_number(found.height)} m"
    caption = (
        f"{found.kind.capitalize()} [{unit}] that the avoider ({name}) demands {where}, at t = {found.time:.2f} s of "
        f"{title}: with the vehicle's velocity and attitude and the perceived obstacles at that time"
    )
    caption += ", and with the avoider's memory at that time. " if found.memory else ". "
    caption += "Before the controller's own limits."
    parts = [_scale(found, dark), tables.note(caption)]
    sentences = []
    if known.size:
        sentences.append(f"Smallest {_number(float(known.min()))}, largest {_number(float(known.max()))} {unit}.")
    if found.own is not None:
        sentences.append(f"At the vehicle: {_number(float(np.linalg.norm(found.own)))} {unit}.")
    none, zero = int(np.isnan(magnitude).sum()), int((known == 0).sum())
    sentences += [f"{none} of {magnitude.size} positions have no demand and no colour."] if none else []
    sentences += [f"{zero} of {magnitude.size} positions have zero demand."] if zero else []
    return "".join([*parts, tables.note(" ".join(sentences))])


def _scale(found: Slice, dark: bool) -> str:
    ends = found.ends
    if ends is None:
        return tables.note("The demand is zero everywhere.", strong=True)
    if ends[1] < ends[0] * (1 + 1e-6):
        return tables.note(f"Uniform: {_number(ends[0])} {found.unit}.", strong=True)
    texts = [_number(ends[0]), f"{_number(float(np.sqrt(ends[0] * ends[1])))}", f"{_number(ends[1])} {found.unit}"]
    bar = f'<div style="height:10px;border-radius:2px;background:{gradient(dark)}"></div>'
    labels = "".join(f"<span>{html.escape(text)}</span>" for text in texts)
    return (
        f'<div style="margin:6px 10px;font-size:0.85em;font-variant-numeric:tabular-nums">{bar}'
        f'<div style="display:flex;justify-content:space-between">{labels}</div>'
        '<div style="opacity:0.7">logarithmic; values beyond the ends have the colours of the ends</div></div>'
    )


def _number(value: float) -> str:
    return f"{float(f'{value:.3g}'):g}".replace("-", "−")


VIRIDIS = np.array(
    [
        (68, 1, 84),
        (72, 36, 117),
        (65, 68, 135),
        (53, 95, 141),
        (42, 120, 142),
        (33, 145, 140),
        (34, 168, 132),
        (68, 191, 112),
        (122, 209, 81),
        (189, 223, 38),
        (253, 231, 37),
    ],
    dtype=np.float64,
)
"""The scale in steps of a tenth."""

PART = {False: (0.0, 0.58), True: (1.0, 0.41)}
"""The part of the scale used from lowest to highest value, in the light and in the dark theme."""


def colours(fractions: ArrayLike, dark: bool) -> NDArray[np.uint8]:
    """Red, green, blue (..., 3) for fractions (...) of the value range, 0 for the lowest; clipped to the range."""
    start, end = PART[dark]
    at = (start + np.clip(np.asarray(fractions, dtype=np.float64), 0.0, 1.0) * (end - start)) * (len(VIRIDIS) - 1)
    known = np.arange(len(VIRIDIS))
    return np.stack([np.interp(at, known, VIRIDIS[:, k]) for k in range(3)], axis=-1).round().astype(np.uint8)


def gradient(dark: bool) -> str:
    """The scale as a CSS background from left (lowest) to right; the highest values stand out."""
    found = colours(1.0 - np.linspace(0.0, 1.0, 9), dark)
    return f"linear-gradient(90deg,{','.join(f'rgb({r},{g},{b})' for r, g, b in found.tolist())})"
